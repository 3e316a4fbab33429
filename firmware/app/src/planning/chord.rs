//! Chords: tones that are multiples of one base frequency, and the proof that their sum fits the DAC.
//!
//! ```text
//! Chord + table --ChordTones::of--> targets --Planner::chord--> Motion, as of a drive
//!                                     | their sum is above full scale
//!                                     +--Proof: renders one period silently--> fits, or Refusal::Peak
//! ```
//! The base frequency is `rate / P` with a period of `P = 2^p` samples, and tone i has the phase step `m_i 2^64 / P`, exact in
//! the 64 bits of a phase. After P samples every phase returns, so the sum repeats. P is a whole number of blocks, and
//! a steady block follows from its phases and its tones alone: each block of a steady chord is one of the `P / 128` that the
//! proof has rendered, bit for bit. So the largest code that the proof has seen is the largest that is ever sent.
//!
//! **While the amplitude moves** (the rise from silence, a ramp to silence, the thermal fold-back) all tones are scaled by one
//! factor of at most 1, within a block, too. So the sum stays below the proven peak, up to what the gliding kernel is less
//! exact than the steady one: -96 dB of each tone's amplitude at worst (asserted by the bank's tests), 9e-5 for the largest
//! sum of amplitudes. A code is clamped only above `2047.5 / 2047`, which is 2.4e-4 more than full scale.
//!
//! **A change of single tones** (a drive, a table) has no proof: it must keep the sum of the amplitudes within full scale on
//! its whole way, from the chord on. To let all tones of a chord fade needs none.
//!
//! **No tone is louder than in a drive.** Its gain is the table's at the place that has its frequency, and a frequency beyond
//! the table's ends is refused.
//!
//! **Combs** are placed like chords. Their period is `P = 128 B` samples, and the phase step `m 2^64 / P` is rounded down, so
//! that after a period a phase is off by less than 2^-41 turns. A frequency beyond the table's ends takes the gain of that end.
//! There is no proof: their amplitudes must add up to full scale at most.

#![cfg_attr(not(test), deny(clippy::float_arithmetic))]

mod proof;

use slipline_protocol::command::{Chord, Comb};
use slipline_protocol::limits::{
    CHORD_PERIOD_LOG2, COMB_BLOCK, COMB_PERIOD_BLOCKS, MAX_CHORD_SUM_PER_MILLE, MAX_FREQUENCY_PER_MILLE,
    MAX_TONES,
};
use slipline_protocol::refusal::{Field, Refusal};
use slipline_protocol::table::{self, Knot, Setting};
use slipline_protocol::units::{FinePosition, Gain, Level, Phase, PhaseStep, per_mille};

pub use self::proof::{Candidate, Extent, Proof};
use crate::planning::level::master_gain;
use crate::planning::program::Target;
use crate::range::{in_range, within};

/// A chord's tones, checked: step, phase and level of each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChordTones {
    targets: [Option<Target>; MAX_TONES],
    /// Samples in a period.
    period: u32,
}

impl ChordTones {
    /// No tones, at the shortest period.
    pub const NONE: Self = Self { targets: [None; MAX_TONES], period: 1 << CHORD_PERIOD_LOG2.0 };

    /// A chord's tones by a table of `knots` knots, which `knot` returns by index.
    ///
    /// # Errors
    /// [`Refusal::NoTable`], [`Refusal::OutOfRange`] for the number of tones, the period, and a multiple that is not above the
    /// one before it or lies outside the table's frequencies.
    pub fn of(chord: &Chord, knots: u16, knot: impl Fn(u16) -> Knot) -> Result<Self, Refusal> {
        let mut tones = Self::NONE;
        tones.set(chord, knots, knot).map(|()| tones)
    }

    /// As [`ChordTones::of`], in place: a firmware has no room for another copy on its stack. After an error they are no
    /// chord's.
    ///
    /// # Errors
    /// As [`ChordTones::of`].
    pub(crate) fn set(
        &mut self,
        chord: &Chord,
        knots: u16,
        knot: impl Fn(u16) -> Knot,
    ) -> Result<(), Refusal> {
        if knots < 2 {
            return Err(Refusal::NoTable);
        }
        let period_log2 = chord.period_log2;
        within(Field::ChordPeriod, CHORD_PERIOD_LOG2, period_log2)?;
        in_range(Field::ToneCount, 1, MAX_TONES as u64, chord.tones.len() as u64)?;
        // The base frequency's phase step, Q0.32; the shifts are in range by the check above.
        let base = 1u32 << (32 - u32::from(period_log2));
        let (first, last) = (knot(0).step, knot(knots - 1).step);
        let harmonics = (first.min(last).div_ceil(base), first.max(last) / base);
        *self = Self { period: 1 << period_log2, ..Self::NONE };
        let tones = chord.tones.iter().map(|tone| (tone.harmonic, tone.level, tone.phase));
        self.place(tones, harmonics, master_gain(chord.master), knots, knot)
    }

