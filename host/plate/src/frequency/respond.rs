//! The amplitude over x at one frequency or at many: the interface of the frequency-domain solver.

use super::equation::Equation;
use super::error::RespondError;
use super::finger::{self, Finger};
use super::numerov::{self, Grid};
use super::peak::{self, Peak};
use crate::definition::limits::FREQUENCY;
use crate::definition::plate::Plate;
use crate::quantity::{OutOfRange, Range};
use num_complex::Complex64;

/// Fewest points of a response.
pub const POINTS_MIN: usize = 8;
/// Most points of a response.
pub const POINTS_MAX: usize = 200_001;

/// Steady amplitude over the plate at one frequency.
///
/// ```
/// use slipline_plate::{Equation, preset, respond};
///
/// let response = respond(&preset("membrane").unwrap(), 150.0, 257, Equation::Corrected).unwrap();
/// assert_eq!(response.amplitude.len(), 257);
/// assert!(response.peak.unwrap().position_m < response.turning_point_m);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Positions, metres: uniform from 0 to the plate's length.
    pub position_m: Vec<f64>,
    /// Complex amplitude at each position relative to the drive; the displacement is Re(f e^(-j omega t)).
    pub amplitude: Vec<Complex64>,
    /// Turning point x0, metres; beyond the plate's end if the wave reaches it.
    pub turning_point_m: f64,
    /// Distance from the peak to a tenth of it in the Airy form, metres: 2.729/kappa.
    pub edge_width_m: f64,
    /// The turning-point peak; `None` if loss or a driven end too close to it leaves none.
    pub peak: Option<Peak>,
    /// |f| at the turning point, relative to the drive; 0 if that lies beyond the plate's end.
    pub amplitude_at_turning_point: f64,
}

/// Solves the amplitude equation at `frequency_hz` (see [`respond_range`]) on `points` (8 to 200 001) uniform points
/// from 0 to the plate's end.
///
/// The solver refines its own grid to an error of about 1e-9, as far as 400 000 points allow.
///
/// # Errors
/// [`RespondError::CannotEnter`] below the cut-off, [`RespondError::Frequency`] for other frequencies out of range,
/// [`RespondError::OutOfRange`] for `points`.
pub fn respond(
    plate: &Plate,
    frequency_hz: f64,
    points: usize,
    equation: Equation,
) -> Result<Response, RespondError> {
    respond_touched(plate, None, frequency_hz, points, equation)
}

/// As [`respond`], with a finger on the plate.
///
/// The finger's force changes the propagating wave and adds the evanescent field around it, computed on a straight
/// strip of the width at the finger. The peak is that of the touched plate: a resting finger may leave none.
///
/// # Errors
/// As [`respond`]; [`RespondError::OutOfRange`] for a field of the finger, [`RespondError::Unstated`] if the plate file
/// does not state the membrane's tension or the sheet's thickness.
pub fn respond_touched(
    plate: &Plate,
    finger: Option<&Finger>,
    frequency_hz: f64,
    points: usize,
    equation: Equation,
) -> Result<Response, RespondError> {
    let plate = &*equation.plate(plate);
    let refinement = checked_refinement(plate, finger, frequency_hz, points)?;
    let grid = Grid::new(plate, equation, points, refinement);
    Ok(Response::solved(&grid, plate, finger, frequency_hz, (points, refinement)))
}

/// The factor by which the grid of a response must be finer than its points.
fn checked_refinement(
    plate: &Plate,
    finger: Option<&Finger>,
    frequency_hz: f64,
    points: usize,
) -> Result<usize, RespondError> {
    check(plate, frequency_hz, points)?;
    if let Some(finger) = finger {
        finger.check(plate)?;
    }
    Ok(numerov::refinement(plate, frequency_hz, plate.length_m() / (points - 1) as f64))
}

/// Most grids that a [`Responder`] keeps: those of a plate differ by how fine they are.
const GRIDS_MAX: usize = 24;

