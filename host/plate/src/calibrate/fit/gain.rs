//! The measured gain, carried from the sensors to the peak by the fitted wave: the correction of a plate file's
//! drive.
//!
//! At each frequency the fit gives the source amplitude s, and the wave has its peak at s p_peak. The correction of
//! the plate file is this over the peak predicted from the file's drive, so a table inverts the measured gain. Every
//! point counts with its variance, and the correction is a smooth curve through the points: a Gaussian process over
//! ln f.

use super::gaussian_process::{Places, Process};
use super::least_squares::Fit;
use super::pairs::MODEL_ERROR;
use super::response::prediction::per_metre;
use crate::calibrate::error::CalibrateError;
use crate::calibrate::measurement::sensor::Measurement;
use crate::definition::{Plate, ResponseCurve};
use crate::order;
use crate::progress::Progress;
use crate::table::level::{DriveToPeak, Level};
use nalgebra::{DMatrix, DVector};

/// Largest relative standard deviation of a point for the first curve: the logarithm of a noisier one is too
/// uncertain.
const CLEAR: f64 = 0.3;
/// Iterations in which the logarithm is linearised about the curve.
const TURNS: usize = 2;
/// Places over the span at which the level is judged, besides the measured points.
const JUDGED: usize = 33;
/// Decibels per unit of relative change.
pub(crate) const DECIBELS: f64 = 20.0 / std::f64::consts::LN_10;
/// Sample rate used for a source without a zero-order hold: the droop is below 1e-6 up to 50 kHz.
const NO_HOLD_HZ: f64 = 1e8;

/// Relative error of the level of a peak in air by the law of the air along a membrane: against two dimensions its peaks are up to
/// 0.4 dB off in a baffle and 0.9 dB in a bare frame, over the span.
const LEVEL_ERROR_IN_AIR: f64 = 0.03;

/// Relative error of the one-mode equation from the sensors to the peak.
pub(crate) fn level_error(plate: &Plate) -> f64 {
    if plate.width_mode(1).air(plate.band_hz().0).is_some() { LEVEL_ERROR_IN_AIR } else { MODEL_ERROR }
}

/// A measured gain, carried to the peak.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Carried {
    pub(crate) frequency_hz: f64,
    /// Amplitude of the peak of the fitted wave per code, in units of the sensor's signal; noise can make it
    /// negative.
    pub(crate) peak: f64,
    /// Its standard deviation by noise and model error, in the same unit.
    pub(crate) error: f64,
}

/// The results of a fit that determine the levels.
pub(crate) struct Levels<'a> {
    /// The fitted plate without a correction.
    pub(crate) plate: &'a Plate,
    /// The plate whose mean level is kept where the sensor is uncalibrated; `None` for that of `plate`.
    pub(crate) nominal: Option<&'a Plate>,
    pub(crate) sensor: &'a Measurement,
    pub(crate) carried: &'a [Carried],
    /// Derivatives of the gains with respect to each coordinate of the fit.
    pub(crate) slopes: &'a [Vec<f64>],
    pub(crate) fit: &'a Fit,
    /// Factor on all standard deviations, over those by noise and model error.
    pub(crate) scale: f64,
}

