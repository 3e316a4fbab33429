//! Tones that change frequency or amplitude within a block.
//!
//! The block is cut into eight sub-blocks of 16 samples. About the centre of sub-block `j`, `tau` samples away, a tone
//! with amplitude `A + a tau`, phase `p` and frequency `w + e + d tau` (`w` that of the block's middle, `d` the chirp
//! per sample, `e = 16 (j - 7/2) d`) is
//! ```text
//! Im[ (A + a tau) exp(i(e tau + d tau^2/2)) exp(ip) exp(i w tau) ] = Im[ g(tau) exp(ip) exp(i w tau) ]
//! g(tau) = A + (a + iAe) tau + (-Ae^2/2 + i(Ad/2 + ae)) tau^2 + O(tau^3)
//! ```
//! so one basis `exp(i w tau)` serves all eight, if the sums have two corrections besides the seed. With `G1 tau` and
//! `G2 tau^2` for the last two terms times `exp(ip)`, the even and odd sums of [`super`] become
//! ```text
//! E = A sin p  C + tau (G1re S + tau G2im C)      C = cos(w tau)
//! O = A cos p  S + tau (G1im C + tau G2re S)      S = sin(w tau)
//! ```
//! The brackets are small, so 16 bits are enough for them: both products are one SMLAD of packed words, `(S, tau C)`
//! and `(C, tau S)`, with packed coefficients, and the sum over the tones is multiplied by `tau`.
//!
//! Of the third order, `-(Aed/2) tau^3 + i(ad/2) tau^3` is the largest. It is replaced by the straight line that is
//! closest to it over the sub-block, `tau^3 -> 5/8 8^2 tau`, which only changes `G1` ("straighten" and "lean" below).
//! At [`MAX_STEP_CHANGE`](super::block::MAX_STEP_CHANGE), `e tau` reaches 0.020 and `d tau^2/2` 0.0013: the cubic of
//! 2.7e-5 at the outermost samples shrinks to 1.0e-5. With the neglected `e^3` and `a e^2` this makes 2e-5 (-94 dB) at
//! the peak; it falls with the square of the chirp. The packed coefficients' unit of 2^-17 leaves 5e-6 (-106 dB) at any
//! chirp. The tests assert the sums of these errors: -93 dB peak and -105 dB rms at the limit, -98 and -108 dB at a
//! quarter of the limit and below.
//!
//! Scales, in units of `tau/8`, fractional bits in brackets: `theta` [36] is the whole block's change in radians per
//! sample; detuning `8e = theta (j - 7/2)` [36]; amplitude `A` [30]; slope `8a` [34]; `8Ae` [34] ("imaginary");
//! swell `64(Ad/2 + ae) = A theta/4 + 8a 8e` [34]; curl `64 Ae^2/2` [37, packed at 18]. Packed corrections [17], packed
//! words [13], their sums [30]. The sign of `tau C` and `tau S` is turned, since the dual products give `-G2`.

use super::block::{TONES, ToneBlock};
use super::layout::{GlideBasis, GlideSeeds};
use super::sine::{add_high, doubled, high, sine_cosine, sub_high, turned};
use super::steady::{amplitude_q30, upper};

/// Half of the packed numbers' unit, before their lower sixteen bits are cut off.
pub(super) const HALF_UNIT: i32 = 1 << 15;

/// `2 pi 2^-36 2^32`: turns a change of step (2^-40 turns) into radians with 36 fractional bits.
pub(super) const THETA: i32 = 1_686_629_713;

/// One tone's change over the block in units of 2^-40 turns per sample, kept within 2^-10 turns.
pub(crate) fn change(block: &ToneBlock) -> i32 {
    const LIMIT: i32 = 1 << 22;
    let change = block.step_end.wrapping_sub(block.step);
    let whole = upper(change).cast_signed().clamp(-LIMIT, LIMIT - 1);
    (whole << 8) | ((change >> 24) & 0xFF) as i32
}

