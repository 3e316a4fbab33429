//! Sine and cosine of a 32-bit phase: a table of 1024 points and a second-order turn from the nearest one.
//!
//! The phase is cut into its upper ten bits, which pick a bin, and the residual angle `r` from the bin's centre,
//! `|r| <= pi/1024 = 0.00307`. With `S` and `C` the bin centre's sine and cosine:
//! ```text
//! sin(centre + r) = S + C k r - S r^2/2        cos(centre + r) = C - S k r - C r^2/2
//! ```
//! What is left out is `r^3/6 = 4.8e-9` at the edge of a bin. The factor `k = 1 - 0.6 (pi/1024)^2/6`, folded into the
//! scale of `r`, takes away the part of the cubic that looks like a straight line (3/5 of it, by least squares): the
//! rest is 1.9e-9 (-174 dB) at the worst phase. The quartic of the cosine is 4e-12. Rounding the table and the three
//! truncations of each sum, 2^-31 = 4.7e-10 at most each, make 3.5e-9 (-169 dB) in all; the test holds that.
//!
//! Everything is integers, the table too: it is made at compile time from a Taylor series in 60-bit fractions.

/// The number for 1.0: a little below 2^31, so that the truncations and the neglected cubic never wrap the sign.
pub const ONE: i32 = i32::MAX - 7;

const BINS: usize = 1024;

/// `2 pi 2^-10 2^32 k`: turns a residual phase (2^-42 turns) into radians with 32 fractional bits.
pub(crate) const RADIANS: i32 = 26_353_564;

/// Sine and cosine at the centre of each bin, in units of 2^-31.
pub(crate) static TABLE: [[i32; 2]; BINS] = table();

/// Sine and cosine of `phase` (2^32 is one turn), scaled by [`ONE`]. Worst error 3.5e-9, that is -169 dB.
#[inline(always)]
#[must_use]
#[expect(
    clippy::indexing_slicing,
    reason = "a phase's upper ten bits are below 1024; the check is compiled away"
)]
pub fn sine_cosine(phase: u32) -> (i32, i32) {
    let [s, c] = TABLE[(phase >> 22) as usize];
    // The bin's lower edge has a residual of all zeros: flipping the top bit makes the centre zero.
    let residual = ((phase << 10) ^ 0x8000_0000).cast_signed();
    let r = high(residual, RADIANS);
    let h = high(r, r) >> 1;
    (sub_high(add_high(s, c, r), s, h), sub_high(sub_high(c, s, r), c, h))
}

/// Sine and cosine of the sum of two angles. Each product halves the scale, so a shift doubles it again. All products
/// are rounded to nearest (SMMULR, SMMLAR, SMMLSR), so that a chain of turns does not drift to one side.
#[inline(always)]
pub(crate) const fn turned(s: i32, c: i32, turn_sine: i32, turn_cosine: i32) -> (i32, i32) {
    let (sine, cosine) = (high_rounded(0, s, turn_cosine), high_rounded(0, c, turn_cosine));
    (high_rounded(sine, c, turn_sine) << 1, high_rounded(cosine, s, -turn_sine) << 1)
}

/// Sine and cosine of twice an angle, rounded in the same way.
#[inline(always)]
pub(crate) const fn doubled(s: i32, c: i32) -> (i32, i32) {
    (high_rounded(0, s, c) << 2, high_rounded(high_rounded(0, c, c), s, -s) << 1)
}

/// `sum` plus the upper half of a product, rounded to nearest.
#[inline(always)]
pub(crate) const fn high_rounded(sum: i32, a: i32, b: i32) -> i32 {
    ((((sum as i64) << 32) + a as i64 * b as i64 + (1 << 31)) >> 32) as i32
}

/// The upper half of a 64-bit product, rounded towards minus infinity: one SMMUL.
#[inline(always)]
pub(crate) const fn high(a: i32, b: i32) -> i32 {
    ((a as i64 * b as i64) >> 32) as i32
}

