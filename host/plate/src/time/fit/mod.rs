//! A modal bank by a rational fit of the frequency-domain field, for any solver of that field.
//!
//! ```text
//! field at sampled frequencies --> AAA --> poles --> least squares --> residues at all positions
//!              ^                                          |
//!              +---- more samples: where the error is largest, at the poles
//! ```
//! field(x, omega) = c0 + c1 (omega - centre) + c2 (omega - centre)^2 + sum of r/(p - omega) over the whole band of
//! the drive's filter, where only c and r depend on x. The samples of a field are exact, and a field has many
//! positions: so a resonance is found from samples that are far apart compared with its width.

mod barycentric;
mod plate;
mod residues;
mod samples;

#[cfg(test)]
pub(super) use plate::response;
pub(super) use plate::{far_air_ends_hz, of_plate};

use super::band_plan::BandPlan;
use super::modal::ModalBank;
use crate::order;
use barycentric::Barycentric;
use nalgebra::DMatrix;
use num_complex::Complex64;
use residues::{LeastSquares, PartialFractions, QUASI_STATIC};
use samples::{Sample, Samples};
use std::f64::consts::TAU;

/// Accuracy of a fit. Errors are relative to the largest amplitude at the same frequency.
#[derive(Debug, Clone, Copy)]
struct Accuracy {
    /// Frequencies with full weight of the error, Hz, and its weight beyond them.
    counts_hz: (f64, f64),
    beyond: f64,
    /// Least decay of a resonance over its frequency: the plate has none that is sharper.
    decay: f64,
    /// Error of the sums of positions at which the search for poles ends.
    poles: f64,
    /// Error of the field at which the fit ends.
    field: f64,
    /// Largest number of fits that may miss that error.
    fits: usize,
    /// Largest error of a fit with fewer poles, over that of the best fit; 0: all poles are kept.
    spare: f64,
    /// Largest error of a usable fit.
    most: f64,
}

impl Accuracy {
    /// For a field that is a sum of decaying resonances. One or two fits are usual; a field that grows or has noise
    /// cannot be fitted.
    const EXACT: Self = Self {
        counts_hz: (0.0, f64::INFINITY),
        beyond: 1.0,
        decay: 0.0,
        poles: 2.5e-5,
        field: 5e-5,
        fits: 12,
        spare: 0.0,
        most: 5e-3,
    };

    /// For a field between clamped edges, from a lowest to a highest frequency. In the tail s of the strip's law is
    /// real at every frequency, which no sum of decaying resonances is. So the field is fitted where it is needed,
    /// and delayed.
    const fn of_strip(counts_hz: (f64, f64), decay: f64) -> Self {
        Self { counts_hz, beyond: 0.01, decay, poles: 2e-3, field: 2e-3, fits: 3, spare: 1.1, most: 3e-2 }
    }

    /// For a field whose frequencies beyond the band's are no sum of decaying resonances, as those near the end of a light
    /// membrane in a baffle: fitted where it is needed.
    const fn within(counts_hz: (f64, f64)) -> Self {
        Self {
            counts_hz,
            beyond: 0.01,
            fits: 3,
            spare: 1.1,
            poles: 1e-3,
            field: 1e-3,
            most: 3e-2,
            ..Self::EXACT
        }
    }

    /// Weight of the error at a frequency.
    fn weight(&self, frequency_hz: f64) -> f64 {
        let (low_hz, high_hz) = self.counts_hz;
        if (low_hz..=high_hz).contains(&frequency_hz) { 1.0 } else { self.beyond }
    }
}

/// Initial number of samples; every eighth is a support point.
const FIRST_SAMPLES: usize = 40;
/// Largest number of support points. A plate of 60 wavelengths, the longest allowed, has about 200 poles.
const SUPPORTS_MAX: usize = 320;
/// Poles farther than this from the middle of the band, in half bands, are represented by the quasi-static terms.
const REACH: f64 = 3.5;
/// Closest sample to a sharp resonance, in half bands: a smaller error of the pole's frequency has no visible effect,
/// and the field without loss is infinite at the pole.
const NEAREST: f64 = 1e-5;