/// Fills one tone's column of the basis, at the frequency the tone has at the block's centre.
pub(super) fn rebuild(block: &ToneBlock, tone: usize, basis: &mut GlideBasis) {
    // Sample 63 1/2 of the block: s + change (1/2 - 1/256).
    let centre = upper(block.step).wrapping_add_signed(high(change(block), 127 << 16));
    let (mut s, mut c) = sine_cosine(centre >> 1);
    // From w/2 to w.
    let (turn_sine, turn_cosine) = doubled(s, c);

    let mut tau = -1;
    let GlideBasis { even, odd, even_bend, odd_bend } = basis;
    let bends = column(even_bend, tone).zip(column(odd_bend, tone));
    for ((even, odd), (even_bend, odd_bend)) in column(even, tone).zip(column(odd, tone)).zip(bends) {
        (*even, *odd) = (c, s);
        *even_bend = pack(add_high(HALF_UNIT, c, tau << 26), s >> 18);
        *odd_bend = pack(add_high(HALF_UNIT, s, tau << 26), c >> 18);
        (s, c) = turned(s, c, turn_sine, turn_cosine);
        tau -= 2;
    }
}

/// Computes one tone's coefficients for each sub-block. `phase` is that at the block's first sample.
pub(super) fn seed(phase: u64, block: &ToneBlock, tone: usize, seeds: &mut GlideSeeds) {
    let change = change(block);
    // Sample 7 1/2: s 15/2 + change (15/2)^2 / 256.
    let mut angle = upper(phase)
        .wrapping_add(upper(block.step << 3))
        .wrapping_sub(upper(block.step) >> 1)
        .wrapping_add_signed(high(change, 225 << 14));
    // From one centre to the next: 16 s + change 31/16, and each time 2 change more.
    let mut gain = upper(block.step << 4).wrapping_add_signed(high(change, 31 << 20));
    let gain_change = change >> 7;

    let theta = high(change, THETA);
    let start = amplitude_q30(block.amplitude);
    let ramp = amplitude_q30(block.amplitude_end) - start;
    let mut amplitude = add_high(start, ramp, 15 << 24);
    let mut detune = theta - (theta << 2) - (theta >> 1);
    let straighten = high(theta, 5 << 23);
    let lean = add_high(HALF_UNIT, ramp, straighten);
    let slope = ramp + HALF_UNIT;
    let mut swell = add_high(add_high(HALF_UNIT, amplitude, theta >> 2), ramp, detune >> 4);
    let swell_change = add_high(high(ramp >> 3, theta >> 2), ramp, theta >> 4);

    let GlideSeeds { even, odd, even_bend, odd_bend } = seeds;
    let bends = column(even_bend, tone).zip(column(odd_bend, tone));
    for ((even, odd), (even_bend, odd_bend)) in column(even, tone).zip(column(odd, tone)).zip(bends) {
        let (s, c) = sine_cosine(angle);
        (*even, *odd) = (high(amplitude >> 1, s), high(amplitude >> 1, c));
        let imaginary = add_high(lean, amplitude, detune);
        let real = sub_high(slope, imaginary, straighten);
        let curl = high(imaginary, detune) >> 21;
        let (s, c) = (s >> 16, c >> 16);
        let (first_re, first_im) = (real >> 16, imaginary >> 16);
        let (second_re, second_im) = (curl, swell >> 16);
        *even_bend =
            pack(HALF_UNIT + second_re * s - second_im * c, (HALF_UNIT + first_re * c - first_im * s) >> 16);
        *odd_bend =
            pack(HALF_UNIT + second_re * c + second_im * s, (HALF_UNIT + first_re * s + first_im * c) >> 16);
        angle = angle.wrapping_add_signed(gain.cast_signed());
        gain = gain.wrapping_add_signed(gain_change);
        amplitude += ramp >> 3;
        detune += theta;
        swell += swell_change;
    }
}

/// One tone's words in the order of the samples or sub-blocks.
#[inline]
fn column<const WIDTH: usize>(
    rows: &mut [[[i32; WIDTH]; TONES]],
    tone: usize,
) -> impl Iterator<Item = &mut i32> {
    rows.iter_mut().filter_map(move |row| row.get_mut(tone)).flatten()
}

/// The upper half of one number over the lower half of another.
#[inline(always)]
const fn pack(upper: i32, lower: i32) -> i32 {
    (upper & !0xFFFF) | (lower & 0xFFFF)
}
