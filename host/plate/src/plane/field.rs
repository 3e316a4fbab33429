//! The field of a plate at one frequency.

use super::discrete::{Discrete, Resolution};
use super::error::PlaneError;
use super::outline::{self, Outline};
use super::section::Section;
use super::setup::Setup;
use super::system::{Mesh, amplitudes};
use crate::definition::plate::Plate;
use crate::frequency::respond::check_frequency;
use crate::frequency::{POINTS_MAX, POINTS_MIN, RespondError, Response};
use crate::quantity::OutOfRange;
use num_complex::Complex64;

/// Decay exponents from the turning point to the far end of the mesh, where the sheet is clamped: a wave that returns
/// from there has decayed by twice as many. The one-mode equation continues the taper beyond the plate's end, too.
const TAIL_EXPONENTS: f64 = 14.0;
/// Positions per element at which the peak is searched for.
const PLACES: f64 = 8.0;
/// Elements and polynomials for an error of the peak below 1e-4 (test
/// `the_field_does_not_depend_on_the_resolution_or_on_the_radius_of_a_corner`).
pub(super) const RESOLUTION: Resolution =
    Resolution { elements_per_wavelength: 12.0, extra_orders: 0, rounding: outline::ROUNDING, panels: 1.0 };

/// The complex deflection w(x, z) of a plate at one frequency, relative to the drive; the displacement is
/// Re(w e^(-j omega t)).
#[derive(Debug, Clone)]
pub struct Field {
    frequency_hz: f64,
    plate: Plate,
    lead_in_m: f64,
    rounding: f64,
    section: Section,
    mesh: Mesh,
    unknowns: Vec<Complex64>,
}

impl Field {
    /// Solves the plate at `frequency_hz` with this setup. The drive end of the plate's specification has an effect
    /// only if [`Setup::of`] has copied it; the actuator has none.
    ///
    /// # Errors
    /// [`PlaneError::Respond`] for a frequency that [`crate::respond()`] refuses, [`PlaneError::TooFine`] for a plate
    /// too many wavelengths wide or long for the largest system, and the error of a setup that is not valid.
    pub fn solve(plate: &Plate, frequency_hz: f64, setup: &Setup) -> Result<Self, PlaneError> {
        Self::solve_with(plate, frequency_hz, setup, RESOLUTION)
    }

    pub(super) fn solve_with(
        plate: &Plate,
        frequency_hz: f64,
        setup: &Setup,
        resolution: Resolution,
    ) -> Result<Self, PlaneError> {
        check_frequency(plate, frequency_hz)?;
        let outline = Outline::of(&plate.edges, setup.lead_in_m(), resolution.rounding);
        let end_m = far_end(plate, frequency_hz);
        let discrete = Discrete::new(plate, frequency_hz, setup, outline, end_m, resolution)?;
        let unknowns = discrete.solve()?;
        let Discrete { section, mesh, .. } = discrete;
        Ok(Self {
            frequency_hz,
            plate: plate.clone(),
            lead_in_m: setup.lead_in_m(),
            rounding: resolution.rounding,
            section,
            mesh,
            unknowns,
        })
    }

    /// The deflection at `x_m` from the driven end and `z_m` from the centre line, metres; zero beside the plate and
    /// beyond its end. Negative `x_m` is on the lead-in.
    #[must_use]
    pub fn at(&self, x_m: f64, z_m: f64) -> Complex64 {
        let width = Outline::of(&self.plate.edges, self.lead_in_m, self.rounding).at(x_m).value.exp();
        let is_on_sheet = (-self.lead_in_m..=self.plate.length_m()).contains(&x_m) && z_m.abs() <= width;
        if is_on_sheet { self.mapped(x_m, &self.section.values(z_m / width)) } else { Complex64::ZERO }
    }

    /// The deflection where the polynomials across the width have these values.
    fn mapped(&self, x: f64, values: &[f64]) -> Complex64 {
        if x > self.mesh.nodes[self.mesh.elements()] {
            // Beyond the mesh the tail is negligible.
            return Complex64::ZERO;
        }
        amplitudes(&self.section, &self.mesh, &self.unknowns, x)
            .iter()
            .zip(values)
            .map(|(amplitude, value)| amplitude * value)
            .sum()
    }

    /// The field on the centre line at `points` (8 to 200 001) uniform positions from 0 to the plate's end, and its
    /// peak, in the form of the one-mode [`crate::respond()`].
    ///
    /// The peak is searched for on a finer grid near the turning point of the one-mode theory.
    ///
    /// # Errors
    /// [`PlaneError::Respond`] if `points` is outside its range.
    pub fn centre_line(&self, points: usize) -> Result<Response, PlaneError> {
        OutOfRange::check_count("points", points, POINTS_MIN..=POINTS_MAX).map_err(RespondError::from)?;
        let step_m = self.plate.length_m() / (points - 1) as f64;
        let refinement = (PLACES * step_m / self.mesh.unit_m).ceil().max(1.0) as usize;
        let fine_m = step_m / refinement as f64;
        let centre = self.section.values(0.0);
        let fine: Vec<Complex64> = (0..=(points - 1) * refinement)
            .map(|place| self.mapped(place as f64 * fine_m, &centre))
            .collect();
        Ok(Response::of(&self.plate, self.frequency_hz, points, refinement, &fine))
    }
}

/// End of the mesh, metres: far enough beyond the turning point that no wave returns. Where necessary the taper is
/// continued beyond the plate's end.
pub(super) fn far_end(plate: &Plate, frequency_hz: f64) -> f64 {
    let mode = plate.width_mode(1);
    let turning_point_m = mode.turning_point_m(frequency_hz);
    let reach_m = plate.edges.reach_m() * (1.0 - 1e-6);
    let step = 0.02 / mode.fall(turning_point_m).cbrt();
    let (mut place, mut exponents) = (turning_point_m, 0.0);
    while exponents < TAIL_EXPONENTS && place + step < reach_m {
        place += step;
        exponents += (-mode.wavenumber_squared(place, frequency_hz)).max(0.0).sqrt() * step;
    }
    place
}
