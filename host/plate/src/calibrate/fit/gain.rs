//! The measured gain, carried from the sensors to the peak by the fitted wave.
//!
//! At each frequency the fit leaves the source's amplitude s, and the wave's peak is s p_peak. Over what the fitted
//! plate file says of its drive this is the correction that the file carries: with it a table inverts what was measured.

use super::response::prediction::per_metre;
use crate::calibrate::error::CalibrateError;
use crate::calibrate::measurement::sensor::Measurement;
use crate::definition::{Plate, ResponseCurve};
use crate::progress::Progress;
use crate::table::level::{DriveToPeak, Level};

/// Points whose amplitude is known worse than this, relative to the best half of them, are left out: the curve goes
/// straight over a frequency at which both sensors stand near a node.
const BLURRED: f64 = 4.0;
/// dB per relative change.
pub(crate) const DECIBELS: f64 = 20.0 / std::f64::consts::LN_10;
/// The rate that stands for a source without a zero-order hold: its droop is below 1e-6 up to 50 kHz.
const NO_HOLD_HZ: f64 = 1e8;

/// A measured gain, carried to the peak.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Carried {
    pub(crate) frequency_hz: f64,
    /// From the code to the peak of the fitted wave, in units of the sensor's signal; above 0.
    pub(crate) peak: f64,
    /// Its relative standard deviation by noise.
    pub(crate) error: f64,
}

/// The correction of `plate`'s drive with which it has these gains. Beside it, the standard deviation of nine tenths of its
/// points, dB, by noise.
///
/// An uncalibrated sensor measures the shape alone: the mean level stays that of `plate`, or that of `nominal`, whose
/// drive may be another one.
pub(crate) fn correction(
    plate: &Plate,
    nominal: Option<&Plate>,
    sensor: &Measurement,
    carried: &[Carried],
) -> Result<(ResponseCurve, f64), CalibrateError> {
    let rate_hz = sensor.sample_rate_hz.unwrap_or(NO_HOLD_HZ);
    let levels_db = |plate: &Plate, points: &[Carried]| -> Result<Vec<f64>, CalibrateError> {
        let frequencies_hz: Vec<f64> = points.iter().map(|point| point.frequency_hz).collect();
        let levels = DriveToPeak::unchecked(plate, rate_hz)
            .levels(&frequencies_hz, &mut Progress::new(&mut |_| true))?;
        let in_metres = |level: &Level| 20.0 * (level.amplitude * plate.spec().full_scale_m).log10();
        Ok(levels.iter().map(in_metres).collect())
    };
    let mut errors: Vec<f64> = carried.iter().map(|point| point.error).collect();
    errors.sort_by(f64::total_cmp);
    let usual = errors.get(errors.len() / 2).copied().unwrap_or(0.0);
    errors.retain(|error| *error <= BLURRED * usual);
    let clear: Vec<Carried> =
        carried.iter().copied().filter(|point| point.error <= BLURRED * usual).collect();
    let noise_db = errors.get(errors.len() * 9 / 10).map_or(f64::INFINITY, |error| DECIBELS * error);
    let predicted_db = levels_db(plate, &clear)?;
    let mut points: Vec<[f64; 3]> = Vec::with_capacity(clear.len());
    for (point, predicted_db) in clear.iter().zip(&predicted_db) {
        let per_metre = per_metre(plate, sensor, point.frequency_hz).norm();
        let measured_m = point.peak * (sensor.unit_per_response.unwrap_or(1.0) / per_metre);
        points.push([point.frequency_hz, 20.0 * measured_m.log10() - predicted_db, 0.0]);
    }
    let level_db = if sensor.unit_per_response.is_some() {
        0.0
    } else {
        let wanted_db = match nominal {
            None => 0.0,
            Some(nominal) => mean(&levels_db(nominal, &clear)?) - mean(&predicted_db),
        };
        mean(&points.iter().map(|point| point[1]).collect::<Vec<f64>>()) - wanted_db
    };
    points.iter_mut().for_each(|point| point[1] -= level_db);
    Ok((ResponseCurve { points }, noise_db))
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}
