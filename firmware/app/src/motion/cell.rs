//! The motion in force, where both halves of the application reach it.

use core::cell::Cell;

use slipline_protocol::limits::MAX_TONES;
use slipline_protocol::units::SampleIndex;

use super::outline::Outline;
use super::track::Track;
use super::{Motion, Onset, Placement, place};
use crate::ramp::RampShape;
use crate::slots::TableSlots;

/// A motion that both halves use, under a lock, part by part: nobody copies sixteen tracks who wants to know an end.
pub(crate) struct MotionCell {
    outline: Cell<Outline>,
    tracks: [Cell<Track>; MAX_TONES],
}

impl MotionCell {
    pub(crate) const fn silent() -> Self {
        Self { outline: Cell::new(Outline::SILENT), tracks: [const { Cell::new(Track::SILENT) }; MAX_TONES] }
    }

    pub(crate) const fn outline(&self) -> Outline {
        self.outline.get()
    }

    pub(crate) fn get(&self) -> Motion {
        let mut motion = Motion { outline: self.outline(), ..Motion::silent() };
        for (to, from) in motion.tracks.iter_mut().zip(&self.tracks) {
            *to = from.get();
        }
        motion
    }

    pub(crate) fn set(&self, motion: &Motion) {
        self.outline.set(motion.outline);
        for (to, from) in self.tracks.iter().zip(&motion.tracks) {
            to.set(*from);
        }
    }

    /// How each tone begins that starts from silence and is to sound.
    pub(crate) fn onsets(&self) -> impl Iterator<Item = Option<Onset>> {
        self.tracks.iter().map(|track| track.get().onset())
    }

    /// As [`Motion::at`], in place.
    pub(crate) fn place(
        &self,
        index: SampleIndex,
        slots: &TableSlots,
        shape: &RampShape,
        places: &mut [Placement; MAX_TONES],
    ) {
        place(&self.outline(), self.tracks.iter().map(Cell::get), index, slots, shape, places);
    }

    /// From now on takes every tone to silence from where it is at an index, `here`, in `ramp` samples.
    pub(crate) fn fade(&self, here: &[Placement; MAX_TONES], index: SampleIndex, ramp: u32) {
        let mut outline = Outline::new(index, ramp, self.outline().table);
        for (track, placement) in self.tracks.iter().zip(here) {
            track.set(Track::fading(placement));
            outline.begins_silent &= placement.level.0 == 0;
        }
        self.outline.set(outline);
    }
}
