//! A rig for the host's link: the link in virtual time, on ports with a simulated device and injected faults.

use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use slipline_link::DeviceTable;
use slipline_link::connection::Connection;
use slipline_link::simulator::{Options, SimulatedDevice};
use slipline_link::transport::Waker;
use slipline_link::{
    DriveRequest, LinkState, Outcome, Port, Request, Snapshot, Sounding, Ticket, ToneRequest,
};
use slipline_protocol::event::State;
use slipline_protocol::limits::{MAX_RETRIES, REPLY_TIMEOUT_MS};

use crate::faulty_ports::{FaultyPorts, PortsOpener, SharedPorts, lock};
use crate::rig::{BLOCK, MID};

/// The host's link on [`FaultyPorts`], in virtual time.
pub struct LinkRig {
    /// The link.
    pub connection: Connection<PortsOpener>,
    /// The ports, the device behind them and the faults to inject.
    pub ports: SharedPorts,
    /// The virtual time since the start.
    pub now: Duration,
    tickets: u64,
    /// The link's states in the order in which they were entered; a state that stays is listed once.
    pub states: Vec<LinkState>,
    /// How often the link was called.
    pub steps: u64,
    /// Whether the program that drives answers when it is asked for a sign of life; see [`LinkRig::watched`].
    pub is_driver_alive: bool,
    /// How often it was asked.
    pub signs_wanted: u64,
    /// The codes that the device has sent since [`LinkRig::record`], with the index of the first one.
    recording: Option<(u64, Vec<u16>)>,
}

impl Default for LinkRig {
    fn default() -> Self {
        Self::new()
    }
}

impl LinkRig {
    /// Not connected yet.
    #[must_use]
    pub fn new() -> Self {
        Self::of(FaultyPorts::default())
    }

    fn of(ports: FaultyPorts) -> Self {
        let ports = Arc::new(Mutex::new(ports));
        let mut nonce = 0u32;
        let nonces = Box::new(move || {
            nonce += 1;
            nonce.to_le_bytes()
        });
        let connection = Connection::new(PortsOpener(ports.clone()), Waker::new(|| ()), nonces);
        Self {
            connection,
            ports,
            now: Duration::ZERO,
            tickets: 0,
            states: Vec::new(),
            steps: 0,
            is_driver_alive: true,
            signs_wanted: 0,
            recording: None,
        }
    }

    /// Connected.
    #[must_use]
    pub fn connected() -> Self {
        Self::new().connect()
    }

    /// Connected, with a table, armed.
    #[must_use]
    pub fn armed() -> Self {
        Self::connected().arm()
    }

    /// The same with another sample rate in Hz: at a low rate hours of virtual time are computed quickly.
    #[must_use]
    pub fn armed_at(sample_rate_hz: u32) -> Self {
        Self::armed_as(Options { sample_rate_hz, ..Options::default() })
    }

    /// The same with a device of these options.
    #[must_use]
    pub fn armed_as(options: Options) -> Self {
        let device = SimulatedDevice::new(options);
        Self::of(FaultyPorts { device, ..FaultyPorts::default() }).connect().arm()
    }

    /// Asks for something, and lets time pass.
    pub fn ask_and_pass(&mut self, request: Request, milliseconds: u64) -> Ticket {
        let ticket = self.ask(request);
        self.pass_ms(milliseconds);
        ticket
    }

    /// Asks for something that must be done within this time.
    ///
    /// # Panics
    /// If it is not.
    pub fn done(&mut self, request: Request, milliseconds: u64) {
        let ticket = self.ask_and_pass(request, milliseconds);
        let outcome = self.outcome(ticket);
        assert!(matches!(outcome, Some(Outcome::Done { .. })), "{outcome:?}");
    }

    /// Connects to the port A.
    ///
    /// # Panics
    /// If nothing answers there.
    #[must_use]
    pub fn connect(mut self) -> Self {
        let ticket = self.ask(Request::Connect(Port::Serial("A".to_owned())));
        self.pass_ms(100);
        assert!(matches!(self.outcome(ticket), Some(Outcome::Done { .. })));
        assert_eq!(self.view().link.state, LinkState::Connected);
        self
    }

    /// Puts a table on the device and arms it.
    ///
    /// # Panics
    /// If the device takes neither.
    #[must_use]
    pub fn arm(mut self) -> Self {
        let knots = (0..100).map(|i| (100.0 + f64::from(i), 0.5));
        let rate = f64::from(self.ports().device.sample_rate_hz());
        let table = DeviceTable::from_knots((0.0, 0.1), rate, knots, 1e-6).unwrap();
        let upload = self.ask(Request::Upload(Arc::new(table)));
        let arm = self.ask(Request::Arm);
        // At the lowest rates a block takes long.
        self.pass_ms(1000);
        assert!(matches!(self.outcome(upload), Some(Outcome::Done { .. })));
        assert_eq!(self.view().table.upload_verified, Some(true));
        assert!(matches!(self.outcome(arm), Some(Outcome::Done { .. })));
        self
    }

