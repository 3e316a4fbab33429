//! The rig of a simulated device, put together in the background; this takes up to a second.

use crate::rig::{PreparedRig, RigError, RigOptions};
use slipline_model::jobs::Task;
use slipline_plate::calibrate::{SensorBody, SensorKind};
use slipline_plate::{Finger, Plate};
use std::sync::Arc;

/// A rig to put together.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct RigJob {
    /// The plate of the rig.
    #[serde(with = "slipline_plate::exchange::by_number")]
    pub truth: Arc<Plate>,
    /// The quantity that the sensor shows.
    pub sensor: SensorKind,
    /// Sensor place, metres from the driven end.
    pub place_m: f64,
    /// The device's sample rate in Hz.
    pub sample_rate_hz: f64,
    /// Sensor value at the end of the input's range, in the sensor's unit; `None` leaves headroom above the
    /// plate's response.
    pub full_scale: Option<f64>,
    /// A finger that rests on the plate.
    pub finger: Option<Finger>,
    /// What the sensor weighs.
    pub body: Option<SensorBody>,
}

impl RigJob {
    /// Whether a rig of this job can serve the other one by moving its sensor.
    #[must_use]
    pub fn serves(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.truth, &other.truth)
            && self.sensor == other.sensor
            && self.sample_rate_hz == other.sample_rate_hz
            && self.finger == other.finger
            && self.body == other.body
    }
}

/// The result.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct RigPrepared {
    /// The job.
    pub job: RigJob,
    /// The rig, or the error.
    pub result: Result<PreparedRig, RigError>,
}

/// The work of the thread. It cannot be interrupted; `None` if the task was cancelled before or during it.
#[must_use]
pub fn work(job: RigJob, task: &Task) -> Option<RigPrepared> {
    if !task.report(0.0) {
        return None;
    }
    let RigJob { place_m, sensor, full_scale, finger, body, .. } = job;
    let options = RigOptions { place_m, sensor, full_scale, finger, body, ..RigOptions::default() };
    let result = PreparedRig::new(&job.truth, &options, job.sample_rate_hz);
    task.report(1.0).then_some(RigPrepared { job, result })
}
