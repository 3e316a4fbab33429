//! The reflection of the propagating wave at a driven end.

use super::discrete::{Discrete, Resolution};
use super::error::PlaneError;
use super::outline::Outline;
use super::setup::Setup;
use super::strip::{self, StripMode};
use super::system::amplitudes;
use crate::definition::plate::Plate;
use crate::frequency::RespondError;
use crate::frequency::respond::check_frequency;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Half-widths between each end of the strip and the part where the waves are fitted: the modes left out of the fit
/// decay at least as e^(-x/W), those of the drive's shape much faster.
const MARGIN_HALF_WIDTHS: f64 = 8.0;
/// Length of the part where the waves are fitted, in wavelengths.
const FITTED_WAVELENGTHS: f64 = 2.0;
/// Number of places where the waves are fitted.
const STATIONS: usize = 60;
const RESOLUTION: Resolution =
    Resolution { elements_per_wavelength: 20.0, extra_orders: 1, rounding: 0.0, panels: 1.0 };

/// The reflection r of the first width mode's propagating wave at the driven end, with the drive at rest: on a uniform
/// strip of the plate's half-width at x = 0 and without loss, a wave e^(-jkx) that arrives is returned as r e^(+jkx).
///
/// The strip is solved in two dimensions with a force at its far end, and the amplitudes of its own width modes are
/// fitted in its middle. A finger in the setup is ignored, and the air is the added mass of the plate's free wave.
///
/// # Errors
/// As [`super::Field::solve`].
pub fn reflection(plate: &Plate, frequency_hz: f64, setup: &Setup) -> Result<Complex64, PlaneError> {
    check_frequency(plate, frequency_hz)?;
    let cannot_enter = || PlaneError::from(RespondError::cannot_enter(plate, frequency_hz));
    let log_width = plate.edges.at(0.0).value;
    let width_mode = plate.width_mode(1);
    let wavenumber = width_mode.wavenumber_squared(0.0, frequency_hz).max(0.0).sqrt();
    // Close to the cut-off the wavelength is unbounded; a part of it also separates two waves.
    let unbounded = plate.spec().model.wavenumber_squared(TAU * frequency_hz).sqrt();
    let margin_m = MARGIN_HALF_WIDTHS * log_width.exp();
    let fitted_m = FITTED_WAVELENGTHS * TAU / wavenumber.max(0.05 * unbounded);
    let end_m = 2.0 * margin_m + fitted_m;
    let setup = Setup { finger: None, ..*setup };
    let outline = Outline::Uniform(log_width);
    let discrete = Discrete::new(plate, frequency_hz, &setup, outline, end_m, RESOLUTION)?;
    let mut system = discrete.equations(0.0, 0.0, discrete.level);
    system.push(discrete.mesh.elements(), Complex64::ONE);
    let unknowns = system.solve();

    let Discrete { section, mesh, level, .. } = &discrete;
    let modes: Vec<StripMode> =
        (0..section.orders).map_while(|number| strip::mode(section, log_width, *level, number)).collect();
    // Two waves of each mode: e^(jkx) from the start of the fitted part and e^(-jkx) from its end. Where k^2 < 0, both
    // decay with the root that has a positive imaginary part.
    let waves: Vec<Complex64> = modes.iter().map(|mode| Complex64::from(mode.square).sqrt()).collect();
    let mut normal = DMatrix::<Complex64>::zeros(2 * modes.len(), 2 * modes.len());
    let mut right = DVector::<Complex64>::zeros(2 * modes.len());
    for station in 0..STATIONS {
        let along = fitted_m * station as f64 / (STATIONS - 1) as f64;
        let found = amplitudes(section, mesh, &unknowns, margin_m + along);
        let columns: Vec<Vec<Complex64>> = modes
            .iter()
            .zip(&waves)
            .flat_map(|(mode, k)| {
                let phases = [Complex64::I * k * along, Complex64::I * k * (fitted_m - along)];
                phases.map(|phase| mode.shape.iter().map(|share| phase.exp() * share).collect())
            })
            .collect();
        for (row, left) in columns.iter().enumerate() {
            right[row] += section.product(left, &found);
            for (column, other) in columns.iter().enumerate() {
                normal[(row, column)] += section.product(left, other);
            }
        }
    }
    let (Some(k), Some(fit)) = (waves.first(), normal.lu().solve(&right)) else {
        return Err(cannot_enter());
    };
    // From the reference places of the two waves to x = 0.
    let to_drive = Complex64::I * k;
    let away = fit[0] * (-to_drive * margin_m).exp();
    let towards = fit[1] * (to_drive * (margin_m + fitted_m)).exp();
    Ok(away / towards)
}
