//! A calibration from two places of a sensor, or from two and a third as a check, in the background.

use crate::calibration::name::named_calibrated;
use crate::calibration::remedy::Remedy;
use crate::calipers::with_calipers;
use slipline_model::jobs::Task;
use slipline_plate::Plate;
use slipline_plate::calibrate::{
    CalibrateError, Calibrated, Calipers, Departure, Measurement, departure, from_checked_ratio, from_ratio,
};
use std::sync::Arc;

/// Share of the fit in the progress.
const FIT_SHARE: f64 = 0.9;

/// Known dimensions of a plate, and the sensor's responses at two places.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct CalibrateJob {
    /// The plate as its file states it.
    #[serde(with = "slipline_plate::exchange::by_number")]
    pub plate: Arc<Plate>,
    /// Its caliper measurements.
    pub calipers: Option<Calipers>,
    /// The responses at the first and at the second place.
    pub sensors: [Arc<Measurement>; 2],
    /// The response at the third place, as a check.
    pub check: Option<Arc<Measurement>>,
    /// Sample rate of the device whose table is judged, in Hz.
    pub sample_rate_hz: f64,
}

impl PartialEq for CalibrateJob {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.plate, &other.plate)
            && self.calipers == other.calipers
            && self.sensors.iter().zip(&other.sensors).all(|(a, b)| Arc::ptr_eq(a, b))
            && self.check.as_ref().map(Arc::as_ptr) == other.check.as_ref().map(Arc::as_ptr)
            && self.sample_rate_hz == other.sample_rate_hz
    }
}

/// The calibrated plate.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct CalibrationResult {
    /// The plate with its intervals.
    pub calibrated: Calibrated,
    /// The same plate, as a setup holds it.
    #[serde(with = "slipline_plate::exchange::by_number")]
    pub plate: Arc<Plate>,
    /// Errors of the file's table on the calibrated plate.
    pub before: Departure,
}

/// A refused calibration.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Refused {
    /// The reason.
    pub reason: String,
    /// What to do.
    pub remedy: Remedy,
}

/// The calibrated plate, or why it was refused.
pub type CalibrateDone = Result<Arc<CalibrationResult>, Refused>;

/// The work of the thread. The fit cannot be interrupted; `None` if the task was cancelled before or during
/// it.
#[must_use]
pub fn work(job: CalibrateJob, task: &Task) -> Option<CalibrateDone> {
    if !task.report(0.0) {
        return None;
    }
    let result = calibrate(&job, task).transpose()?;
    let result = result.map(Arc::new).map_err(|error| {
        let remedy = Remedy::of(&error, [&job.sensors[0], &job.sensors[1]], job.check.as_deref());
        Refused { reason: error.to_string(), remedy }
    });
    task.report(1.0).then_some(result)
}

fn calibrate(job: &CalibrateJob, task: &Task) -> Result<Option<CalibrationResult>, CalibrateError> {
    let (nominal, priors) = with_calipers(&job.plate, job.calipers)?;
    let sensors = [&*job.sensors[0], &*job.sensors[1]];
    let calibrated = match &job.check {
        Some(check) => from_checked_ratio(&nominal, sensors, check, &priors)?,
        None => from_ratio(&nominal, sensors, &priors)?,
    };
    if !task.report(FIT_SHARE) {
        return Ok(None);
    }
    let before = departure(&job.plate, &calibrated.plate, job.sample_rate_hz)?;
    let plate = Arc::new(named_calibrated(&calibrated.plate));
    Ok(Some(CalibrationResult { calibrated, plate, before }))
}
