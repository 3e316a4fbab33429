//! The field of a plate's width mode as the fit asks for it: by Numerov's method, with the actuator's resonance.

use crate::definition::actuator::Actuator;
use crate::definition::plate::Plate;
use crate::frequency::finger::{self, Finger};
use crate::frequency::numerov::{self, Grid};
use num_complex::Complex64;

/// Error of the field, well below that of the fit.
const ERROR: f64 = 1e-6;

/// Computes the field of width mode `mode` at `points` uniform positions from 0 to the plate's end, relative to the
/// actuator's input, for each of many frequencies up to `top_hz`. Between clamped edges the plate has the tangent of the
/// strip's law, see [`Grid::tangent`].
pub(crate) fn response(
    plate: &Plate,
    mode: u32,
    points: usize,
    top_hz: f64,
) -> impl FnMut(&[f64]) -> Vec<Vec<Complex64>> {
    let (grid, refinement) = grid(plate, mode, points, top_hz);
    move |frequencies_hz| {
        let mut rows = Vec::with_capacity(frequencies_hz.len());
        numerov::solve_each(&grid, plate, frequencies_hz, |number, field| {
            rows.push(row(plate, frequencies_hz[number], field, refinement));
        });
        rows
    }
}

/// As [`response`], of the first width mode with a finger on the plate.
pub(crate) fn touched_response(
    plate: &Plate,
    finger: &Finger,
    points: usize,
    top_hz: f64,
) -> impl FnMut(&[f64]) -> Vec<Vec<Complex64>> {
    let (grid, refinement) = grid(plate, 1, points, top_hz);
    move |frequencies_hz| {
        let touched = |hz: f64| row(plate, hz, &finger::touched(&grid, plate, finger, hz), refinement);
        frequencies_hz.iter().map(|&hz| touched(hz)).collect()
    }
}

/// A grid for frequencies up to `top_hz`, and how much finer than `points` it is.
fn grid(plate: &Plate, mode: u32, points: usize, top_hz: f64) -> (Grid, usize) {
    let step = plate.length_m() / (points - 1) as f64;
    let refinement = numerov::refinement_for(plate, top_hz, step, ERROR);
    (Grid::tangent(plate, mode, points, refinement), refinement)
}

/// The field at the positions, relative to the resonator's input; curves of the drive are left to its filter.
fn row(plate: &Plate, frequency_hz: f64, fine: &[Complex64], refinement: usize) -> Vec<Complex64> {
    let resonator = plate.spec().actuator.as_ref().and_then(Actuator::resonator);
    let actuator = resonator.map_or(Complex64::ONE, |it| it.response(frequency_hz));
    fine.iter().step_by(refinement).map(|value| value * actuator).collect()
}
