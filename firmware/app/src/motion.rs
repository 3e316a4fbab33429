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

#![cfg_attr(not(test), deny(clippy::float_arithmetic))]

use slipline_protocol::limits::{MAX_KNOT_STEP, MAX_TONES};
use slipline_protocol::table::Setting;
use slipline_protocol::units::{FinePosition, Gain, PhaseStep, SampleIndex};

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

/// How a tone's setting moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Course {
    /// Along the table, from what it was at the start: the differences there, in units of step and of gain.
    Follow { step: i64, gain: i64 },
    /// Not at all.
    Hold(Setting),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Track {
    from: FinePosition,
    to: FinePosition,
    from_level: Gain,
    to_level: Gain,
    course: Course,
}

impl Course {
    /// Along the table, from on it.
    const ALONG: Self = Self::Follow { step: 0, gain: 0 };

    /// Along the table, which says `on_table` where the tone is.
    fn from(placement: &Placement, on_table: Setting) -> Self {
        Self::Follow {
            // Both steps lie below 2^63.
            step: placement.setting.step.0.wrapping_sub(on_table.step.0).cast_signed(),
            gain: i64::from(placement.setting.gain.0) - i64::from(on_table.gain.0),
        }
    }
}

impl Track {
    const SILENT: Self = Self {
        from: FinePosition::saturating(0),
        to: FinePosition::saturating(0),
        from_level: Gain(0),
        to_level: Gain(0),
        course: Course::Hold(Setting { step: PhaseStep(0), gain: Gain(0) }),
    };

    /// Where the tone is when the share `u` of the time has passed and the ramp has come to `s`.
    fn at(&self, u: u32, s: u32, table: TableRef, slots: &TableSlots) -> Placement {
        let position = between_positions(self.from, self.to, u);
        let setting = match self.course {
            Course::Hold(setting) => setting,
            Course::Follow { step, gain } => {
                blend(slots.evaluate(table, position), step, gain, ONE.saturating_sub(s))
            }
        };
        Placement { position, setting, level: between_levels(self.from_level, self.to_level, s) }
    }
}

