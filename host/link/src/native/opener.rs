//! Opens this computer's ports and the simulated device.

use super::serial;
use super::serial_ports::list_ports;
use super::watch::Watch;
use crate::error::LinkError;
use crate::port::{Port, PortInfo};
use crate::simulator::realtime::{Clock, RealtimeDevice, RealtimeLine};
use crate::simulator::{Options, SimulatedDevice, SimulatedInputs};
use crate::transport::{Opener, Waker};
use std::sync::{Arc, Mutex};
use std::time::Instant;

/// The computer's monotonic clock, starting now.
#[must_use]
pub fn system_clock() -> Clock {
    let since = Instant::now();
    Arc::new(move || since.elapsed())
}

impl Watch for RealtimeLine {}

/// Creates the inputs of a simulated device that is switched on.
type Wiring = Box<dyn FnMut() -> Box<dyn SimulatedInputs> + Send>;

/// Opens ports of this computer. The simulated device is switched on at its first use and stays on.
pub struct SystemOpener {
    simulated: Option<Arc<Mutex<RealtimeDevice>>>,
    wiring: Option<Wiring>,
    clock: Clock,
}

impl Default for SystemOpener {
    fn default() -> Self {
        Self::in_time_of(system_clock())
    }
}

impl SystemOpener {
    /// As the default one, with a simulated device that runs by this clock.
    #[must_use]
    pub const fn in_time_of(clock: Clock) -> Self {
        Self { simulated: None, wiring: None, clock }
    }

    /// As the default one, but its simulated device has the inputs of `wiring`, which is called when the
    /// device is switched on. The sample rate is that of [`Options::default`].
    pub fn with_inputs(wiring: impl FnMut() -> Box<dyn SimulatedInputs> + Send + 'static) -> Self {
        Self { wiring: Some(Box::new(wiring)), ..Self::default() }
    }
}

impl Opener for SystemOpener {
    type Transport = Box<dyn Watch>;

    fn list(&mut self) -> Vec<PortInfo> {
        list_ports()
    }

    fn open(&mut self, port: &Port, waker: &Waker) -> Result<Self::Transport, LinkError> {
        match port {
            Port::Simulated => {
                let (wiring, clock) = (&mut self.wiring, &self.clock);
                let device = self.simulated.get_or_insert_with(|| {
                    let device = match wiring {
                        Some(wiring) => SimulatedDevice::with_inputs(Options::default(), wiring()),
                        None => SimulatedDevice::new(Options::default()),
                    };
                    Arc::new(Mutex::new(RealtimeDevice::new(device, clock.clone())))
                });
                Ok(Box::new(RealtimeLine::new(device.clone(), waker.clone())))
            }
            Port::Serial(name) => Ok(Box::new(serial::open(name)?)),
            #[cfg(unix)]
            Port::Unix(path) => Ok(Box::new(super::socket::open(path)?)),
            #[cfg(not(unix))]
            Port::Unix(_) => Err(LinkError::Io("this system has no Unix sockets".to_owned())),
        }
    }
}
