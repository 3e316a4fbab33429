//! The fit of a plate and its source together to one complex response.
//!
//! For a given plate and delay the source's numbers enter a response nearly linearly ([`SourceModel`] says how). So a scan
//! over wave speed and loss solves a linear problem at each place, and Gauss and Newton's method moves all coordinates from
//! the best of them.

use super::acceptance::{CHI2_PER_N_MAX, SPEED_MAX};
use super::least_squares::{Fit, slope};
use super::misfit::misfit;
use super::pairs::MODEL_ERROR;
use super::response::plate_response::{PlateResponse, Units, answers};
use super::response::sensor_body::{OF_MASS, weigh};
use super::response::wave::{COARSE, FINE, points};
use super::search::{PLACE_STEP_M, SCAN_ERROR, SCAN_FREQUENCIES, Searched, column, scan};
use super::source::data::Datum;
use super::source::source_model::SourceModel;
use super::source::third_mode::add_third;
use super::unknowns::{EDGE_GIVE, HELD, OF_PLATE, Priors, SPEED, of_baffle, spec_at, with_speed};
use crate::calibrate::error::CalibrateError;
use crate::calibrate::measurement::sensor::{MeasuredPoint, Measurement, SensorBody, SensorKind};
use crate::definition::{Plate, PlateSpec};
use std::iter::repeat_n;

/// Radians that the phase of the wave may change on its way to the turning point and back from one speed to the next.
const SCAN_RADIANS: f64 = 0.5;
/// Valleys of the scan that are followed to their bottom.
const VALLEYS: usize = 4;
/// A bottom within this much chi^2 of the best is as good; if its speed is [`FAR`] standard deviations away, it is another
/// plate.
const AS_GOOD: f64 = 25.0;
const FAR: f64 = 6.0;
/// Way over which the derivative by a coordinate of the source is taken.
const SOURCE_STEP: f64 = 1e-5;
/// Coordinates of a source's resistance, mass and stiffness: none is below zero.
const OF_IMPEDANCE: usize = 3;

/// The least squares of a plate and a source.
pub(crate) struct Joint<'a, S> {
    pub(crate) nominal: &'a PlateSpec,
    pub(crate) source: S,
    pub(crate) units: Units,
    /// The sensor on the plate; none for a current.
    pub(crate) sensor: Option<&'a Measurement>,
    /// The prior deviations of all coordinates: the plate's, the place's, the source's.
    pub(crate) deviations: Vec<f64>,
    pub(crate) frequencies_hz: Vec<f64>,
    pub(crate) data: Vec<Datum>,
    /// Radians to the turning point and back at the highest frequency.
    turns: f64,
}

impl<'a, S: SourceModel> Joint<'a, S> {
    pub(crate) fn new(
        plate: &'a Plate,
        source: S,
        units: Units,
        sensor: Option<&'a Measurement>,
        priors: &Priors,
        (points, data): (&[MeasuredPoint], Vec<Datum>),
    ) -> Self {
        let frequencies_hz: Vec<f64> = points.iter().map(|point| point.frequency_hz).collect();
        let of_place = sensor.iter().map(|sensor| sensor.place_tolerance_m.max(PLACE_STEP_M));
        let of_mass = sensor.and_then(Measurement::body).map(|_| OF_MASS);
        let mut of_plate = priors.deviations_of(plate.spec());
        // One place does not tell edges that give from another length: without a stated tolerance they are those of the file.
        if priors.edge_give_m.or(plate.spec().edge_give_tolerance_m).is_none() {
            of_plate[EDGE_GIVE] = HELD;
        }
        let known = of_plate.into_iter().chain(of_place).chain(of_mass);
        let deviations = known.chain(source.deviations()).collect();
        let highest_hz = frequencies_hz.last().copied().unwrap_or(0.0);
        let turns = 2.0 * plate.width_mode(1).phase_to(plate.length_m(), highest_hz);
        Self { nominal: plate.spec(), source, units, sensor, deviations, frequencies_hz, data, turns }
    }

    /// Where the source's coordinates begin.
    pub(crate) fn of_source(&self) -> usize {
        self.of_plate() + usize::from(self.sensor.is_some()) + usize::from(self.body().is_some())
    }

    /// The body of a sensor that weighs; the coordinate of its mass, ln over the stated one, follows that of its place.
    fn body(&self) -> Option<SensorBody> {
        self.sensor.and_then(Measurement::body)
    }

    /// The coordinate of its mass; `None` where it does not weigh.
    pub(crate) fn of_mass(&self, coordinates: &[f64]) -> Option<f64> {
        self.body().and_then(|_| coordinates.get(self.of_plate() + 1).copied())
    }

    /// Number of all residuals.
    pub(crate) fn residual_count(&self) -> usize {
        2 * self.data.len() + self.deviations.iter().filter(|deviation| deviation.is_finite()).count()
    }

