//! The codes that the device has played, replayed from the drives that it has acknowledged.

use slipline_link::Snapshot;
use slipline_link::mirror::replay::{DeviceHistory, Replay};

/// Time from a stop to the first tone, seconds: long enough for the replay to know that the device is silent.
pub(super) const SILENT_S: f64 = 0.3;

/// The latest codes of a device.
pub(super) struct Codes(Replay);

impl Codes {
    /// Keeps at most this number of codes.
    pub(super) fn new(samples: u64) -> Self {
        Self(Replay::new(samples as usize))
    }

    /// Replays up to the link's snapshot. Must be called in every turn.
    pub(super) fn follow(&mut self, snapshot: &Snapshot) {
        if let Some(history) = DeviceHistory::of(snapshot) {
            self.0.follow(&history);
        }
    }

    /// The codes of `count` samples from an index on; `None` while they are not known.
    pub(super) fn played(&self, from: u64, count: u64) -> Option<Vec<u16>> {
        Some(self.0.exact_codes(from, u32::try_from(count).unwrap_or(u32::MAX))?.collect())
    }
}
