//! Phases for a small peak of a sum of multiples of one base frequency.
//!
//! The peak is the limit of the norm `(mean |x|^p)^(1/p)` for large p. For each p of a rising list this norm is
//! minimised by Gauss and Newton's method in the phases, damped after Levenberg and Marquardt, starting from
//! Schroeder's phases: P. Guillaume, J. Schoukens, R. Pintelon and I. Kollar, "Crest-factor minimization using
//! nonlinear Chebyshev approximation methods", IEEE Trans. Instrum. Meas. 40, 982 (1991). Sixteen equal adjacent
//! tones reach a crest factor (peak over RMS) of 1.6. It rises with the range in octaves: 2.3 to 2.9 for sixteen
//! tones over one to four octaves.

use super::phases::low_crest_turns;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;

/// The powers p of the norms.
const POWERS: [i32; 7] = [4, 8, 16, 32, 64, 128, 256];
/// Largest number of steps for each power.
const STEPS: usize = 8;
/// A relative reduction of the norm below this ends the steps.
const WORTH_IT: f64 = 1e-4;
/// Least number of samples in the shortest period; the list represents the wave itself.
const SAMPLES_OF_HIGHEST: u32 = 8;

/// One period of tones, sampled.
struct Period<'a> {
    amplitudes: &'a [f64],
    /// Rows: samples. Columns: tones, with `sin(2 pi m n / N)` and the cosine.
    sines: DMatrix<f64>,
    cosines: DMatrix<f64>,
}

impl<'a> Period<'a> {
    fn of(harmonics: &[u32], amplitudes: &'a [f64], longest: u32) -> Self {
        // A common divisor of all multiples shortens the period.
        let common = harmonics.iter().copied().fold(0, gcd).max(1);
        let highest = harmonics.iter().copied().max().unwrap_or(1) / common;
        let samples = (SAMPLES_OF_HIGHEST * highest).next_power_of_two().min(longest.max(1));
        let table: Vec<(f64, f64)> =
            (0..samples).map(|n| (TAU * f64::from(n) / f64::from(samples)).sin_cos()).collect();
        let at = |n: usize, tone: usize| {
            table[(n as u64 * u64::from(harmonics[tone] / common) % u64::from(samples)) as usize]
        };
        let (rows, columns) = (samples as usize, harmonics.len());
        Self {
            amplitudes,
            sines: DMatrix::from_fn(rows, columns, |n, tone| at(n, tone).0),
            cosines: DMatrix::from_fn(rows, columns, |n, tone| at(n, tone).1),
        }
    }

    /// The wave with these phases in radians: `sum a sin(w n + phase)`.
    fn wave(&self, phases: &DVector<f64>) -> DVector<f64> {
        let part = |of: fn(f64) -> f64| {
            DVector::from_iterator(
                phases.len(),
                phases.iter().zip(self.amplitudes).map(|(&phase, a)| a * of(phase)),
            )
        };
        &self.sines * part(f64::cos) + &self.cosines * part(f64::sin)
    }

    /// The wave's derivatives with respect to each phase, each sample times its weight.
    fn slopes(&self, phases: &DVector<f64>, weights: &DVector<f64>) -> DMatrix<f64> {
        let mut slopes = DMatrix::zeros(self.sines.nrows(), phases.len());
        for (tone, mut column) in slopes.column_iter_mut().enumerate() {
            let (sine, cosine) = phases[tone].sin_cos();
            let (along, across) = (self.amplitudes[tone] * cosine, self.amplitudes[tone] * sine);
            let (cosines, sines) = (self.cosines.column(tone), self.sines.column(tone));
            let samples = cosines.iter().zip(sines.iter()).zip(weights);
            for (slope, ((c, s), weight)) in column.iter_mut().zip(samples) {
                *slope = (along * c - across * s) * weight;
            }
        }
        slopes
    }
}

