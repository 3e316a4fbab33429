//! The recorder's clock, from two recordings of one sweep.
//!
//! Plate, sensor and recorder change both sweeps alike. So the second recording is the first one, delayed by
//! d values more than with an exact clock, and d is where
//!
//! ```text
//! g(d) = Re sum over k of C(k) e^(j 2 pi k d/N),   C = W Y2 Y1*/(|Y1 Y2| + 10 P)
//! ```
//! is largest: searched to a value by a transform, then refined by Newton's method. P is the noise's power in
//! a bin: bins of noise have a small weight, and so does a hum of any loudness, as it occupies few bins. If
//! the phases deviate by s, d deviates by s (sum of w^2 k^2)^(1/2)/(sum of w k^2) N/(2 pi), w = |C|.

use super::super::deconvolution::values;
use rustfft::num_complex::Complex;
use std::f64::consts::TAU;

/// Ratio of a bin to the noise from which on it has nearly full weight.
const ABOVE: f64 = 10.0;
/// Number of places within two values of which Newton's method starts at the best.
const PLACES: u32 = 21;
/// Largest number of Newton steps; few are needed.
const STEPS: usize = 20;

/// Delay of the second recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Delay {
    /// In values.
    pub(super) values: f64,
    /// Its standard deviation, values.
    pub(super) deviation: f64,
    /// g over the sum of |C|: 1 for identical recordings, 0 for unrelated ones.
    pub(super) coherence: f64,
}

/// The delay of the second of two spectra, within this number of values. `weight` is W at a bin, `floor` P.
pub(super) fn delay(
    first: &[Complex<f64>],
    second: &[Complex<f64>],
    weight: impl Fn(usize) -> f64,
    floor: f64,
    within: usize,
) -> Option<Delay> {
    let cross = |(bin, (one, other)): (usize, (&Complex<f64>, &Complex<f64>))| {
        let (product, weight) = (other * one.conj(), weight(bin));
        let size = product.norm() + ABOVE * floor;
        if weight > 0.0 && size > 0.0 { product * (weight / size) } else { Complex::default() }
    };
    let cross: Vec<Complex<f64>> = first.iter().zip(second).enumerate().map(cross).collect();
    let count = 2 * (cross.len() - 1);
    let terms: Vec<(f64, Complex<f64>)> = cross
        .iter()
        .enumerate()
        .filter(|(_, c)| c.norm_sqr() > 0.0)
        .map(|(bin, c)| (TAU * bin as f64 / count as f64, *c))
        .collect();
    let correlation = values(&cross)?;
    let at = |delay: isize| correlation[delay.rem_euclid(count as isize) as usize];
    let within = within.min(count / 2 - 1) as isize;
    let whole = (-within..=within).max_by(|&a, &b| at(a).total_cmp(&at(b)))?;
    let turned = |delay: f64| terms.iter().map(move |(turn, c)| (*turn, c * Complex::cis(turn * delay)));
    let g = |delay: &f64| turned(*delay).map(|(_, c)| c.re).sum::<f64>();
    let near = (0..PLACES).map(|place| whole as f64 - 1.0 + 2.0 * f64::from(place) / f64::from(PLACES - 1));
    let mut delay = near.max_by(|a, b| g(a).total_cmp(&g(b)))?;
    for _ in 0..STEPS {
        let (slope, bend) = turned(delay)
            .fold((0.0, 0.0), |(slope, bend), (turn, c)| (slope - turn * c.im, bend - turn * turn * c.re));
        if bend >= 0.0 {
            break;
        }
        let step = (slope / bend).clamp(-0.1, 0.1);
        delay -= step;
        if step.abs() < 1e-12 {
            break;
        }
    }
    let mut sums = [0.0; 5];
    for (turn, c) in turned(delay) {
        let (weight, phase) = (c.norm(), c.arg());
        let parts = [weight, c.re, weight * phase * phase, weight * turn * turn, (weight * turn).powi(2)];
        sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part);
    }
    let [weights, aligned, phases, bend, spread] = sums;
    let deviation = (phases / weights).sqrt() * spread.sqrt() / bend;
    (weights > 0.0).then_some(Delay { values: delay, deviation, coherence: aligned / weights })
}

