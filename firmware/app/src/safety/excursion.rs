//! The limit of the actuator's travel: a motion whose tones together would pass it is refused.
//!
//! ```text
//! knots of a table --written--> the largest travel of each group of knots --+
//! Motion of a drive or a table swap ----------------------------------------+--check--> Ok, or Refusal::Travel
//! ```
//! A tone of amplitude a and phase step f moves the actuator by a x(f) (`law`). The tones' travels add up, because
//! their phases may meet. As for the headroom, one bound `T_i` for each tone's whole way is enough: `T_i` is the largest
//! `gain x(f)` on it, all levels share one `s`, and `sum T_i level_i(s)` is linear in `s`, so it is largest at one of
//! the ends.
//!
//! This is the steady travel. A change adds free motion to it, the more the faster it is, so that with a limit a drive
//! takes at least [`GLIDE_PERIODS`](limits::GLIDE_PERIODS) of the resonance. A limit belongs to a session: one that is set for a plate must not judge
//! another host's tables. All of this runs on the thread side; the renderer does not know the limit.

#![cfg_attr(not(test), deny(clippy::arithmetic_side_effects))]

mod groups;
mod law;

use slipline_protocol::command::TravelLimit;
use slipline_protocol::limits::{self, MAX_KNOT_STEP};
use slipline_protocol::refusal::{Field, Refusal};
use slipline_protocol::table::Setting;
use slipline_protocol::timing::Timing;
use slipline_protocol::units::Gain;

use self::groups::Groups;
use self::law::Law;
use crate::motion::Motion;
use crate::motion::trajectory::{SettingTrajectory, ToneTrajectory};
use crate::range::within;
use crate::slots::{SlotIndex, TableRef, TableSlots, knots_between};

/// The limit in force, if any, and the travels of the two tables by it.
#[derive(Clone, Debug)]
pub struct Excursion {
    sample_rate_hz: u32,
    limit: Option<(TravelLimit, Law)>,
    first: Groups,
    second: Groups,
}

impl Excursion {
    /// Without a limit, at a sample rate in Hz.
    #[must_use]
    pub const fn unlimited(sample_rate_hz: u32) -> Self {
        Self { sample_rate_hz, limit: None, first: Groups::NONE, second: Groups::NONE }
    }

    /// The limit in force.
    #[must_use]
    pub fn limit(&self) -> Option<TravelLimit> {
        self.limit.map(|(limit, _)| limit)
    }

    /// Puts a limit in force, or none, and computes by it the travels of `tables`, which the slots hold already.
    ///
    /// # Errors
    /// [`Refusal::OutOfRange`] with the field; the limit stays as it was.
    pub fn set(
        &mut self,
        limit: Option<TravelLimit>,
        tables: [TableRef; 2],
        slots: &TableSlots,
    ) -> Result<(), Refusal> {
        if let Some(limit) = &limit {
            check_ranges(limit)?;
        }
        self.limit = limit.map(|limit| (limit, Law::new(&limit, self.sample_rate_hz)));
        for table in tables {
            self.begin(table.slot);
            self.written(table, 0, slots);
        }
        Ok(())
    }

    /// A session begins: there is no limit until it sets one.
    pub const fn clear(&mut self) {
        self.limit = None;
    }

    /// A slot is about to be written again.
    pub const fn begin(&mut self, slot: SlotIndex) {
        *self.groups_of(slot) = Groups::NONE;
    }

    /// The knots from `first` on have been written; `table` has all that have been written so far.
    pub fn written(&mut self, table: TableRef, first: u16, slots: &TableSlots) {
        let Some((_, law)) = self.limit else { return };
        let groups = self.groups_of(table.slot);
        // The first of them ends the interval before it.
        let begin = first.saturating_sub(1);
        let mut left = slots.knot(table.slot, begin);
        for index in begin..table.knots.saturating_sub(1) {
            let right = slots.knot(table.slot, index.saturating_add(1));
            let largest = law.largest(left.step, right.step);
            groups.add(index.into(), amplitude(left.gain.max(right.gain)) * largest);
            left = right;
        }
    }

    const fn groups_of(&mut self, slot: SlotIndex) -> &mut Groups {
        match slot {
            SlotIndex::First => &mut self.first,
            SlotIndex::Second => &mut self.second,
        }
    }

    /// Checks that a drive does not change faster than the actuator can follow.
    ///
    /// # Errors
    /// [`Refusal::OutOfRange`] for the glide.
    pub fn check_glide(&self, glide: u32, timing: &Timing) -> Result<(), Refusal> {
        // A glide that is too short for any motion is refused where it is planned.
        let Some((limit, _)) = &self.limit else { return Ok(()) };
        let shortest = timing.shortest_glide(limit);
        if glide >= shortest {
            return Ok(());
        }
        Err(Refusal::out_of_range(Field::Glide, shortest.into(), timing.max_glide.into(), glide.into()))
    }

