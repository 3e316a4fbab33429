//! A simulated device behind a socket, for the tests of this folder.

use super::file;
use slipline_link::native::{Server, system_clock};
use slipline_link::simulator::realtime::RealtimeDevice;
use slipline_link::simulator::{Options, SimulatedDevice};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;

/// A simulated device behind a socket, until it is dropped.
pub(crate) struct Served {
    pub(crate) port: String,
    pub(crate) device: Arc<Mutex<RealtimeDevice>>,
    ended: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Served {
    pub(crate) fn new(name: &str, options: Options) -> Self {
        let path = file(name);
        let mut server = Server::at_socket(&path).unwrap();
        let ended = Arc::new(AtomicBool::new(false));
        let is_ended = Arc::clone(&ended);
        let device = RealtimeDevice::new(SimulatedDevice::new(options), system_clock());
        let device = Arc::new(Mutex::new(device));
        let served = Arc::clone(&device);
        let thread = std::thread::spawn(move || server.serve(served, &is_ended).unwrap());
        Self { port: format!("unix:{}", path.display()), device, ended, thread: Some(thread) }
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
