//! Constant parts of a running rig.

use super::error::RigError;
use super::fault::RigFault;
use super::sampler::Signals;
use slipline_plate::calibrate::SensorKind;
use slipline_plate::{Output, SensedPlate};
use std::fmt;
use std::sync::Arc;

/// The computed parts of a rig.
#[derive(serde::Serialize, serde::Deserialize)]
pub(super) struct Parts {
    pub(super) plate: SensedPlate,
    /// The quantity that the sensor shows.
    pub(super) sensor: SensorKind,
    /// What a device samples.
    pub(super) signals: Arc<Signals>,
    /// The fraction of a sample of the sensor's delay, seconds.
    pub(super) late_s: f64,
}

impl fmt::Debug for Parts {
    /// Shows the plate by its name; the other fields are some thousand numbers.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut debug = f.debug_struct("Parts");
        debug.field("plate", &self.plate.plate().name()).field("sensor", &self.sensor).finish_non_exhaustive()
    }
}

impl Parts {
    /// The output of the sensor on a mark.
    pub(super) fn sensor_at(&self, place_m: f64, fault: Option<RigFault>) -> Result<Output, RigError> {
        let length_m = self.plate.plate().length_m();
        let off_m = match fault {
            Some(RigFault::OffItsMark(off_m)) if (0.0..=length_m).contains(&place_m) => off_m,
            _ => 0.0,
        };
        let stands_m = if off_m == 0.0 { place_m } else { (place_m + off_m).clamp(0.0, length_m) };
        Ok(self.plate.sensor(self.sensor, stands_m, self.late_s)?)
    }
}
