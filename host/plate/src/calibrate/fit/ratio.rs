//! The ratio of two places: speed, loss, taper and width of the plate from |H_b|/|H_a|, without a model of the source.
//!
//! At each frequency the source has one unknown amplitude s, and the sensors show s p_a and s p_b of the wave's magnitude
//! p. Its best value leaves
//!
//! ```text
//! min over s of (|H_a| - s p_a)^2/v_a + (|H_b| - s p_b)^2/v_b = (|H_a| p_b - |H_b| p_a)^2/(v_a p_b^2 + v_b p_a^2)
//! ```
//!
//! with the variances v: the residual of the ratio, which stays finite where one of the two places is a node.

use super::gain::Carried;
use super::least_squares::{self, Fit, Problem, minima, slope};
use super::pairs::{MODEL_ERROR, Pair, pairs};
use super::response::wave::{COARSE, FINE, Wave, points};
use super::unknowns::{OF_PLATE, Priors, STEPS, spec_at};
use crate::calibrate::measurement::sensor::{Measurement, SensorKind};
use crate::definition::{Plate, PlateSpec};
use crate::frequency::respond_range;
use std::f64::consts::TAU;

/// The same as [`MODEL_ERROR`] while the minimum is looked for: it widens the valleys, so that fewer places must be tried.
const SCAN_ERROR: f64 = 0.2;
/// Wave speeds that are tried, as the logarithm over the file's: a quarter less to a third more.
const SPEEDS: (f64, f64) = (-0.29, 0.29);
/// Radians that the phase at the farther sensor may change from one speed to the next.
const SCAN_RADIANS: f64 = 0.25;
/// Loss factors over the file's that are tried.
const LOSSES: [f64; 3] = [0.5, 1.0, 2.2];
/// Most frequencies of the scan.
const SCAN_FREQUENCIES: usize = 60;
/// Valleys of the scan that are followed to their bottom.
const VALLEYS: usize = 3;
/// A bottom with no more chi^2 per answer is that of the plate: the other valleys need not be followed.
const ENOUGH: f64 = 1.5;
/// When a fit ends, as a share of the standard deviations: among the valleys, and at last.
const STILL: (f64, f64) = (1e-2, 1e-5);
/// Way over which the derivative by a sensor's place is taken, metres.
const PLACE_STEP_M: f64 = 1e-7;

/// The fit of the ratio of two measurements of one plate.
pub(crate) struct Ratio<'a> {
    nominal: &'a PlateSpec,
    sensor: SensorKind,
    pub(crate) places_m: [f64; 2],
    /// Standard deviations of all coordinates: the plate's, then the places'.
    pub(crate) deviations: Vec<f64>,
    pub(crate) pairs: Vec<Pair>,
    frequencies_hz: Vec<f64>,
}

impl<'a> Ratio<'a> {
    pub(crate) fn new(plate: &'a Plate, sensors: [&Measurement; 2], priors: &Priors) -> Self {
        let pairs = pairs(sensors, respond_range(plate));
        let places = sensors.map(|sensor| sensor.place_tolerance_m.max(PLACE_STEP_M));
        Self {
            nominal: plate.spec(),
            sensor: sensors[0].sensor,
            places_m: sensors.map(|sensor| sensor.place_m),
            deviations: priors.deviations().into_iter().chain(places).collect(),
            frequencies_hz: pairs.iter().map(|pair| pair.frequency_hz).collect(),
            pairs,
        }
    }

    /// The same with the two places swapped.
    pub(crate) fn swapped(&self) -> Self {
        let [a, b] = self.places_m;
        let mut deviations = self.deviations.clone();
        deviations.swap(OF_PLATE, OF_PLATE + 1);
        let (pairs, frequencies_hz) = (self.pairs.clone(), self.frequencies_hz.clone());
        Self { places_m: [b, a], deviations, pairs, frequencies_hz, ..*self }
    }

    /// The best coordinates: the lowest valleys of a scan over wave speed and loss, each followed to its bottom.
    pub(crate) fn fit(&self) -> Option<Fit> {
        let coarse = OnGrid { ratio: self, radians: COARSE };
        let mut best: Option<Fit> = None;
        for [speed, loss] in self.valleys() {
            let mut start = vec![0.0; self.deviations.len()];
            start[..2].copy_from_slice(&[speed, loss]);
            let bottom = least_squares::fit(&coarse, &start, STILL.0);
            best = bottom.into_iter().chain(best).min_by(|a, b| a.chi2.total_cmp(&b.chi2));
            if best.as_ref().is_some_and(|best| best.chi2 <= ENOUGH * self.pairs.len() as f64) {
                break;
            }
        }
        let best = best?;
        least_squares::fit(&OnGrid { ratio: self, radians: FINE }, &best.parameters, STILL.1)
    }

    /// Magnitudes at the two sensors, moved by these ways, and the peak, at each frequency.
    pub(crate) fn with_peak(&self, coordinates: &[f64]) -> Option<Vec<(Vec<f64>, f64)>> {
        let wave = self.wave(coordinates, FINE)?;
        Some(wave.with_peak(self.sensor, &self.places_at(coordinates)?, &self.frequencies_hz))
    }

    /// The measured gains, carried to the peak by the wave of [`Ratio::with_peak`].
    pub(crate) fn carried(&self, peaks: &[(Vec<f64>, f64)]) -> impl Iterator<Item = Carried> {
        self.pairs.iter().zip(peaks).map(|(pair, (p, peak))| {
            let (source, variance) = pair.source(p);
            let error = variance.sqrt() / source;
            Carried { frequency_hz: pair.frequency_hz, peak: source * peak, error }
        })
    }

