//! The sample index from which the replayed codes equal the device's exactly.

use slipline_app::BLOCK;
use slipline_protocol::units::SampleIndex;

/// Samples within which the renderer's amplitude settles after a step of the thermal fold-back: from full scale to zero
/// it takes 65 blocks.
pub(super) const FOLDBACK_SETTLES: u64 = 80 * BLOCK as u64;

/// Unknown parts of the codes; once there are none, the index from which the codes are exact.
#[derive(Clone, Copy, Debug)]
pub(super) struct Exactness {
    since: SampleIndex,
    /// An unknown drive sounds or has sounded: the codes are exact once the device is silent.
    pub(super) misses_sound: bool,
    /// A step of the thermal fold-back is missing: the codes are exact once the present one is known.
    pub(super) misses_foldback: bool,
}

impl Exactness {
    /// Nothing is known of the device.
    pub(super) const fn unknown() -> Self {
        Self { since: 0, misses_sound: true, misses_foldback: false }
    }

    /// The replay begins at `at`; a device that is silent there has no unknown drive.
    pub(super) const fn beginning(at: SampleIndex, is_silent: bool) -> Self {
        Self { since: at, misses_sound: !is_silent, misses_foldback: !is_silent }
    }

    /// The index from which the codes are exact; `None` while a part is unknown.
    pub(super) const fn since(&self) -> Option<SampleIndex> {
        if self.misses_sound || self.misses_foldback { None } else { Some(self.since) }
    }

    /// The device is known to be silent at `at`.
    pub(super) fn silent(&mut self, at: SampleIndex) {
        self.misses_sound = false;
        self.since = self.since.max(at);
    }

    /// The thermal fold-back is known from `at` on, and was not known before.
    pub(super) fn foldback_known(&mut self, at: SampleIndex) {
        self.misses_foldback = false;
        self.since = self.since.max(at + FOLDBACK_SETTLES);
    }
}
