//! A board on a desk in virtual time: a simulated device with wires and faults, and the link to it.

use crate::pluggable_port::read_from;
use slipline_instrument::measure::{MeasureError, Prompt, Run};
use slipline_instrument::selftest::{SelftestReport, SelftestRequest, Selftesting, Verdict, step};
use slipline_link::connection::Connection;
use slipline_link::protocol::event::ResetCause;
use slipline_link::protocol::version::Minor;
use slipline_link::protocol::{Decoder, Event, Header};
use slipline_link::simulator::{Options, SimulatedDevice, SimulatedInputs};
use slipline_link::transport::{Opener, Transport, Waker};
use slipline_link::{LinkError, Port, PortInfo, Request, Snapshot, Ticket};
use slipline_plate::truth::Random;
use std::collections::VecDeque;
use std::io;
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// Time between two looks.
const LOOK: Duration = Duration::from_millis(1);
/// Looks after which a test that has not ended never will.
const LOOKS: usize = 100_000;

/// What changes an answer of the device on its way.
pub(crate) type Alter = Box<dyn FnMut(Event) -> Event + Send>;

/// A device, its line, and what happened at its mute pin.
struct Board {
    device: SimulatedDevice,
    /// Blocks that were played with the amplifier on, and the code farthest from mid-scale.
    unmuted: u64,
    loudest: u16,
    is_plugged: bool,
    alter: Option<Alter>,
    decoder: Decoder,
}

/// The board at its port.
#[derive(Clone)]
struct Line(Arc<Mutex<Board>>);

impl Transport for Line {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let Board { device, is_plugged, alter, decoder, .. } = &mut *self.0.lock().unwrap();
        if device.is_in_bootloader() {
            return Err(io::ErrorKind::WouldBlock.into());
        }
        read_from(device, *is_plugged, buffer, |bytes| match alter {
            Some(alter) => altered(&bytes, decoder, alter),
            None => bytes,
        })
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let board = &mut *self.0.lock().unwrap();
        if !board.is_plugged {
            return Err(io::ErrorKind::BrokenPipe.into());
        }
        if !board.device.is_in_bootloader() {
            board.device.feed(bytes);
        }
        Ok(bytes.len())
    }
}

/// The frames of these bytes with their events changed.
fn altered(bytes: &[u8], decoder: &mut Decoder, alter: &mut Alter) -> Vec<u8> {
    let mut changed = Vec::new();
    for &byte in bytes {
        let event = decoder.push(byte, |frame| (frame.header, Event::decode(frame.header.id, frame.body)));
        if let Some((Header { session, sequence, .. }, Ok(event))) = event {
            changed.extend_from_slice(&alter(event).frame_for(Minor::OURS, session, sequence).unwrap());
        }
    }
    changed
}

impl Opener for Line {
    type Transport = Self;

    fn list(&mut self) -> Vec<PortInfo> {
        vec![PortInfo::simulated()]
    }

    fn open(&mut self, _port: &Port, _waker: &Waker) -> Result<Self, LinkError> {
        Ok(self.clone())
    }
}

/// A board on a desk, the program that tests it, and a person.
pub(crate) struct Desk {
    line: Line,
    connection: Connection<Line>,
    now: Duration,
    tickets: u64,
    /// Samples of the device over those of the host's clock.
    pub(crate) clock: f64,
    blocks: f64,
    /// The person presses what is asked.
    pub(crate) obeys: bool,
    /// Called before each request.
    pub(crate) before: Option<fn(&mut SimulatedDevice, &Request)>,
}

impl Desk {
    /// A connected board.
    pub(crate) fn new(device: SimulatedDevice, alter: Option<Alter>) -> Self {
        let board =
            Board { device, unmuted: 0, loudest: 0, is_plugged: true, alter, decoder: Decoder::new() };
        let line = Line(Arc::new(Mutex::new(board)));
        let connection = Self::connection(&line, 0);
        let mut desk = Self {
            line,
            connection,
            now: Duration::ZERO,
            tickets: 0,
            clock: 1.0,
            blocks: 0.0,
            obeys: true,
            before: None,
        };
        desk.connect();
        desk
    }

