//! Tones that keep their frequency and amplitude over a block.

use super::kernel::{SteadyBasis, SteadySeeds};
use super::sine::{add_high, high, sine_cosine};

/// Turns a tone's amplitude and phase at the block's centre into those at the centres of its two halves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn {
    cosine: i32,
    sine: i32,
    minus_sine: i32,
}

impl Turn {
    /// No turn; for a tone that has no basis yet.
    pub(super) const NONE: Self = Self { cosine: 0, sine: 0, minus_sine: 0 };
}

/// Computes the basis of one tone: `cos(w tau)` and `sin(w tau)` for `tau = 1/2, 3/2 .. 63/2`, and the turn `32 w`.
pub(super) fn rebuild(step: u64, tone: usize, basis: &mut SteadyBasis) -> Turn {
    let half = step >> 1;
    let mut phase = half;
    for (even, odd) in basis.even.iter_mut().zip(&mut basis.odd) {
        let (Some(even), Some(odd)) = (even.get_mut(tone), odd.get_mut(tone)) else { continue };
        for (even, odd) in even.iter_mut().zip(odd) {
            (*odd, *even) = sine_cosine(upper(phase));
            phase = phase.wrapping_add(step);
        }
    }
    let (sine, cosine) = sine_cosine(upper(step.wrapping_mul(32)));
    Turn { cosine, sine, minus_sine: -sine }
}

/// The seeds of one tone: `a sin` and `a cos` of the phase at the centres of the block's halves.
pub(super) fn seed(phase: u64, step: u64, amplitude: u32, turn: &Turn, tone: usize, seeds: &mut SteadySeeds) {
    let (Some(even), Some(odd)) = (seeds.even.get_mut(tone), seeds.odd.get_mut(tone)) else { return };
    // The block's centre lies half a sample before its 64th.
    let centre = phase.wrapping_add(step << 6).wrapping_sub(step >> 1);
    let (s, c) = sine_cosine(upper(centre));
    let amplitude = (amplitude >> 1).cast_signed();
    let (p, q) = (high(amplitude, s), high(amplitude, c));
    let (along_p, along_q) = (high(p, turn.cosine), high(q, turn.cosine));
    *even = [add_high(along_p, q, turn.minus_sine), add_high(along_p, q, turn.sine)];
    *odd = [add_high(along_q, p, turn.sine), add_high(along_q, p, turn.minus_sine)];
}

/// The upper half of a 64-bit phase.
#[inline(always)]
pub(super) const fn upper(phase: u64) -> u32 {
    (phase >> 32) as u32
}
