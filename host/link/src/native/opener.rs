//! Opens this computer's ports.

use super::serial;
use super::serial_ports::list_ports;
#[cfg(feature = "simulator")]
use super::simulated::Simulated;
use super::watch::Watch;
use crate::clock::Clock;
use crate::error::LinkError;
use crate::port::{Port, PortInfo};
#[cfg(feature = "simulator")]
use crate::simulator::{Options, SimulatedInputs};
use crate::transport::{Opener, Waker};
use std::sync::Arc;
use std::time::Instant;

/// The computer's monotonic clock, starting now.
#[must_use]
pub fn system_clock() -> Clock {
    let since = Instant::now();
    Arc::new(move || since.elapsed())
}

/// Opens ports of this computer. With the feature `simulator` it has the simulated device, too, which is switched on at its
/// first use and stays on.
pub struct SystemOpener {
    #[cfg(feature = "simulator")]
    simulated: Simulated,
}

impl Default for SystemOpener {
    fn default() -> Self {
        Self {
            #[cfg(feature = "simulator")]
            simulated: Simulated::new(Options::default(), None, system_clock()),
        }
    }
}

#[cfg(feature = "simulator")]
impl SystemOpener {
    /// As the default one, with a simulated device that runs by this clock.
    #[must_use]
    pub fn in_time_of(clock: Clock) -> Self {
        Self { simulated: Simulated::new(Options::default(), None, clock) }
    }

    /// As the default one, but its simulated device has these options and the inputs of `wiring`, which is called when the device is
    /// switched on.
    pub fn wired(
        options: Options,
        wiring: impl FnMut() -> Box<dyn SimulatedInputs> + Send + 'static,
    ) -> Self {
        Self { simulated: Simulated::new(options, Some(Box::new(wiring)), system_clock()) }
    }

    /// As the default one, with a simulated device of these options, for example with wires between its pins.
    #[must_use]
    pub fn with_options(options: Options) -> Self {
        Self { simulated: Simulated::new(options, None, system_clock()) }
    }
}

impl Opener for SystemOpener {
    type Transport = Box<dyn Watch>;

    fn list(&mut self) -> Vec<PortInfo> {
        list_ports()
    }

    #[cfg_attr(
        not(feature = "simulator"),
        expect(unused_variables, reason = "only the simulated device wakes the worker itself")
    )]
    fn open(&mut self, port: &Port, waker: &Waker) -> Result<Self::Transport, LinkError> {
        match port {
            #[cfg(feature = "simulator")]
            Port::Simulated => Ok(Box::new(self.simulated.open(waker))),
            #[cfg(not(feature = "simulator"))]
            Port::Simulated => Err(LinkError::Io("this program has no simulated device".to_owned())),
            Port::Serial(name) => Ok(Box::new(serial::open(name)?)),
            #[cfg(unix)]
            Port::Unix(path) => Ok(Box::new(super::socket::open(path)?)),
            #[cfg(not(unix))]
            Port::Unix(_) => Err(LinkError::Io("this system has no Unix sockets".to_owned())),
        }
    }
}
