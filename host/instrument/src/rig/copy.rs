//! A copy of a rig beside its device, in another worker of a browser: what the device samples is sent there once, and then
//! what a person changes. All that takes long is computed on this side.

use super::bench::{Bench, lock};
use super::prepared::PreparedRig;
use super::sampler::{Sampler, Signals};
use serde::{Deserialize, Serialize};
use slipline_link::simulator::SimulatedInputs;
use std::sync::{Arc, Mutex};

/// The part of a rig that a device samples: some kilobytes of the megabytes by which a person moves its sensor.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RigCopy {
    signals: Arc<Signals>,
    bench: Arc<Mutex<Bench>>,
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
    /// The part that a device samples.
    #[must_use]
    pub fn copy(&self) -> RigCopy {
        RigCopy { signals: Arc::clone(&self.parts.signals), bench: Arc::clone(&self.bench) }
    }
}

impl RigCopy {
    /// The inputs of a device that is wired to it: its plate is at rest.
    #[must_use]
    pub fn inputs(&self) -> Box<dyn SimulatedInputs> {
        Box::new(Sampler::new(Arc::clone(&self.signals), Arc::clone(&self.bench)))
    }

    /// Where the sensor stands, and the fault.
    #[must_use]
    pub fn state(&self) -> RigState {
        RigState(lock(&self.bench).clone())
    }

    /// Takes over the state of the rig that this is a copy of.
    pub(crate) fn set_state(&self, RigState(state): RigState) {
        *lock(&self.bench) = state;
    }
}
