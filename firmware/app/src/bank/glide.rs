//! Tones that change frequency or amplitude within a block.

use super::ToneBlock;
use super::kernel::{GlideBasis, GlideSeeds};
use super::sine::{add_high, doubled, high, sine_cosine, sub_high, turned};
use super::steady::{loudness, upper};

/// Half of the packed numbers' unit, before their lower sixteen bits are cut off.
pub(super) const HALF_UNIT: i32 = 1 << 15;

/// `2 pi 2^-36 2^32`: turns a change of step (2^-40 turns) into radians with 36 fractional bits.
pub(super) const THETA: i32 = 1_686_629_713;

/// One tone's change over the block in units of 2^-40 turns per sample, kept within 2^-10 turns.
fn change(block: &ToneBlock) -> i32 {
    const LIMIT: i32 = 1 << 22;
    let change = block.step_end.wrapping_sub(block.step);
    let whole = upper(change).cast_signed().clamp(-LIMIT, LIMIT - 1);
    (whole << 8) | ((change >> 24) & 0xFF) as i32
}

/// Fills one tone's column of the basis, at the frequency the tone has at the block's centre.
pub(super) fn rebuild(block: &ToneBlock, tone: usize, basis: &mut GlideBasis) {
    // Sample 63 1/2: s + change (1/2 - 1/256).
    let centre = upper(block.step).wrapping_add_signed(high(change(block), 127 << 16));
    let (mut s, mut c) = sine_cosine(centre >> 1);
    // From w/2 to w.
    let (turn_sine, turn_cosine) = doubled(s, c);

    let mut tau = -1;
    let packed = basis.even_bend.iter_mut().zip(&mut basis.odd_bend);
    for ((even, odd), (even_bend, odd_bend)) in basis.even.iter_mut().zip(&mut basis.odd).zip(packed) {
        let (Some(even), Some(odd), Some(even_bend), Some(odd_bend)) =
            (even.get_mut(tone), odd.get_mut(tone), even_bend.get_mut(tone), odd_bend.get_mut(tone))
        else {
            continue;
        };
        let packed = even_bend.iter_mut().zip(odd_bend);
        for ((even, odd), (even_bend, odd_bend)) in even.iter_mut().zip(odd).zip(packed) {
            (*even, *odd) = (c, s);
            *even_bend = pack(add_high(HALF_UNIT, c, tau << 26), s >> 18);
            *odd_bend = pack(add_high(HALF_UNIT, s, tau << 26), c >> 18);
            (s, c) = turned(s, c, turn_sine, turn_cosine);
            tau -= 2;
        }
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
    let start = loudness(block.amplitude);
    let ramp = loudness(block.amplitude_end) - start;
    let mut amplitude = add_high(start, ramp, 15 << 24);
    let mut detune = theta - (theta << 2) - (theta >> 1);
    let straighten = high(theta, 5 << 23);
    let lean = add_high(HALF_UNIT, ramp, straighten);
    let slope = ramp + HALF_UNIT;
    let mut swell = add_high(add_high(HALF_UNIT, amplitude, theta >> 2), ramp, detune >> 4);
    let swell_change = add_high(high(ramp >> 3, theta >> 2), ramp, theta >> 4);

    let packed = seeds.even_bend.iter_mut().zip(&mut seeds.odd_bend);
    for ((even, odd), (even_bend, odd_bend)) in seeds.even.iter_mut().zip(&mut seeds.odd).zip(packed) {
        let (Some(even), Some(odd), Some(even_bend), Some(odd_bend)) =
            (even.get_mut(tone), odd.get_mut(tone), even_bend.get_mut(tone), odd_bend.get_mut(tone))
        else {
            continue;
        };
        let packed = even_bend.iter_mut().zip(odd_bend);
        for ((even, odd), (even_bend, odd_bend)) in even.iter_mut().zip(odd).zip(packed) {
            let (s, c) = sine_cosine(angle);
            (*even, *odd) = (high(amplitude >> 1, s), high(amplitude >> 1, c));
            let imaginary = add_high(lean, amplitude, detune);
            let real = sub_high(slope, imaginary, straighten);
            let curl = high(imaginary, detune) >> 21;
            let (s, c) = (s >> 16, c >> 16);
            let (first_re, first_im) = (real >> 16, imaginary >> 16);
            let (second_re, second_im) = (curl, swell >> 16);
            *even_bend = pack(
                HALF_UNIT + second_re * s - second_im * c,
                (HALF_UNIT + first_re * c - first_im * s) >> 16,
            );
            *odd_bend = pack(
                HALF_UNIT + second_re * c + second_im * s,
                (HALF_UNIT + first_re * s + first_im * c) >> 16,
            );
            angle = angle.wrapping_add_signed(gain.cast_signed());
            gain = gain.wrapping_add_signed(gain_change);
            amplitude += ramp >> 3;
            detune += theta;
            swell += swell_change;
        }
    }
}

/// The upper half of one number over the lower half of another.
#[inline(always)]
const fn pack(upper: i32, lower: i32) -> i32 {
    (upper & !0xFFFF) | (lower & 0xFFFF)
}
