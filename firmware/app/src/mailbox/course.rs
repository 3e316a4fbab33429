//! The motion in force without its tones: a part of the [`View`](super::View) that costs little.

use embassy_sync::blocking_mutex::raw::RawMutex;
use slipline_protocol::units::SampleIndex;

use super::Mailbox;

/// Which motion is in force, without its tones, and what may end it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Course {
    /// The first index that is not rendered yet.
    pub next: SampleIndex,
    /// How often the motion in force has changed; wraps.
    pub changes: u32,
    /// Where it begins.
    pub start: SampleIndex,
    /// Whether nothing sounds after its end.
    pub ends_silent: bool,
    /// Whether a motion has not begun.
    pub is_pending: bool,
    /// A stop has been ordered or is ramping.
    pub stopping: bool,
    /// Whether drives are accepted.
    pub armed: bool,
    /// The thermal fold-back factor in the renderer's last report, per mille.
    pub foldback_per_mille: u16,
}

impl<M: RawMutex> Mailbox<M> {
    /// The motion in force without its tones.
    pub fn course(&self) -> Course {
        self.shared.lock(|shared| {
            let (outline, report) = (shared.outline(), shared.report.get());
            Course {
                next: shared.next.get(),
                changes: shared.changes.get(),
                start: outline.start,
                ends_silent: outline.ends_silent,
                is_pending: shared.pending.get().is_some(),
                stopping: shared.stop.get().is_some() || report.stopping,
                armed: shared.armed.get(),
                foldback_per_mille: report.foldback.map_or(1000, |foldback| foldback.per_mille),
            }
        })
    }
}
