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

    /// Whether this stop, emergency stop or disarm undoes it; nothing but an emergency stop undoes what arms.
    pub(super) const fn yields_to(&self, stop: &Command) -> bool {
        let arms = matches!(
            self,
            Self::ArmUnasked
                | Self::Send(Command::Arm | Command::ArmFor(_) | Command::Bench(_) | Command::ClearFaults)
        );
        // What sounds has jobs of its own; sent as a plain command it would sound, too.
        let sounds = matches!(
            self,
            Self::Play(_)
                | Self::Hold(_)
                | Self::Send(Command::Drive(_) | Command::Chord(_) | Command::Comb(_) | Command::Hold(_))
        );
        // A fault on purpose needs a device that nothing has stopped since.
        let fails = matches!(self, Self::Send(Command::FaultOrder(_)));
        sounds || fails || arms && matches!(stop, Command::EmergencyStop)
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