    /// Checks that the steady travel of all tones together stays within the limit on the whole way of a motion.
    ///
    /// # Errors
    /// [`Refusal::Travel`].
    pub fn check(&self, motion: &Motion, slots: &TableSlots) -> Result<(), Refusal> {
        let Some((_, law)) = &self.limit else { return Ok(()) };
        let (mut at_start, mut at_end) = (0.0_f32, 0.0_f32);
        for tone in motion.trajectories() {
            if tone.from_level.0 == 0 && tone.to_level.0 == 0 {
                continue;
            }
            let travel = self.on_the_way(tone, motion.table(), law, slots);
            at_start += travel * amplitude(tone.from_level);
            at_end += travel * amplitude(tone.to_level);
        }
        // Not by `max`, which ignores a NaN.
        if at_start <= 1.0 && at_end <= 1.0 { Ok(()) } else { Err(refusal(at_start, at_end)) }
    }

    /// The largest travel of a tone of level 1 on its way.
    fn on_the_way(&self, tone: &ToneTrajectory, table: TableRef, law: &Law, slots: &TableSlots) -> f32 {
        let at = |setting: Setting| amplitude(setting.gain) * law.share(upper_half(setting));
        match tone.setting {
            SettingTrajectory::Hold { step, gain } => {
                // A comb's step may lie between two that the law takes, and far below the table's.
                let upper = upper_half(Setting { step, gain });
                amplitude(gain) * law.largest(upper, upper.saturating_add(1))
            }
            SettingTrajectory::Along if tone.from == tone.to => at(slots.evaluate(table, tone.to)),
            SettingTrajectory::Along => {
                let groups = match table.slot {
                    SlotIndex::First => &self.first,
                    SlotIndex::Second => &self.second,
                };
                let (first, last) = knots_between(table, tone.from, tone.to);
                groups.largest(first.into(), last.into())
            }
            SettingTrajectory::Join { step_upper, gain, .. } => {
                let ends = [tone.from, tone.to].map(|place| upper_half(slots.evaluate(table, place)));
                let widened = widen(ends, step_upper);
                let most = slots.extremes(table, tone.from, tone.to).gain;
                let most = most.saturating_add_signed(gain.max(0)).min(Gain::FULL.0);
                amplitude(Gain(most)) * law.largest(widened[0], widened[1])
            }
        }
    }
}

/// The steps between two, and those that are off by a part of `difference` (of the upper half of a step), too.
fn widen(ends: [u32; 2], difference: i32) -> [u32; 2] {
    let low = ends[0].min(ends[1]).saturating_add_signed(difference.min(0));
    // The lower half of the difference is less than one more.
    let high = ends[0].max(ends[1]).saturating_add_signed(difference.max(0).saturating_add(1));
    [low, high.min(MAX_KNOT_STEP)]
}

const fn upper_half(setting: Setting) -> u32 {
    (setting.step.0 >> 32) as u32
}

/// A gain as a float, 1 = full scale.
fn amplitude(gain: Gain) -> f32 {
    gain.0 as f32 / Gain::FULL.0 as f32
}

/// The refusal of a motion. A lower level helps at the end only: at the start the tones keep the levels that they have.
#[expect(clippy::cast_possible_truncation, reason = "the casts saturate")]
fn refusal(at_start: f32, at_end: f32) -> Refusal {
    // Rounded up, so that the reported travel is above the limit; the allowed level is rounded down.
    let travel_per_mille = ((at_start.max(at_end) * 1000.0) as u16).saturating_add(1);
    let allowed_per_mille = if at_start <= 1.0 { (1000.0 / at_end) as u16 } else { 0 };
    Refusal::Travel { travel_per_mille, allowed_per_mille: allowed_per_mille.min(999) }
}

/// Checks the values of a limit.
///
/// # Errors
/// [`Refusal::OutOfRange`] with the field.
pub(crate) fn check_ranges(limit: &TravelLimit) -> Result<(), Refusal> {
    within(Field::Resonance, limits::RESONANCE_UHZ, limit.resonance_uhz)?;
    within(Field::Quality, limits::QUALITY_PER_MILLE, limit.quality_per_mille)?;
    within(Field::StaticTravel, limits::STATIC_TRAVEL_PPM, limit.static_ppm)
}

#[cfg(test)]
mod tests;
