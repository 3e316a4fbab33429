//! What the inputs of the simulated device are wired to: the rig that was put together last. Without one they show nothing.

use slipline_link::simulator::SimulatedInputs;
use slipline_model::rig::PreparedRig;
use std::sync::{Arc, Mutex, PoisonError};

/// Mid-scale of an input.
const SILENCE: u16 = 2048;

/// The place of the rig. Cloning is cheap: all clones have one rig.
#[derive(Clone, Default)]
pub struct Bench(Arc<Mutex<Option<Box<dyn SimulatedInputs>>>>);

impl Bench {
    /// The inputs of a simulated device at this bench.
    #[must_use]
    pub fn inputs(&self) -> Box<dyn SimulatedInputs> {
        Box::new(Wires(self.clone()))
    }

    /// Puts another rig in the place of the present one; it is at rest.
    pub fn put(&self, rig: &PreparedRig) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(rig.inputs());
    }
}

/// Wires from the bench to the device.
struct Wires(Bench);

impl SimulatedInputs for Wires {
    fn inputs(&self) -> usize {
        2
    }

    fn delay_ns(&self) -> i32 {
        // What every rig states.
        0
    }

    fn sample(&mut self, codes: &[u16; 128], muted: bool, sensed: &mut [[u16; 128]; 2]) {
        match &mut *self.0.0.lock().unwrap_or_else(PoisonError::into_inner) {
            Some(rig) => rig.sample(codes, muted, sensed),
            None => *sensed = [[SILENCE; 128]; 2],
        }
    }
}
