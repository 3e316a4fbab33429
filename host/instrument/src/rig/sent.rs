//! A rig on its way to another worker of a browser: what was computed is sent, so that nothing is computed for long there.

use super::bench::{Bench, lock};
use super::parts::Parts;
use super::prepared::PreparedRig;
use serde::{Deserialize, Serialize};
use std::sync::{Arc, Mutex};

/// The parts of a rig, and the state of its bench.
#[derive(Serialize, Deserialize)]
pub(super) struct SentRig(Arc<Parts>, Bench);

impl From<PreparedRig> for SentRig {
    fn from(rig: PreparedRig) -> Self {
        let bench = lock(&rig.bench).clone();
        Self(rig.parts, bench)
    }
}

impl From<SentRig> for PreparedRig {
    fn from(SentRig(parts, bench): SentRig) -> Self {
        Self { parts, bench: Arc::new(Mutex::new(bench)) }
    }
}

/// Where the sensor of a rig stands, and the rig's fault.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RigState(Bench);

impl PartialEq for RigState {
    fn eq(&self, other: &Self) -> bool {
        // The sensor's signal follows from both.
        self.0.place_m == other.0.place_m && self.0.fault == other.0.fault
    }
}

impl PreparedRig {
    /// Where the sensor stands, and the fault.
    #[must_use]
    pub fn state(&self) -> RigState {
        RigState(lock(&self.bench).clone())
    }

    /// Takes over the state of another copy of this rig.
    pub fn set_state(&self, RigState(state): RigState) {
        *lock(&self.bench) = state;
    }
}
