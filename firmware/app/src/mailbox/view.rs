//! A consistent copy of what the mailbox holds.

use slipline_protocol::units::SampleIndex;

use super::report::Report;
use crate::faults::FaultLatch;
use crate::motion::Motion;

/// The state at one moment, as the thread side sees it.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// The first index that is not rendered yet.
    pub next: SampleIndex,
    /// The motion in force.
    pub motion: Motion,
    /// How often that has changed; wraps.
    pub changes: u32,
    /// When the pending program begins, or from when on it waits for the trigger input.
    pub pending: Option<SampleIndex>,
    /// Whether it waits for the trigger input.
    pub waits: bool,
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
    /// Whether nothing sounds and nothing is about to.
    #[must_use]
    pub const fn is_silent(&self) -> bool {
        self.report.silent && self.pending.is_none()
    }
}
