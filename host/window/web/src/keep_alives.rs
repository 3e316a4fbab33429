//! How evenly the keep-alives leave, for tests: a device stops by its dead-man when they stay away.

use slipline_link::protocol::Command;
use slipline_link::{Snapshot, TracedMessage};
use std::time::Duration;

/// The keep-alives since the device was armed.
#[derive(Default)]
pub(crate) struct KeepAlives {
    is_armed: bool,
    latest: Option<Duration>,
    /// Number of keep-alives.
    pub(crate) count: u32,
    /// The longest time between two of them.
    pub(crate) longest_gap: Duration,
}

impl KeepAlives {
    /// Looks at what was sent meanwhile.
    pub(crate) fn attend(&mut self, view: &Snapshot) {
        let is_armed = view.is_armed();
        if is_armed && !self.is_armed {
            *self = Self::default();
        }
        self.is_armed = is_armed;
        for frame in view.record.frames.iter() {
            let is_keep_alive = matches!(frame.message, TracedMessage::Command(Command::KeepAlive(_)));
            if !is_keep_alive || self.latest.is_some_and(|latest| frame.time <= latest) {
                continue;
            }
            if let Some(latest) = self.latest.replace(frame.time) {
                self.longest_gap = self.longest_gap.max(frame.time.saturating_sub(latest));
            }
            self.count += 1;
        }
    }
}
