//! A recording of the sweep as a measurement of a plate.
//!
//! The recorder does not know when the device began, so its responses have an unknown lag. The ratio of two
//! places uses magnitudes only and does not depend on it. The fit of one sensor accepts a lag of -2 to 12
//! periods of the highest frequency. The lag tau that brings the phases nearest to those of the plate file's
//! model is where
//!
//! ```text
//! | sum over f of w H P*/|H P| e^(-j omega tau) |,   w = |H|^2/(|H|^2 + noise^2)
//! ```
//! is largest, with P the model's response; it is removed except for [`LAG_PERIODS`].

use super::{ForeignError, band, sensor};
use crate::measure::{HeardSweep, PlayedSweep};
use slipline_model::wav::Wav;
use slipline_plate::calibrate::{Measurement, SensorKind, predicted};
use slipline_plate::{Complex64, Plate};
use std::f64::consts::TAU;

/// Remaining lag, in periods of the highest frequency, within the range of the fit.
const LAG_PERIODS: f64 = 4.0;
/// Candidate lags per period of the highest frequency.
const TRIED: f64 = 10.0;
/// Range of the candidate lags, in ring times of the plate.
const LAGS: (f64, f64) = (-1.0, 0.25);

/// Metadata of a recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecordingMetadata {
    /// Sensor place, metres from the driven end.
    pub place_m: f64,
    /// The quantity that the sensor shows; `None` while it is not stated.
    pub kind: Option<SensorKind>,
    /// Its channel in the file, from 1.
    pub channel: usize,
}

/// The measurement from a recording of a sweep, with notes as sentences.
///
/// # Errors
/// [`ForeignError`]: what is missing, out of its range, or wrong with the recording.
pub fn recorded(
    plate: &Plate,
    wav: &Wav,
    sweep: &PlayedSweep,
    metadata: &RecordingMetadata,
) -> Result<(Measurement, Vec<String>), ForeignError> {
    let kind = sensor(plate, metadata.place_m, metadata.kind)?;
    band(plate, sweep.chirp().measured_hz().into_iter())?;
    let heard = HeardSweep::new(&wav.channel(metadata.channel)?, sweep)?;
    let notes = heard.notes();
    let mut measurement = Measurement {
        sample_rate_hz: Some(heard.dac_rate_hz),
        ..Measurement::at(metadata.place_m, kind, heard.points)
    };
    measurement.check()?;
    align(plate, &mut measurement, sweep.chirp().ring_s)?;
    Ok((measurement, notes))
}

/// Removes the unknown lag.
fn align(plate: &Plate, measurement: &mut Measurement, ring_s: f64) -> Result<(), ForeignError> {
    let file = predicted(plate, measurement)?;
    let unit = |(point, file): (&slipline_plate::calibrate::MeasuredPoint, &Option<Complex64>)| {
        let product = point.response * file.as_ref()?.conj();
        let square = point.response.norm_sqr();
        let weight = square / (square + point.noise * point.noise);
        (product.norm() > 0.0).then(|| (point.frequency_hz, product * (weight / product.norm())))
    };
    let units: Vec<(f64, Complex64)> = measurement.points.iter().zip(&file).filter_map(unit).collect();
    let Some(&(highest_hz, _)) = units.last() else { return Ok(()) };
    let step_s = (TRIED * highest_hz).recip();
    let first = (LAGS.0 * ring_s / step_s) as i64;
    let last = (LAGS.1 * ring_s / step_s) as i64;
    let alike = |step: i64| -> f64 {
        let lag_s = step as f64 * step_s;
        let turned = units.iter().map(|(hz, unit)| unit * Complex64::cis(-TAU * hz * lag_s));
        turned.sum::<Complex64>().norm()
    };
    let best = (first..=last).map(|step| (step, alike(step))).max_by(|a, b| a.1.total_cmp(&b.1));
    let lag_s = best.map_or(0.0, |(step, _)| step as f64 * step_s) - LAG_PERIODS / highest_hz;
    for point in &mut measurement.points {
        point.response *= Complex64::cis(-TAU * point.frequency_hz * lag_s);
    }
    Ok(())
}
