//! Tones that change frequency or amplitude within a block.

use super::kernel::{GlideBasis, GlideSeeds};
use super::sine::{add_high, high, sine_cosine};
use super::steady::upper;
use super::{MAX_STEP_CHANGE, ToneBlock};

/// Half of the packed coefficients' unit, before their lower sixteen bits are cut off.
const HALF_UNIT: i32 = 1 << 15;

/// Fills one tone's column of the basis, at the frequency the tone has at the block's centre.
pub(super) fn rebuild(step: u64, change: i64, tone: usize, basis: &mut GlideBasis) {
    let centre = step.wrapping_add((change >> 1).cast_unsigned()).wrapping_sub((change >> 8).cast_unsigned());
    let mut phase = centre >> 1;
    let mut odd_number = 1;
    let groups =
        basis.even.iter_mut().zip(&mut basis.odd).zip(basis.even_bend.iter_mut().zip(&mut basis.odd_bend));
    for ((even, odd), (even_bend, odd_bend)) in groups {
        let (Some(even), Some(odd), Some(even_bend), Some(odd_bend)) =
            (even.get_mut(tone), odd.get_mut(tone), even_bend.get_mut(tone), odd_bend.get_mut(tone))
        else {
            continue;
        };
        for ((even, odd), (even_bend, odd_bend)) in
            even.iter_mut().zip(odd).zip(even_bend.iter_mut().zip(odd_bend))
        {
            let (s, c) = sine_cosine(upper(phase));
            let (first, second) = (odd_number << 26, (odd_number * odd_number) << 22);
            (*even, *odd) = (c, s);
            *even_bend = pack(add_high(HALF_UNIT, s, first), add_high(HALF_UNIT, c, second));
            *odd_bend = pack(add_high(HALF_UNIT, c, first), add_high(HALF_UNIT, s, second));
            phase = phase.wrapping_add(centre);
            odd_number += 2;
        }
    }
}

/// Computes one tone's coefficients for each sub-block.
pub(super) fn seed(phase: u64, block: &ToneBlock, tone: usize, seeds: &mut GlideSeeds) {
    let change = block.step_end.wrapping_sub(block.step).cast_signed();
    const LIMIT: i64 = MAX_STEP_CHANGE.cast_signed();
    let bounded = change.clamp(-LIMIT, LIMIT);

    // Sample 7 1/2: s 15/2 + change (15/2)^2 / 256.
    let curve = (change >> 10).wrapping_mul(225).cast_unsigned();
    let to_first = (block.step >> 1).wrapping_mul(15).wrapping_add(curve);
    let mut angle = upper(phase.wrapping_add(to_first));
    // From one centre to the next: 16 s + change 31/16, and 2 change more each time.
    let mut gain = upper((block.step << 4).wrapping_add((change >> 4).wrapping_mul(31).cast_unsigned()));
    let gain_change = upper(change.wrapping_mul(2).cast_unsigned());

    #[expect(clippy::cast_possible_truncation, reason = "bounded to 2^54, so 2^30 after the shift")]
    let theta = high((bounded >> 24) as i32, 1_686_629_713);
    let start = (block.amplitude >> 1).cast_signed();
    let ramp = (block.amplitude_end >> 1).cast_signed() - start;
    let mut amplitude = start + high(ramp, 15 << 24);
    let mut detune = -(3 * theta + (theta >> 1));
    let straighten = high(theta, 5 << 23);
    let lean = high(ramp, straighten);
    let mut swell = high(amplitude, theta >> 2) + high(ramp, detune >> 4);
    let swell_change = high(ramp >> 3, theta >> 2) + high(ramp, theta >> 4);

    let even = seeds.even.iter_mut().zip(&mut seeds.even_bend);
    let odd = seeds.odd.iter_mut().zip(&mut seeds.odd_bend);
    for ((even, even_bend), (odd, odd_bend)) in even.zip(odd) {
        let (Some(even), Some(even_bend), Some(odd), Some(odd_bend)) =
            (even.get_mut(tone), even_bend.get_mut(tone), odd.get_mut(tone), odd_bend.get_mut(tone))
        else {
            continue;
        };
        for ((even, even_bend), (odd, odd_bend)) in
            even.iter_mut().zip(even_bend).zip(odd.iter_mut().zip(odd_bend))
        {
            let (s, c) = sine_cosine(angle);
            *even = high(amplitude >> 1, s);
            *odd = high(amplitude >> 1, c);
            let imaginary = add_high(lean, amplitude, detune);
            let real = add_high(ramp, imaginary, -straighten);
            let curl = high(imaginary, -(detune >> 5));
            *even_bend = pack(
                add_high(add_high(HALF_UNIT, real, c), imaginary, -s),
                add_high(add_high(HALF_UNIT, curl, s), swell, c),
            );
            *odd_bend = pack(
                add_high(add_high(HALF_UNIT, real, s), imaginary, c),
                add_high(add_high(HALF_UNIT, curl, c), swell, -s),
            );
            angle = angle.wrapping_add(gain);
            gain = gain.wrapping_add(gain_change);
            amplitude += ramp >> 3;
            detune += theta;
            swell += swell_change;
        }
    }
}

/// The upper halves of two numbers in one word.
#[inline(always)]
const fn pack(lower: i32, upper: i32) -> i32 {
    (lower >> 16 & 0xFFFF) | (upper & !0xFFFF)
}