/// Solves one plate at one frequency after the other, with the results of [`respond_touched`] with [`Equation::Corrected`], on
/// grids that it keeps: a grid depends on the plate and on how fine it must be, not on the frequency.
///
/// ```
/// use slipline_plate::{Equation, Responder, preset, respond};
///
/// let plate = preset("membrane").unwrap();
/// let mut responder = Responder::new(&plate, 257);
/// for hertz in [140.0, 150.0] {
///     assert_eq!(responder.respond(None, hertz), respond(&plate, hertz, 257, Equation::Corrected));
/// }
/// ```
#[derive(Debug, Clone)]
pub struct Responder {
    plate: Plate,
    points: usize,
    /// Each with its refinement, the latest last.
    grids: Vec<(usize, Grid)>,
}

impl Responder {
    /// A responder of this plate on `points` (8 to 200 001) uniform points from 0 to its end.
    #[must_use]
    pub fn new(plate: &Plate, points: usize) -> Self {
        Self { plate: plate.clone(), points, grids: Vec::new() }
    }

    /// The plate.
    #[must_use]
    pub fn plate(&self) -> &Plate {
        &self.plate
    }

    /// The response at `frequency_hz`, with a finger on the plate or without.
    ///
    /// # Errors
    /// As [`respond_touched`].
    pub fn respond(&mut self, finger: Option<&Finger>, frequency_hz: f64) -> Result<Response, RespondError> {
        let Self { plate, points, grids } = self;
        let refinement = checked_refinement(plate, finger, frequency_hz, *points)?;
        let known = grids.iter().position(|(fine, _)| *fine == refinement);
        let kept = match known {
            Some(known) => grids.remove(known),
            None => (refinement, Grid::new(plate, Equation::Corrected, *points, refinement)),
        };
        if grids.len() == GRIDS_MAX {
            grids.remove(0);
        }
        let response = Response::solved(&kept.1, plate, finger, frequency_hz, (*points, refinement));
        grids.push(kept);
        Ok(response)
    }
}

/// Solves the equation at many frequencies on a grid of `points` (8 to 200 001), without refinement.
///
/// Returns one row of `points` complex amplitudes per frequency. The error is of fourth order in the spacing of the
/// points: about 1e-7 for 30 wavelengths on 2000 points.
///
/// # Errors
/// The error of [`respond`] for the first frequency that has one.
pub fn respond_batch(
    plate: &Plate,
    frequencies_hz: &[f64],
    points: usize,
    equation: Equation,
) -> Result<Vec<Vec<Complex64>>, RespondError> {
    let plate = &*equation.plate(plate);
    for &frequency_hz in frequencies_hz {
        check(plate, frequency_hz, points)?;
    }
    let grid = Grid::new(plate, equation, points, 1);
    let mut rows = Vec::with_capacity(frequencies_hz.len());
    numerov::solve_each(&grid, plate, frequencies_hz, |_, field| rows.push(field.to_vec()));
    Ok(rows)
}

/// [`respond`] with [`Equation::Corrected`] at several frequencies, on one grid that is fine enough for all of them.
pub(crate) fn respond_each(
    plate: &Plate,
    frequencies_hz: &[f64],
    points: usize,
) -> Result<Vec<Response>, RespondError> {
    for &frequency_hz in frequencies_hz {
        check(plate, frequency_hz, points)?;
    }
    let step = plate.length_m() / (points - 1) as f64;
    let finest =
        frequencies_hz.iter().map(|&frequency_hz| numerov::refinement(plate, frequency_hz, step)).max();
    let refinement = finest.unwrap_or(1);
    let grid = Grid::new(plate, Equation::Corrected, points, refinement);
    let mut responses = Vec::with_capacity(frequencies_hz.len());
    numerov::solve_each(&grid, plate, frequencies_hz, |number, field| {
        responses.push(Response::of(plate, frequencies_hz[number], points, refinement, field));
    });
    Ok(responses)
}

/// The frequencies that [`respond`] accepts, Hz: from the cut-off at the wide end to four times the frequency that
/// turns at the plate's end. The upper limit bounds the number of wavelengths and so the work.
pub fn respond_range(plate: &Plate) -> Range {
    // At the cut-off itself no wave propagates.
    Range::new(
        plate.cut_off_hz() * (1.0 + 1e-9),
        plate.frequency_for_boundary_hz(plate.length_m()) * 4.0,
        "Hz",
    )
}