    fn connection(line: &Line, programs: u8) -> Connection<Line> {
        let mut sessions = 0;
        let nonces = move || {
            sessions += 1;
            [b'd', b'k', programs, sessions]
        };
        Connection::new(line.clone(), Waker::new(|| {}), Box::new(nonces))
    }

    pub(crate) fn connect(&mut self) {
        self.send(Request::Observe);
        self.send(Request::Connect(Port::Simulated));
        (0..200).for_each(|_| self.pass());
        assert!(self.snapshot().is_connected());
    }

    /// Another program connects; the first one is gone.
    pub(crate) fn connect_again(&mut self) {
        self.connection = Self::connection(&self.line, 1);
        self.connect();
    }

    pub(crate) fn send(&mut self, request: Request) -> Ticket {
        if let Some(before) = self.before {
            before(&mut self.line.0.lock().unwrap().device, &request);
        }
        self.tickets += 1;
        self.connection.request(Ticket(self.tickets), request, self.now);
        self.connection.step(self.now);
        Ticket(self.tickets)
    }

    pub(crate) fn snapshot(&mut self) -> Snapshot {
        self.connection.take_changes();
        self.connection.view().clone()
    }

    /// Lets the device and the link run for a look.
    pub(crate) fn pass(&mut self) {
        self.pass_alone();
        self.connection.step(self.now);
    }

    /// Lets the device run while its host is gone.
    pub(crate) fn pass_alone(&mut self) {
        self.now += LOOK;
        self.blocks += 400.0 * LOOK.as_secs_f64() * 1e3 / 128.0 * self.clock;
        let due = self.blocks as u64;
        self.blocks -= due as f64;
        let board = &mut *self.line.0.lock().unwrap();
        let (unmuted, loudest) = (&mut board.unmuted, &mut board.loudest);
        board.device.advance(due, |block| {
            *unmuted += u64::from(!block.muted);
            *loudest = block.codes.iter().map(|code| code.abs_diff(2048)).fold(*loudest, u16::max);
        });
    }

    /// Pulls the cable, or plugs it in.
    pub(crate) fn plug(&self, is_plugged: bool) {
        self.line.0.lock().unwrap().is_plugged = is_plugged;
    }

    /// Presses reset if the device is in its ROM bootloader; returns whether it was.
    pub(crate) fn press_reset(&self) -> bool {
        let device = &mut self.line.0.lock().unwrap().device;
        let is_there = device.is_in_bootloader();
        if is_there {
            device.restart(ResetCause::Pin);
        }
        is_there
    }

    /// Blocks that were played with the amplifier on.
    pub(crate) fn unmuted(&self) -> u64 {
        self.line.0.lock().unwrap().unmuted
    }

    /// The code farthest from mid-scale so far, in codes from there.
    pub(crate) fn loudest(&self) -> u16 {
        self.line.0.lock().unwrap().loudest
    }

    pub(crate) fn is_muted(&self) -> bool {
        self.line.0.lock().unwrap().device.is_muted()
    }

    /// The device's time, seconds, which goes on while it restarts.
    pub(crate) fn time_s(&self) -> f64 {
        self.now.as_secs_f64() * self.clock
    }

    /// Runs a test to its end, or for this number of looks; returns whether it has ended. `each` is called at each look.
    pub(crate) fn run(
        &mut self,
        run: &mut Run<Selftesting>,
        looks: usize,
        mut each: impl FnMut(usize, &mut Run<Selftesting>),
    ) -> bool {
        for look in 0..looks {
            let snapshot = self.snapshot();
            if !run.turn(&snapshot, |request| self.send(request)) {
                return true;
            }
            each(look, run);
            let holds = matches!(run.prompt(), Some(Prompt::PressButton | Prompt::HoldButton));
            if self.obeys && run.prompt().is_some() {
                self.line.0.lock().unwrap().device.press_button(holds);
                if run.prompt() == Some(Prompt::PressReset) {
                    self.press_reset();
                }
            }
            self.pass();
        }
        false
    }

