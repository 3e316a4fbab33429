//! The field of a plate's first width mode for the fit: by Numerov's method, with the actuator's resonance.

use super::{Accuracy, Fit, bank};
use crate::definition::actuator::Actuator;
use crate::definition::plate::Plate;
use crate::frequency::equation::Equation;
use crate::frequency::finger::{self, Finger};
use crate::frequency::numerov::{self, Grid};
use crate::time::band_plan::BandPlan;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Error of the field, far below that of the fit.
const ERROR: f64 = 1e-6;

/// Delay of a clamped plate's field against its drive, in periods of the lowest frequency.
const DELAY_PERIODS: f64 = 4.0;
/// Least decay of a resonance of a clamped plate, over the decay rate by its material's or its actuator's loss.
const LEAST_DECAY: f64 = 0.4;

/// The end of the band in a baffle that can be fitted, over the frequency that turns at the plate's end.
const BEFORE_THE_END: f64 = 0.95;

/// Fits the field of `respond` with the actuator's resonance, and with a finger if there is one, over the band of the
/// filter's `plan`.
///
/// Between clamped edges the fit is approximate, from `exact_hz.0` to `exact_hz.1`, and delayed: see
/// [`Fit::delay_s`]. In a baffle it is so, without a delay, where the whole band of the filter has no exact fit:
/// `frequency/far_air.rs` computes the pressure at a distance by orders, which the resonances above the span do not bear.
pub(crate) fn of_plate(
    plate: &Plate,
    finger: Option<&Finger>,
    plan: &BandPlan,
    places: usize,
    exact_hz: (f64, f64),
) -> Fit {
    let top_hz = plan.stop_hz().1;
    let (accuracy, delay_s) = match plate.width_mode(1).strip {
        None => (Accuracy::EXACT, 0.0),
        Some(_) => (Accuracy::of_strip(exact_hz, least_decay(plate)), DELAY_PERIODS / exact_hz.0),
    };
    let fitted =
        |accuracy| bank(late(response(plate, finger, places, top_hz), delay_s), plan, places, accuracy);
    let fit = fitted(accuracy);
    let fit = match far_air_ends_hz(plate) {
        Some(end_hz) if fit.error > fit.most => {
            fitted(Accuracy::within((exact_hz.0, exact_hz.1.min(end_hz))))
        }
        _ => fit,
    };
    Fit { delay_s, ..fit }
}

/// The frequency up to which the pressure at a distance can be fitted, Hz, where there is one: of a membrane in a baffle. At the
/// frequency that turns at the plate's end it is singular (`frequency/far_air.rs` divides by Q of the last point), which no
/// resonance follows.
pub(crate) fn far_air_ends_hz(plate: &Plate) -> Option<f64> {
    let is_distant = plate.spec().air.is_some_and(|air| air.distant() != 0.0);
    let is_along = plate.width_mode(1).air(plate.band_hz().1).is_some();
    (is_distant && is_along).then(|| BEFORE_THE_END * plate.frequency_for_boundary_hz(plate.length_m()))
}

/// Least decay of a resonance of a clamped plate, over its frequency.
fn least_decay(plate: &Plate) -> f64 {
    let resonator = plate.spec().actuator.as_ref().and_then(Actuator::resonator);
    let of_actuator = resonator.map_or(f64::INFINITY, |it| 0.5 / it.quality);
    // K^2 is proportional to the frequency or to a power of it up to two.
    LEAST_DECAY * plate.wave_loss().min(of_actuator)
}

/// A field with the delay `delay_s`.
fn late(
    mut response: impl FnMut(&[f64]) -> Vec<Vec<Complex64>>,
    delay_s: f64,
) -> impl FnMut(&[f64]) -> Vec<Vec<Complex64>> {
    move |frequencies_hz| {
        let mut rows = response(frequencies_hz);
        for (row, hz) in rows.iter_mut().zip(frequencies_hz).filter(|_| delay_s > 0.0) {
            let turn = Complex64::cis(TAU * hz * delay_s);
            row.iter_mut().for_each(|value| *value *= turn);
        }
        rows
    }
}

/// Computes the field at `points` uniform positions from 0 to the plate's end, relative to the
/// actuator's input, for each of many frequencies up to `top_hz`; with a finger on the plate where there is one.
pub(crate) fn response(
    plate: &Plate,
    finger: Option<&Finger>,
    points: usize,
    top_hz: f64,
) -> impl FnMut(&[f64]) -> Vec<Vec<Complex64>> {
    let step = plate.length_m() / (points - 1) as f64;
    let refinement = numerov::refinement_for(plate, top_hz, step, ERROR);
    let grid = Grid::new(plate, Equation::Corrected, points, refinement);
    move |frequencies_hz| {
        let mut rows = Vec::with_capacity(frequencies_hz.len());
        finger::solve_each_touched(&grid, plate, finger, frequencies_hz, refinement, |number, field| {
            rows.push(row(plate, frequencies_hz[number], field));
        });
        rows
    }
}

/// The field at the positions, relative to the resonator's input; the drive's filter applies the curves.
fn row(plate: &Plate, frequency_hz: f64, field: &[Complex64]) -> Vec<Complex64> {
    let resonator = plate.spec().actuator.as_ref().and_then(Actuator::resonator);
    let actuator = resonator.map_or(Complex64::ONE, |it| it.response(frequency_hz));
    field.iter().map(|value| value * actuator).collect()
}
