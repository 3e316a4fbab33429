//! The shape of every amplitude ramp: a raised cosine, made by the compiler.

#![cfg_attr(not(test), deny(clippy::float_arithmetic))]

/// 1 in Q1.31.
pub(crate) const ONE: u32 = 1 << 31;
/// Intervals of the shape; linear between them, the error is below 4e-5 of full scale.
const INTERVALS: usize = 128;
/// The shape at the intervals' ends.
static SHAPE: [u32; INTERVALS + 1] = shape();

/// 60 fractional bits: the terms of a series lose nothing that 31 bits would show.
const FRACTION: u32 = 60;

#[expect(
    clippy::indexing_slicing,
    clippy::cast_possible_truncation,
    reason = "evaluated by the compiler: an index out of range does not build; a share is at most one"
)]
const fn shape() -> [u32; INTERVALS + 1] {
    let mut shape = [0; INTERVALS + 1];
    let mut i = 0;
    while i <= INTERVALS / 2 {
        // (1 - cos(pi u)) / 2 by Taylor's series, up to u = 1/2; then mirrored, so that both halves are alike.
        const PI: i128 = 0x3243_F6A8_885A_308D;
        let x = PI * i as i128 / INTERVALS as i128;
        let square = (x * x) >> FRACTION;
        let (mut term, mut cosine, mut n) = (1i128 << FRACTION, 0, 0);
        while n < 40 {
            cosine += term;
            term = -((term * square) >> FRACTION) / ((n + 1) * (n + 2));
            n += 2;
        }
        // A half, and from 60 bits to 31, rounded to nearest.
        let share = (((1 << FRACTION) - cosine + (1 << 29)) >> 30) as u32;
        shape[i] = share;
        shape[INTERVALS - i] = ONE - share;
        i += 1;
    }
    shape
}

/// How far a ramp has come when the share `u` of its time has passed: `s(u) = (1 - cos(pi u)) / 2`, both Q1.31; 0 at 0, 1 at 1,
/// rising between.
#[must_use]
#[expect(clippy::cast_possible_truncation, reason = "at most the difference of two 32-bit values")]
pub fn progress(u: u32) -> u32 {
    let u = u.min(ONE);
    // 128 intervals: the upper 7 bits below the leading one are the index, the lower 24 the fraction.
    let index = (u >> 24) as usize;
    let fraction = u64::from(u & 0x00ff_ffff);
    let Some(&a) = SHAPE.get(index) else { return ONE };
    let Some(&b) = SHAPE.get(index + 1) else { return a };
    a + ((u64::from(b.saturating_sub(a)) * fraction) >> 24) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shape_rises_from_zero_to_one_monotonically() {
        assert_eq!((progress(0), progress(ONE), progress(u32::MAX)), (0, ONE, ONE));
        let values: std::vec::Vec<u32> = (0..=4096).map(|i| progress(i << 19)).collect();
        assert!(values.windows(2).all(|w| w[0] <= w[1]));
    }

    #[test]
    fn the_shape_is_a_raised_cosine() {
        for i in 0..=1000u32 {
            let u = f64::from(i) / 1000.0;
            let want = (1.0 - (core::f64::consts::PI * u).cos()) / 2.0;
            let got = f64::from(progress((u * f64::from(ONE)) as u32)) / f64::from(ONE);
            assert!((got - want).abs() < 4e-5, "at {u}: {got} for {want}");
        }
    }
}
