//! Commands to be sent to a device: one task for each request, in order.

use super::reading::{CaptureReading, ListenReading};
use super::upload::Upload;
use crate::hold::HoldRequest;
use crate::listen::{CaptureRequest, ListenRequest};
use crate::request::Ticket;
use crate::sounding::Sounding;
use slipline_protocol::Command;
use std::time::Duration;

/// What a task sends.
#[derive(Clone, Debug)]
pub(super) enum Job {
    /// A complete command.
    Send(Command),
    /// Arm a device that may be armed without the user's request.
    ArmUnasked,
    Play(Sounding),
    Listen(ListenRequest),
    Capture(CaptureRequest),
    Hold(HoldRequest),
    BeginUpload(Upload),
    CancelUpload,
    DigestRead,
    ListenRead(Box<ListenReading>),
    CaptureRead(Box<CaptureReading>),
    HoldRead,
    /// Read the table's digest to complete the handshake.
    FirstReadBack,
}

impl Job {
    /// Whether it makes the device sound: a newer such job replaces it.
    pub(super) const fn sounds(&self) -> bool {
        matches!(self, Self::Play(_))
    }

    /// Whether it requests a result that may not be ready: other jobs are sent before it.
    pub(super) const fn asks_for_result(&self) -> bool {
        matches!(self, Self::DigestRead | Self::ListenRead(_) | Self::CaptureRead(_) | Self::HoldRead)
    }

    /// Whether this stop, emergency stop or disarm undoes it.
    pub(super) const fn yields_to(&self, stop: &Command) -> bool {
        match self {
            Self::Send(command) => is_undone_by(command, stop),
            Self::Play(_) | Self::Hold(_) => true,
            Self::ArmUnasked => matches!(stop, Command::EmergencyStop),
            Self::Listen(_)
            | Self::Capture(_)
            | Self::BeginUpload(_)
            | Self::CancelUpload
            | Self::DigestRead
            | Self::ListenRead(_)
            | Self::CaptureRead(_)
            | Self::HoldRead
            | Self::FirstReadBack => false,
        }
    }
}

/// Whether a stop, an emergency stop or a disarm undoes this command.
const fn is_undone_by(command: &Command, stop: &Command) -> bool {
    match command {
        // These have jobs of their own; sent as plain commands they would sound, too.
        Command::Drive(_) | Command::Chord(_) | Command::Comb(_) | Command::Hold(_) => true,
        Command::Arm | Command::ArmFor(_) | Command::Bench(_) | Command::ClearFaults => {
            matches!(stop, Command::EmergencyStop)
        }
        // It needs a device that nothing has stopped since.
        Command::FaultOrder(_) => true,
        // They neither sound nor arm.
        Command::Hello(_)
        | Command::KeepAlive(_)
        | Command::Status
        | Command::Maintenance
        | Command::Board
        | Command::Profile
        | Command::Wear
        | Command::Analogue
        | Command::MutePin(_)
        | Command::Clock
        | Command::Stall
        | Command::WriteProfile(_)
        | Command::BrownOut(_)
        | Command::Disarm
        | Command::Stop
        | Command::EmergencyStop
        | Command::SetTravelLimit(_)
        | Command::TravelLimit
        | Command::Trigger
        | Command::TableBegin(_)
        | Command::TableChunk(_)
        | Command::TableCommit
        | Command::TableAbort
        | Command::TableDigest
        | Command::DigestStart(_)
        | Command::DigestRead
        | Command::Store
        | Command::Forget
        | Command::BootloaderToken
        | Command::BootloaderEnter(_)
        | Command::FaultToken
        | Command::Inputs
        | Command::Listen(_)
        | Command::ListenRead(_)
        | Command::ListenStop
        | Command::Capture(_)
        | Command::CaptureRead(_)
        | Command::CaptureStop
        | Command::HoldRead => false,
    }
}

#[derive(Clone, Debug)]
pub(super) struct Task {
    /// `None` for tasks that the link creates by itself.
    pub(super) ticket: Option<Ticket>,
    pub(super) job: Job,
    pub(super) tries: u32,
    pub(super) not_before: Duration,
    /// A stop was sent after it: it is not repeated, whatever the reply.
    pub(super) is_overtaken: bool,
}

impl Task {
    pub(super) const fn new(ticket: Option<Ticket>, job: Job) -> Self {
        Self { ticket, job, tries: 0, not_before: Duration::ZERO, is_overtaken: false }
    }
}

/// The sender that awaits the reply in the numbered lane.
#[derive(Clone, Debug)]
pub(super) enum Current {
    Task(Box<Task>),
    Upload,
}

/// Progress of the handshake.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Stage {
    /// The hello is sent.
    #[default]
    Hello,
    /// The hello is answered; status and table are being read.
    Reading,
    Connected,
    /// The firmware's version may not be driven.
    Limited,
}

#[cfg(test)]
mod tests;
