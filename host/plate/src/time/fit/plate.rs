//! The field of a plate's width mode as the fit asks for it: by Numerov's method, with the actuator.

use crate::frequency::equation::Equation;
use crate::frequency::numerov::{self, Grid};
use crate::spec::plate::Plate;
use num_complex::Complex64;

/// Error of the field, well below that of the fit.
const ERROR: f64 = 1e-6;

/// Computes the field of width mode `mode` at `points` uniform positions from 0 to the plate's end, relative to the
/// actuator's input, for each of many frequencies up to `top_hz`.
pub(crate) fn response(
    plate: &Plate,
    mode: u32,
    points: usize,
    top_hz: f64,
) -> impl FnMut(&[f64]) -> Vec<Vec<Complex64>> {
    let step = plate.length_m() / (points - 1) as f64;
    let refinement = numerov::refinement_for(plate, top_hz, step, ERROR);
    let grid = Grid::new(plate, mode, Equation::Corrected, points, refinement);
    move |frequencies_hz| {
        let mut rows = Vec::with_capacity(frequencies_hz.len());
        numerov::solve_each(&grid, plate, frequencies_hz, |number, field| {
            let actuator = plate
                .spec()
                .actuator
                .as_ref()
                .map_or(Complex64::ONE, |it| it.response(frequencies_hz[number]));
            rows.push(field.iter().step_by(refinement).map(|value| value * actuator).collect());
        });
        rows
    }
}
