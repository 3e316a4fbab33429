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
//! The thread side makes motions, for it has the time. The renderer evaluates one once a block, in place (`cell.rs`),
//! so the arithmetic here consists of 32 by 32 bit products.

#![cfg_attr(not(test), deny(clippy::float_arithmetic))]

pub(crate) mod cell;
mod evaluation;
pub(crate) mod outline;
mod placement;
pub(crate) mod trajectory;

use slipline_protocol::limits::MAX_TONES;
use slipline_protocol::table::Setting;
use slipline_protocol::units::{Gain, SampleIndex};

use self::evaluation::place;
use self::outline::Outline;
pub use self::placement::{Onset, Placement};
use self::trajectory::{SettingTrajectory, ToneTrajectory};
use crate::planning::program::{Program, Target};
use crate::slots::{TableRef, TableSlots};

/// The trajectories of all tones from one program's start to its end. After the end the tones stay where they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Motion {
    outline: Outline,
    tones: [ToneTrajectory; MAX_TONES],
}

impl Motion {
    /// Silence, without a table.
    #[must_use]
    pub const fn silent() -> Self {
        Self { outline: Outline::SILENT, tones: [ToneTrajectory::SILENT; MAX_TONES] }
    }

    pub(crate) const fn outline(&self) -> Outline {
        self.outline
    }

    /// Its table.
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

    /// Where the tones go, as the targets of a program; silent slots have none.
    #[must_use]
    pub fn goals(&self) -> [Option<Target>; MAX_TONES] {
        self.tones.map(|tone| {
            (tone.to_level.0 != 0).then_some(Target {
                position: tone.to,
                level: tone.to_level,
                phase: 0,
                setting: None,
            })
        })
    }

    /// As [`Motion::goals`], but a tone that has a step and a gain of its own, as a chord's has, keeps them.
    #[must_use]
    pub fn goals_as_set(&self) -> [Option<Target>; MAX_TONES] {
        let mut goals = self.goals();
        for (goal, tone) in goals.iter_mut().zip(&self.tones) {
            if let (Some(goal), SettingTrajectory::Hold { step, gain }) = (goal, tone.setting) {
                goal.setting = Some(Setting { step, gain });
            }
        }
        goals
    }

    /// How each tone moves.
    pub(crate) const fn trajectories(&self) -> &[ToneTrajectory; MAX_TONES] {
        &self.tones
    }

    /// Where each tone is at an index; before the start as at the start, after the end as at the end.
    #[must_use]
    pub fn at(&self, index: SampleIndex, slots: &TableSlots) -> [Placement; MAX_TONES] {
        let mut all = [Placement::default(); MAX_TONES];
        place(&self.outline, &self.tones, index, slots, &mut all);
        all
    }

    /// The motion that a program starts where this one is at the program's index, `here`.
    #[must_use]
    pub fn follow(&self, here: &[Placement; MAX_TONES], program: &Program, slots: &TableSlots) -> Self {
        self.toward(here, Outline::new(program.at, program.glide, program.table), &program.targets, slots)
    }

    /// The motion from silence to these targets.
    #[must_use]
    pub(crate) fn rising(
        at: SampleIndex,
        glide: u32,
        table: TableRef,
        targets: &[Option<Target>; MAX_TONES],
        slots: &TableSlots,
    ) -> Self {
        // Not on the stack, which has no room for them beside the motion that is made.
        static SILENT: Motion = Motion::silent();
        static NOWHERE: [Placement; MAX_TONES] = [Placement::NOWHERE; MAX_TONES];
        SILENT.toward(&NOWHERE, Outline::new(at, glide, table), targets, slots)
    }

    fn toward(
        &self,
        here: &[Placement; MAX_TONES],
        outline: Outline,
        targets: &[Option<Target>; MAX_TONES],
        slots: &TableSlots,
    ) -> Self {
        let mut next = Self::silent();
        next.outline = outline;
        let outline = &mut next.outline;
        for (((tone, old), placement), target) in
            next.tones.iter_mut().zip(&self.tones).zip(here).zip(targets)
        {
            *tone = match target {
                None => ToneTrajectory::fading(placement),
                Some(target) if placement.is_silent() => ToneTrajectory {
                    from: target.position,
                    to: target.position,
                    from_level: Gain(0),
                    to_level: target.level,
                    setting: SettingTrajectory::hold(
                        target.setting.unwrap_or_else(|| slots.evaluate(outline.table, target.position)),
                    ),
                    phase: target.phase,
                },
                Some(target) => ToneTrajectory {
                    from: placement.position,
                    to: target.position,
                    from_level: placement.level,
                    to_level: target.level,
                    setting: if let Some(setting) = target.setting {
                        SettingTrajectory::hold(setting)
                    } else if self.table() == outline.table && old.setting == SettingTrajectory::Along {
                        // It follows this table already.
                        SettingTrajectory::Along
                    } else {
                        SettingTrajectory::from(placement, slots.evaluate(outline.table, placement.position))
                    },
                    phase: 0,
                },
            };
            outline.begins_silent &= tone.from_level.0 == 0;
            outline.ends_silent &= tone.to_level.0 == 0;
        }
        next
    }
}

#[cfg(test)]
mod tests;
