//! The field at sampled frequencies, in the fit's own scale: s = (omega - centre)/half band.

use crate::order;
use num_complex::Complex64;

/// Sums over all positions that represent the field in the search for poles.
pub(super) const SUMS: usize = 4;

/// The field at one frequency.
pub(super) struct Sample {
    pub(super) s: f64,
    /// Field at the positions, relative to the drive.
    pub(super) field: Vec<Complex64>,
    /// Largest |field| over the weight at this frequency: the scale of relative errors.
    pub(super) top: f64,
    /// Weight of an error at this frequency, 1 or less.
    pub(super) weight: f64,
    /// Sums over all positions with different signs.
    pub(super) sum: [Complex64; SUMS],
}

/// Largest absolute value.
pub(super) fn largest<'a>(values: impl IntoIterator<Item = &'a Complex64>) -> f64 {
    values.into_iter().map(Complex64::norm_sqr).fold(0.0, f64::max).sqrt()
}

/// Samples in the order of frequency.
pub(super) struct Samples<R, W> {
    /// The field at each of many s.
    response: R,
    /// The weight of an error at s.
    weight: W,
    /// Random sign of each position in each sum, so that no mode cancels in all sums.
    sign: Vec<[f64; SUMS]>,
    sample: Vec<Sample>,
}

/// Least distance of two samples.
const CLOSEST: f64 = 1e-6;

impl<R: FnMut(&[f64]) -> Vec<Vec<Complex64>>, W: Fn(f64) -> f64> Samples<R, W> {
    pub(super) fn new(response: R, weight: W, places: usize) -> Self {
        // A linear congruential generator (Knuth's constants for MMIX): the same signs on every machine.
        let mut state = 1_u64;
        let mut next_sign = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            if state >> 63 == 0 { 1.0 } else { -1.0 }
        };
        let sign = (0..places).map(|_| std::array::from_fn(|_| next_sign())).collect();
        Self { response, weight, sign, sample: Vec::new() }
    }

    pub(super) fn all(&self) -> &[Sample] {
        &self.sample
    }

    /// Takes a sample at each `wanted` place without one. A field that is zero or not finite is left out.
    pub(super) fn take(&mut self, wanted: &[f64]) {
        let mut fresh: Vec<f64> = Vec::with_capacity(wanted.len());
        for &s in wanted {
            let mut taken = self.sample.iter().map(|it| it.s).chain(fresh.iter().copied());
            if !taken.any(|it| (it - s).abs() < CLOSEST) {
                fresh.push(s);
            }
        }
        for (&s, field) in fresh.iter().zip((self.response)(&fresh)) {
            let weight = (self.weight)(s);
            let top = largest(&field) / weight;
            let mut sum = [Complex64::ZERO; SUMS];
            for (value, signs) in field.iter().zip(&self.sign) {
                for (sum, sign) in sum.iter_mut().zip(signs) {
                    *sum += value * *sign;
                }
            }
            if field.len() == self.sign.len() && top > 0.0 && top.is_finite() && largest(&sum) > 0.0 {
                self.sample.push(Sample { s, field, top, weight, sum });
            }
        }
        order::sort_by(&mut self.sample, |a, b| a.s.total_cmp(&b.s));
    }
}
