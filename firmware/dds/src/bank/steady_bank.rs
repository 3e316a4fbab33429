//! Steady tones, rendered apart from the bank that sounds.

use super::block::{BLOCK, TONES, ToneBlock};
use super::kernel::Kernel;
use super::layout::{NO_PAIR, SteadyBasis, SteadySeeds, Turn, no_words};
use super::native::Native;

/// Sixteen steady tones with their phases. A block is, bit for bit, the one that [`Bank`](super::Bank) renders of steady tones
/// at these phases: the same kernel computes it from the same numbers.
#[derive(Clone, Debug)]
pub struct SteadyBank {
    phases: [u64; TONES],
    tones: [ToneBlock; TONES],
    turns: [Turn; TONES],
    basis: SteadyBasis,
    seeds: SteadySeeds,
}

impl SteadyBank {
    /// Silence.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            phases: [0; TONES],
            tones: [ToneBlock::steady(0, 0); TONES],
            turns: [Turn::NONE; TONES],
            basis: SteadyBasis::both(no_words()),
            seeds: SteadySeeds::both(NO_PAIR),
        }
    }

    /// Makes every tone silent.
    #[inline]
    pub fn silence(&mut self) {
        self.tones = [ToneBlock::steady(0, 0); TONES];
    }

    /// Makes a tone sound: its step and its phase at the next block's first sample, 2^64 = one turn, and its amplitude,
    /// 0..=[`AMPLITUDE_ONE`](super::AMPLITUDE_ONE). Does nothing for a slot that does not exist.
    #[inline]
    pub fn set(&mut self, slot: usize, step: u64, phase: u64, amplitude: u32) {
        let Self { phases, tones, turns, basis, .. } = self;
        let tone = phases.get_mut(slot).zip(tones.get_mut(slot)).zip(turns.get_mut(slot));
        if let Some(((at, tone), turn)) = tone {
            *at = phase;
            *tone = ToneBlock::steady(step, amplitude);
            Native::rebuild(step, slot, basis, turn);
        }
    }

    /// Renders the next block, in units of 1/[`FULL_SCALE`](super::FULL_SCALE) of half the DAC's swing.
    #[inline]
    pub fn render(&mut self, out: &mut [i32; BLOCK]) {
        Native::seed_steady(&mut self.phases, &self.tones, &self.turns, &mut self.seeds);
        Native::steady(&self.basis, &self.seeds, out);
    }
}
