//! A consistent copy of what the mailbox holds.

use slipline_protocol::units::SampleIndex;

use super::pending::Pending;
use super::report::Report;
use crate::motion::Motion;
use crate::safety::faults::FaultLatch;

/// The state at one moment, as the thread side sees it.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// The first index that is not rendered yet.
    pub next: SampleIndex,
    /// The motion in force.
    pub motion: Motion,
    /// Number of its changes; wraps.
    pub changes: u32,
    /// The program that has not begun.
    pub pending: Option<Pending>,
    /// A stop has been ordered or is ramping.
    pub stopping: bool,
    /// Whether drives are accepted.
    pub armed: bool,
    /// No drive begins before this index.
    pub ready_at: SampleIndex,
    /// The renderer's last report.
    pub report: Report,
    /// The latched faults.
    pub faults: FaultLatch,
}

impl View {
    /// Whether nothing sounds and nothing is about to. A swap of the table in silence makes no sound.
    #[must_use]
    pub fn is_silent(&self) -> bool {
        self.report.silent && !self.pending.is_some_and(|pending| pending.sounds)
    }

    /// Whether a program waits for the trigger input.
    #[must_use]
    pub fn waits(&self) -> bool {
        self.pending.is_some_and(|pending| pending.waits)
    }

    /// Whether a new program can be published: none is pending, or the pending one may be replaced.
    #[must_use]
    pub fn has_room(&self) -> bool {
        self.pending.is_none_or(|pending| pending.yields)
    }
}
