//! Sensor responses predicted from the plate file: drive, wave and kind of sensor.

use super::sensor_body::rises;
use super::wave::{FINE, points, seen};
use crate::calibrate::error::CalibrateError;
use crate::calibrate::measurement::sensor::{Measurement, SensorKind};
use crate::calibrate::measurement::signal;
use crate::definition::Plate;
use crate::frequency::numerov::{self, Grid};
use crate::frequency::{Equation, respond_range};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// The response that the file of `plate` predicts at the place and frequencies of `sensor`, for its kind and in its
/// unit; for an uncalibrated sensor in metres, m/s, m/s^2 or strain over the DAC's amplitude. `None` at a frequency
/// whose wave does not enter the plate.
///
/// ```
/// use slipline_plate::Complex64;
/// use slipline_plate::calibrate::{MeasuredPoint, Measurement, SensorKind, predicted};
///
/// let plate = slipline_plate::preset("membrane").unwrap();
/// let point = |frequency_hz| MeasuredPoint {
///     frequency_hz,
///     response: Complex64::ONE,
///     noise: 0.01,
///     headroom_db: None,
/// };
/// let points = (0..8).map(|i| point(20.0 + 20.0 * f64::from(i))).collect();
/// let there = predicted(&plate, &Measurement::at(0.03, SensorKind::Displacement, points)).unwrap();
/// // The lowest frequencies are below the cut-off.
/// assert!(there[0].is_none() && there[7].is_some());
/// ```
///
/// # Errors
/// [`CalibrateError`]: a number of the measurement is out of its range, its place is beyond the plate, or the plate
/// has no strain.
pub fn predicted(plate: &Plate, sensor: &Measurement) -> Result<Vec<Option<Complex64>>, CalibrateError> {
    let predicted = predicted_beside_largest(plate, sensor)?;
    Ok(predicted.into_iter().map(|it| it.map(|(at, _)| at)).collect())
}

/// As [`predicted`], beside the magnitude that such a sensor would show where the wave is largest.
///
/// # Errors
/// As [`predicted`].
pub(crate) fn predicted_beside_largest(
    plate: &Plate,
    sensor: &Measurement,
) -> Result<Vec<Option<(Complex64, f64)>>, CalibrateError> {
    signal::check_place(plate, sensor)?;
    let allowed = respond_range(plate);
    let hertz = || sensor.points.iter().map(|point| point.frequency_hz);
    let entering: Vec<f64> = hertz().filter(|hertz| allowed.contains(*hertz)).collect();
    let Some(&highest_hz) = entering.last() else { return Ok(vec![None; sensor.points.len()]) };
    let count = points(plate.spec(), highest_hz, FINE);
    let grid = Grid::new(plate, Equation::Corrected, count, 1);
    let step_m = plate.length_m() / (count - 1) as f64;
    let mut found = Vec::with_capacity(entering.len());
    numerov::solve_each(&grid, plate, &entering, |number, field| {
        let hertz = entering[number];
        let before = plate.drive_response(hertz) * plate.spec().full_scale_m * sensor.hold_droop(hertz);
        let per_metre = per_metre(plate, sensor, hertz) / sensor.unit_per_response.unwrap_or(1.0);
        let bends = match sensor.sensor {
            SensorKind::Strain => plate.wavenumber_squared(hertz),
            _ => 1.0,
        };
        let largest = field.iter().map(Complex64::norm_sqr).fold(0.0, f64::max).sqrt() * bends;
        let at = before * seen(field, step_m, sensor.place_m, sensor.sensor) * per_metre;
        found.push((at, largest * (before * per_metre).norm()));
    });
    if let Some(body) = sensor.body() {
        let rises = rises(plate, body, sensor.place_m, &entering)?;
        found.iter_mut().zip(rises).for_each(|((found, _), rise)| *found /= rise);
    }
    let mut found = found.into_iter();
    Ok(hertz().map(|hertz| if allowed.contains(hertz) { found.next() } else { None }).collect())
}

