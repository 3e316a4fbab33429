//! The real world's ports, and the simulated device among them.

use super::pace::{PacedDevice, PacedLine};
use super::simulated::{Options, SimulatedDevice};
use super::transport::{Opener, Transport, Waker};
use super::{Port, PortInfo, Trouble, list_ports, serial};
use std::sync::{Arc, Mutex};

/// Opens ports of this computer. The simulated device is powered at its first use and stays so.
#[derive(Default)]
pub struct SystemOpener {
    simulated: Option<Arc<Mutex<PacedDevice>>>,
}

impl Opener for SystemOpener {
    fn list(&mut self) -> Vec<PortInfo> {
        list_ports()
    }

    fn open(&mut self, port: &Port, waker: &Waker) -> Result<Box<dyn Transport>, Trouble> {
        match port {
            Port::Simulated => {
                let device = self.simulated.get_or_insert_with(|| {
                    Arc::new(Mutex::new(PacedDevice::new(SimulatedDevice::new(Options::default()))))
                });
                Ok(Box::new(PacedLine::new(device.clone(), waker.clone())))
            }
            Port::Serial(name) => Ok(Box::new(serial::open(name)?)),
            #[cfg(unix)]
            Port::Unix(path) => Ok(Box::new(super::socket::open(path)?)),
            #[cfg(not(unix))]
            Port::Unix(_) => Err(Trouble::Io("this system has no Unix sockets".to_owned())),
        }
    }
}
