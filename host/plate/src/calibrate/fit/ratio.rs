//! The ratio of two places: speed, loss, taper and width of the plate from |H_b|/|H_a|, without a model of the source.
//!
//! At each frequency the source has one unknown amplitude s, and the sensors show s p_a and s p_b of the wave's magnitude
//! p. Its best value leaves
//!
//! ```text
//! min over s of (|H_a| - s p_a)^2/v_a + (|H_b| - s p_b)^2/v_b = (|H_a| p_b - |H_b| p_a)^2/(v_a p_b^2 + v_b p_a^2)
//! ```
//!
//! with the variances v: the residual of the ratio, which stays finite where one of the two places is a node. Where the sensor
//! weighs, p is the wave's magnitude with its mass on the plate, and its mass and the source are unknowns, too (`sensor_load.rs`).

use super::acceptance::CHI2_PER_N_MAX;
use super::gain::Carried;
use super::least_squares::{self, Fit};
use super::misfit::misfit;
use super::pairs::{self, MODEL_ERROR, Pair, pairs};
use super::response::wave::{COARSE, FINE, Wave, points};
use super::search::{PLACE_STEP_M, SCAN_ERROR, SCAN_FREQUENCIES, Searched, column, scan};
use super::sensor_load::{Load, SensorLoad};
use super::unknowns::{
    AIR, DISTANT_AIR, EDGE_GIVE, HELD, OF_PLATE, Priors, from_tried_air, in_tried_air, of_baffle, spec_at,
};
use crate::calibrate::measurement::sensor::{Measurement, SensorKind};
use crate::definition::{Plate, PlateSpec};
use crate::frequency::respond_range;
use std::f64::consts::TAU;

/// Radians that the phase at the farther sensor may change from one speed to the next.
const SCAN_RADIANS: f64 = 0.25;
/// Way over which the derivative by a coordinate of the sensor's mass and of the source is taken.
const LOAD_STEP: f64 = 1e-5;
/// Where a search begins that found nothing from the edges of the file, in standard deviations of how far they give.
const GIVE_TRIED: [f64; 2] = [1.5, -1.5];
/// Valleys of the scan that are followed to their bottom.
const VALLEYS: usize = 3;

/// The fit of the ratio of two measurements of one plate.
#[derive(Clone)]
pub(crate) struct Ratio<'a> {
    nominal: &'a PlateSpec,
    sensor: SensorKind,
    pub(crate) places_m: [f64; 2],
    /// Standard deviations of all coordinates: the plate's, then the places'.
    pub(crate) deviations: Vec<f64>,
    pub(crate) pairs: Vec<Pair>,
    pub(crate) frequencies_hz: Vec<f64>,
    /// How far the edges give beyond the file's where the search begins, metres.
    give_from_m: f64,
    /// The share of the wave that the sensor's mass leaves; `None` without mass.
    load: Option<SensorLoad>,
}

impl<'a> Ratio<'a> {
    pub(crate) fn new(plate: &'a Plate, sensors: [&Measurement; 2], priors: &Priors) -> Self {
        let mut pairs = pairs(sensors, respond_range(plate));
        let magnitudes = pairs.iter().map(|pair| pair.magnitude);
        let tails = pairs::tail_variances(magnitudes, pairs::tail_error(&plate.spec().model));
        for (pair, tail) in pairs.iter_mut().zip(tails) {
            pair.variance.iter_mut().for_each(|variance| *variance += tail);
        }
        let places = sensors.map(|sensor| sensor.place_tolerance_m.max(PLACE_STEP_M));
        let load = SensorLoad::of(plate, sensors);
        let of_load = load.iter().flat_map(|load| load.deviations(HELD));
        Self {
            nominal: plate.spec(),
            sensor: sensors[0].sensor,
            places_m: sensors.map(|sensor| sensor.place_m),
            deviations: priors.deviations_of(plate.spec()).into_iter().chain(places).chain(of_load).collect(),
            frequencies_hz: pairs.iter().map(|pair| pair.frequency_hz).collect(),
            pairs,
            give_from_m: 0.0,
            load,
        }
    }

    /// The same with the two places swapped.
    pub(crate) fn swapped(&self) -> Self {
        let mut swapped = self.clone();
        swapped.places_m.swap(0, 1);
        swapped.deviations.swap(self.of_plate(), self.of_plate() + 1);
        swapped.load.iter_mut().for_each(SensorLoad::swap);
        swapped
    }

    /// The best coordinates.
    pub(crate) fn fit(&self) -> Option<Fit> {
        let (mut best, _) = self.lowest(self.best_of_tried_air().as_deref())?;
        // From edges that do not give no valley leads to those that give by half a millimetre on a narrow plate.
        if self.nominal.air.is_none() && best.chi2 > CHI2_PER_N_MAX * self.count() {
            for side in GIVE_TRIED {
                let tried = Ratio { give_from_m: side * self.deviations[EDGE_GIVE], ..self.clone() };
                if let Some((fit, _)) = tried.lowest(None).filter(|(fit, _)| fit.chi2 < best.chi2) {
                    best = fit;
                }
            }
        }
        self.refined(&best)
    }