    /// The best coordinates and chi^2 over the number of residuals, if the model fits the data.
    pub(crate) fn accepted(&mut self) -> Result<(Fit, f64), CalibrateError> {
        let (fit, bottoms) = self.fit().ok_or(CalibrateError::NoFit)?;
        let chi2_per_n = fit.chi2 / (self.residual_count() - fit.parameters.len()) as f64;
        if chi2_per_n > CHI2_PER_N_MAX {
            return Err(CalibrateError::Unlike { chi2_per_n, most: CHI2_PER_N_MAX });
        }
        // Another plate fits as well.
        let margin = AS_GOOD * chi2_per_n.max(1.0);
        let deviation = fit.covariance[(SPEED, SPEED)].sqrt();
        let is_other = |bottom: &&Fit| {
            bottom.chi2 < fit.chi2 + margin
                && (bottom.parameters[SPEED] - fit.parameters[SPEED]).abs() > FAR * deviation
        };
        match bottoms.iter().find(is_other) {
            Some(other) if S::ALL => {
                let shares = [&fit, other].map(|fit| fit.parameters[SPEED].exp());
                Err(CalibrateError::Ambiguous { shares })
            }
            _ => Ok((fit, chi2_per_n)),
        }
    }

    /// The best coordinates, and the bottoms of all valleys that were followed.
    fn fit(&mut self) -> Option<(Fit, Vec<Fit>)> {
        let (best, bottoms) = self.lowest(None)?;
        let mut fit = self.refined(&best)?;
        // A resistance, mass or spring below zero is none.
        for _ in 0..OF_IMPEDANCE {
            let first = self.of_source();
            let negative = |i: &usize| fit.parameters[*i] < 0.0 && self.deviations[*i] > HELD;
            let Some(lowest) = (first..first + OF_IMPEDANCE)
                .filter(negative)
                .min_by(|a, b| fit.parameters[*a].total_cmp(&fit.parameters[*b]))
            else {
                break;
            };
            self.deviations[lowest] = HELD;
            fit.parameters[lowest] = 0.0;
            fit = self.refined(&fit)?;
        }
        Some((fit, bottoms))
    }

    /// Relative model error with which chi^2 of these coordinates would be 1 per answer.
    pub(crate) fn misfit(&self, coordinates: &[f64]) -> Option<f64> {
        let places_m = self.places_at(coordinates)?;
        let answers = self.answers(coordinates, &places_m, &self.frequencies_hz, FINE, false)?;
        let chi2 = |model_error: f64| {
            self.residuals_of(coordinates, &answers, 0, model_error).iter().map(|it| it * it).sum()
        };
        Some(misfit(chi2, (self.residual_count() - coordinates.len()) as f64))
    }

    /// The resistance, mass and stiffness of the source in units, none below zero.
    pub(crate) fn impedance_of(&self, coordinates: &[f64]) -> [f64; OF_IMPEDANCE] {
        let first = self.of_source();
        [0, 1, 2].map(|i| coordinates[first + i].max(0.0))
    }

    /// Responses of the plate at these coordinates, with its peak.
    pub(crate) fn answers_with_peak(&self, coordinates: &[f64]) -> Option<Vec<PlateResponse>> {
        self.answers(coordinates, &self.places_at(coordinates)?, &self.frequencies_hz, FINE, true)
    }

    fn answers(
        &self,
        coordinates: &[f64],
        places_m: &[f64],
        frequencies_hz: &[f64],
        radians: f64,
        with_peak: bool,
    ) -> Option<Vec<PlateResponse>> {
        let points = points(self.nominal, *self.frequencies_hz.last()?, radians);
        let spec = spec_at(self.nominal, coordinates);
        let sensor = self.sensor.map_or(SensorKind::Displacement, |sensor| sensor.sensor);
        let mut found = answers(&spec, points, self.units, sensor, places_m, frequencies_hz, with_peak)?;
        // A scan does without.
        if self.source.counts_third_mode() && coordinates.len() > self.of_source() {
            add_third(&mut found, &Plate::new(spec.clone()).ok()?, sensor, places_m);
        }
        if let (Some(body), Some(&place_m)) = (self.body(), places_m.first()) {
            let factor = self.of_mass(coordinates).unwrap_or(0.0).exp();
            let body = SensorBody { mass_kg: factor * body.mass_kg, ..body };
            weigh(&mut found, &spec, points, self.units, (body, place_m))?;
        }
        Some(found)
    }

    fn places_at(&self, coordinates: &[f64]) -> Option<Vec<f64>> {
        let Some(sensor) = self.sensor else { return Some(Vec::new()) };
        let place_m = sensor.place_m + coordinates[self.of_plate()];
        (0.0..=self.nominal.length_m).contains(&place_m).then(|| vec![place_m])
    }

    /// Residuals of the data, real and imaginary parts, then of what was known beforehand.
    fn residuals_of(
        &self,
        coordinates: &[f64],
        answers: &[PlateResponse],
        place: usize,
        model_error: f64,
    ) -> Vec<f64> {
        let source = &coordinates[self.of_source()..];
        let mut residuals = Vec::with_capacity(self.residual_count());
        for (datum, answer) in self.data.iter().zip(answers) {
            let left = self.source.response(answer, place, source) - datum.response;
            let left = left / datum.deviation(model_error);
            residuals.extend([left.re, left.im]);
        }
        let known = coordinates.iter().zip(&self.deviations).filter(|(_, deviation)| deviation.is_finite());
        residuals.extend(known.map(|(at, deviation)| at / deviation));
        residuals.extend(of_baffle(self.nominal, coordinates));
        residuals
    }

