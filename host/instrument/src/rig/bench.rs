//! The rig as it stands, shared by the device and the person at it.

use super::fault::RigFault;
use slipline_plate::Output;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The rig as it stands.
#[derive(Clone)]
pub(super) struct Bench {
    /// The sensor's mark, metres.
    pub(super) place_m: f64,
    /// What the sensor shows where it stands.
    pub(super) sensor: Arc<Output>,
    pub(super) fault: Option<RigFault>,
}

impl fmt::Debug for Bench {
    /// Without what the sensor shows of some thousand modes.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut debug = f.debug_struct("Bench");
        debug.field("place_m", &self.place_m).field("fault", &self.fault).finish_non_exhaustive()
    }
}

pub(super) fn lock(bench: &Mutex<Bench>) -> MutexGuard<'_, Bench> {
    // It is complete at any time, even after a panic.
    bench.lock().unwrap_or_else(PoisonError::into_inner)
}
