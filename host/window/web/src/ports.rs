//! The ports of a page: the simulated device, switched on at its first use, and boards by Web Serial.

use crate::clock::now;
use crate::serial::Boards;
use slipline_instrument::bench::Bench;
use slipline_link::simulator::realtime::{RealtimeDevice, RealtimeLine};
use slipline_link::simulator::{Options, SimulatedDevice};
use slipline_link::transport::{Opener, Transport, Waker};
use slipline_link::{LinkError, Port, PortInfo};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::Duration;

/// While a plate is computed with the codes, the simulated device renders this often, and not only at commands: a keep-alive
/// alone would render a fifth of a second at once, in which the worker receives no STOP.
const RENDERS_EACH: Duration = Duration::from_millis(20);

/// The ports; clones are the same ones.
#[derive(Clone, Default)]
pub(crate) struct PagePorts {
    device: Arc<OnceLock<Arc<Mutex<RealtimeDevice>>>>,
    /// What the simulated device's inputs are wired to.
    pub(crate) bench: Bench,
    pub(crate) boards: Boards,
}

impl PagePorts {
    /// The ports that the browser lets this page open, the simulated device first.
    pub(crate) fn with_simulated(boards: Vec<PortInfo>) -> Vec<PortInfo> {
        std::iter::once(PortInfo::simulated()).chain(boards).collect()
    }

    /// Has the simulated device render what is due if that takes long. Returns how soon it is due again.
    pub(crate) fn render_due(&self) -> Option<Duration> {
        let device = self.device.get().filter(|_| self.bench.is_heard())?;
        device.lock().unwrap_or_else(PoisonError::into_inner).catch_up();
        Some(RENDERS_EACH)
    }
}

impl Opener for PagePorts {
    type Transport = Box<dyn Transport>;

    fn list(&mut self) -> Vec<PortInfo> {
        Self::with_simulated(self.boards.list())
    }

    fn open(&mut self, port: &Port, waker: &Waker) -> Result<Self::Transport, LinkError> {
        if *port != Port::Simulated {
            return Ok(Box::new(self.boards.open(port)?));
        }
        let device = self.device.get_or_init(|| {
            let device = SimulatedDevice::with_inputs(Options::default(), self.bench.inputs());
            Arc::new(Mutex::new(RealtimeDevice::new(device, Arc::new(now))))
        });
        Ok(Box::new(RealtimeLine::new(Arc::clone(device), waker.clone())))
    }
}
