//! The measured gain, carried from the sensors to the peak by the fitted wave.
//!
//! At each frequency the fit leaves the source's amplitude s, and the wave's peak is s p_peak. Over what the fitted
//! plate file says of its drive this is the correction that the file carries: with it a table inverts what was measured.

use super::error::CalibrateError;
use super::measurement::{Measurement, SensorKind};
use super::pairs::Pair;
use crate::progress::Progress;
use crate::spec::{Plate, ResponseCurve};
use crate::table::level::DriveToPeak;
use std::f64::consts::TAU;

/// Points whose amplitude is known worse than this, relative to the best half of them, are left out: the curve goes
/// straight over a frequency at which both sensors stand near a node.
const BLURRED: f64 = 4.0;
/// dB per relative change.
pub(super) const DECIBELS: f64 = 20.0 / std::f64::consts::LN_10;
/// The rate that stands for a source without a zero-order hold: its droop is below 1e-6 up to 50 kHz.
const NO_HOLD_HZ: f64 = 1e8;

/// The correction of `plate`'s drive: `peaks` has the magnitudes of the fitted wave at the two sensors and its peak, for
/// each of the `pairs`. Beside it, the standard deviation of nine tenths of its points, dB: what noise leaves.
pub(super) fn correction(
    plate: &Plate,
    sensor: &Measurement,
    pairs: &[Pair],
    peaks: &[(Vec<f64>, f64)],
) -> Result<(ResponseCurve, f64), CalibrateError> {
    let frequencies_hz: Vec<f64> = pairs.iter().map(|pair| pair.frequency_hz).collect();
    let file = DriveToPeak::unchecked(plate, sensor.sample_rate_hz.unwrap_or(NO_HOLD_HZ));
    let told = file.levels(&frequencies_hz, &mut Progress::new(&mut |_| true))?;
    let mut points: Vec<(f64, f64, f64)> = Vec::with_capacity(pairs.len());
    for ((pair, (p, peak)), told) in pairs.iter().zip(peaks).zip(&told) {
        let (source, variance) = pair.source(p);
        if source > 0.0 {
            let measured = source * peak * metres_per_response(plate, sensor, pair.frequency_hz);
            let told_m = told.amplitude * plate.spec().full_scale_m;
            points.push((pair.frequency_hz, 20.0 * (measured / told_m).log10(), variance.sqrt() / source));
        }
    }
    let mut errors: Vec<f64> = points.iter().map(|point| point.2).collect();
    errors.sort_by(f64::total_cmp);
    let usual = errors.get(errors.len() / 2).copied().unwrap_or(0.0);
    points.retain(|point| point.2 <= BLURRED * usual);
    errors.retain(|error| *error <= BLURRED * usual);
    let noise_db = errors.get(errors.len() * 9 / 10).map_or(f64::INFINITY, |error| DECIBELS * error);
    // An uncalibrated sensor tells the shape alone: the file's level stays as it is.
    let level_db = match sensor.unit_per_response {
        Some(_) => 0.0,
        None => points.iter().map(|point| point.1).sum::<f64>() / points.len().max(1) as f64,
    };
    let points = points.iter().map(|(hz, db, _)| [*hz, db - level_db, 0.0]).collect();
    Ok((ResponseCurve { points }, noise_db))
}

/// Metres of deflection per unit of the sensor's response; where nobody calibrated it, in an unknown unit.
fn metres_per_response(plate: &Plate, sensor: &Measurement, frequency_hz: f64) -> f64 {
    let omega = TAU * frequency_hz;
    let per_metre = match sensor.sensor {
        SensorKind::Displacement => 1.0,
        SensorKind::Velocity => omega,
        SensorKind::Acceleration => omega * omega,
        // The surface is half of the thickness away from the neutral plane: strain = h/2 w''.
        SensorKind::Strain => plate.spec().model.bending().map_or(1.0, |bending| 0.5 * bending.thickness_m),
    };
    sensor.unit_per_response.unwrap_or(1.0) / per_metre
}
