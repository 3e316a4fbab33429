//! The measured responses to which plate and source are fitted.

use crate::calibrate::error::CalibrateError;
use crate::calibrate::fit::acceptance::check_count;
use crate::calibrate::fit::response::plate_response::Units;
use crate::calibrate::measurement::sensor::{MeasuredPoint, Measurement};
use crate::definition::Plate;
use crate::frequency::respond_range;
use num_complex::Complex64;

/// A response without the zero-order hold and the sensor's own factor, over the root mean square of all.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Datum {
    pub(crate) response: Complex64,
    /// Variance of the real part and of the imaginary part.
    pub(crate) variance: f64,
}

impl Datum {
    /// Standard deviation of each part by noise and model error.
    pub(crate) fn deviation(&self, model_error: f64) -> f64 {
        (self.variance + model_error * model_error * self.response.norm_sqr()).sqrt()
    }

    /// That deviation over the response's magnitude.
    pub(crate) fn relative(&self, model_error: f64) -> f64 {
        self.deviation(model_error) / self.response.norm().max(1e-300)
    }
}

/// The responses without the sensor's own factor and the hold of the DAC.
pub(crate) fn of_deflection(points: &[MeasuredPoint], sensor: &Measurement, units: Units) -> Vec<Datum> {
    normalised(points, |hz| sensor.sensor.rise(units.rate(hz)) * sensor.hold_droop(hz))
}

/// The points of a measurement whose wave enters the plate.
pub(crate) fn entering(plate: &Plate, sensor: &Measurement) -> Result<Vec<MeasuredPoint>, CalibrateError> {
    let allowed = respond_range(plate);
    let points: Vec<MeasuredPoint> =
        sensor.points.iter().copied().filter(|point| allowed.contains(point.frequency_hz)).collect();
    check_count(points.len())?;
    Ok(points)
}

/// The responses over `rise`, divided by their root mean square.
pub(crate) fn normalised(points: &[MeasuredPoint], rise: impl Fn(f64) -> Complex64) -> Vec<Datum> {
    let plain = points.iter().map(|point| {
        let rise = rise(point.frequency_hz);
        (point.response / rise, point.noise / rise.norm())
    });
    let plain: Vec<(Complex64, f64)> = plain.collect();
    let square = plain.iter().map(|(response, _)| response.norm_sqr()).sum::<f64>() / plain.len() as f64;
    let scale = square.sqrt().max(1e-300);
    let datum = |(response, noise): &(Complex64, f64)| Datum {
        response: response / scale,
        variance: (noise / scale).powi(2),
    };
    plain.iter().map(datum).collect()
}
