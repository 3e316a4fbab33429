//! The simulated device as a port of this computer.

use super::watch::Watch;
use crate::clock::Clock;
use crate::simulator::realtime::{RealtimeDevice, RealtimeLine};
use crate::simulator::{Options, SimulatedDevice, SimulatedInputs};
use crate::transport::Waker;
use std::sync::{Arc, Mutex};

impl Watch for RealtimeLine {}

/// Creates the inputs of a simulated device that is switched on.
pub(super) type Wiring = Box<dyn FnMut() -> Box<dyn SimulatedInputs> + Send>;

/// The simulated device of an opener. It is switched on at its first use and stays on.
pub(super) struct Simulated {
    device: Option<Arc<Mutex<RealtimeDevice>>>,
    options: Options,
    wiring: Option<Wiring>,
    clock: Clock,
}

impl Simulated {
    pub(super) const fn new(options: Options, wiring: Option<Wiring>, clock: Clock) -> Self {
        Self { device: None, options, wiring, clock }
    }

    pub(super) fn open(&mut self, waker: &Waker) -> RealtimeLine {
        let (options, wiring, clock) = (&self.options, &mut self.wiring, &self.clock);
        let device = self.device.get_or_insert_with(|| {
            let device = match wiring {
                Some(wiring) => SimulatedDevice::with_inputs(options.clone(), wiring()),
                None => SimulatedDevice::new(options.clone()),
            };
            Arc::new(Mutex::new(RealtimeDevice::new(device, clock.clone())))
        });
        RealtimeLine::new(device.clone(), waker.clone())
    }
}
