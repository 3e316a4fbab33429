//! Present state of the rig, shared by the device and its user.

use super::fault::RigFault;
use super::standing::Standing;
use std::fmt;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Present state of the rig.
#[derive(Clone, serde::Serialize, serde::Deserialize)]
pub(super) struct Bench {
    /// The mark where the sensor is placed, metres.
    pub(super) place_m: f64,
    /// The sensor at its present place.
    pub(super) standing: Standing,
    pub(super) fault: Option<RigFault>,
}

impl fmt::Debug for Bench {
    /// Omits the sensor's output of some thousand modes.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut debug = f.debug_struct("Bench");
        debug.field("place_m", &self.place_m).field("fault", &self.fault).finish_non_exhaustive()
    }
}

pub(super) fn lock(bench: &Mutex<Bench>) -> MutexGuard<'_, Bench> {
    // The state is complete at any time, even after a panic.
    bench.lock().unwrap_or_else(PoisonError::into_inner)
}
