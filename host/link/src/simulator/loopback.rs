//! Link and simulated device in virtual time: requests in, DAC codes out. It uses the worker's state machine
//! and the device application of the firmware; nothing is implemented twice.
//!
//! ```text
//! Request -> Connection == bytes ==> SimulatedDevice -> DAC codes -> sink
//! ```
//! The time is the number of rendered samples, so the same requests give the same codes in every run.

use super::device::{Options, SimulatedDevice};
use super::peripherals::MemoryFlash;
use crate::connection::Connection;
use crate::error::LinkError;
use crate::port::{Port, PortInfo};
use crate::refusal::Refusal;
use crate::request::{Outcome, Request, Ticket};
use crate::snapshot::Snapshot;
use crate::sounding::Sounding;
use crate::table::DeviceTable;
use crate::transport::{Opener, Transport, Waker, read_received};
use slipline_app::BLOCK;
use std::io;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Blocks that a request may take: 20 s at 400 kS/s. A longer time indicates an error.
const PATIENCE_BLOCKS: u64 = 62_500;

/// Why the loopback did not carry out a request.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LoopbackError {
    /// The device or the link refused.
    #[error(transparent)]
    Refused(#[from] Refusal),
    /// The request was dropped or never ended.
    #[error("the simulated device did not answer")]
    NoAnswer,
}

type Shared = Arc<Mutex<SimulatedDevice>>;

fn lock(device: &Shared) -> MutexGuard<'_, SimulatedDevice> {
    device.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A link and a simulated device in virtual time.
///
/// ```
/// use slipline_link::Request;
/// use slipline_link::simulator::loopback::Loopback;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let mut loopback = Loopback::connect(400_000)?;
/// // A second of codes, in blocks of 128; the device is armed and silent.
/// let mut codes = 0;
/// loopback.pass(400_000, |block| codes += block.len());
/// assert_eq!(codes, 400_000);
/// loopback.perform(Request::Stop, |_| ())?;
/// # Ok(())
/// # }
/// ```
pub struct Loopback {
    connection: Connection<OneDevice>,
    device: Shared,
    tickets: u64,
    blocks: u64,
}

impl Loopback {
    /// A connected, armed device with samples at this rate in Hz.
    ///
    /// # Errors
    /// [`LoopbackError`] if the device cannot be armed.
    pub fn connect(sample_rate_hz: u32) -> Result<Self, LoopbackError> {
        Self::connect_to(SimulatedDevice::new(Options { sample_rate_hz, ..Options::default() }))
    }

    /// The same with a device that has a past: a table in its flash, or a warm coil.
    ///
    /// # Errors
    /// [`LoopbackError`] if the device cannot be armed.
    pub fn connect_to(device: SimulatedDevice) -> Result<Self, LoopbackError> {
        let device = Arc::new(Mutex::new(device));
        let opener = OneDevice(device.clone());
        // One session of one device: any nonce is unique.
        let connection = Connection::new(opener, Waker::new(|| ()), Box::new(|| *b"sim0"));
        let mut loopback = Self { connection, device, tickets: 0, blocks: 0 };
        loopback.perform(Request::Connect(Port::Simulated), |_| ())?;
        loopback.perform(Request::Arm, |_| ())?;
        Ok(loopback)
    }

    /// The link's state.
    #[must_use]
    pub const fn view(&self) -> &Snapshot {
        self.connection.view()
    }

    /// Samples rendered so far.
    #[must_use]
    pub const fn samples(&self) -> u64 {
        self.blocks * BLOCK as u64
    }

