//! A calibration by two places of a sensor, in the background.

use crate::calibration::remedy::Remedy;
use slipline_model::jobs::Task;
use slipline_plate::Plate;
use slipline_plate::calibrate::{
    CalibrateError, Calibrated, Calipers, Departure, Measurement, Priors, departure, from_ratio,
};
use std::sync::Arc;

/// The share of the work that the fit is.
const FIT_SHARE: f64 = 0.9;

/// What is known of a plate, and what the sensor answered at two places of it.
#[derive(Clone, Debug)]
pub struct CalibrateJob {
    /// The plate as its file tells it.
    pub plate: Arc<Plate>,
    /// What calipers say of it.
    pub calipers: Option<Calipers>,
    /// The answers at the first and at the second place.
    pub sensors: [Arc<Measurement>; 2],
    /// The rate of the device whose table is judged, in Hz.
    pub sample_rate_hz: f64,
}

impl PartialEq for CalibrateJob {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.plate, &other.plate)
            && self.calipers == other.calipers
            && self.sensors.iter().zip(&other.sensors).all(|(a, b)| Arc::ptr_eq(a, b))
            && self.sample_rate_hz == other.sample_rate_hz
    }
}

/// The plate that comes of it.
#[derive(Clone, Debug)]
pub struct CalibrationResult {
    /// The plate with its intervals.
    pub calibrated: Calibrated,
    /// The same plate, as a setup holds it.
    pub plate: Arc<Plate>,
    /// What the table of the file would do on it.
    pub before: Departure,
}

/// Why there is none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refused {
    /// The reason.
    pub reason: String,
    /// What to do.
    pub remedy: Remedy,
}

/// The result.
#[derive(Clone, Debug)]
pub struct CalibrateDone {
    /// What was asked.
    pub job: CalibrateJob,
    /// The plate, or why there is none.
    pub result: Result<Arc<CalibrationResult>, Refused>,
}

/// The work of the thread. The fit is not interrupted; `None` when the task was over before or after it.
#[must_use]
pub fn work(job: CalibrateJob, task: &Task) -> Option<CalibrateDone> {
    if !task.report(0.0) {
        return None;
    }
    let result = calibrate(&job, task).transpose()?;
    let result = result.map(Arc::new).map_err(|error| {
        let remedy = Remedy::of(&error, [&job.sensors[0], &job.sensors[1]]);
        Refused { reason: error.to_string(), remedy }
    });
    task.report(1.0).then_some(CalibrateDone { job, result })
}

fn calibrate(job: &CalibrateJob, task: &Task) -> Result<Option<CalibrationResult>, CalibrateError> {
    let known = match job.calipers {
        Some(calipers) => calipers.applied_to(&job.plate)?,
        None => (Plate::clone(&job.plate), Priors::default()),
    };
    let calibrated = from_ratio(&known.0, [&job.sensors[0], &job.sensors[1]], &known.1)?;
    if !task.report(FIT_SHARE) {
        return Ok(None);
    }
    let before = departure(&job.plate, &calibrated.plate, job.sample_rate_hz)?;
    let plate = Arc::new(calibrated.plate.clone());
    Ok(Some(CalibrationResult { calibrated, plate, before }))
}
