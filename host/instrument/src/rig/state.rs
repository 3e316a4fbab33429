//! What a person changes at a rig, for a copy of it in another worker of a browser.

use super::bench::{Bench, lock};
use super::prepared::PreparedRig;
use serde::{Deserialize, Serialize};

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
