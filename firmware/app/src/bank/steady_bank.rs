//! Steady tones, rendered apart from the bank that sounds.

use super::block::{BLOCK, TONES, ToneBlock};
use super::kernel::Kernel;
use super::layout::{SteadyBasis, SteadySeeds, Turn};
use super::native::Native;
use super::portable::Portable;

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

impl Default for SteadyBank {
    fn default() -> Self {
        Self::new()
    }
}

impl SteadyBank {
    /// Silence.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            phases: [0; TONES],
            tones: [ToneBlock::steady(0, 0); TONES],
            turns: [Turn::NONE; TONES],
            basis: SteadyBasis::new(),
            seeds: SteadySeeds::new(),
        }
    }

    /// Makes every tone silent.
    pub fn silence(&mut self) {
        self.tones = [ToneBlock::steady(0, 0); TONES];
    }

    /// Makes a tone sound: its step and its phase at the next block's first sample, 2^64 = one turn, and its amplitude,
    /// 0..=[`AMPLITUDE_ONE`](super::AMPLITUDE_ONE). Does nothing for a slot that does not exist.
    pub fn set(&mut self, slot: usize, step: u64, phase: u64, amplitude: u32) {
        self.set_with::<Native>(slot, step, phase, amplitude);
    }

    /// Renders the next block, in units of 1/[`FULL_SCALE`](super::FULL_SCALE) of half the DAC's swing.
    pub fn render(&mut self, out: &mut [i32; BLOCK]) {
        self.render_with::<Native>(out);
    }

    /// As [`SteadyBank::set`], by the portable kernel on every machine. Tests compare the assembly with it.
    pub fn set_portable(&mut self, slot: usize, step: u64, phase: u64, amplitude: u32) {
        self.set_with::<Portable>(slot, step, phase, amplitude);
    }

    /// As [`SteadyBank::render`], by the portable kernel on every machine.
    pub fn render_portable(&mut self, out: &mut [i32; BLOCK]) {
        self.render_with::<Portable>(out);
    }

    fn set_with<K: Kernel>(&mut self, slot: usize, step: u64, phase: u64, amplitude: u32) {
        let Self { phases, tones, turns, basis, .. } = self;
        let tone = phases.get_mut(slot).zip(tones.get_mut(slot)).zip(turns.get_mut(slot));
        if let Some(((at, tone), turn)) = tone {
            *at = phase;
            *tone = ToneBlock::steady(step, amplitude);
            K::rebuild(step, slot, basis, turn);
        }
    }

    fn render_with<K: Kernel>(&mut self, out: &mut [i32; BLOCK]) {
        K::seed_steady(&mut self.phases, &self.tones, &self.turns, &mut self.seeds);
        K::steady(&self.basis, &self.seeds, out);
    }
}
