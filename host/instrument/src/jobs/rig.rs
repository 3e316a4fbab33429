//! The rig of a simulated device, put together in the background: it takes up to a second.

use crate::rig::{PreparedRig, RigError, RigOptions};
use slipline_model::jobs::Task;
use slipline_plate::calibrate::SensorKind;
use slipline_plate::{Finger, Plate};
use std::sync::Arc;

/// A rig to put together.
#[derive(Clone, Debug)]
pub struct RigJob {
    /// The plate that is really there.
    pub truth: Arc<Plate>,
    /// What the sensor shows.
    pub sensor: SensorKind,
    /// Where it stands, metres from the driven end.
    pub place_m: f64,
    /// The device's sample rate in Hz.
    pub sample_rate_hz: f64,
    /// What the end of the input's range stands for, in the sensor's unit; `None` leaves room over what the plate does.
    pub full_scale: Option<f64>,
    /// A finger that rests on the plate.
    pub finger: Option<Finger>,
}

impl RigJob {
    /// Whether a rig of this job serves that one, too: only its sensor has to be moved.
    #[must_use]
    pub fn serves(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.truth, &other.truth)
            && self.sensor == other.sensor
            && self.sample_rate_hz == other.sample_rate_hz
            && self.finger == other.finger
    }
}

/// The result.
#[derive(Clone, Debug)]
pub struct RigPrepared {
    /// What was asked.
    pub job: RigJob,
    /// The rig, or why there is none.
    pub result: Result<PreparedRig, RigError>,
}

/// The work of the thread. It is not interrupted; `None` when the task was over before or after it.
#[must_use]
pub fn work(job: RigJob, task: &Task) -> Option<RigPrepared> {
    if !task.report(0.0) {
        return None;
    }
    let RigJob { place_m, sensor, full_scale, finger, .. } = job;
    let options = RigOptions { place_m, sensor, full_scale, finger, ..RigOptions::default() };
    let result = PreparedRig::new(&job.truth, &options, job.sample_rate_hz);
    task.report(1.0).then_some(RigPrepared { job, result })
}