/// The way of all tones from one program's start to its end, and on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Motion {
    start: SampleIndex,
    glide: u32,
    table: TableRef,
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
        let table = TableRef { slot: crate::slots::SlotIndex::First, knots: 0 };
        Self { start: 0, glide: 1, table, tracks: [Track::SILENT; MAX_TONES] }
    }

    /// The table it goes by.
    #[must_use]
    pub const fn table(&self) -> TableRef {
        self.table
    }

    /// The index from which nothing moves any more.
    #[must_use]
    pub const fn end(&self) -> SampleIndex {
        self.start.saturating_add(self.glide as u64)
    }

    /// Whether every tone fades out or is silent: after [`Motion::end`] nothing sounds.
    #[must_use]
    pub fn ends_silent(&self) -> bool {
        self.tracks.iter().all(|track| track.to_level.0 == 0)
    }

    /// Whether nothing sounds at an index or ever after.
    #[must_use]
    pub fn is_silent_from(&self, index: SampleIndex) -> bool {
        self.ends_silent() && (index >= self.end() || self.tracks.iter().all(|track| track.from_level.0 == 0))
    }

    /// Where the tones are going, as the targets of a program; silent slots have none.
    #[must_use]
    pub fn goals(&self) -> [Option<Target>; MAX_TONES] {
        self.tracks.map(|track| {
            (track.to_level.0 != 0).then_some(Target { position: track.to, level: track.to_level, phase: 0 })
        })
    }

    /// Where each tone is at an index; before the start as at the start, after the end as at the end.
    pub fn placements(
        &self,
        index: SampleIndex,
        slots: &TableSlots,
        shape: &RampShape,
    ) -> impl Iterator<Item = Placement> {
        let u = self.share_of_time(index);
        let s = shape.at(u);
        self.tracks.iter().map(move |track| track.at(u, s, self.table, slots))
    }

    /// The same, all at once.
    #[must_use]
    pub fn at(&self, index: SampleIndex, slots: &TableSlots, shape: &RampShape) -> [Placement; MAX_TONES] {
        let mut all = [Placement::default(); MAX_TONES];
        for (to, from) in all.iter_mut().zip(self.placements(index, slots, shape)) {
            *to = from;
        }
        all
    }

    /// The motion that a program starts where this one is at the program's index, `here`; and how each tone begins
    /// that starts from silence there.
    #[must_use]
    pub fn follow(
        &self,
        here: &[Placement; MAX_TONES],
        program: &Program,
        slots: &TableSlots,
    ) -> (Self, [Option<Onset>; MAX_TONES]) {
        let mut next = Self {
            start: program.at,
            glide: program.glide.max(1),
            table: program.table,
            tracks: [Track::SILENT; MAX_TONES],
        };
        let mut onsets = [None; MAX_TONES];
        for ((((track, onset), old), placement), target) in
            next.tracks.iter_mut().zip(&mut onsets).zip(&self.tracks).zip(here).zip(&program.targets)
        {
            *track = match target {
                None => fading(placement),
                Some(target) if placement.is_silent() => {
                    let setting = slots.evaluate(program.table, target.position);
                    *onset = Some(Onset { phase: target.phase, step: setting.step });
                    Track {
                        from: target.position,
                        to: target.position,
                        from_level: Gain(0),
                        to_level: target.level,
                        course: Course::Hold(setting),
                    }
                }
                Some(target) => Track {
                    from: placement.position,
                    to: target.position,
                    from_level: placement.level,
                    to_level: target.level,
                    course: if self.table == program.table && old.course == Course::ALONG {
                        // It is on the table already: no need to look.
                        Course::ALONG
                    } else {
                        Course::from(placement, slots.evaluate(program.table, placement.position))
                    },
                },
            };
        }
        (next, onsets)
    }

    /// The motion that takes every tone to silence from where it is at an index, `here`, in `ramp` samples.
    #[must_use]
    pub fn fade(&self, here: &[Placement; MAX_TONES], index: SampleIndex, ramp: u32) -> Self {
        let mut next =
            Self { start: index, glide: ramp.max(1), table: self.table, tracks: [Track::SILENT; MAX_TONES] };
        for (track, placement) in next.tracks.iter_mut().zip(here) {
            *track = fading(placement);
        }
        next
    }

    /// The share of the glide's time that has passed at an index, Q1.31.
    #[expect(clippy::cast_possible_truncation, reason = "a share of at most one")]
    fn share_of_time(&self, index: SampleIndex) -> u32 {
        let glide = u64::from(self.glide.max(1));
        let elapsed = index.saturating_sub(self.start).min(glide);
        // 32 bits up by 31 fit 64; one division a block for all tones.
        ((elapsed << 31) / glide) as u32
    }
}

const fn fading(placement: &Placement) -> Track {
    Track {
        from: placement.position,
        to: placement.position,
        from_level: placement.level,
        to_level: Gain(0),
        course: Course::Hold(placement.setting),
    }
}

/// `a + u (b - a)`, all Q1.31.
#[expect(clippy::cast_possible_truncation, reason = "the result lies between a and b")]
fn between(a: u32, b: u32, u: u32) -> u32 {
    let (a, b) = (i64::from(a), i64::from(b));
    (a + (((b - a) * i64::from(u)) >> 31)) as u32
}

fn between_positions(a: FinePosition, b: FinePosition, u: u32) -> FinePosition {
    FinePosition::saturating(between(a.raw(), b.raw(), u))
}

fn between_levels(a: Gain, b: Gain, s: u32) -> Gain {
    Gain(between(a.0, b.0, s))
}

/// The table's setting and what `left` (Q1.31) leaves of the differences at the start, kept within the ranges of a
/// setting: the clamp of something continuous is continuous.
#[expect(clippy::cast_possible_truncation, reason = "clamped to its range before the cast")]
fn blend(setting: Setting, step: i64, gain: i64, left: u32) -> Setting {
    if step == 0 && gain == 0 {
        return setting;
    }
    const MAX_STEP: i128 = (MAX_KNOT_STEP as i128) << 32;
    let left = i64::from(left);
    let step = i128::from(setting.step.0) + ((i128::from(step) * i128::from(left)) >> 31);
    // A gain difference has 32 bits and a sign: with 31 more it fits.
    let gain = i64::from(setting.gain.0) + ((gain * left) >> 31);
    Setting {
        step: PhaseStep(step.clamp(0, MAX_STEP) as u64),
        gain: Gain(gain.clamp(0, i64::from(Gain::FULL.0)) as u32),
    }
}

#[cfg(test)]
mod tests;