/// The greatest common divisor; gcd(0, n) = n.
fn gcd(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// `(mean |x|^p)^(1/p)`, without overflow.
fn norm(wave: &DVector<f64>, power: i32) -> f64 {
    let peak = wave.amax();
    if peak == 0.0 {
        return 0.0;
    }
    let mean = wave.iter().map(|x| (x / peak).abs().powi(power)).sum::<f64>() / wave.len() as f64;
    peak * mean.powf(1.0 / f64::from(power))
}

/// Phases in turns, 0 to 1, for a small peak of tones with these multiples (rising, 1 or more) and amplitudes (0 or
/// more, as many); and that peak. `longest` is the period in samples, a power of two; the peak is that of the
/// samples.
pub(crate) fn low_peak_turns(harmonics: &[u32], amplitudes: &[f64], longest: u32) -> (Vec<f64>, f64) {
    let period = Period::of(harmonics, amplitudes, longest);
    let mut phases = DVector::from_vec(low_crest_turns(amplitudes)) * TAU;
    let mut best = (phases.clone(), period.wave(&phases).amax());
    for power in POWERS {
        descend(&period, power, &mut phases);
        let peak = period.wave(&phases).amax();
        if peak < best.1 {
            best = (phases.clone(), peak);
        }
    }
    let turns: Vec<f64> = best.0.iter().map(|phase| (phase / TAU).rem_euclid(1.0)).collect();
    let peak = peak(harmonics, amplitudes, &turns, longest);
    (turns, peak)
}

/// The largest sample over a period of `samples` samples.
fn peak(harmonics: &[u32], amplitudes: &[f64], turns: &[f64], samples: u32) -> f64 {
    let value = |n: u32| -> f64 {
        let tones = harmonics.iter().zip(amplitudes).zip(turns);
        tones
            .map(|((&m, a), turns)| {
                let part = u64::from(m) * u64::from(n) % u64::from(samples);
                a * (TAU * (part as f64 / f64::from(samples) + turns)).sin()
            })
            .sum()
    };
    (0..samples).map(|n| value(n).abs()).fold(0.0, f64::max)
}

/// Reduces the norm by damped steps.
fn descend(period: &Period<'_>, power: i32, phases: &mut DVector<f64>) {
    let mut wave = period.wave(phases);
    let mut now = norm(&wave, power);
    let mut damping = 1e-3;
    for _ in 0..STEPS {
        if now == 0.0 {
            return;
        }
        // The residual |x/s|^(p/2), whose sum of squares is proportional to the p-th power of the norm, and its
        // derivative.
        let half = power / 2;
        let residual = wave.map(|x| (x / now).abs().powi(half));
        let weights = wave.map(|x| f64::from(half) * (x / now).abs().powi(half - 1) * x.signum() / now);
        let slopes = period.slopes(phases, &weights);
        let (gradient, curvature) = (slopes.tr_mul(&residual), slopes.tr_mul(&slopes));
        let floor = 1e-12 * curvature.diagonal().amax();
        let mut better = None;
        while damping < 1e6 && better.is_none() {
            let mut damped = curvature.clone();
            for i in 0..damped.nrows() {
                damped[(i, i)] += damping * curvature[(i, i)] + floor;
            }
            let step = damped.lu().solve(&gradient).unwrap_or_else(|| DVector::zeros(phases.len()));
            let next = &*phases - step;
            let next_wave = period.wave(&next);
            let next_norm = norm(&next_wave, power);
            if next_norm < now {
                damping *= 0.2;
                better = Some((next, next_wave, next_norm));
            } else {
                damping *= 5.0;
            }
        }
        let Some((next, next_wave, next_norm)) = better else { return };
        let done = now - next_norm < WORTH_IT * now;
        (*phases, wave, now) = (next, next_wave, next_norm);
        if done {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LONGEST: u32 = 1 << 14;

    /// Peak over RMS of equal tones with the phases found.
    fn crest(harmonics: &[u32]) -> f64 {
        let amplitudes = vec![1.0; harmonics.len()];
        let (turns, peak) = low_peak_turns(harmonics, &amplitudes, LONGEST);
        assert!(turns.iter().all(|turns| (0.0..1.0).contains(turns)));
        peak / (0.5 * harmonics.len() as f64).sqrt()
    }

    fn spaced_by_octaves(from: f64, to: f64) -> Vec<u32> {
        (0..16).map(|i| (from * (to / from).powf(f64::from(i) / 15.0)).round() as u32).collect()
    }

    #[test]
    fn sixteen_tones_side_by_side_come_to_a_crest_factor_of_1_63() {
        for first in [1, 20, 300] {
            for apart in [1, 20] {
                let crest = crest(&(0..16).map(|i| first + apart * i).collect::<Vec<_>>());
                println!("{first} and every {apart}: {crest:.2}");
                assert!(crest < 1.63 * 1.05, "{first} {apart}: {crest}");
            }
        }
    }

    #[test]
    fn sixteen_tones_at_equal_intervals_of_pitch_come_to_2_5_to_2_9() {
        for (from, to) in [(100.0, 1000.0), (164.0, 1800.0), (20.0, 400.0), (60.0, 2000.0)] {
            let crest = crest(&spaced_by_octaves(from, to));
            println!("{from} to {to}: {crest:.2}");
            assert!(crest < 2.9 * 1.05, "{from} to {to}: {crest}");
        }
    }

    #[test]
    fn any_tones_have_a_smaller_peak_than_with_schroeders_phases() {
        let (turns, one) = low_peak_turns(&[7], &[0.3], LONGEST);
        assert!((one - 0.3).abs() < 1e-5 && turns.len() == 1);
        assert_eq!(low_peak_turns(&[], &[], LONGEST), (Vec::new(), 0.0));
        assert_eq!(low_peak_turns(&[3, 5], &[0.0, 0.0], LONGEST).1, 0.0);
        let (harmonics, amplitudes) = ([205, 206, 300, 614], [0.5, 0.02, 0.3, 0.1]);
        let (_, found) = low_peak_turns(&harmonics, &amplitudes, LONGEST);
        let schroeder = low_crest_turns(&amplitudes);
        assert!(found <= peak(&harmonics, &amplitudes, &schroeder, LONGEST));
    }
}
