//! How the sixteen tones move between two programs, in closed form.
//!
//! With `u` the share of the glide's time that has passed and `s(u)` the raised cosine:
//! ```text
//! position p(u) = p0 + u (p1 - p0)
//! setting       = E(p(u)) + (1 - s(u)) (setting at the start - E(p0))      E: the table, step and gain
//! level         = l0 + s(u) (l1 - l0)
//! amplitude     = gain * level
//! ```
//! The second term is 0 unless the table has been swapped; with it step and amplitude are continuous in any case. A
//! tone that fades out or starts from silence keeps its setting. Integers only: a motion gives the same values on
//! every machine, at any index, in any order.
//!
//! A motion is made by the link's half, which has the time. The renderer evaluates it once a block, where it stands
//! (`MotionCell`), and so the arithmetic here is made of 32 by 32 bit products.

#![cfg_attr(not(test), deny(clippy::float_arithmetic))]

mod cell;
mod outline;
mod track;

use slipline_protocol::limits::MAX_TONES;
use slipline_protocol::table::Setting;
use slipline_protocol::units::{FinePosition, Gain, PhaseStep, SampleIndex};

pub(crate) use self::cell::MotionCell;
pub(crate) use self::outline::Outline;
use self::track::{Course, Track, between_levels, between_positions, blend};
use crate::program::{Program, Target};
use crate::ramp::RampShape;
use crate::slots::{TableRef, TableSlots};

const ONE: u32 = 1 << 31;

/// Where a tone is at one index.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Placement {
    /// Its place on the table.
    pub position: FinePosition,
    /// Its step and gain.
    pub setting: Setting,
    /// Its level.
    pub level: Gain,
}

impl Placement {
    /// Of a tone that has never sounded.
    pub(crate) const NOWHERE: Self = Self {
        position: FinePosition::saturating(0),
        setting: Setting { step: PhaseStep(0), gain: Gain(0) },
        level: Gain(0),
    };

    /// Whether nothing is heard of it.
    #[must_use]
    pub const fn is_silent(&self) -> bool {
        self.level.0 == 0
    }

    /// Its amplitude, Q1.31.
    #[must_use]
    pub const fn amplitude(&self) -> Gain {
        self.setting.gain.times(self.level)
    }
}

/// How a tone begins that starts from silence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Onset {
    /// Its phase; 2^64 = one turn.
    pub phase: u64,
    /// Its step.
    pub step: PhaseStep,
}

/// The way of all tones from one program's start to its end, and on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Motion {
    outline: Outline,
    tracks: [Track; MAX_TONES],
}

impl Default for Motion {
    fn default() -> Self {
        Self::silent()
    }
}

impl Motion {
    /// Silence, by no table.
    #[must_use]
    pub const fn silent() -> Self {
        Self { outline: Outline::SILENT, tracks: [Track::SILENT; MAX_TONES] }
    }

    /// The table it goes by.
    #[must_use]
    pub const fn table(&self) -> TableRef {
        self.outline.table
    }

    /// The index at which it begins.
    #[must_use]
    pub const fn start(&self) -> SampleIndex {
        self.outline.start
    }

    /// The index from which nothing moves any more.
    #[must_use]
    pub const fn end(&self) -> SampleIndex {
        self.outline.end()
    }

    /// Whether every tone fades out or is silent: after [`Motion::end`] nothing sounds.
    #[must_use]
    pub const fn ends_silent(&self) -> bool {
        self.outline.ends_silent
    }

    /// Whether nothing sounds at an index or ever after.
    #[must_use]
    pub const fn is_silent_from(&self, index: SampleIndex) -> bool {
        self.outline.is_silent_from(index)
    }

    /// Where the tones are going, as the targets of a program; silent slots have none.
    #[must_use]
    pub fn goals(&self) -> [Option<Target>; MAX_TONES] {
        self.tracks.map(|track| {
            (track.to_level.0 != 0).then_some(Target { position: track.to, level: track.to_level, phase: 0 })
        })
    }

    /// Where each tone is at an index; before the start as at the start, after the end as at the end.
    #[must_use]
    pub fn at(&self, index: SampleIndex, slots: &TableSlots, shape: &RampShape) -> [Placement; MAX_TONES] {
        let mut all = [Placement::default(); MAX_TONES];
        place(&self.outline, self.tracks.iter().copied(), index, slots, shape, &mut all);
        all
    }

    /// The motion that a program starts where this one is at the program's index, `here`.
    #[must_use]
    pub fn follow(&self, here: &[Placement; MAX_TONES], program: &Program, slots: &TableSlots) -> Self {
        let mut next = Self::silent();
        next.outline = Outline::new(program.at, program.glide, program.table);
        let outline = &mut next.outline;
        for (((track, old), placement), target) in
            next.tracks.iter_mut().zip(&self.tracks).zip(here).zip(&program.targets)
        {
            *track = match target {
                None => Track::fading(placement),
                Some(target) if placement.is_silent() => Track {
                    from: target.position,
                    to: target.position,
                    from_level: Gain(0),
                    to_level: target.level,
                    course: Course::hold(slots.evaluate(program.table, target.position)),
                    phase: target.phase,
                },
                Some(target) => Track {
                    from: placement.position,
                    to: target.position,
                    from_level: placement.level,
                    to_level: target.level,
                    course: if self.table() == program.table && old.course == Course::Along {
                        // It is on the table already: no need to look.
                        Course::Along
                    } else {
                        Course::from(placement, slots.evaluate(program.table, placement.position))
                    },
                    phase: 0,
                },
            };
            outline.begins_silent &= track.from_level.0 == 0;
            outline.ends_silent &= track.to_level.0 == 0;
        }
        next
    }
}

/// Writes where each tone is at an index to `places`.
#[inline(always)]
fn place(
    outline: &Outline,
    tracks: impl Iterator<Item = Track> + Clone,
    index: SampleIndex,
    slots: &TableSlots,
    shape: &RampShape,
    places: &mut [Placement; MAX_TONES],
) {
    let u = outline.share_of_time(index);
    let s = shape.at(u);
    let table = slots.table(outline.table);
    // In three rounds: a processor has too few registers for all at once.
    for (place, track) in places.iter_mut().zip(tracks.clone()) {
        place.position = between_positions(track.from, track.to, u);
        place.level = between_levels(track.from_level, track.to_level, s);
    }
    for (place, track) in places.iter_mut().zip(tracks.clone()) {
        place.setting = match track.course {
            Course::Hold { step, gain } => Setting { step, gain },
            Course::Along | Course::Join { .. } => table.evaluate(place.position),
        };
    }
    let left = ONE.saturating_sub(s);
    for (place, track) in places.iter_mut().zip(tracks) {
        if let Course::Join { step_upper, step_lower, gain } = track.course {
            place.setting = blend(place.setting, (step_upper, step_lower), gain, left);
        }
    }
}

#[cfg(test)]
mod tests;