/// A fitted bank.
pub(super) struct Fit {
    pub(super) bank: ModalBank,
    /// Delay of the fitted field against its drive, seconds.
    pub(super) delay_s: f64,
    /// Largest error at the samples, relative to the largest amplitude at the same frequency. It is large only for a
    /// field whose poles a fit cannot find, for example with noise.
    pub(super) error: f64,
    /// Largest usable error.
    pub(super) most: f64,
}

/// Fits the field that `response` computes for many frequencies (Hz), one value per place, relative to the drive,
/// over the band of the filter's `plan`.
///
/// `response` must be smooth: the same grid at all frequencies. Every pole of the bank decays.
fn bank(
    mut response: impl FnMut(&[f64]) -> Vec<Vec<Complex64>>,
    plan: &BandPlan,
    places: usize,
    accuracy: Accuracy,
) -> Fit {
    let (low_hz, high_hz) = plan.stop_hz();
    let scaled = |frequency_hz: f64| (frequency_hz - plan.centre_hz) / plan.half_band_hz;
    let hertz = |s: f64| plan.centre_hz + s * plan.half_band_hz;
    let stable = |poles: &[Complex64]| stable(poles, |s| accuracy.decay * hertz(s).abs() / plan.half_band_hz);
    let mut samples = Samples::new(
        |s: &[f64]| response(&s.iter().map(|s| hertz(*s)).collect::<Vec<f64>>()),
        |s| accuracy.weight(hertz(s)),
        places,
    );
    let fit = partial_fractions(&mut samples, places, scaled(low_hz), scaled(high_hz), accuracy, stable);
    unscaled(&fit, plan, accuracy.most)
}

/// [`bank`] for a field that is a sum of decaying resonances.
#[cfg(test)]
pub(super) fn exact(
    response: impl FnMut(&[f64]) -> Vec<Vec<Complex64>>,
    plan: &BandPlan,
    places: usize,
) -> Fit {
    bank(response, plan, places, Accuracy::EXACT)
}

/// The fit between `low` and `high`, in its own scale of frequency.
fn partial_fractions<R: FnMut(&[f64]) -> Vec<Vec<Complex64>>, W: Fn(f64) -> f64>(
    samples: &mut Samples<R, W>,
    places: usize,
    low: f64,
    high: f64,
    accuracy: Accuracy,
    stable: impl Fn(&[Complex64]) -> Vec<Complex64>,
) -> PartialFractions {
    let step = (high - low) / (FIRST_SAMPLES - 1) as f64;
    samples.take(&(0..FIRST_SAMPLES).map(|i| low + step * i as f64).collect::<Vec<f64>>());
    // Few supports: a rational function with more poles than the field has spurious ones at undetermined places.
    let mut support: Vec<f64> = samples.all().iter().skip(4).step_by(8).map(|sample| sample.s).collect();
    let mut is_checked = false;
    let mut best: Option<PartialFractions> = None;
    let mut fits = 0;
    loop {
        let is_support: Vec<bool> = samples.all().iter().map(|sample| support.contains(&sample.s)).collect();
        let rational = Barycentric::new(samples.all(), &is_support);
        let mut error: Vec<f64> = samples
            .all()
            .iter()
            .zip(is_support)
            .map(|(sample, is_support)| if is_support { 0.0 } else { rational.error(sample) })
            .collect();
        let is_full = support.len() >= SUPPORTS_MAX;
        if is_full || error.iter().all(|error| *error < accuracy.poles) {
            let pole = stable(&rational.poles());
            let known = samples.all().len();
            samples.take(&beside_resonances(&pole, low, high));
            let fit = fit_all(samples.all(), pole, places);
            if fit.worst() < accuracy.field {
                return fewest_poles(samples.all(), fit, accuracy.field);
            }
            error.clone_from(&fit.error);
            if best.as_ref().is_none_or(|best| fit.worst() < best.worst()) {
                best = Some(fit);
            }
            fits += 1;
            if let Some(best) = best.take_if(|_| is_full || fits == accuracy.fits) {
                let tolerance = accuracy.spare * best.worst();
                return fewest_poles(samples.all(), best, tolerance);
            }
            // First fit the weights to the new samples. Add poles only if that is not enough.
            if samples.all().len() > known && !is_checked {
                is_checked = true;
                continue;
            }
        }
        is_checked = false;
        let fresh = refine(samples.all(), &error, &mut support, accuracy.poles);
        if fresh.is_empty() {
            // All samples are support points or have no error: nothing can be added.
            return fit_all(samples.all(), stable(&rational.poles()), places);
        }
        samples.take(&fresh);
    }
}

