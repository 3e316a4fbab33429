//! The motion of the plate at the sensor's measured places, relative to its model, computed in the background.

use crate::field::steady_field::SteadyField;
use crate::jobs::Task;
use slipline_plate::Plate;
use slipline_plate::calibrate::{Comparison, Measurement};
use slipline_plate::quantity::from_decibels;
use std::sync::Arc;

/// A plate and its measurements.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct MeasuredPlacesJob {
    /// The plate.
    #[serde(with = "slipline_plate::exchange::by_number")]
    pub plate: Arc<Plate>,
    /// The measurements.
    pub measurements: Vec<Arc<Measurement>>,
}

impl PartialEq for MeasuredPlacesJob {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.plate, &other.plate)
            && self.measurements.iter().map(Arc::as_ptr).eq(other.measurements.iter().map(Arc::as_ptr))
    }
}

/// The plate at the place of a sensor.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct MeasuredPlace {
    /// The place, metres from the driven end.
    pub place_m: f64,
    /// Frequency in Hz, rising, and the measured amplitude over that of the model. That of an uncalibrated sensor is
    /// over its median.
    pub ratios: Vec<(f64, f64)>,
}

impl MeasuredPlace {
    /// The displacement at the place under the tones of this field of the plate's model, in metres, with the definition of
    /// the predicted envelope. `None` for a tone outside the measured band, and without tones.
    #[must_use]
    pub fn amplitude_m(&self, field: &SteadyField) -> Option<f64> {
        let squares = field.tones.iter().map(|wave| {
            let amplitude_m = wave.at(self.place_m / field.length_m).norm();
            Some((amplitude_m * self.ratio(wave.tone.frequency_hz)?).powi(2))
        });
        let sum: f64 = squares.sum::<Option<f64>>()?;
        (!field.tones.is_empty()).then(|| sum.sqrt())
    }

    /// The ratio at a frequency, linear between the measured ones.
    fn ratio(&self, frequency_hz: f64) -> Option<f64> {
        let after = self.ratios.iter().position(|(hz, _)| *hz >= frequency_hz)?;
        let (high_hz, high) = self.ratios[after];
        let Some((low_hz, low)) = after.checked_sub(1).map(|before| self.ratios[before]) else {
            return (high_hz == frequency_hz).then_some(high);
        };
        Some(low + (high - low) * (frequency_hz - low_hz) / (high_hz - low_hz))
    }
}

/// The places of the measurements that the model can be compared with. The work of the thread: some milliseconds for each
/// measurement.
#[must_use]
pub fn work(job: MeasuredPlacesJob, task: &Task) -> Option<Vec<MeasuredPlace>> {
    let mut places = Vec::new();
    for (i, measurement) in job.measurements.iter().enumerate() {
        if !task.report(i as f64 / job.measurements.len() as f64) {
            return None;
        }
        let Ok(comparison) = Comparison::of(&job.plate, measurement) else { continue };
        let ratios = measurement.points.iter().zip(&comparison.off_db);
        let ratios = ratios
            .filter_map(|(point, off_db)| off_db.map(|off_db| (point.frequency_hz, from_decibels(off_db))));
        places.push(MeasuredPlace { place_m: measurement.place_m, ratios: ratios.collect() });
    }
    task.report(1.0).then_some(places)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::steady_field::SteadyTone;
    use slipline_plate::Complex64;
    use slipline_plate::calibrate::{MeasuredPoint, SensorKind, predicted};

    /// A velocity sensor at this place of a plate; `unit` is its sensitivity.
    fn measured(plate: &Plate, place_m: f64, unit: f64) -> Measurement {
        let (low_hz, high_hz) = plate.band_hz();
        let point = |i: u32| MeasuredPoint {
            frequency_hz: low_hz + (high_hz - low_hz) * f64::from(i) / 60.0,
            response: Complex64::ONE,
            noise: 1e-9,
            headroom_db: None,
        };
        let mut sensor = Measurement::at(place_m, SensorKind::Velocity, (0..=60).map(point).collect());
        let seen = predicted(plate, &sensor).unwrap();
        for (point, seen) in sensor.points.iter_mut().zip(seen) {
            point.response = seen.unwrap() * unit;
        }
        sensor
    }

    #[test]
    fn a_plate_that_equals_its_model_lies_on_the_curve_and_another_off_it() {
        let model = Arc::new(slipline_plate::preset("membrane").unwrap());
        let other = model.with_wave_speed(1.03).unwrap();
        let frequency_hz = model.frequency_for_boundary_hz(0.18);
        let field = SteadyField::solve(&model, &[SteadyTone { slot: 0, frequency_hz, peak_m: 1e-4 }]);
        let off = |truth: &Plate, unit: f64| {
            let measurements =
                vec![Arc::new(measured(truth, 0.03, unit)), Arc::new(measured(truth, 0.15, unit))];
            let job = MeasuredPlacesJob { plate: Arc::clone(&model), measurements };
            let found = work(job, &Task::default()).unwrap();
            assert_eq!(found.len(), 2);
            let off = |place: &MeasuredPlace| {
                place.amplitude_m(&field).unwrap() / field.bound_at(place.place_m) - 1.0
            };
            found.iter().map(|place| off(place).abs()).fold(0.0, f64::max)
        };
        // The sensitivity of an uncalibrated sensor does not count.
        assert!(
            off(&model, 1.0) < 1e-6 && off(&model, 7.0) < 1e-6,
            "{} {}",
            off(&model, 1.0),
            off(&model, 7.0)
        );
        assert!(off(&other, 1.0) > 0.05, "{}", off(&other, 1.0));
    }

    #[test]
    fn a_tone_outside_the_measured_band_has_no_amplitude_and_a_sensor_beyond_the_plate_no_place() {
        let plate = Arc::new(slipline_plate::preset("membrane").unwrap());
        let place = MeasuredPlace { place_m: 0.1, ratios: vec![(100.0, 1.0), (120.0, 2.0)] };
        let field =
            |frequency_hz| SteadyField::solve(&plate, &[SteadyTone { slot: 0, frequency_hz, peak_m: 1e-4 }]);
        assert_eq!(place.amplitude_m(&field(99.0)), None);
        assert_eq!(place.amplitude_m(&field(121.0)), None);
        assert_eq!(place.amplitude_m(&SteadyField::default()), None);
        let at_110 = field(110.0);
        assert!((place.amplitude_m(&at_110).unwrap() / at_110.bound_at(0.1) - 1.5).abs() < 1e-9);
        let beyond = Measurement { place_m: 0.5, ..measured(&plate, 0.1, 1.0) };
        let job = MeasuredPlacesJob { plate: Arc::clone(&plate), measurements: vec![Arc::new(beyond)] };
        assert!(work(job, &Task::default()).unwrap().is_empty());
    }
}