/// The sensor's response over the deflection, or over the curvature for strain, with time as e^(-j omega t).
pub(crate) fn per_metre(plate: &Plate, sensor: &Measurement, frequency_hz: f64) -> Complex64 {
    let rise = sensor.sensor.rise(Complex64::new(0.0, -TAU * frequency_hz));
    if sensor.sensor != SensorKind::Strain {
        return rise;
    }
    // The surface is half of the thickness away from the neutral plane: strain = h/2 w''.
    rise * plate.spec().model.bending().map_or(f64::NAN, |bending| 0.5 * bending.thickness_m)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::measurement::sensor::MeasuredPoint;
    use crate::definition::preset;
    use crate::{PlateSpec, Resonator, respond};

    fn wanted(place_m: f64, sensor: SensorKind, frequencies_hz: &[f64]) -> Measurement {
        let point = |&frequency_hz: &f64| MeasuredPoint {
            frequency_hz,
            response: Complex64::ONE,
            noise: 1e-3,
            headroom_db: None,
        };
        Measurement::at(place_m, sensor, frequencies_hz.iter().map(point).collect())
    }

    /// Compared with the field of [`respond`], which has its own grid and refines the row of the boundary.
    #[test]
    fn a_sensor_shows_the_field_behind_actuator_and_hold_in_its_own_unit() {
        let actuator = Resonator { resonance_hz: 140.0, quality: 2.0, travel: None };
        for (name, frequencies_hz) in [
            ("membrane", [95.0, 100.0, 120.0, 130.0, 145.0, 150.0, 160.0, 170.0]),
            ("al-bending", [24e3, 26e3, 28e3, 30e3, 31e3, 32e3, 34e3, 36e3]),
        ] {
            let spec = preset(name).expect("a preset").spec().clone();
            let plate =
                Plate::new(PlateSpec { actuator: Some(crate::Actuator::Resonator(actuator)), ..spec });
            let plate = plate.expect("valid");
            let place_m = 0.25 * plate.length_m();
            for kind in [SensorKind::Displacement, SensorKind::Velocity, SensorKind::Acceleration] {
                let mut sensor = wanted(place_m, kind, &frequencies_hz);
                (sensor.sample_rate_hz, sensor.unit_per_response) = (Some(200e3), Some(4.0));
                let found = predicted(&plate, &sensor).expect("on the plate");
                for (&hertz, found) in frequencies_hz.iter().zip(found) {
                    let field = respond(&plate, hertz, 2001, Equation::Corrected).expect("a field");
                    let ratio = hertz / actuator.resonance_hz;
                    let moved = Complex64::new(1.0 - ratio * ratio, -ratio / actuator.quality).inv();
                    let half_turn = std::f64::consts::PI * hertz / 200e3;
                    let rate = Complex64::new(0.0, -TAU * hertz);
                    let power = SensorKind::ALL.iter().position(|it| *it == kind).expect("listed") as i32;
                    let deflection = field.amplitude[500] * moved * (half_turn.sin() / half_turn);
                    let wanted = deflection * plate.spec().full_scale_m * rate.powi(power) / 4.0;
                    let found = found.expect("enters");
                    assert!(
                        (found - wanted).norm() < 1e-4 * wanted.norm(),
                        "{name} {hertz}: {found} {wanted}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_place_beyond_the_plate_and_strain_of_a_membrane_are_refused() {
        let plate = preset("membrane").expect("a preset");
        let hertz = [95.0, 100.0, 120.0, 130.0, 145.0, 150.0, 160.0, 170.0];
        let refused = |place_m, kind| predicted(&plate, &wanted(place_m, kind, &hertz)).expect_err("refused");
        assert!(matches!(refused(0.4, SensorKind::Velocity), CalibrateError::BeyondPlate { .. }));
        assert_eq!(refused(0.1, SensorKind::Strain), CalibrateError::NoStrain);
        assert!(matches!(refused(f64::NAN, SensorKind::Velocity), CalibrateError::OutOfRange(_)));
    }
}