fn check(plate: &Plate, frequency_hz: f64, points: usize) -> Result<(), RespondError> {
    OutOfRange::check_count("points", points, POINTS_MIN..=POINTS_MAX)?;
    check_frequency(plate, frequency_hz)
}

/// Refuses a frequency outside [`respond_range`].
pub(crate) fn check_frequency(plate: &Plate, frequency_hz: f64) -> Result<(), RespondError> {
    let (cut_off_hz, high) = (plate.cut_off_hz(), respond_range(plate).high);
    let cannot_enter = || RespondError::cannot_enter(plate, frequency_hz);
    let low = FREQUENCY.low.min(cut_off_hz);
    if !(frequency_hz >= low && frequency_hz <= high) {
        return Err(if frequency_hz < low && frequency_hz > 0.0 {
            cannot_enter()
        } else {
            RespondError::frequency(frequency_hz, cut_off_hz, high)
        });
    }
    if plate.turning_point_m(frequency_hz).is_none() {
        return Err(cannot_enter());
    }
    Ok(())
}

impl Response {
    /// The response of a plate on its grid, `refinement` times as fine as `points` uniform points.
    fn solved(
        grid: &Grid,
        plate: &Plate,
        finger: Option<&Finger>,
        frequency_hz: f64,
        (points, refinement): (usize, usize),
    ) -> Self {
        let fine = match finger {
            None => numerov::solve(grid, plate, frequency_hz),
            Some(finger) => finger::touched(grid, plate, finger, frequency_hz),
        };
        Self::of(plate, frequency_hz, points, refinement, &fine)
    }

    /// Height of the turning-point peak, relative to the drive. Where there is none it follows from the amplitude at the
    /// turning point, which is 66.28 % of an Airy peak.
    #[must_use]
    pub fn height(&self) -> f64 {
        self.peak.map_or(self.amplitude_at_turning_point / 0.6628, |peak| peak.amplitude)
    }

    /// Describes a field on a grid `refinement` times as fine as `points` uniform points from 0 to the plate's end.
    pub(crate) fn of(
        plate: &Plate,
        frequency_hz: f64,
        points: usize,
        refinement: usize,
        fine: &[Complex64],
    ) -> Self {
        let step = plate.length_m() / ((points - 1) * refinement) as f64;
        let turning_point_m = plate.turning_point_m(frequency_hz).unwrap_or(0.0);
        let kappa = plate.kappa_per_m(frequency_hz).unwrap_or(f64::NAN);
        Self {
            frequency_hz,
            position_m: (0..points).map(|i| (i * refinement) as f64 * step).collect(),
            amplitude: fine.iter().copied().step_by(refinement).collect(),
            turning_point_m,
            edge_width_m: crate::special::airy::EDGE_WIDTH / kappa,
            peak: peak::find(fine, step, turning_point_m, kappa),
            amplitude_at_turning_point: peak::amplitude_at(fine, step, turning_point_m),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presets;

    #[test]
    fn a_responder_sets_up_one_grid_for_many_frequencies_and_answers_as_without_it() {
        for preset in presets() {
            let plate = preset.plate().expect("a preset");
            let (start_m, end_m) = plate.span_m();
            let hertz =
                |i: u32| plate.frequency_for_boundary_hz(start_m + (end_m - start_m) * f64::from(i) / 40.0);
            let mut responder = Responder::new(&plate, 401);
            let step_m = plate.length_m() / 400.0;
            let mut kinds: Vec<usize> =
                (0..=40).map(|i| numerov::refinement(&plate, hertz(i), step_m)).collect();
            kinds.sort_unstable();
            kinds.dedup();
            let before = numerov::work::done().grids;
            let answers: Vec<_> = (0..=40).map(|i| responder.respond(None, hertz(i))).collect();
            let grids = numerov::work::done().grids - before;
            assert!(kinds.len() <= GRIDS_MAX && grids == kinds.len(), "{}: {grids}", preset.name);
            for (i, answer) in (0..).zip(answers).step_by(8) {
                assert_eq!(answer, respond(&plate, hertz(i), 401, Equation::Corrected), "{}", preset.name);
            }
        }
    }
}