    /// A comb's tones in place, as [`ChordTones::of`] a chord's.
    ///
    /// # Errors
    /// [`Refusal::NoTable`], [`Refusal::OutOfRange`] for the number of tones, the period, and a multiple that is not above the
    /// one before it or above 0.45 of the sample rate.
    pub(crate) fn set_comb(
        &mut self,
        comb: &Comb,
        knots: u16,
        knot: impl Fn(u16) -> Knot,
    ) -> Result<(), Refusal> {
        if knots < 2 {
            return Err(Refusal::NoTable);
        }
        let blocks = comb.period_blocks;
        within(Field::CombPeriod, COMB_PERIOD_BLOCKS, blocks)?;
        in_range(Field::ToneCount, 1, MAX_TONES as u64, comb.tones.len() as u64)?;
        let period = COMB_BLOCK * u32::from(blocks);
        let highest = u64::from(period) * u64::from(MAX_FREQUENCY_PER_MILLE) / 1000;
        let highest = u32::try_from(highest).unwrap_or(u32::MAX).min(u16::MAX.into());
        *self = Self { period, ..Self::NONE };
        let tones = comb.tones.iter().map(|tone| (tone.harmonic, tone.level, tone.phase));
        self.place(tones, (1, highest), master_gain(comb.master), knots, knot)
    }

    /// Places tones (multiple, level, phase) whose multiples rise within a range. A frequency beyond the table's takes the
    /// place and the gain of its end.
    fn place(
        &mut self,
        tones: impl Iterator<Item = (u16, Level, Phase)>,
        (mut lowest, highest): (u32, u32),
        master: Gain,
        knots: u16,
        knot: impl Fn(u16) -> Knot,
    ) -> Result<(), Refusal> {
        let last = knots - 1;
        let first_is_lower = knot(0).step < knot(last).step;
        for ((harmonic, level, phase), target) in tones.zip(&mut self.targets) {
            let harmonic = u32::from(harmonic);
            within(Field::Harmonic, (lowest, highest), harmonic)?;
            let step = step_of(harmonic, self.period);
            let upper = (step.0 >> 32) as u32;
            let (position, gain) = match table::place_of_step(knots, upper, &knot) {
                Some((index, fraction)) => (
                    table::position_between(knots, index, fraction),
                    table::between(knot(index), knot(index + 1), fraction).gain,
                ),
                None if (upper < knot(0).step) == first_is_lower => (FinePosition::default(), knot(0).gain),
                None => (FinePosition::END, knot(last).gain),
            };
            *target = Some(Target {
                position,
                level: master.scaled(level),
                phase: u64::from(phase.0) << 48,
                setting: Some(Setting { step, gain }),
            });
            lowest = harmonic + 1;
        }
        Ok(())
    }

    /// The goal of each slot.
    #[must_use]
    pub(crate) const fn targets(&self) -> &[Option<Target>; MAX_TONES] {
        &self.targets
    }

    /// Samples in a period.
    #[must_use]
    pub const fn period(&self) -> u32 {
        self.period
    }

    /// The sum of the amplitudes, Q1.31.
    #[must_use]
    pub fn sum(&self) -> u64 {
        self.sounding().map(|(_, _, _, amplitude)| u64::from(amplitude.0)).sum()
    }

    /// Checks that phases may exist with which the tones fit. It also keeps every sample within 32 bits.
    ///
    /// # Errors
    /// [`Refusal::Headroom`].
    pub fn check_sum(&self) -> Result<(), Refusal> {
        let sum_per_mille = per_mille(self.sum());
        if u32::from(sum_per_mille) > MAX_CHORD_SUM_PER_MILLE {
            return Err(Refusal::Headroom { sum_per_mille });
        }
        Ok(())
    }

    /// Slot, phase step, phase and amplitude of every tone.
    fn sounding(&self) -> impl Iterator<Item = (usize, PhaseStep, u64, Gain)> {
        self.targets.iter().enumerate().filter_map(|(slot, target)| {
            let target = target.as_ref()?;
            let setting = target.setting?;
            Some((slot, setting.step, target.phase, setting.gain.times(target.level)))
        })
    }
}

/// `harmonic * 2^64 / period`, rounded down, for a multiple below the period: by two divisions of 64 bits, since one of 128
/// bits takes as long as twenty of them, and no stop is looked for meanwhile.
const fn step_of(harmonic: u32, period: u32) -> PhaseStep {
    let (high, period) = ((harmonic as u64) << 32, period as u64);
    let low = (high % period) << 32;
    PhaseStep(((high / period) << 32) | (low / period))
}

#[cfg(test)]
mod tests;