    fn wave(&self, coordinates: &[f64], radians: f64) -> Option<Wave> {
        let highest_hz = *self.frequencies_hz.last()?;
        let points = points(self.nominal, highest_hz, radians);
        let wave = Wave::new(spec_at(self.nominal, coordinates), points).ok()?;
        (wave.enters(self.frequencies_hz[0]) && wave.enters(highest_hz)).then_some(wave)
    }

    fn places_at(&self, coordinates: &[f64]) -> Option<[f64; 2]> {
        let places_m = [0, 1].map(|i| self.places_m[i] + coordinates[OF_PLATE + i]);
        let is_on_plate = |place_m: &f64| (0.0..=self.nominal.length_m).contains(place_m);
        places_m.iter().all(is_on_plate).then_some(places_m)
    }

    /// Residuals of the data, then of what was known beforehand.
    fn residuals<'p>(&self, coordinates: &[f64], p: impl Iterator<Item = [&'p f64; 2]>) -> Vec<f64> {
        let of_data = self.pairs.iter().zip(p).map(|(pair, p)| pair.residual(&p.map(|p| *p), MODEL_ERROR));
        let of_priors = coordinates.iter().zip(&self.deviations).map(|(at, deviation)| at / deviation);
        of_data.chain(of_priors).collect()
    }

    /// Wave speed and loss at the lowest minima of a scan.
    fn valleys(&self) -> Vec<[f64; 2]> {
        let every = self.pairs.len().div_ceil(SCAN_FREQUENCIES).max(1);
        let some: Vec<Pair> = self.pairs.iter().copied().step_by(every).collect();
        let frequencies_hz: Vec<f64> = some.iter().map(|pair| pair.frequency_hz).collect();
        let Some(&highest_hz) = frequencies_hz.last() else { return Vec::new() };
        let shortest = self.nominal.model.wavenumber_squared(TAU * highest_hz).sqrt();
        let turns = shortest * self.places_m[0].max(self.places_m[1]);
        let count = ((SPEEDS.1 - SPEEDS.0) * turns.max(1.0) / SCAN_RADIANS).ceil();
        let speed = |i: usize| SPEEDS.0 + (SPEEDS.1 - SPEEDS.0) * i as f64 / count;
        let chi2 = |coordinates: [f64; OF_PLATE]| {
            self.wave(&coordinates, COARSE).map_or(f64::INFINITY, |wave| {
                let rows = wave.at(self.sensor, &self.places_m, &frequencies_hz);
                some.iter().zip(&rows).map(|(pair, p)| pair.residual(p, SCAN_ERROR).powi(2)).sum()
            })
        };
        let mut found = Vec::new();
        for loss in LOSSES.map(f64::ln) {
            let along: Vec<f64> = (0..=count as usize).map(|i| chi2([speed(i), loss, 0.0, 0.0])).collect();
            found.extend(minima(&along).map(|(i, here)| (here, [speed(i), loss])));
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found.into_iter().take(VALLEYS).map(|(_, at)| at).collect()
    }
}

/// The least squares on a grid of a given fineness.
struct OnGrid<'r, 'a> {
    ratio: &'r Ratio<'a>,
    radians: f64,
}

impl Problem for OnGrid<'_, '_> {
    fn residuals(&self, at: &[f64]) -> Option<Vec<f64>> {
        let Self { ratio, radians } = *self;
        let rows = ratio.wave(at, radians)?.at(ratio.sensor, &ratio.places_at(at)?, &ratio.frequencies_hz);
        Some(ratio.residuals(at, rows.iter().map(|p| [&p[0], &p[1]])))
    }

    fn slopes(&self, at: &[f64], r: &[f64]) -> Option<Vec<Vec<f64>>> {
        let Self { ratio, radians } = *self;
        let beside = |i: usize, step: f64| {
            let mut beside = at.to_vec();
            beside[i] += step;
            beside
        };
        let of_plate = STEPS.iter().enumerate().map(|(i, &step)| {
            let above = self.residuals(&beside(i, step))?;
            if radians > FINE {
                return Some(slope(&above, r, step));
            }
            // Speed, width and places nearly make up for each other, and that magnifies the error of a difference to
            // one side: to 2e-3 of the interval.
            Some(slope(&above, &self.residuals(&beside(i, -step))?, 2.0 * step))
        });
        let mut columns: Vec<Vec<f64>> = of_plate.collect::<Option<_>>()?;
        // One field serves all places.
        let [a, b] = ratio.places_at(at)?;
        let h = PLACE_STEP_M;
        let places = [a, b, a + h, a - h, b + h, b - h];
        let rows = ratio.wave(at, radians)?.at(ratio.sensor, &places, &ratio.frequencies_hz);
        for (i, picks) in [[[2, 1], [3, 1]], [[0, 4], [0, 5]]].into_iter().enumerate() {
            let [above, below] = [(h, picks[0]), (-h, picks[1])].map(|(step, pick)| {
                let moved = beside(OF_PLATE + i, step);
                ratio.residuals(&moved, rows.iter().map(|p| pick.map(|at| &p[at])))
            });
            columns.push(slope(&above, &below, 2.0 * h));
        }
        Some(columns)
    }
}
