//! Resonances that represent the curves of a plate's drive.

use super::fields;
use super::output::{Held, Output};
use crate::definition::plate::Plate;
use crate::time::DriveCurve;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Error at which the search for more resonances ends, relative to the curve at the same frequency.
const TOLERANCE: f64 = 1e-3;
/// Numbers of resonances, fewest first.
const COUNTS: [usize; 3] = [0, 24, 120];
/// Half width of a resonance over the distance to the next one: the ripple of a sum of equal resonances is then
/// 2 e^(-3 pi).
const HALF_WIDTH: f64 = 1.5;
/// Number of test frequencies, uniform in the logarithm: over the exact band, and over the whole band of the filter;
/// and largest number of corners of the curve in addition. They exceed the number of unknowns.
const TRIED: [usize; 3] = [400, 100, 300];

/// The smallest number of resonances that represents the curves of `plate` within 1e-3, otherwise the largest number;
/// none if its drive has no curve. Complex angular frequencies, rad/s. `decay` gives the factors per sample for such
/// frequencies.
///
/// They represent the minimum phase of the curve's gain. A calibration does not measure the phase and writes 0
/// degrees, and no sum of decaying resonances has that phase where the gain changes.
pub(super) fn resonances(
    plate: &Plate,
    exact_hz: (f64, f64),
    stop_hz: (f64, f64),
    sample_rate_hz: f64,
    decay: impl Fn(&[Complex64]) -> Vec<Complex64>,
) -> Vec<Complex64> {
    let Some(curve) = DriveCurve::of(plate) else { return Vec::new() };
    let corners: Vec<f64> = curve.corners_hz(exact_hz).collect();
    let every = corners.len().div_ceil(TRIED[2]).max(1);
    let spread = |(low_hz, high_hz): (f64, f64), count: usize| {
        (0..count).map(move |i| low_hz * (high_hz / low_hz).powf(i as f64 / (count - 1) as f64))
    };
    let mut tried: Vec<f64> = spread(exact_hz, TRIED[0]).chain(spread(stop_hz, TRIED[1])).collect();
    tried.extend(corners.into_iter().step_by(every));
    tried.sort_by(f64::total_cmp);
    let goals: Vec<(f64, Complex64)> =
        tried.into_iter().map(|hz| (hz, curve.least_phase_response(hz))).collect();

    let error = |pole: &[Complex64]| {
        let advance = decay(&fields::with_background(pole, stop_hz, sample_rate_hz));
        Output::fit(goals.clone(), exact_hz, Held::NOWHERE, &advance, sample_rate_hz).error()
    };
    let [fewer @ .., most] = COUNTS;
    let found = fewer.into_iter().map(|count| comb(count, exact_hz)).find(|pole| error(pole) < TOLERANCE);
    found.unwrap_or_else(|| comb(most, exact_hz))
}

/// Resonances at equal ratios of frequency between two frequencies, Hz.
fn comb(count: usize, (low_hz, high_hz): (f64, f64)) -> Vec<Complex64> {
    let ratio = (high_hz / low_hz).powf(1.0 / count.max(2).saturating_sub(1) as f64);
    let shape = Complex64::new(1.0, -HALF_WIDTH * (ratio - 1.0));
    (0..count).map(|i| TAU * low_hz * ratio.powi(i as i32) * shape).collect()
}
