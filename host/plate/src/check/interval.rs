//! The uncertainty of a plate after its calibration.
//!
//! The intervals of wave speed, widths and loss are correlated: each one alone would move the boundary much farther
//! than all of them together may. So the ends of the interval are plates with the widths, and how far their edges give, at
//! the ends of their intervals, and with the wave speed that puts the boundary at an end of its interval. A light that
//! depends on nothing else is monotone in each of these over so short a range, so a limit that holds at these corners
//! holds between them.

use crate::definition::limits;
use crate::definition::plate::Plate;
use crate::quantity::number_format::with_decimals;
use crate::quantity::show_length;
use std::f64::consts::TAU;

/// The interval of a calibrated plate at one boundary.
#[derive(Debug)]
pub(super) struct Interval {
    /// Half of the interval of the boundary, metres.
    pub(super) boundary_m: f64,
    /// Upper end of the interval of the loss over the fitted loss, and the fitted loss over the lower end.
    pub(super) loss: f64,
    /// The plates at the corners of the interval.
    pub(super) ends: Vec<End>,
    /// Whether all corners are valid plates.
    pub(super) is_whole: bool,
}

/// A plate at an end of the interval.
#[derive(Debug)]
pub(super) struct End {
    pub(super) plate: Plate,
    /// Turning point on this plate of the wave that turns at the boundary of the calibrated plate, metres.
    pub(super) boundary_m: f64,
}

impl Interval {
    /// The interval of `plate` at the boundary `boundary_m`, metres, where the wave of `frequency_hz` turns; `None` for
    /// an uncalibrated plate.
    pub(super) fn new(plate: &Plate, boundary_m: f64, frequency_hz: f64) -> Option<Self> {
        let calibration = plate.spec().calibration.as_ref()?;
        let half_m = plate.boundary_tolerance_m(boundary_m)?;
        let nearest_m = limits::span_start(plate.length_m()).low;
        let mut ends = Vec::new();
        let mut is_whole = true;
        let give_m = plate.spec().edge_give_tolerance_m.unwrap_or(0.0);
        for [side, width, taper, give] in corners(give_m > 0.0) {
            let scale = (width * calibration.half_width_tolerance).exp();
            let power = 1.0 + taper * calibration.taper_tolerance;
            let cut = plate.spec().taper.stretched(scale, power);
            let place_m = (boundary_m + side * half_m).max(nearest_m);
            let edges = plate.with_edges(cut, give * give_m).ok();
            match edges.and_then(|plate| turning_at(plate, place_m, frequency_hz)) {
                Some(plate) => ends.push(End { plate, boundary_m: place_m }),
                None => is_whole = false,
            }
        }
        let loss = 1.0 + plate.spec().loss_tolerance.unwrap_or(super::thresholds::LOSS_TOLERANCE);
        Some(Self { boundary_m: half_m, loss, ends, is_whole })
    }

    /// The uncertainty of the boundary, in words.
    pub(super) fn boundary(&self) -> String {
        boundary_words(self.boundary_m)
    }

    /// The uncertainty of boundary and loss, in words.
    pub(super) fn boundary_and_loss(&self) -> String {
        format!("{}, the loss to a factor of {}", self.boundary(), with_decimals(self.loss, 2))
    }
}

/// The uncertainty of a boundary with the half interval `half_m`, in words.
pub(super) fn boundary_words(half_m: f64) -> String {
    format!("the turning point is known to ±{}", show_length(half_m))
}

/// The signs of boundary, width, taper and how far the edges give at the corners; the last is 0 unless `edges_give`.
fn corners(edges_give: bool) -> impl Iterator<Item = [f64; 4]> {
    let sign = |bit: u32| if bit == 0 { -1.0 } else { 1.0 };
    let give = move |i: u32| if edges_give { sign(i >> 3) } else { 0.0 };
    (0..if edges_give { 16 } else { 8 })
        .map(move |i| [sign(i & 1), sign(i >> 1 & 1), sign(i >> 2 & 1), give(i)])
}

/// The plate with the wave speed at which a wave of `frequency_hz` turns at `place_m`.
fn turning_at(mut plate: Plate, place_m: f64, frequency_hz: f64) -> Option<Plate> {
    // The tension also changes the edge length of a film, so this is an iteration: six steps give the place to 0.1 um.
    let steps = if plate.spec().model.film().is_some() { FILM_STEPS } else { 1 };
    for _ in 0..steps {
        plate = retuned(&plate, place_m, frequency_hz)?;
    }
    Some(plate)
}

/// Iterations for the wave speed of a film.
const FILM_STEPS: usize = 6;

/// The plate with the wave speed at which a wave of `frequency_hz` turns at `place_m`, for its present turning width.
fn retuned(plate: &Plate, place_m: f64, frequency_hz: f64) -> Option<Plate> {
    let turning = plate.width_mode(1).number / plate.turning_at(place_m).0.exp();
    // Frequency in vacuum at which the plate has the wavenumber that it has with its air at this frequency.
    let vacuum = plate.free_wave().vacuum_of(TAU * frequency_hz, turning);
    let model = &plate.spec().model;
    let factor = match model.film_square() {
        None => model.wavenumber_squared(vacuum).sqrt() / turning,
        // T K^2 + D K^4 = omega^2 sigma, solved for the tension T.
        Some(square) => {
            let (own, turning) = (model.wavenumber_squared(vacuum), turning * turning);
            (own * (1.0 + square * own) / turning - square * turning).max(0.0).sqrt()
        }
    };
    plate.with_wave_speed(factor).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Calibration, Film, Model, PlateSpec, preset};

    #[test]
    fn a_film_at_the_ends_of_its_interval_turns_at_those_ends() {
        let film = Film { youngs_modulus_pa: 4.5e9, poisson_ratio: 0.38, thickness_m: 50e-6 };
        let calibration = Calibration {
            chi2_per_n: 1.0,
            half_width_tolerance: 3e-3,
            taper_tolerance: 4e-3,
            level_tolerance_db: None,
            source_tolerance: None,
            correction: None,
        };
        let spec = PlateSpec {
            model: Model::Membrane {
                wave_speed_m_per_s: 12.0,
                tension_n_per_m: Some(10.0),
                film: Some(film),
            },
            wave_speed_tolerance: 0.01,
            calibration: Some(calibration),
            ..preset("membrane").expect("a preset").spec().clone()
        };
        // Whose edges are known, and known to 0.05 mm: narrower by more the film would be too stiff for its half-width.
        let given = PlateSpec { edge_give_tolerance_m: Some(5e-5), ..spec.clone() };
        let plates = [(spec, 8, 0.0), (given, 16, 5e-5)]
            .map(|(spec, corners, give_m)| (Plate::new(spec).expect("a plate"), corners, give_m));
        for ((plate, corners, give_m), boundary_m) in plates.iter().flat_map(|it| [(it, 0.1), (it, 0.25)]) {
            let frequency_hz = plate.frequency_for_boundary_hz(boundary_m);
            let interval = Interval::new(plate, boundary_m, frequency_hz).expect("calibrated");
            assert!(interval.is_whole && interval.ends.len() == *corners && interval.boundary_m > 1e-3);
            for end in &interval.ends {
                let more_m = end.plate.half_width_m(0.1) - end.plate.cut_half_width_m(0.1);
                assert!((more_m.abs() - give_m).abs() < 1e-9, "{more_m}");
                let found = end.plate.turning_point_m(frequency_hz).expect("enters");
                assert!(
                    (found - end.boundary_m).abs() < 1e-6,
                    "{boundary_m}: {found} for {}",
                    end.boundary_m
                );
            }
        }
    }
}