    /// Of a plate of unknown mounting: where it has the best of the coefficients that are tried with the air held.
    fn best_of_tried_air(&self) -> Option<Vec<f64>> {
        let tried = in_tried_air(self.nominal);
        let fits = tried.iter().filter_map(|nominal| {
            let mut held = Ratio { nominal, ..self.clone() };
            held.deviations.remove(DISTANT_AIR);
            held.deviations[AIR] = HELD;
            let (fit, _) = held.lowest(None)?;
            Some((fit.chi2, from_tried_air(self.nominal, nominal, &fit.parameters)))
        });
        fits.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, start)| start)
    }

    /// The coordinate of the sensor's mass; `None` where it does not weigh.
    pub(crate) fn of_mass(&self, coordinates: &[f64]) -> Option<f64> {
        coordinates.get(self.of_plate() + 2).copied()
    }

    /// Relative model error with which chi^2 of these coordinates would be 1 per answer.
    pub(crate) fn misfit(&self, coordinates: &[f64]) -> Option<f64> {
        let places_m = self.places_at(coordinates)?;
        let rows = self.wave(coordinates, FINE)?.at(self.sensor, &places_m, &self.frequencies_hz);
        let rows = self.loaded(rows, coordinates, self.load_at(coordinates, FINE, &places_m)?.as_ref());
        let chi2 = |model_error: f64| {
            let p = rows.iter().map(|p| [&p[0], &p[1]]);
            self.residuals_of(coordinates, p, model_error).iter().map(|it| it * it).sum()
        };
        Some(misfit(chi2, self.pairs.len() as f64))
    }

    /// Magnitudes at the two sensors, moved by these ways, and the peak, at each frequency.
    pub(crate) fn with_peak(&self, coordinates: &[f64]) -> Option<Vec<(Vec<f64>, f64)>> {
        let wave = self.wave(coordinates, FINE)?;
        let places_m = self.places_at(coordinates)?;
        let peaks = wave.with_peak(self.sensor, &places_m, &self.frequencies_hz);
        let Some(load) = self.load_at(coordinates, FINE, &places_m)? else { return Some(peaks) };
        let (rows, peaks): (Vec<Vec<f64>>, Vec<f64>) = peaks.into_iter().unzip();
        Some(self.loaded(rows, coordinates, Some(&load)).into_iter().zip(peaks).collect())
    }

    /// What the sensor's mass does at these places, two and two of the first and of the second sensor's; none where it does
    /// not weigh.
    fn load_at(&self, coordinates: &[f64], radians: f64, places_m: &[f64]) -> Option<Option<Load<'_>>> {
        self.load_over(coordinates, radians, (places_m, &[0, 1]), &self.frequencies_hz)
    }

    /// The same at places of the sensors with these numbers.
    fn load_over(
        &self,
        coordinates: &[f64],
        radians: f64,
        (places_m, sensors): (&[f64], &'static [usize]),
        frequencies_hz: &[f64],
    ) -> Option<Option<Load<'_>>> {
        let Some(load) = &self.load else { return Some(None) };
        let wave = self.wave(coordinates, radians)?;
        let mut spec = wave.plate().spec().clone();
        spec.drive_end = self.nominal.drive_end;
        Some(Some(load.on(&wave, &spec, (places_m, sensors), frequencies_hz)?))
    }

    /// The magnitudes that the sensors show of `rows`, those of the bare plate.
    fn loaded(&self, mut rows: Vec<Vec<f64>>, coordinates: &[f64], load: Option<&Load<'_>>) -> Vec<Vec<f64>> {
        if let Some(load) = load {
            load.lessen(&mut rows, coordinates.get(self.of_plate() + 2..).unwrap_or_default());
        }
        rows
    }

    /// The measured gains, carried to the peak by the wave of [`Ratio::with_peak`].
    pub(crate) fn carried(&self, peaks: &[(Vec<f64>, f64)]) -> impl Iterator<Item = Carried> {
        self.pairs.iter().zip(peaks).map(|(pair, (p, peak))| {
            let (source, variance) = pair.source(p, MODEL_ERROR);
            Carried { frequency_hz: pair.frequency_hz, peak: source * peak, error: variance.sqrt() * peak }
        })
    }

    fn wave(&self, coordinates: &[f64], radians: f64) -> Option<Wave> {
        let highest_hz = *self.frequencies_hz.last()?;
        let points = points(self.nominal, highest_hz, radians);
        let mut spec = spec_at(self.nominal, coordinates);
        if let (OF_PLATE, Some(air)) = (coordinates.len(), &mut spec.air) {
            // The scan does without the air at a distance.
            *air = air.near_alone();
        }
        let wave = Wave::new(spec, points).ok()?;
        (wave.enters(self.frequencies_hz[0]) && wave.enters(highest_hz)).then_some(wave)
    }

    fn places_at(&self, coordinates: &[f64]) -> Option<[f64; 2]> {
        let places_m = [0, 1].map(|i| self.places_m[i] + coordinates[self.of_plate() + i]);
        let is_on_plate = |place_m: &f64| (0.0..=self.nominal.length_m).contains(place_m);
        places_m.iter().all(is_on_plate).then_some(places_m)
    }

    /// Residuals of the data, then of what was known beforehand.
    fn residuals_of<'p>(
        &self,
        coordinates: &[f64],
        p: impl Iterator<Item = [&'p f64; 2]>,
        model_error: f64,
    ) -> Vec<f64> {
        let of_data = self.pairs.iter().zip(p).map(|(pair, p)| pair.residual(&p.map(|p| *p), model_error));
        let of_priors = coordinates.iter().zip(&self.deviations).map(|(at, deviation)| at / deviation);
        of_data.chain(of_priors).chain(of_baffle(self.nominal, coordinates)).collect()
    }
}