    /// With a link that wants signs of life from the program that drives, as the worker's does.
    #[must_use]
    pub fn watched(mut self) -> Self {
        self.connection.watch_driver();
        self
    }

    /// Keeps every code that the device sends from now on.
    pub fn record(&mut self) {
        let first = self.ports().device.now();
        self.recording = Some((first, Vec::new()));
    }

    /// The codes of a window that the device has sent since [`LinkRig::record`].
    #[must_use]
    pub fn sent(&self, from: u64, count: u32) -> &[u16] {
        let (first, codes) = self.recording.as_ref().expect("record() was called");
        &codes[(from - first) as usize..][..count as usize]
    }

    /// The ports, locked: their device and the faults to inject.
    pub fn ports(&self) -> MutexGuard<'_, FaultyPorts> {
        lock(&self.ports)
    }

    /// The snapshot that the link publishes.
    pub fn view(&self) -> &Snapshot {
        self.connection.view()
    }

    /// Hands a request over and lets the link work.
    pub fn ask(&mut self, request: Request) -> Ticket {
        let ticket = self.only_ask(request);
        self.step();
        ticket
    }

    /// Hands a request over without letting the link work.
    pub fn only_ask(&mut self, request: Request) -> Ticket {
        self.tickets += 1;
        self.connection.request(Ticket(self.tickets), request, self.now);
        Ticket(self.tickets)
    }

    /// Calls the link, as its waker does.
    pub fn step(&mut self) {
        self.connection.step(self.now);
        self.steps += 1;
        if self.connection.take_sign_wanted() {
            self.signs_wanted += 1;
            if self.is_driver_alive {
                self.connection.sign_of_life(self.now);
            }
        }
        let link = self.view().link.state.clone();
        if self.states.last() != Some(&link) {
            self.states.push(link);
        }
    }

    /// Lets the device and the link go on; the link is called only when it asks for it, or bytes have come.
    pub fn pass_ms(&mut self, milliseconds: u64) {
        for _ in 0..milliseconds {
            self.advance(Duration::from_millis(1));
            let is_due = self.connection.deadline(self.now).is_some_and(|due| due <= self.now);
            let has_answered = self.ports().error.is_none();
            if is_due || (has_answered && self.connection.is_open()) {
                self.step();
            }
        }
    }

    /// The host's computer sleeps: the device goes on by itself. Returns whether anything sounded at the end.
    pub fn sleep(&mut self, time: Duration) -> bool {
        let last = Duration::from_secs(1);
        self.advance(time - last);
        self.advance(last)
    }

    /// Lets the device go on; returns whether anything sounded.
    fn advance(&mut self, time: Duration) -> bool {
        let mut ports = lock(&self.ports);
        let rate = u128::from(ports.device.sample_rate_hz());
        let blocks_until =
            |time: Duration| (time.as_micros() * rate / (1_000_000 * u128::from(BLOCK))) as u64;
        let blocks = blocks_until(self.now + time) - blocks_until(self.now);
        self.now += time;
        let mut sounds = false;
        if ports.is_stalled {
            return false;
        }
        let recording = &mut self.recording;
        ports.device.advance(blocks, |block| {
            sounds |= !block.muted || *block.codes != [MID; BLOCK as usize];
            if let Some((_, codes)) = recording {
                codes.extend(block.codes);
            }
        });
        sounds
    }

    /// How a request ended, if it has.
    pub fn outcome(&self, ticket: Ticket) -> Option<Outcome> {
        self.view().outcome(ticket).cloned()
    }

    /// The device's state, as the link knows it.
    pub fn state(&self) -> State {
        self.view().drive.status.unwrap().state
    }
}

/// A request for one tone with its boundary there, in metres.
#[must_use]
pub fn drive(boundary_m: f64) -> Request {
    Request::Play(Sounding::Drive(DriveRequest::of(vec![ToneRequest {
        slot: 0,
        boundary_m,
        level: 0.5,
        phase_turns: 0.0,
    }])))
}

/// Time until a device that answers no more is lost, in milliseconds.
pub const LOST_AFTER_MS: u64 = (REPLY_TIMEOUT_MS * (MAX_RETRIES + 1)) as u64;
