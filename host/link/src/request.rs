//! Requests of a program to the link, and their outcomes.

use crate::hold::HoldRequest;
use crate::listen::{CaptureRequest, Captured, ListenRequest, Listened};
use crate::log::Severity;
use crate::port::Port;
use crate::refusal::Refusal;
use crate::sounding::Sounding;
use crate::table::DeviceTable;
use slipline_protocol::board::{BrownOutOrder, FaultOrder, MuteTrial};
use slipline_protocol::command::DigestWindow;
use slipline_protocol::event::Digest;
use slipline_protocol::profile::ActuatorProfile;
use std::sync::Arc;
use std::time::Duration;

/// One request. Requests are carried out in order, but [`Request::Stop`] and [`Request::EmergencyStop`]
/// overtake all others, and a newer [`Request::Play`] or a [`Request::Disarm`] replaces a [`Request::Play`]
/// that the device has not accepted yet.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum Request {
    /// Open this port and say hello. An open connection is closed first. A port that does not exist is refused
    /// ([`LinkError::NoSuchPort`](crate::LinkError::NoSuchPort)), and waited for if [`Request::AutoReconnect`] is on.
    Connect(Port),
    /// Stop, disarm and close the port.
    Disconnect,
    /// Unmute the amplifier and accept drives.
    Arm,
    /// The same on a lease: without a drive for so long the device stops and disarms by itself. A device of a protocol older than
    /// 1.3 knows no lease and is armed without one.
    ArmFor(Duration),
    /// The same, but the mute pin stays low until the device is disarmed: drives sound at the DAC's output alone.
    Bench(Duration),
    /// Ramp to silence and mute.
    Disarm,
    /// Start a drive, a chord or a comb.
    Play(Sounding),
    /// Measure an input's response to each tone.
    Listen(ListenRequest),
    /// Capture the codes of an input.
    Capture(CaptureRequest),
    /// Hold the measured amplitudes of sounding tones, or end the hold.
    Hold(HoldRequest),
    /// Ramp to silence; stay armed.
    Stop,
    /// Ramp to silence at once, mute, latch a fault.
    EmergencyStop,
    /// Clear the latched faults whose cause is gone.
    ClearFaults,
    /// Make the device hold this table: send it, swap it in, and read its digest back. If a silent device has
    /// held it since before this session, it is not sent.
    Upload(Arc<DeviceTable>),
    /// Cancel the upload under way; no effect if there is none, or if its table is in force already.
    CancelUpload,
    /// Read the digest of the device's table.
    ReadBack,
    /// Store the device's table in its flash. Only when silent.
    Store,
    /// Erase the stored data from the device's flash. Only when silent.
    Forget,
    /// Write this profile of the board's actuator into the device's flash, or erase it. Only when disarmed and silent, and while the
    /// board's user button is held, pressed within the last 30 s.
    WriteProfile(Box<Option<ActuatorProfile>>),
    /// Restart into the ROM bootloader (both steps). Only when disarmed; where a profile is kept only with the button as for one.
    Bootloader,
    /// Read the mute pin back, or measure how long it takes to go low; [`DeviceView::mute_pin`](crate::snapshot::DeviceView::mute_pin)
    /// has the answer. A trial disarms the device.
    MutePin(MuteTrial),
    /// Read again what the device finds on its board and how many blocks its inputs have lost; [`DeviceView::board`](crate::snapshot::DeviceView::board)
    /// and [`DeviceView::inputs`](crate::snapshot::DeviceView::inputs) have the answers.
    ReadBoard,
    /// Read the device's clocks at one moment; [`DeviceView::clock`](crate::snapshot::DeviceView::clock) has the answer.
    ReadClock,
    /// Stop the DAC's DMA for a millisecond, on the bench: the device must notice, which it shows by its count of underruns, and recover.
    Stall,
    /// Read the level of the brown-out reset, or write the one that the board needs into the chip's option bytes;
    /// [`DeviceView::brown_out`](crate::snapshot::DeviceView::brown_out) has the answer. Written only when disarmed and silent, and
    /// while the board's user button is held; then the device restarts.
    BrownOut(BrownOutOrder),
    /// Ask for the token of a fault on purpose, and how the last one ended;
    /// [`DeviceView::fault_trial`](crate::snapshot::DeviceView::fault_trial) has the answer.
    FaultToken,
    /// Make the device fail on purpose, while it is armed, its mute pin is high and nothing sounds. It resets, and the link loses it.
    FaultOrder(FaultOrder),
    /// Wait until the device answers, for so long at most; then it is not connected.
    Await(Duration),
    /// Read the status now.
    Refresh,
    /// Set whether a lost device is looked for, and a missing port waited for.
    AutoReconnect(bool),
    /// From now on no device is armed without a request of the user, not even a simulated one. Ends with the program.
    Observe,
    /// Take the digest of the DAC codes of a future window; it ends with the window.
    Digest(DigestWindow),
    /// Write a line of the app into the common log of link, device and app.
    Note(Severity, String),
}

impl Request {
    /// Its name in the log.
    pub(crate) const fn name(&self) -> &'static str {
        match self {
            Self::Connect(_) => "connect",
            Self::Disconnect => "disconnect",
            Self::Arm | Self::ArmFor(_) => "arm",
            Self::Bench(_) => "bench",
            Self::Disarm => "disarm",
            Self::Play(_) => "play",
            Self::Listen(_) => "listen",
            Self::Capture(_) => "capture",
            Self::Hold(_) => "level hold",
            Self::Stop => "stop",
            Self::EmergencyStop => "emergency stop",
            Self::ClearFaults => "clear faults",
            Self::Upload(_) => "upload",
            Self::CancelUpload => "cancel upload",
            Self::ReadBack => "read back",
            Self::Store => "store",
            Self::Forget => "forget",
            Self::WriteProfile(_) => "write profile",
            Self::Bootloader => "enter bootloader",
            Self::MutePin(_) => "mute pin",
            Self::ReadBoard => "board",
            Self::ReadClock => "clocks",
            Self::Stall => "stall",
            Self::BrownOut(_) => "brown-out level",
            Self::FaultToken => "token of a fault",
            Self::FaultOrder(_) => "fault on purpose",
            Self::Await(_) => "wait",
            Self::Refresh => "status",
            Self::AutoReconnect(_) => "reconnect switch",
            Self::Observe => "observe",
            Self::Digest(_) => "digest",
            Self::Note(..) => "note",
        }
    }
}

/// The number of a request; increases by one with each.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
pub struct Ticket(pub u64);

/// The outcome of a request.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum Outcome {
    /// Done; the sample index from which it takes effect, or the device's present one.
    Done {
        /// The index.
        at: u64,
    },
    /// The requested digest.
    Digest(Digest),
    /// The input's response to each tone.
    Listened(Arc<Listened>),
    /// The captured codes.
    Captured(Arc<Captured>),
    /// Refused, with the reason.
    Refused(Refusal),
    /// Not done: the device's firmware is older than this program and does not know the command.
    DeviceTooOld,
    /// Replaced by a newer request or a stop before the device had accepted it.
    Superseded,
    /// The link was lost, or not connected.
    NotConnected,
}