    /// The columns of place, mass and source where the sensor weighs: beside its place it leaves another share of the motion.
    fn columns_of_a_weight(
        &self,
        (at, answers): (&[f64], &[PlateResponse]),
        radians: f64,
        model_error: f64,
    ) -> Option<Vec<Vec<f64>>> {
        let mut columns = Vec::new();
        for (i, step) in [(self.of_plate(), PLACE_STEP_M), (self.of_plate() + 1, SOURCE_STEP)] {
            let beside = |way: f64| {
                let mut beside = at.to_vec();
                beside[i] += way;
                self.residuals(&beside, radians, model_error)
            };
            columns.push(slope(&beside(step)?, &beside(-step)?, 2.0 * step));
        }
        columns.extend((self.of_source()..at.len()).map(|i| {
            column(at, i, SOURCE_STEP, |moved, _| self.residuals_of(moved, answers, 0, model_error))
        }));
        Some(columns)
    }
}

impl<S: SourceModel> Searched for Joint<'_, S> {
    const SPEEDS: &'static [(f64, f64)] = &[(-SPEED_MAX, SPEED_MAX), (-0.29, 0.29)];
    // At first the widths and the place stay what calipers say.
    const ERRORS: &'static [(f64, f64)] = &[(0.2, 0.25), (0.05, 2.0), (MODEL_ERROR, f64::INFINITY)];
    const STEPS_MAX: usize = 30;
    const ALL: bool = S::ALL;

    fn nominal(&self) -> &PlateSpec {
        self.nominal
    }

    fn count(&self) -> f64 {
        self.residual_count() as f64
    }

    fn of_noise(&self, model_error: f64) -> f64 {
        let share = |datum: &Datum| datum.variance / datum.deviation(model_error).powi(2);
        2.0 * self.data.iter().map(share).sum::<f64>() / self.count()
    }

    fn starts(&self, speeds: (f64, f64)) -> Vec<Vec<Vec<f64>>> {
        let every = self.data.len().div_ceil(SCAN_FREQUENCIES).max(1);
        let some: Vec<Datum> = self.data.iter().copied().step_by(every).collect();
        let frequencies_hz: Vec<f64> = self.frequencies_hz.iter().copied().step_by(every).collect();
        let places_m: Vec<f64> = self.sensor.iter().map(|sensor| sensor.place_m).collect();
        let on_plate = |coordinates: [f64; OF_PLATE]| {
            self.answers(&coordinates, &places_m, &frequencies_hz, COARSE, false)
        };
        let (mut minima, step) = scan(speeds, self.turns, SCAN_RADIANS, |coordinates| {
            self.source.suited(&some, &on_plate(coordinates)?, SCAN_ERROR)
        });
        // One valley goes through all losses.
        let mut speeds: Vec<f64> = Vec::new();
        minima.retain(|(_, [speed, _])| {
            let is_new = speeds.iter().all(|other| (other - speed).abs() > 1.5 * step);
            speeds.extend(is_new.then_some(*speed));
            is_new
        });
        let starts = |(_, [speed, loss]): (f64, [f64; 2])| {
            let answers = on_plate(with_speed(speed, loss)).unwrap_or_default();
            let zeros = self.of_source() - OF_PLATE;
            let whole = move |source: Vec<f64>| {
                let of_plate = with_speed(speed, loss).into_iter().chain(repeat_n(0.0, zeros));
                of_plate.chain(source).collect::<Vec<f64>>()
            };
            self.source.starts(&some, &answers).into_iter().map(whole).collect::<Vec<_>>()
        };
        minima.into_iter().take(VALLEYS).map(starts).collect()
    }

    fn residuals(&self, at: &[f64], radians: f64, model_error: f64) -> Option<Vec<f64>> {
        let answers = self.answers(at, &self.places_at(at)?, &self.frequencies_hz, radians, false)?;
        Some(self.residuals_of(at, &answers, 0, model_error))
    }

    fn columns(&self, at: &[f64], radians: f64, model_error: f64) -> Option<Vec<Vec<f64>>> {
        // One field serves the place and the source.
        let mut places_m = self.places_at(at)?;
        if let Some(&place_m) = places_m.first() {
            places_m.extend([place_m + PLACE_STEP_M, place_m - PLACE_STEP_M]);
        }
        let answers = self.answers(at, &places_m, &self.frequencies_hz, radians, false)?;
        if self.body().is_some() {
            return self.columns_of_a_weight((at, &answers), radians, model_error);
        }
        let of_place = self.sensor.map(|_| {
            column(at, self.of_plate(), PLACE_STEP_M, |moved, side| {
                self.residuals_of(moved, &answers, 1 + side, model_error)
            })
        });
        let of_source = (self.of_source()..at.len()).map(|i| {
            column(at, i, SOURCE_STEP, |moved, _| self.residuals_of(moved, &answers, 0, model_error))
        });
        Some(of_place.into_iter().chain(of_source).collect())
    }
}
