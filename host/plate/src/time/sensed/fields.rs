//! The field of the plate at the frequencies of the outputs' fit.

use crate::calibrate::{SensorKind, seen};
use crate::definition::plate::Plate;
use crate::frequency::equation::Equation;
use crate::frequency::finger::{self, Finger};
use crate::frequency::numerov::{self, Grid};
use crate::order;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Radians of the shortest wave per station: the error of the polynomial through six stations is then 1e-6 of the
/// wave.
const RADIANS_PER_STATION: f64 = 0.15;
/// Error of the field.
const ERROR: f64 = 1e-7;
/// Smallest and largest number of stations.
const STATIONS: (usize, usize) = (65, 8193);
/// Numbers of frequencies over the band, uniform and uniform in the logarithm.
const SPREAD: (usize, usize) = (240, 120);
/// Frequencies near each resonance, as offsets in its half widths.
const BESIDE: [f64; 7] = [-4.0, -1.7, -0.7, 0.0, 0.7, 1.7, 4.0];
/// Number of frequencies above the band, and their highest over the end of the band.
const ROUGHLY: (usize, f64) = (48, 4.0);
/// Least half width of a resonance for these offsets, over its frequency: for a resonance without loss.
const NEAREST: f64 = 1e-5;
/// Broad poles per octave for slow variations: distant resonances, the hold, a delay, a coil.
const BACKGROUND_PER_OCTAVE: f64 = 1.5;

/// The poles of the plate, plus broad ones from well below the band to above it, all with a positive frequency;
/// rad/s.
pub(super) fn with_background(
    fitted: &[Complex64],
    (low_hz, high_hz): (f64, f64),
    sample_rate_hz: f64,
) -> Vec<Complex64> {
    // A resonator of a real signal responds at both signs of the frequency.
    let mut pole: Vec<Complex64> = fitted.iter().map(|p| Complex64::new(p.re.abs(), p.im)).collect();
    // The broadest poles of the fit are its own background and are left out.
    let top_hz = (16.0 * high_hz).min(0.45 * sample_rate_hz);
    pole.retain(|p| p.norm() < TAU * top_hz);
    let octaves = (top_hz / low_hz).log2();
    let count = (octaves * BACKGROUND_PER_OCTAVE).ceil() as usize + 1;
    pole.extend((0..count).map(|i| {
        let hertz = low_hz * (octaves * i as f64 / (count - 1).max(1) as f64).exp2();
        TAU * hertz * Complex64::new(0.6, -0.8)
    }));
    pole
}

/// Fields over the plate at many frequencies.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(super) struct Fields {
    /// Frequencies, Hz, and fields relative to the drive.
    #[serde(with = "crate::exchange::by_bytes")]
    rows: Vec<(f64, Vec<Complex64>)>,
    step_m: f64,
    exact_hz: (f64, f64),
}

impl Fields {
    /// Solves the plate from `stop_hz.0` to `stop_hz.1`, with more frequencies near the resonances `pole` (rad/s).
    pub(super) fn new(
        plate: &Plate,
        finger: Option<&Finger>,
        pole: &[Complex64],
        exact_hz: (f64, f64),
        stop_hz: (f64, f64),
        sample_rate_hz: f64,
    ) -> Self {
        let shortest = plate.width_mode(1).axial_squared(stop_hz.1).sqrt();
        let stations = (plate.length_m() * shortest / RADIANS_PER_STATION).ceil() as usize + 1;
        let stations = stations.clamp(STATIONS.0, STATIONS.1);
        let step_m = plate.length_m() / (stations - 1) as f64;
        let refinement = numerov::refinement_for(plate, stop_hz.1, step_m, ERROR);
        let grid = Grid::new(plate, Equation::Corrected, stations, refinement);
        let mut frequency_hz = frequencies(pole, stop_hz);
        // Above the band the plate is only sampled coarsely, so that an output need not fall off steeply.
        let octaves = (ROUGHLY.1.min(0.45 * sample_rate_hz / stop_hz.1)).log2().max(0.0);
        let above = |i: usize| stop_hz.1 * (octaves * i as f64 / ROUGHLY.0 as f64).exp2();
        frequency_hz.extend((1..=ROUGHLY.0).map(above));
        let mut rows: Vec<(f64, Vec<Complex64>)> = Vec::with_capacity(frequency_hz.len());
        finger::solve_each_touched(&grid, plate, finger, &frequency_hz, refinement, |number, field| {
            rows.push((frequency_hz[number], field.to_vec()));
        });
        // Far below the band a finger's field is not finite.
        rows.retain(|(_, field)| field.iter().all(|it| it.is_finite()));
        order::sort_by(&mut rows, |a, b| a.0.total_cmp(&b.0));
        Self { rows, step_m, exact_hz }
    }

    pub(super) const fn exact_hz(&self) -> (f64, f64) {
        self.exact_hz
    }

    /// The frequencies in rising order, Hz, and the fields at the stations, relative to the drive.
    pub(super) fn each(&self) -> impl Iterator<Item = (f64, &[Complex64])> {
        self.rows.iter().map(|(hz, field)| (*hz, field.as_slice()))
    }

    /// The field at a place, or its curvature for strain.
    pub(super) fn seen(&self, field: &[Complex64], place_m: f64, sensor: SensorKind) -> Complex64 {
        seen(field, self.step_m, place_m, sensor)
    }
}

/// Frequencies in rising order, Hz.
fn frequencies(pole: &[Complex64], (low_hz, high_hz): (f64, f64)) -> Vec<f64> {
    let share = |i: usize, count: usize| i as f64 / (count - 1) as f64;
    let uniform = (0..SPREAD.0).map(|i| low_hz + (high_hz - low_hz) * share(i, SPREAD.0));
    let octaves = (0..SPREAD.1).map(|i| low_hz * (high_hz / low_hz).powf(share(i, SPREAD.1)));
    let beside = pole.iter().flat_map(|p| {
        let half_width = (-p.im).max(NEAREST * p.re);
        BESIDE.map(|aside| (p.re + aside * half_width) / TAU)
    });
    let inside = |hz: &f64| *hz >= low_hz && *hz <= high_hz;
    let mut all: Vec<f64> = uniform.chain(octaves).chain(beside.filter(inside)).collect();
    all.sort_by(f64::total_cmp);
    all.dedup_by(|a, b| (*a - *b).abs() < 1e-7 * *b);
    all
}