    /// The report of a test.
    pub(crate) fn test(&mut self, request: SelftestRequest) -> Result<SelftestReport, MeasureError> {
        let mut run = Run::of(Selftesting::new(request));
        assert!(self.run(&mut run, LOOKS, |_, _| ()), "it never ends");
        run.finish()
    }
}

/// A wire from the DAC to the sensor, with a fault.
pub(crate) struct FaultyWire {
    /// Standard deviation of its noise, codes.
    pub(crate) noise: f64,
    /// Whole blocks by which it is late.
    pub(crate) late_blocks: usize,
    /// The codes from mid-scale at which the DAC saturates.
    pub(crate) ends: f64,
    /// The code that the input always reads.
    pub(crate) stuck: Option<u16>,
    /// It leads through the amplifier, of which a part passes also while it is muted.
    pub(crate) amplifier: Option<f64>,
    blocks: VecDeque<[u16; 128]>,
    random: Random,
}

impl FaultyWire {
    pub(crate) const fn good() -> Self {
        Self {
            noise: 0.4,
            late_blocks: 0,
            ends: 2048.0,
            stuck: None,
            amplifier: None,
            blocks: VecDeque::new(),
            random: Random::new(7),
        }
    }
}

impl SimulatedInputs for FaultyWire {
    fn sample(&mut self, codes: &[u16; 128], muted: bool, sensed: &mut [[u16; 128]; 2]) {
        self.blocks.push_back(*codes);
        let late = if self.blocks.len() > self.late_blocks { self.blocks.pop_front() } else { None };
        let sent = late.unwrap_or([2048; 128]);
        for (read, code) in sensed[0].iter_mut().zip(sent) {
            let passes = self.amplifier.map_or(1.0, |leak| if muted { leak } else { 1.0 });
            let code = 2048.0 + (passes * (f64::from(code) - 2048.0)).clamp(-self.ends, self.ends);
            let code = code + self.noise * self.random.normal();
            *read = self.stuck.unwrap_or(code.round().clamp(0.0, 4095.0) as u16);
        }
    }
}

/// A device whose trigger output is wired to its input, and its DAC to its sensor by this wire.
pub(crate) fn wired(options: Options, wire: FaultyWire) -> SimulatedDevice {
    let mut options = options;
    options.wires.trigger = true;
    SimulatedDevice::with_inputs(options, Box::new(wire))
}

/// Both wires, a person, and no amplifier.
pub(crate) fn everything() -> SelftestRequest {
    SelftestRequest {
        has_sensor_wire: true,
        has_trigger_wire: true,
        is_amplifier_unplugged: true,
        is_amplifier_on: false,
        asks: true,
        is_short: true,
        seed: 1,
    }
}

/// As [`everything`], in full: with bootloader and faults on purpose, too.
pub(crate) fn in_full() -> SelftestRequest {
    SelftestRequest { is_short: false, ..everything() }
}

/// The steps that no message of today can show, or that the test of the amplifier alone carries out.
const NEVER: [&str; 2] = [step::OTHERS, step::AMPLIFIER];
/// A test of three seconds leaves these out.
const LONG: [&str; 2] = [step::BOOTLOADER, step::FAULTS];

/// A board without a fault, with both wires.
pub(crate) fn good() -> SimulatedDevice {
    wired(Options::default(), FaultyWire::good())
}

/// The names of the steps with this verdict.
pub(crate) fn named(report: &SelftestReport, verdict: Verdict) -> Vec<&str> {
    report.named(verdict).collect()
}

/// The report with its red and skipped steps as expected, and no other that is not green but those that are never shown by it.
pub(crate) fn expect(report: &SelftestReport, red: &[&str], skipped: &[&str]) {
    assert_eq!(named(report, Verdict::Red), red, "{report:#?}");
    let long: &[&str] = if report.short { &LONG } else { &[] };
    let mut expected: Vec<&str> = skipped.iter().chain(&NEVER).chain(long).copied().collect();
    expected.sort_by_key(|name| step::ALL.iter().position(|step| step == name));
    assert_eq!(named(report, Verdict::Skipped), expected, "{report:#?}");
    assert_eq!(named(report, Verdict::Amber), [""; 0], "{report:#?}");
}
