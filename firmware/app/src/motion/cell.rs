//! The motion in force, where both halves of the application reach it.

use core::cell::Cell;

use slipline_protocol::limits::MAX_TONES;
use slipline_protocol::units::SampleIndex;

use super::Motion;
use super::evaluation::place;
use super::outline::Outline;
use super::placement::{Onset, Placement};
use super::trajectory::ToneTrajectory;
use crate::ramp::RampShape;
use crate::slots::TableSlots;

/// A motion that both halves use, under a lock, part by part: nobody copies sixteen tones who wants to know an end.
pub(crate) struct MotionCell {
    outline: Cell<Outline>,
    tones: [Cell<ToneTrajectory>; MAX_TONES],
}

impl MotionCell {
    pub(crate) const fn silent() -> Self {
        Self {
            outline: Cell::new(Outline::SILENT),
            tones: [const { Cell::new(ToneTrajectory::SILENT) }; MAX_TONES],
        }
    }

    pub(crate) const fn outline(&self) -> Outline {
        self.outline.get()
    }

    pub(crate) fn get(&self) -> Motion {
        let mut motion = Motion { outline: self.outline(), ..Motion::silent() };
        for (to, from) in motion.tones.iter_mut().zip(&self.tones) {
            *to = from.get();
        }
        motion
    }

    pub(crate) fn set(&self, motion: &Motion) {
        self.outline.set(motion.outline);
        for (to, from) in self.tones.iter().zip(&motion.tones) {
            to.set(*from);
        }
    }

    /// How each tone begins that starts from silence and is to sound.
    pub(crate) fn onsets(&self) -> impl Iterator<Item = Option<Onset>> {
        self.tones.iter().map(|tone| tone.get().onset())
    }

    /// As [`Motion::at`], in place.
    pub(crate) fn place(
        &self,
        index: SampleIndex,
        slots: &TableSlots,
        shape: &RampShape,
        places: &mut [Placement; MAX_TONES],
    ) {
        place(&self.outline(), self.tones.iter().map(Cell::get), index, slots, shape, places);
    }

    /// From now on takes every tone to silence from where it is at an index, `here`, in `ramp` samples.
    pub(crate) fn fade(&self, here: &[Placement; MAX_TONES], index: SampleIndex, ramp: u32) {
        let mut outline = Outline::new(index, ramp, self.outline().table);
        for (tone, placement) in self.tones.iter().zip(here) {
            tone.set(ToneTrajectory::fading(placement));
            outline.begins_silent &= placement.level.0 == 0;
        }
        self.outline.set(outline);
    }
}
