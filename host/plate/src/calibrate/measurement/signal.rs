//! Refusals of a single measurement: its place, its kind, its signal.

use super::sensor::{MeasuredPoint, Measurement, SensorKind};
use crate::calibrate::error::CalibrateError;
use crate::definition::Plate;

/// Least signal-to-noise ratio of a response. The largest of 10 000 responses of noise alone is 4.3 times their
/// standard deviation.
pub(crate) const AUDIBLE: f64 = 6.0;
/// Refuses a measurement that does not belong to this plate: a place beyond it, or a strain on a plate without
/// bending.
pub(crate) fn check_place(plate: &Plate, sensor: &Measurement) -> Result<(), CalibrateError> {
    sensor.check()?;
    let place_m = sensor.place_m;
    if place_m > plate.length_m() {
        return Err(CalibrateError::BeyondPlate { place_m, length_m: plate.length_m() });
    }
    check_kind(plate, sensor.sensor)
}

/// Refuses a strain sensor on a plate without bending.
pub(crate) fn check_kind(plate: &Plate, kind: SensorKind) -> Result<(), CalibrateError> {
    if kind == SensorKind::Strain && plate.spec().model.bending().is_none() {
        return Err(CalibrateError::NoStrain);
    }
    Ok(())
}

/// Refuses such a measurement, and one without a signal or clipped.
pub(crate) fn check_sensor(plate: &Plate, sensor: &Measurement) -> Result<(), CalibrateError> {
    check_place(plate, sensor)?;
    let place_m = sensor.place_m;
    let clipped =
        sensor.points.iter().filter(|point| point.headroom_db.is_some_and(|headroom| headroom <= 0.0));
    match clipped.count() {
        0 => {}
        count => return Err(CalibrateError::Clipped { place_m, count, of: sensor.points.len() }),
    }
    let above = |point: &MeasuredPoint| point.response.norm() / point.noise;
    let loudest = sensor.points.iter().map(above).fold(0.0, f64::max);
    if loudest < AUDIBLE { Err(CalibrateError::NoSignal { place_m }) } else { Ok(()) }
}
