//! Tones that keep their frequency and amplitude over a block.

use super::block::ToneBlock;
use super::layout::{SteadyBasis, Turn};
use super::sine::{add_high, high, sine_cosine, sub_high, turned};

/// The largest amplitude in the kernels' unit, 2^-30 of full scale: one unit below 1, because one instruction (USAT)
/// clamps to it.
const MAX_AMPLITUDE: u32 = (1 << 30) - 1;

/// Computes the basis of one tone: `cos(w tau)` and `sin(w tau)` for `tau = 1/2, 3/2 .. 63/2`, and the turn `32 w`.
///
/// Every eighth sample comes from the sine table; from it, seven turns by `w` give the samples up to the next. A turn
/// costs less than the table. With seven turns the error reaches 4.2e-8 at worst. It is mostly the rotor's, which is
/// a little shorter than 1 (see `sine::ONE`) and has its phase cut to 32 bits.
pub(super) fn rebuild(step: u64, slot: usize, basis: &mut SteadyBasis) -> Turn {
    let (turn_sine, turn_cosine) = sine_cosine(upper(step));
    let mut phase = step >> 1;
    for (even, odd) in basis.even.chunks_exact_mut(2).zip(basis.odd.chunks_exact_mut(2)) {
        let (mut s, mut c) = sine_cosine(upper(phase));
        for (even, odd) in even.iter_mut().zip(odd) {
            let (Some(even), Some(odd)) = (even.get_mut(slot), odd.get_mut(slot)) else { continue };
            for (even, odd) in even.iter_mut().zip(odd) {
                (*even, *odd) = (c, s);
                (s, c) = turned(s, c, turn_sine, turn_cosine);
            }
        }
        phase = phase.wrapping_add((step >> 1) << 4);
    }
    let (sine, cosine) = sine_cosine(upper(step << 5));
    Turn { cosine, sine }
}

/// The seeds of one tone, `a sin` and `a cos` of the phase at the centres of the block's halves. `phase` is that at
/// the block's first sample.
#[inline]
pub(super) fn seed(phase: u64, tone: &ToneBlock, turn: &Turn, even: &mut [i32; 2], odd: &mut [i32; 2]) {
    // The block's centre lies half a sample before its 64th.
    let centre = upper(phase.wrapping_add(tone.step << 6)).wrapping_sub(upper(tone.step) >> 1);
    let (s, c) = sine_cosine(centre);
    let amplitude = amplitude_q30(tone.amplitude);
    let (p, q) = (high(amplitude, s), high(amplitude, c));
    let (along_p, along_q) = (high(p, turn.cosine), high(q, turn.cosine));
    *even = [sub_high(along_p, q, turn.sine), add_high(along_p, q, turn.sine)];
    *odd = [add_high(along_q, p, turn.sine), sub_high(along_q, p, turn.sine)];
}

/// An amplitude in units of 2^-30 of full scale, at most [`MAX_AMPLITUDE`].
#[inline(always)]
pub(super) const fn amplitude_q30(amplitude: u32) -> i32 {
    let half = amplitude >> 1;
    (if half < MAX_AMPLITUDE { half } else { MAX_AMPLITUDE }).cast_signed()
}

/// The upper half of a 64-bit phase.
#[inline(always)]
pub(super) const fn upper(phase: u64) -> u32 {
    (phase >> 32) as u32
}
