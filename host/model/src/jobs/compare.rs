//! Compares a measurement with the model of a plate, in the background.

use crate::jobs::Task;
use slipline_plate::Plate;
use slipline_plate::calibrate::{CalibrateError, Comparison, Measurement};
use std::sync::Arc;

/// A plate and its measurement.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct CompareJob {
    /// The plate.
    #[serde(with = "slipline_plate::exchange::by_number")]
    pub plate: Arc<Plate>,
    /// The measurement.
    pub measurement: Arc<Measurement>,
}

impl PartialEq for CompareJob {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.plate, &other.plate) && Arc::ptr_eq(&self.measurement, &other.measurement)
    }
}

/// Their differences, or why they cannot be compared.
pub type Compared = Result<Comparison, CalibrateError>;

/// The work of the thread: some milliseconds.
#[must_use]
pub fn work(job: CompareJob, task: &Task) -> Option<Compared> {
    let result = Comparison::of(&job.plate, &job.measurement);
    task.report(1.0).then_some(result)
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_plate::Complex64;
    use slipline_plate::calibrate::{MeasuredPoint, SensorKind};

    #[test]
    fn a_sensor_beyond_the_plate_has_a_reason_and_a_cancelled_task_no_result() {
        let plate = Arc::new(slipline_plate::preset("membrane").unwrap());
        let point = |i: u32| MeasuredPoint {
            frequency_hz: 100.0 + f64::from(i),
            response: Complex64::ONE,
            noise: 0.01,
            headroom_db: None,
        };
        let job = |place_m| {
            let points = (0..10).map(point).collect();
            let measurement = Arc::new(Measurement::at(place_m, SensorKind::Velocity, points));
            CompareJob { plate: Arc::clone(&plate), measurement }
        };
        let task = Task::default();
        assert_eq!(work(job(0.1), &task).unwrap().unwrap().count, 10);
        let reason = work(job(0.5), &task).unwrap().unwrap_err();
        assert_eq!(reason.to_string(), "the sensor at 500.0 mm is beyond the plate's end at 320.0 mm");
        task.end();
        assert!(work(job(0.1), &task).is_none());
    }
}
