//! The time of a motion and its table.

use slipline_protocol::limits::MAX_TONES;
use slipline_protocol::units::SampleIndex;

use super::placement::Placement;
use crate::planning::ramp::{ONE, progress};
use crate::slots::{SlotIndex, TableRef};

/// Time and table of a motion, and whether it begins and ends in silence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Outline {
    pub(crate) start: SampleIndex,
    /// Its length in samples, at least 1.
    pub(super) glide: u32,
    /// `2^63 / glide`, rounded down: what a sample is of the whole.
    sample: u64,
    pub(crate) table: TableRef,
    /// Every tone starts from silence.
    pub(super) begins_silent: bool,
    /// Every tone goes to silence.
    pub(crate) ends_silent: bool,
}

impl Outline {
    pub(crate) const SILENT: Self = Self::new(0, 1, TableRef { slot: SlotIndex::First, knots: 0 });

    /// The outline of a motion from silence to silence.
    pub(super) const fn new(start: SampleIndex, glide: u32, table: TableRef) -> Self {
        let glide = if glide == 0 { 1 } else { glide };
        let sample = (1 << 63) / glide as u64;
        Self { start, glide, sample, table, begins_silent: true, ends_silent: true }
    }

    /// The outline of a ramp to silence of the tones that are at `here`.
    pub(crate) fn fading(
        here: &[Placement; MAX_TONES],
        start: SampleIndex,
        ramp: u32,
        table: TableRef,
    ) -> Self {
        let mut outline = Self::new(start, ramp, table);
        outline.begins_silent = here.iter().all(Placement::is_silent);
        outline
    }

    /// The same at another index.
    pub(crate) const fn starting_at(self, start: SampleIndex) -> Self {
        Self { start, ..self }
    }

    /// As [`Motion::end`].
    pub(crate) const fn end(&self) -> SampleIndex {
        self.start.saturating_add(self.glide as u64)
    }

    /// The share of the glide's time that has passed at an index, Q1.31: at most 2^-31 below the truth.
    ///
    /// A multiplication, for a 64-bit division is a loop.
    pub(super) fn share_of_time(&self, index: SampleIndex) -> u32 {
        let elapsed = index.saturating_sub(self.start);
        if elapsed >= u64::from(self.glide) {
            return ONE;
        }
        // Fewer samples than 2^63 / sample: the product fits.
        (elapsed.wrapping_mul(self.sample) >> 32) as u32
    }

    /// The factor of a ramp to silence at an index, Q1.31.
    pub(crate) fn share_left(&self, index: SampleIndex) -> u32 {
        ONE.saturating_sub(progress(self.share_of_time(index)))
    }

    /// As [`Motion::is_silent_from`].
    pub(crate) const fn is_silent_from(&self, index: SampleIndex) -> bool {
        self.ends_silent && (self.begins_silent || index >= self.end())
    }
}