impl Searched for Ratio<'_> {
    const SPEEDS: &'static [(f64, f64)] = &[(-0.29, 0.29)];
    const ERRORS: &'static [(f64, f64)] = &[(MODEL_ERROR, f64::INFINITY)];
    const STEPS_MAX: usize = least_squares::STEPS_MAX;
    const ALL: bool = false;

    fn nominal(&self) -> &PlateSpec {
        self.nominal
    }

    fn count(&self) -> f64 {
        self.pairs.len() as f64
    }

    fn of_noise(&self, _model_error: f64) -> f64 {
        // Every valley is followed.
        0.0
    }

    fn starts(&self, speeds: (f64, f64)) -> Vec<Vec<Vec<f64>>> {
        let every = self.pairs.len().div_ceil(SCAN_FREQUENCIES).max(1);
        let some: Vec<Pair> = self.pairs.iter().copied().step_by(every).collect();
        let frequencies_hz: Vec<f64> = some.iter().map(|pair| pair.frequency_hz).collect();
        let Some(&highest_hz) = frequencies_hz.last() else { return Vec::new() };
        let shortest = self.nominal.free_wave().wavenumber_squared(TAU * highest_hz).sqrt();
        let turns = shortest * self.places_m[0].max(self.places_m[1]);
        let (minima, _) = scan(speeds, turns, SCAN_RADIANS, |mut coordinates| {
            coordinates[EDGE_GIVE] = self.give_from_m;
            let rows = self.wave(&coordinates, COARSE)?.at(self.sensor, &self.places_m, &frequencies_hz);
            let load = self.load_over(&coordinates, COARSE, (&self.places_m, &[0, 1]), &frequencies_hz)?;
            let rows = self.loaded(rows, &coordinates, load.as_ref());
            Some(some.iter().zip(&rows).map(|(pair, p)| pair.residual(p, SCAN_ERROR).powi(2)).sum())
        });
        let start = |(_, at): &(f64, [f64; 2])| {
            let mut start = vec![0.0; self.deviations.len()];
            start[..2].copy_from_slice(at);
            start[EDGE_GIVE] = self.give_from_m;
            vec![start]
        };
        minima.iter().take(VALLEYS).map(start).collect()
    }

    fn residuals(&self, at: &[f64], radians: f64, model_error: f64) -> Option<Vec<f64>> {
        let places_m = self.places_at(at)?;
        let rows = self.wave(at, radians)?.at(self.sensor, &places_m, &self.frequencies_hz);
        let rows = self.loaded(rows, at, self.load_at(at, radians, &places_m)?.as_ref());
        Some(self.residuals_of(at, rows.iter().map(|p| [&p[0], &p[1]]), model_error))
    }

    fn columns(&self, at: &[f64], radians: f64, model_error: f64) -> Option<Vec<Vec<f64>>> {
        // One field serves all places.
        let [a, b] = self.places_at(at)?;
        let h = PLACE_STEP_M;
        let places = [a, b, a + h, a - h, b + h, b - h];
        let bare = self.wave(at, radians)?.at(self.sensor, &places, &self.frequencies_hz);
        let load = self.load_over(at, radians, (&places, &[0, 1, 0, 0, 1, 1]), &self.frequencies_hz)?;
        let rows = self.loaded(bare.clone(), at, load.as_ref());
        let of_place = |i: usize, picks: [[usize; 2]; 2]| {
            column(at, self.of_plate() + i, h, |moved, side| {
                let p = rows.iter().map(|p| picks[side].map(|at| &p[at]));
                self.residuals_of(moved, p, model_error)
            })
        };
        // The same field serves the mass and the source.
        let of_load = (self.of_plate() + 2..at.len()).map(|i| {
            column(at, i, LOAD_STEP, |moved, _| {
                let rows = self.loaded(bare.clone(), moved, load.as_ref());
                self.residuals_of(moved, rows.iter().map(|p| [&p[0], &p[1]]), model_error)
            })
        });
        let of_load: Vec<Vec<f64>> = of_load.collect();
        let of_places = [of_place(0, [[2, 1], [3, 1]]), of_place(1, [[0, 4], [0, 5]])];
        Some(of_places.into_iter().chain(of_load).collect())
    }
}