impl Levels<'_> {
    /// The correction of the plate's drive, and the largest standard deviation of the peak level over the span, dB.
    ///
    /// An uncalibrated sensor measures the shape alone: the mean level stays that of the plate, or that of the
    /// nominal plate, whose drive may differ.
    pub(crate) fn correction(&self) -> Result<(ResponseCurve, f64), CalibrateError> {
        let predicted = self.predicted(self.plate)?;
        let relative: Vec<(f64, f64)> = self
            .carried
            .iter()
            .zip(&predicted)
            .map(|(it, predicted)| (it.peak / predicted, self.scale * it.error / predicted))
            .collect();
        let logs = |at: &[f64]| -> Vec<f64> { at.iter().map(|hz| hz.ln()).collect() };
        let measured_hz: Vec<f64> = self.carried.iter().map(|it| it.frequency_hz).collect();
        // The first curve is fitted to the clear points; later ones to all points, linearised about the curve before.
        let mut places = Places { at: logs(&measured_hz), variances: Vec::new() };
        let mut values: Vec<f64> = Vec::new();
        for (share, error) in &relative {
            let is_clear = *share > 0.0 && error / share < CLEAR;
            values.push(if is_clear { share.ln() } else { 0.0 });
            places.variances.push(if is_clear { (error / share).powi(2) } else { f64::INFINITY });
        }
        let mut process = Process::likeliest(&places, &values).ok_or(CalibrateError::NoFit)?;
        let mut curve = process.posterior(&places, &[&values]).ok_or(CalibrateError::NoFit)?.means.remove(0);
        for _ in 0..TURNS {
            for (i, ((share, error), at)) in relative.iter().zip(&curve).enumerate() {
                values[i] = at + share / at.exp() - 1.0;
                places.variances[i] = (error / at.exp()).powi(2);
            }
            process = Process::likeliest(&places, &values).ok_or(CalibrateError::NoFit)?;
            curve = process.posterior(&places, &[&values]).ok_or(CalibrateError::NoFit)?.means.remove(0);
        }
        let slopes = self.slopes.iter().map(|column| {
            let over = column.iter().zip(&predicted).zip(&curve);
            over.map(|((slope, predicted), at)| slope / (predicted * at.exp())).collect()
        });
        let slopes: Vec<Vec<f64>> = slopes.collect();
        let covariance = &self.fit.covariance * self.scale.powi(2);
        let is_shape = self.sensor.unit_per_response.is_none();
        let error = level_error(self.plate);
        let deviation_db =
            process.deviation_db(&places, &slopes, &covariance, self.plate.band_hz(), (is_shape, error));
        let deviation_db = deviation_db.ok_or(CalibrateError::NoFit)?;
        let mut points: Vec<[f64; 3]> =
            measured_hz.iter().zip(&curve).map(|(hz, at)| [*hz, DECIBELS * at, 0.0]).collect();
        if is_shape {
            let decibels = |values: &[f64]| values.iter().map(|it| DECIBELS * it.ln()).collect::<Vec<f64>>();
            let wanted_db = match self.nominal {
                None => 0.0,
                Some(nominal) => mean(&decibels(&self.predicted(nominal)?)) - mean(&decibels(&predicted)),
            };
            let level_db = mean(&points.iter().map(|point| point[1]).collect::<Vec<f64>>()) - wanted_db;
            points.iter_mut().for_each(|point| point[1] -= level_db);
        }
        Ok((ResponseCurve { points }, deviation_db))
    }

    /// The gains that a plate file predicts at the measured frequencies, in units of the sensor's signal.
    fn predicted(&self, plate: &Plate) -> Result<Vec<f64>, CalibrateError> {
        let frequencies_hz: Vec<f64> = self.carried.iter().map(|it| it.frequency_hz).collect();
        let levels = DriveToPeak::unchecked(plate, self.sensor.sample_rate_hz.unwrap_or(NO_HOLD_HZ))
            .levels(&frequencies_hz, &mut Progress::unwatched())?;
        let in_signal = |(level, &hz): (&Level, &f64)| {
            let metres = level.amplitude * plate.spec().full_scale_m;
            metres * per_metre(plate, self.sensor, hz).norm() / self.sensor.unit_per_response.unwrap_or(1.0)
        };
        Ok(levels.iter().zip(&frequencies_hz).map(in_signal).collect())
    }
}

impl Process {
    /// Largest standard deviation over a band, dB, of a curve through points at `places` (logarithms of their
    /// frequencies), from the curve itself and from fitted coordinates with this covariance. `slopes` are the
    /// derivatives of the points' logarithms with respect to each coordinate; the curve weights them as it weights
    /// the points. Where the curve is a shape alone (`is_shape`), a common factor does not count. The model error
    /// between the sensors and the peak ([`level_error`]) is correlated over neighbouring frequencies, so no number of points
    /// averages it out: it is added.
    pub(crate) fn deviation_db(
        &self,
        places: &Places,
        slopes: &[Vec<f64>],
        covariance: &DMatrix<f64>,
        band_hz: (f64, f64),
        (is_shape, level_error): (bool, f64),
    ) -> Option<f64> {
        let (low, high) = (band_hz.0.ln(), band_hz.1.ln());
        let judged = (0..JUDGED).map(|i| (low + (high - low) * i as f64 / (JUDGED - 1) as f64, None));
        let mut all: Vec<(f64, Option<usize>)> =
            judged.chain(places.at.iter().enumerate().map(|(i, at)| (*at, Some(i)))).collect();
        order::sort_by(&mut all, |a, b| a.0.total_cmp(&b.0));
        let places = Places {
            at: all.iter().map(|(at, _)| *at).collect(),
            variances: all.iter().map(|(_, i)| i.map_or(f64::INFINITY, |i| places.variances[i])).collect(),
        };
        let at_all = |column: &Vec<f64>| all.iter().map(|(_, i)| i.map_or(0.0, |i| column[i])).collect();
        let columns: Vec<Vec<f64>> = slopes.iter().map(at_all).collect();
        let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        let mut found = self.posterior(&places, &columns)?;
        let within: Vec<usize> = (0..all.len()).filter(|&i| (low..=high).contains(&all[i].0)).collect();
        if is_shape {
            for column in &mut found.means {
                let mean = mean(&within.iter().map(|&i| column[i]).collect::<Vec<f64>>());
                column.iter_mut().for_each(|slope| *slope -= mean);
            }
        }
        let square = |&i: &usize| {
            let slopes = DVector::from_iterator(columns.len(), found.means.iter().map(|column| column[i]));
            found.variances[i] + (slopes.transpose() * covariance * &slopes)[(0, 0)].max(0.0)
        };
        let largest = within.iter().map(square).fold(0.0, f64::max);
        Some(DECIBELS * (largest + level_error.powi(2)).sqrt())
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}
