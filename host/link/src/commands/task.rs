//! What is to be sent to a device: one task for each request, in order.

use super::reading::{CaptureReading, ListenReading};
use super::upload::Upload;
use crate::chord::ChordRequest;
use crate::comb::CombRequest;
use crate::drive::DriveRequest;
use crate::hold::HoldRequest;
use crate::listen::{CaptureRequest, ListenRequest};
use crate::request::Ticket;
use slipline_protocol::Command;
use std::time::Duration;

/// One thing to send.
#[derive(Clone, Debug)]
pub(super) enum Job {
    /// A command that is complete as it is.
    Send(Command),
    /// Arm a device that may be armed without the user's request.
    ArmUnasked,
    Drive(DriveRequest),
    Chord(ChordRequest),
    Comb(CombRequest),
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
    /// Whether it makes the device sound: a newer such job takes its place.
    pub(super) const fn sounds(&self) -> bool {
        matches!(self, Self::Drive(_) | Self::Chord(_) | Self::Comb(_))
    }

    /// Whether it asks for a result that may not be there yet: others go before it.
    pub(super) const fn asks_for_result(&self) -> bool {
        matches!(self, Self::DigestRead | Self::ListenRead(_) | Self::CaptureRead(_) | Self::HoldRead)
    }

    /// Whether this stop, emergency stop or disarm undoes it.
    pub(super) const fn yields_to(&self, stop: &Command) -> bool {
        match self {
            Self::Drive(_) | Self::Chord(_) | Self::Comb(_) | Self::Hold(_) => true,
            Self::ArmUnasked | Self::Send(Command::Arm | Command::ClearFaults) => {
                matches!(stop, Command::EmergencyStop)
            }
            _ => false,
        }
    }
}

#[derive(Clone, Debug)]
pub(super) struct Task {
    /// None for what the link does by itself.
    pub(super) ticket: Option<Ticket>,
    pub(super) job: Job,
    pub(super) tries: u32,
    pub(super) not_before: Duration,
    /// A stop came after it had been sent: whatever the answer, it is not sent again.
    pub(super) is_overtaken: bool,
}

impl Task {
    pub(super) const fn new(ticket: Option<Ticket>, job: Job) -> Self {
        Self { ticket, job, tries: 0, not_before: Duration::ZERO, is_overtaken: false }
    }
}

/// What waits for the answer of the numbered lane.
#[derive(Clone, Debug)]
pub(super) enum Current {
    Task(Box<Task>),
    Upload,
}

/// How far the handshake has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stage {
    /// The hello is out.
    Hello,
    /// The hello is answered; status and table are being read.
    Reading,
    Connected,
    /// The firmware's version may not be driven.
    Limited,
}
