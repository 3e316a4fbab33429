//! Spectrum of the played codes, at the bins of a recorder's transform.
//!
//! The codes have the device's rate R, the recording the rate r; r/R is not a simple ratio, and is known to a
//! millionth only after the recorder's clock has been estimated. So the codes are not resampled; their
//! spectrum is computed at the frequencies of the recorder's bins, k r/N:
//!
//! ```text
//! X(k) = sum over n of c(n) e^(-j 2 pi k n q),  q = r/(N R)            k n = (k^2 + n^2 - (k - n)^2)/2
//!      = e^(-j pi q k^2) sum over n of { c(n) e^(-j pi q n^2) } e^(j pi q (k - n)^2)
//! ```
//! which is a convolution, computed by three transforms (L. Rabiner, R. Schafer, C. Rader, "The chirp
//! z-transform algorithm", 1969). Before that, the codes are reduced to a lower rate by cutting the spectrum
//! above it, where the sweep has no energy.

use super::super::deconvolution::{spectrum, values};
use rustfft::algorithm::Radix4;
use rustfft::num_complex::Complex;
use rustfft::{Fft as _, FftDirection};
use std::f64::consts::PI;

/// Lower rate over the highest wanted frequency, at least.
const RATE_OVER_HIGHEST: f64 = 2.6;

/// Codes of a sweep at a rate that suits their band.
pub(in super::super) struct Reference {
    values: Vec<f64>,
    rate_hz: f64,
}

impl Reference {
    /// From codes at a rate, for frequencies up to `highest_hz`.
    pub(in super::super) fn new(codes: &[f64], rate_hz: f64, highest_hz: f64) -> Option<Self> {
        // Zero padding of half the length, so that ringing from the cut does not wrap around to the codes.
        let count = (codes.len() + codes.len() / 2).next_power_of_two();
        let mut fewer = count;
        while fewer > 64 && fewer as f64 / count as f64 * rate_hz * 0.5 >= RATE_OVER_HIGHEST * highest_hz {
            fewer /= 2;
        }
        let mut bins = spectrum(codes, count)?;
        bins.truncate(fewer / 2 + 1);
        // Keeps the spectrum's scale with fewer values.
        let scale = (fewer as f64).recip();
        let values = values(&bins)?.into_iter().map(|value| value * scale).collect();
        Some(Self { values, rate_hz: rate_hz * fewer as f64 / count as f64 })
    }

    /// The sums over the codes at `count` frequencies, from 0 in steps of `step_hz`.
    pub(in super::super) fn spectrum(&self, step_hz: f64, count: usize) -> Vec<Complex<f64>> {
        let ratio = step_hz / self.rate_hz;
        // Whole turns are removed, so that the squares keep their precision.
        let turn = |n: usize| {
            let turns = 0.5 * ratio * (n as f64) * (n as f64);
            Complex::cis(2.0 * PI * turns.fract())
        };
        let longest = self.values.len().max(count);
        let turns: Vec<Complex<f64>> = (0..longest).map(turn).collect();
        let length = (self.values.len() + count).next_power_of_two();
        let mut weighed = vec![Complex::default(); length];
        for ((into, value), turn) in weighed.iter_mut().zip(&self.values).zip(&turns) {
            *into = turn.conj() * value;
        }
        let mut chirp = vec![Complex::default(); length];
        for (n, turn) in turns.iter().enumerate() {
            if n < count {
                chirp[n] = *turn;
            }
            if n > 0 && n < self.values.len() {
                chirp[length - n] = *turn;
            }
        }
        let both = convolved(weighed, chirp);
        both.into_iter().zip(&turns).take(count).map(|(sum, turn)| sum * turn.conj()).collect()
    }
}

/// Circular convolution of two lists of equal length, a power of two.
fn convolved(mut one: Vec<Complex<f64>>, mut other: Vec<Complex<f64>>) -> Vec<Complex<f64>> {
    let forward = Radix4::<f64>::new(one.len(), FftDirection::Forward);
    forward.process(&mut one);
    forward.process(&mut other);
    let scale = (one.len() as f64).recip();
    for (here, there) in one.iter_mut().zip(&other) {
        *here *= there * scale;
    }
    Radix4::<f64>::new(one.len(), FftDirection::Inverse).process(&mut one);
    one
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_plate::truth::Random;

    #[test]
    fn the_spectrum_is_the_sum_over_the_codes_at_any_frequency() {
        // A pulse of a few hundred hertz at 40 kHz, which is reduced to a lower rate, and noise, which is
        // not.
        let pulse = |n: usize| {
            let t = (n as f64 - 3000.0) / 40e3;
            (-(t / 0.012).powi(2)).exp() * (2.0 * PI * 300.0 * t).sin()
        };
        let mut random = Random::new(1);
        let pulse: Vec<f64> = (0..6000).map(pulse).collect();
        let noise: Vec<f64> = (0..900).map(|_| random.normal()).collect();
        for (codes, highest_hz, step_hz) in [(pulse, 500.0, 1.234_567), (noise, 12e3, 17.3)] {
            let reference = Reference::new(&codes, 40e3, highest_hz).unwrap();
            assert_eq!(reference.rate_hz < 40e3, highest_hz < 1e3);
            let found = reference.spectrum(step_hz, 400);
            let direct = |k: usize| -> Complex<f64> {
                let turns = k as f64 * step_hz / 40e3;
                let term =
                    |(n, code): (usize, &f64)| Complex::cis(-2.0 * PI * (turns * n as f64).fract()) * code;
                codes.iter().enumerate().map(term).sum()
            };
            let loudest = found.iter().map(|x| x.norm()).fold(0.0, f64::max);
            for (k, x) in found.iter().enumerate() {
                let error = (x - direct(k)).norm() / loudest;
                assert!(error < 1e-9, "{k}: {error}");
            }
        }
    }
}