/// The fit by all of these poles.
fn fit_all(samples: &[Sample], pole: Vec<Complex64>, places: usize) -> PartialFractions {
    let count = pole.len();
    LeastSquares::new(samples, pole, places).fit(count)
}

/// The poles near the band. A growing pole is replaced by its decaying mirror image; each decays at least by `decay`.
fn stable(poles: &[Complex64], decay: impl Fn(f64) -> f64) -> Vec<Complex64> {
    let near = poles.iter().filter(|p| p.norm() < REACH);
    near.map(|p| Complex64::new(p.re, -p.im.abs().max(decay(p.re)))).collect()
}

/// Places on both sides of each pole in the band.
fn beside_resonances(pole: &[Complex64], low: f64, high: f64) -> Vec<f64> {
    let sides = pole.iter().flat_map(|p| {
        let aside = NEAREST.max(-p.im);
        [p.re - aside, p.re + aside]
    });
    sides.filter(|s| *s > low && *s < high).collect()
}

/// Makes the worst samples support points and returns the places of new samples on both sides of each.
fn refine(samples: &[Sample], error: &[f64], support: &mut Vec<f64>, tolerance: f64) -> Vec<f64> {
    let mut order: Vec<usize> = (0..samples.len()).filter(|&i| !support.contains(&samples[i].s)).collect();
    order::sort_by(&mut order, |&a, &b| error[b].total_cmp(&error[a]));
    // Several at a time, because each round costs a decomposition; fewer near the end, for few poles.
    let is_far = order.first().is_some_and(|&i| error[i] > 300.0 * tolerance);
    let most = (support.len() / if is_far { 4 } else { 12 }).max(1);
    let mut chosen: Vec<usize> = Vec::new();
    for i in order {
        let is_apart = chosen.iter().all(|&other| i.abs_diff(other) > 2);
        if chosen.len() < most && is_apart && error[i] > tolerance {
            chosen.push(i);
        }
    }
    let mut fresh = Vec::new();
    for i in chosen {
        support.push(samples[i].s);
        let neighbours = [i.checked_sub(1), Some(i + 1)].into_iter().flatten().filter_map(|k| samples.get(k));
        fresh.extend(neighbours.map(|neighbour| 0.5 * (neighbour.s + samples[i].s)));
    }
    fresh
}

/// Removes the poles with the least effect, as many as the tolerance allows: each pole costs time in every step.
fn fewest_poles(samples: &[Sample], all: PartialFractions, tolerance: f64) -> PartialFractions {
    let effect = all.effect(samples);
    let mut order: Vec<usize> = (0..all.pole.len()).collect();
    order::sort_by(&mut order, |&a, &b| effect[b].total_cmp(&effect[a]));
    let pole = order.iter().map(|&i| all.pole[i]).collect();
    let squares = LeastSquares::new(samples, pole, all.term.ncols());
    let enough = squares.fewest(tolerance);
    if enough == all.pole.len() { all } else { squares.fit(enough) }
}

/// The bank of a fit, in rad/s.
fn unscaled(fit: &PartialFractions, plan: &BandPlan, most: f64) -> Fit {
    let half = TAU * plan.half_band_hz;
    let places = fit.term.ncols();
    let bank = ModalBank {
        pole: fit.pole.iter().map(|p| TAU * plan.centre_hz + p * half).collect(),
        shape: fit.term.rows_range(QUASI_STATIC..).transpose() * Complex64::from(half),
        quasi_static: DMatrix::from_fn(places, QUASI_STATIC, |place, k| {
            fit.term[(k, place)] / half.powi(k as i32)
        }),
    };
    Fit { bank, delay_s: 0.0, error: fit.worst(), most }
}

#[cfg(test)]
mod tests;