/// `sum` plus the upper half of a product: one SMMLA.
#[inline(always)]
pub(crate) const fn add_high(sum: i32, a: i32, b: i32) -> i32 {
    sum.wrapping_add(high(a, b))
}

/// `sum` plus the products of the lower and of the upper halves of two words: one SMLAD.
#[inline(always)]
pub(crate) const fn add_halves(sum: i32, a: i32, b: i32) -> i32 {
    let (lower_a, lower_b) = ((a << 16) >> 16, (b << 16) >> 16);
    sum.wrapping_add(lower_a * lower_b).wrapping_add((a >> 16) * (b >> 16))
}

/// `sum` minus a product, upper half, rounded towards minus infinity: one SMMLS.
#[inline(always)]
pub(crate) const fn sub_high(sum: i32, a: i32, b: i32) -> i32 {
    // An odd product's lower half makes the difference one less than the difference of the upper halves.
    ((((sum as i64) << 32).wrapping_sub(a as i64 * b as i64)) >> 32) as i32
}

/// 60 fractional bits: four more than are needed, and the products still fit in an i128.
const FRACTION: u32 = 60;

#[expect(
    clippy::indexing_slicing,
    reason = "evaluated by the compiler: an index out of range does not build"
)]
const fn table() -> [[i32; 2]; BINS] {
    let mut table = [[0; 2]; BINS];
    let mut bin = 0;
    while bin < BINS {
        table[bin] = [sine_of_centre(bin), sine_of_centre(bin + BINS / 4)];
        bin += 1;
    }
    table
}

/// The sine of the centre of `bin`, folded into the first quarter.
const fn sine_of_centre(bin: usize) -> i32 {
    let (quarter, within) = ((bin / (BINS / 4)) % 4, bin % (BINS / 4));
    let folded = if quarter % 2 == 0 { within } else { BINS / 4 - 1 - within };
    let sine = sine_of_quarter(folded);
    if quarter < 2 { sine } else { -sine }
}

/// `sin((bin + 1/2) 2 pi / 1024)` by its Taylor series; the angle is below pi/2, so 15 terms reach 2^-60.
#[expect(clippy::cast_possible_truncation, reason = "a sine scaled by ONE is below 2^31")]
const fn sine_of_quarter(bin: usize) -> i32 {
    const PI: i128 = 0x3243_F6A8_885A_308D;
    let x = PI * (2 * bin as i128 + 1) / BINS as i128;
    let square = (x * x) >> FRACTION;
    let (mut term, mut sum, mut n) = (x, x, 1);
    while n < 30 {
        term = -((term * square) >> FRACTION) / ((n + 1) * (n + 2));
        sum += term;
        n += 2;
    }
    ((sum * ONE as i128 + (1 << (FRACTION - 1))) >> FRACTION) as i32
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::{ONE, sine_cosine};

    #[test]
    fn sine_and_cosine_stay_within_3_5e_9_of_the_truth_at_every_phase() {
        let mut worst = 0.0_f64;
        let mut check = |phase: u32| {
            let angle = f64::from(phase) * core::f64::consts::TAU / 4_294_967_296.0;
            let (s, c) = sine_cosine(phase);
            let (sine, cosine) = angle.sin_cos();
            worst = worst
                .max((f64::from(s) / f64::from(ONE) - sine).abs())
                .max((f64::from(c) / f64::from(ONE) - cosine).abs());
        };
        (0..3_000_000_u32).for_each(|n| check(n.wrapping_mul(0x9E37_79B9)));
        // The bins' edges, where the residual is largest, and the quarters, where a wrap would show.
        (0..512_u32)
            .for_each(|bin| (0..64).for_each(|n| check((bin << 23).wrapping_add(n).wrapping_sub(32))));
        assert!(worst < 3.5e-9, "worst error {worst:e}");
        assert!(worst > 2.0e-9, "the documented bound is not tight any more: {worst:e}");
    }
}