#[cfg(test)]
mod tests {
    use super::super::super::deconvolution::spectrum;
    use super::*;
    use slipline_plate::truth::Random;

    const COUNT: usize = 4096;

    /// Two recordings of the same pulse by its formula; the second has half the level and this delay in
    /// values.
    fn two(delay: f64, noise: f64, hum: f64, seed: u64) -> [Vec<Complex<f64>>; 2] {
        let mut random = Random::new(seed);
        [(1.0, 0.0), (0.5, delay)].map(|(level, later)| {
            let value = |n: usize| {
                let t = n as f64 - 1500.0 - later;
                let pulse = level * (0.35 * t).sin() * (-(t / 8.0).powi(2)).exp();
                pulse + hum * (0.37 * n as f64 + 900.0 * level).sin()
            };
            let fade = |n: usize| {
                let end = n.min(COUNT - 1 - n) as f64 / 300.0;
                if end < 1.0 { 0.5 - 0.5 * (0.5 * TAU * end).cos() } else { 1.0 }
            };
            let values: Vec<f64> =
                (0..COUNT).map(|n| fade(n) * (value(n) + noise * random.normal())).collect();
            spectrum(&values, COUNT).unwrap()
        })
    }

    fn found(delay: f64, noise: f64, hum: f64, seed: u64) -> Delay {
        let [first, second] = two(delay, noise, hum, seed);
        let band = |bin: usize| if (130..330).contains(&bin) { 1.0 } else { 0.0 };
        super::delay(&first, &second, band, COUNT as f64 * noise * noise, 300).unwrap()
    }

    #[test]
    fn a_delay_is_found_to_1e_5_of_a_value_or_to_its_stated_error_with_noise() {
        for delay in [0.0, 0.5, -0.499, 17.321, -211.77] {
            let found = found(delay, 1e-9, 0.0, 1);
            assert!((found.values - delay).abs() < 1e-5, "{delay}: {found:?}");
            assert!(found.coherence > 0.999);
        }
        let (mut square, mut worst) = (0.0, 0.0_f64);
        for seed in 0..40 {
            let found = found(3.3, 3e-3, 0.0, seed);
            square += ((found.values - 3.3) / found.deviation).powi(2) / 40.0;
            worst = worst.max((found.values - 3.3).abs());
        }
        assert!((0.5..2.0).contains(&square.sqrt()) && worst < 0.05, "{} {worst}", square.sqrt());
    }

    #[test]
    fn a_hum_moves_a_delay_by_less_than_a_tenth_of_a_value() {
        let found = found(5.25, 1e-3, 0.05, 3);
        assert!((found.values - 5.25).abs() < 0.1, "{found:?}");
    }

    #[test]
    fn bins_of_noise_alone_count_for_little() {
        let [first, second] = two(3.3, 3e-3, 0.0, 8);
        // The pulse occupies a third of the band.
        let band = |bin: usize| if bin > 600 || (130..330).contains(&bin) { 1.0 } else { 0.0 };
        let found = super::delay(&first, &second, band, COUNT as f64 * 9e-6, 300).unwrap();
        assert!(found.coherence > 0.5 && (found.values - 3.3).abs() < 0.05, "{found:?}");
    }

    #[test]
    fn two_recordings_of_noise_have_nothing_in_common() {
        let [first, _] = two(0.0, 1.0, 0.0, 5);
        let [_, second] = two(0.0, 1.0, 0.0, 6);
        let band = |bin: usize| if bin > 400 { 1.0 } else { 0.0 };
        let found = super::delay(&first, &second, band, 1e-9, 300).unwrap();
        assert!(found.coherence < 0.3, "{found:?}");
    }
}
