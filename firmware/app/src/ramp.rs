//! The shape of every amplitude ramp: a raised cosine, made once.

use micromath::F32Ext;

/// Q1.31.
const ONE: u32 = 1 << 31;
/// Intervals of the shape; linear between them, the error is below 2e-5 of full scale.
const INTERVALS: usize = 128;

/// How far a ramp has come as a function of how much of its time has passed: `s(u) = sin^2(pi u / 2)`.
///
/// The square of the sine is taken and not `(1 - cos) / 2` because micromath's sine is exact at 0 and at a quarter
/// turn and of one piece between: the shape has no step at either end and never turns back.
#[derive(Clone, Debug)]
pub struct RampShape([u32; INTERVALS + 1]);

impl RampShape {
    /// The shape.
    #[must_use]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the index is below 2^24 and the square lies in 0..=1; a cast of f32 saturates"
    )]
    pub fn new() -> Self {
        let mut shape = [0; INTERVALS + 1];
        for (i, value) in shape.iter_mut().enumerate() {
            // By the trait's name: a plain `.sin()` would be the standard library's wherever that is linked.
            let sine = F32Ext::sin(core::f32::consts::FRAC_PI_2 * i as f32 / INTERVALS as f32);
            // 2^31 in f32 is exact; the cast saturates.
            *value = ((sine * sine * ONE as f32) as u32).min(ONE);
        }
        let [first, .., last] = &mut shape;
        *first = 0;
        *last = ONE;
        Self(shape)
    }

    /// `s(u)`, both Q1.31; 0 at 0, 1 at 1, rising between.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, reason = "at most the difference of two 32-bit values")]
    pub fn at(&self, u: u32) -> u32 {
        let u = u.min(ONE);
        // 128 intervals: the upper 7 bits below the leading one are the index, the lower 24 the fraction.
        let index = (u >> 24) as usize;
        let fraction = u64::from(u & 0x00ff_ffff);
        let Some(&a) = self.0.get(index) else { return ONE };
        let Some(&b) = self.0.get(index + 1) else { return a };
        a + ((u64::from(b.saturating_sub(a)) * fraction) >> 24) as u32
    }
}

impl Default for RampShape {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shape_rises_from_nothing_to_all_and_never_turns_back() {
        let shape = RampShape::new();
        assert_eq!((shape.at(0), shape.at(ONE), shape.at(u32::MAX)), (0, ONE, ONE));
        let values: std::vec::Vec<u32> = (0..=4096).map(|i| shape.at(i << 19)).collect();
        assert!(values.windows(2).all(|w| w[0] <= w[1]));
    }

    #[test]
    fn the_shape_is_a_raised_cosine() {
        let shape = RampShape::new();
        for i in 0..=1000u32 {
            let u = f64::from(i) / 1000.0;
            let want = (1.0 - (core::f64::consts::PI * u).cos()) / 2.0;
            let got = f64::from(shape.at((u * f64::from(ONE)) as u32)) / f64::from(ONE);
            // micromath's sine is good to 1.1e-3, so its square to 2.2e-3.
            assert!((got - want).abs() < 2.5e-3, "at {u}: {got} for {want}");
        }
    }
}