    /// Sends a request and advances time until it is done; returns the index from which it takes effect.
    /// `sink` receives the codes of that time.
    ///
    /// # Errors
    /// [`LoopbackError`] if it is refused or does not end.
    pub fn perform(&mut self, request: Request, mut sink: impl FnMut(&[u16])) -> Result<u64, LoopbackError> {
        let ticket = self.hand_over(request);
        for _ in 0..PATIENCE_BLOCKS {
            self.pass_block(&mut sink);
            match self.connection.view().outcome(ticket) {
                None => {}
                Some(Outcome::Done { at }) => return Ok(*at),
                Some(Outcome::Refused(refusal)) => return Err(refusal.clone().into()),
                Some(Outcome::Digest(digest)) => return Ok(digest.from),
                Some(Outcome::Listened(listened)) => return Ok(listened.begin),
                Some(Outcome::Captured(captured)) => return Ok(captured.from),
                Some(Outcome::DeviceTooOld | Outcome::Superseded | Outcome::NotConnected) => {
                    return Err(LoopbackError::NoAnswer);
                }
            }
        }
        Err(LoopbackError::NoAnswer)
    }

    /// Makes the device hold this table.
    ///
    /// # Errors
    /// [`LoopbackError`], as for every request.
    pub fn use_table(&mut self, table: Arc<DeviceTable>) -> Result<(), LoopbackError> {
        self.perform(Request::Upload(table), |_| ()).map(drop)
    }

    /// Plays this; returns the index at which it begins. `sink` receives the codes until then.
    ///
    /// # Errors
    /// [`LoopbackError`], as for every request.
    pub fn play(
        &mut self,
        sounding: impl Into<Sounding>,
        sink: impl FnMut(&[u16]),
    ) -> Result<u64, LoopbackError> {
        self.perform(Request::Play(sounding.into()), sink)
    }

    /// Disarms the device, which otherwise does not write its flash, and stores its table there.
    ///
    /// # Errors
    /// [`LoopbackError`], as for every request.
    pub fn store(&mut self) -> Result<(), LoopbackError> {
        self.perform(Request::Disarm, |_| ())?;
        self.perform(Request::Store, |_| ()).map(drop)
    }

    /// Sends a request; [`Loopback::pass`] advances time until it is done, and the view has its outcome.
    pub fn hand_over(&mut self, request: Request) -> Ticket {
        self.tickets += 1;
        let ticket = Ticket(self.tickets);
        let now = self.now();
        self.connection.request(ticket, request, now);
        ticket
    }

    /// Drops the next `blocks` blocks that the device's inputs sample.
    pub fn inject_overrun(&mut self, blocks: u32) {
        lock(&self.device).inject_overrun(blocks);
    }

    /// Raises the device's trigger input briefly.
    pub fn raise_trigger(&mut self) {
        lock(&self.device).raise_trigger();
    }

    /// The present content of the device's flash.
    #[must_use]
    pub fn flash(&self) -> MemoryFlash {
        lock(&self.device).flash()
    }

    /// Advances time by this number of samples (rounded up to blocks); `sink` receives their codes.
    pub fn pass(&mut self, samples: u64, mut sink: impl FnMut(&[u16])) {
        for _ in 0..samples.div_ceil(BLOCK as u64) {
            self.pass_block(&mut sink);
        }
    }

    fn pass_block(&mut self, sink: &mut impl FnMut(&[u16])) {
        self.connection.step(self.now());
        lock(&self.device).advance(1, |block| sink(block.codes));
        self.blocks += 1;
    }

    fn now(&self) -> Duration {
        let rate = u64::from(lock(&self.device).sample_rate_hz());
        // Fits for 58 000 years at 400 kS/s.
        Duration::from_nanos((u128::from(self.samples()) * 1_000_000_000 / u128::from(rate.max(1))) as u64)
    }
}

/// An opener of one device, for any port.
struct OneDevice(Shared);

impl Opener for OneDevice {
    type Transport = Line;

    fn list(&mut self) -> Vec<PortInfo> {
        vec![PortInfo::simulated()]
    }

    fn open(&mut self, _port: &Port, _waker: &Waker) -> Result<Line, LinkError> {
        Ok(Line { device: self.0.clone(), received: Vec::new() })
    }
}

struct Line {
    device: Shared,
    received: Vec<u8>,
}

impl Transport for Line {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        lock(&self.device).take(&mut self.received);
        read_received(&mut self.received, buffer)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        lock(&self.device).feed(bytes);
        Ok(bytes.len())
    }
}
