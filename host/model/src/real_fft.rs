//! The Fourier transform of a power of two real values.
//!
//! Of rustfft it uses the radix-4 algorithm: rustfft's planner contains algorithms for every length, which would be 50 kB of a page
//! that a browser loads before the first picture.

use rustfft::algorithm::Radix4;
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftDirection};
use std::f64::consts::TAU;

/// Forward and inverse transform of one length. Each packs pairs of values, z(k) = x(2k) + j x(2k+1), into a complex transform of
/// half the length: of its bins, E(k) = (Z(k) + conj Z(m-k))/2 is the transform of the even values and
/// O(k) = (Z(k) - conj Z(m-k))/(2j) that of the odd ones, and X(k) = E(k) + exp(-2 pi j k/n) O(k).
pub struct RealFft {
    forward: Radix4<f64>,
    inverse: Radix4<f64>,
    /// exp(-2 pi j k/n) for k from 0 to n/2.
    turns: Vec<Complex<f64>>,
}

impl RealFft {
    /// The transform of `count` values; `None` unless that is a power of two from 2 on.
    #[must_use]
    pub fn new(count: usize) -> Option<Self> {
        let half = count / 2;
        let turn = |k: usize| Complex::cis(-TAU * k as f64 / count as f64);
        (count.is_power_of_two() && half > 0).then(|| Self {
            forward: Radix4::new(half, FftDirection::Forward),
            inverse: Radix4::new(half, FftDirection::Inverse),
            turns: (0..=half).map(turn).collect(),
        })
    }

    /// The number of values.
    #[must_use]
    pub fn count(&self) -> usize {
        2 * (self.turns.len() - 1)
    }

    /// X(k), the sum of x(i) exp(-2 pi j i k/n), for k from 0 to n/2. Missing values are zeros; values beyond the n-th are
    /// ignored.
    #[must_use]
    pub fn spectrum(&self, values: &[f64]) -> Vec<Complex<f64>> {
        let half = self.count() / 2;
        let value = |i: usize| values.get(i).copied().unwrap_or(0.0);
        let mut bins: Vec<Complex<f64>> =
            (0..half).map(|k| Complex::new(value(2 * k), value(2 * k + 1))).collect();
        self.forward.process(&mut bins);
        let bin = |k: usize| {
            let (z, mirrored) = (bins[k % half], bins[(half - k) % half].conj());
            let (even, odd) = (0.5 * (z + mirrored), Complex::new(0.0, -0.5) * (z - mirrored));
            even + self.turns[k] * odd
        };
        (0..=half).map(bin).collect()
    }

    /// n x(i): the inverse of [`Self::spectrum`], not divided by the number of values. The first and the last bin of a real signal
    /// are real: their imaginary parts are ignored, and so are bins beyond the last. Missing bins are zeros.
    #[must_use]
    pub fn values(&self, bins: &[Complex<f64>]) -> Vec<f64> {
        let half = self.count() / 2;
        let bin = |k: usize| {
            let bin = bins.get(k).copied().unwrap_or_default();
            if k.is_multiple_of(half) { Complex::from(bin.re) } else { bin }
        };
        let packed = |k: usize| {
            let (x, mirrored) = (bin(k), bin(half - k).conj());
            (x + mirrored) + Complex::<f64>::i() * self.turns[k].conj() * (x - mirrored)
        };
        let mut pairs: Vec<Complex<f64>> = (0..half).map(packed).collect();
        self.inverse.process(&mut pairs);
        pairs.into_iter().flat_map(|pair| [pair.re, pair.im]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_plate::truth::Random;

    #[test]
    fn the_bins_are_the_sums_over_the_values_and_lead_back_to_them() {
        let mut random = Random::new(3);
        for count in [2_usize, 4, 8, 64, 256] {
            let fft = RealFft::new(count).unwrap();
            let values: Vec<f64> = (0..count).map(|_| random.normal()).collect();
            let bins = fft.spectrum(&values);
            assert_eq!((bins.len(), fft.count()), (count / 2 + 1, count));
            for (k, bin) in bins.iter().enumerate() {
                let turn = |i: usize| Complex::cis(-TAU * (i * k % count) as f64 / count as f64);
                let sum: Complex<f64> = values.iter().enumerate().map(|(i, value)| value * turn(i)).sum();
                assert!((bin - sum).norm() < 1e-12 * count as f64, "{count}, {k}: {bin} {sum}");
            }
            let back = fft.values(&bins);
            assert!(back.len() == count);
            for (back, value) in back.iter().zip(&values) {
                assert!(
                    (back / count as f64 - value).abs() < 1e-14 * count as f64,
                    "{count}: {back} {value}"
                );
            }
        }
    }

    #[test]
    fn other_lengths_have_no_transform_and_missing_values_are_zeros() {
        for count in [0, 1, 3, 6, 1000] {
            assert!(RealFft::new(count).is_none(), "{count}");
        }
        let fft = RealFft::new(8).unwrap();
        assert_eq!(fft.spectrum(&[1.0, 2.0]), fft.spectrum(&[1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 9.0]));
        assert_eq!(fft.values(&[]), [0.0; 8]);
    }
}
