//! A recorded session: the bytes between a host and a device of one version.
//!
//! ```text
//! # a remark
//! + 3                3 blocks of the device pass
//! > 000aa500...      what the host writes at once, in hexadecimal
//! < 0a5a0102...      a frame of the device
//! ```
//! The files lie in `transcripts/`. They are never edited and never made again: later code must understand them.

use std::collections::VecDeque;
use std::io;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use slipline_link::DeviceTable;
use slipline_link::connection::Connection;
use slipline_link::simulator::{Options, SimulatedDevice};
use slipline_link::transport::{Opener, Transport, Waker, read_received};
use slipline_link::{
    ChordRequest, DriveRequest, HarmonicRequest, LinkError, Outcome, Port, PortInfo, Request, Sounding,
    Ticket,
};
use slipline_protocol::Decoder;
use slipline_protocol::command::{Apply, DigestWindow};

/// One line of a transcript.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Line {
    /// Number of blocks that pass.
    Blocks(u64),
    /// What the host writes at once: frames.
    Host(Vec<u8>),
    /// A frame of the device.
    Device(Vec<u8>),
}

/// The lines of a transcript.
///
/// # Panics
/// If the text is not one.
#[must_use]
pub fn parse(text: &str) -> Vec<Line> {
    let bytes = |hex: &str| -> Vec<u8> {
        (0..hex.len()).step_by(2).map(|at| u8::from_str_radix(&hex[at..at + 2], 16).expect("hex")).collect()
    };
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    lines
        .map(|line| match line.split_once(' ').expect("a sign and a value") {
            ("+", blocks) => Line::Blocks(blocks.parse().expect("a number of blocks")),
            (">", frame) => Line::Host(bytes(frame)),
            ("<", frame) => Line::Device(bytes(frame)),
            (sign, _) => panic!("no line begins with {sign}"),
        })
        .collect()
}

/// The device of every transcript.
#[must_use]
pub fn device() -> SimulatedDevice {
    SimulatedDevice::new(Options { unit: *b"recorded-1.0", ..Options::default() })
}

/// The table that is uploaded: two chunks.
///
/// # Panics
/// Never: its values are in range.
#[must_use]
pub fn table() -> DeviceTable {
    let knots = (0..30).map(|i| (60_000.0 - 1000.0 * f64::from(i), 0.5 + f64::from(i) / 64.0));
    DeviceTable::from_knots((0.08, 0.27), 4e5, knots, 1e-6).expect("values in range")
}

/// The requests to the host in a minor version's transcript, each with the milliseconds until the next one.
///
/// # Panics
/// Never: its values are in range.
#[must_use]
pub fn requests(minor: u8) -> Vec<(Request, u64)> {
    let drive = |tones: &[(f64, f64)]| Request::Play(Sounding::Drive(DriveRequest::at(tones)));
    let mut requests = vec![
        (Request::Connect(Port::Serial("A".to_owned())), 100),
        // No table: refused by the device.
        (Request::Store, 50),
        (Request::Upload(Arc::new(table())), 100),
        (Request::Arm, 50),
        (Request::Digest(DigestWindow { from: 200_000, count: 4096 }), 20),
        (drive(&[(0.1, 0.5), (0.2, 0.4)]), 50),
        (Request::Refresh, 30),
        // Busy: it sounds.
        (Request::Store, 200),
        (drive(&[(0.15, 0.9)]), 100),
        (Request::Stop, 100),
        (drive(&[(0.25, 1.0)]), 50),
        (Request::EmergencyStop, 50),
        // A fault is latched.
        (Request::Arm, 20),
        (Request::ClearFaults, 50),
        (Request::Store, 50),
        (Request::ReadBack, 20),
        (Request::Disarm, 50),
        (Request::Forget, 50),
    ];
    if minor >= 1 {
        let limited = table().with_travel_limit(50.0, 2.0, 0.5).expect("values in range");
        let waiting = DriveRequest { apply: Apply::AtTrigger, ..DriveRequest::at(&[(0.1, 0.5), (0.2, 0.4)]) };
        requests.extend([
            (Request::Upload(Arc::new(limited)), 100),
            (Request::Arm, 50),
            (Request::Play(Sounding::Drive(waiting)), 50),
            (Request::Refresh, 20),
            // It drops the drive that waits.
            (Request::Stop, 50),
            (drive(&[(0.12, 0.3)]), 100),
            (Request::Disarm, 50),
        ]);
    }
    if minor >= 2 {
        // In phase their sum clips: refused by the device, which has rendered a period of it.
        let chord = |turns: [f64; 3]| {
            let tone = |(harmonic, phase_turns)| HarmonicRequest { harmonic, level: 0.5, phase_turns };
            let tones = [400, 450, 500].into_iter().zip(turns).map(tone);
            Request::Play(Sounding::Chord(ChordRequest::of(12, tones.collect())))
        };
        requests.extend([
            (Request::Upload(Arc::new(table())), 100),
            (Request::Arm, 50),
            (chord([0.0; 3]), 50),
            (chord([0.0, 0.3, 0.1]), 100),
            (Request::Stop, 50),
            (Request::Disarm, 50),
        ]);
    }
    // The simulated device has no bootloader in ROM before it is disarmed and silent.
    requests.push((Request::Disconnect, 500));
    requests
}

/// What answers the host's bytes.
pub trait Peer: Send {
    /// Takes what the host has written.
    fn take(&mut self, bytes: &[u8]);
    /// Gives what it has to say.
    fn give(&mut self, bytes: &mut Vec<u8>);
}

/// A way to a peer that a test shares with the link.
pub struct Way<P>(Arc<Mutex<P>>, Vec<u8>);

impl<P: Peer> Transport for Way<P> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.lock().expect("no test panics here").give(&mut self.1);
        read_received(&mut self.1, buffer)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().expect("no test panics here").take(bytes);
        Ok(bytes.len())
    }
}

/// Opens in-memory transports to a peer.
struct Ways<P>(Arc<Mutex<P>>);

impl<P: Peer> Opener for Ways<P> {
    type Transport = Way<P>;

    fn list(&mut self) -> Vec<PortInfo> {
        Vec::new()
    }

    fn open(&mut self, _: &Port, _: &Waker) -> Result<Way<P>, LinkError> {
        Ok(Way(self.0.clone(), Vec::new()))
    }
}

/// Lets this build's host say all of a minor's [`requests`] to a peer; `pass` is called for every millisecond. Returns how
/// each request ended.
pub fn play<P: Peer>(peer: &Arc<Mutex<P>>, minor: u8, mut pass: impl FnMut(&mut P)) -> Vec<Option<Outcome>> {
    let nonces = Box::new(|| *b"1.0!");
    let mut connection = Connection::new(Ways(peer.clone()), Waker::new(|| ()), nonces);
    let mut now = Duration::ZERO;
    for (number, (request, milliseconds)) in (1..).zip(requests(minor)) {
        connection.request(Ticket(number), request, now);
        connection.step(now);
        for _ in 0..milliseconds {
            pass(&mut peer.lock().expect("no test panics here"));
            now += Duration::from_millis(1);
            connection.step(now);
        }
    }
    (1..).zip(requests(minor)).map(|(number, _)| connection.view().outcome(Ticket(number)).cloned()).collect()
}

/// A device that is listened to.
pub struct SessionRecorder {
    device: SimulatedDevice,
    from_device: Vec<u8>,
    /// What has been said.
    pub lines: Vec<Line>,
}

impl Default for SessionRecorder {
    fn default() -> Self {
        Self { device: device(), from_device: Vec::new(), lines: Vec::new() }
    }
}

impl SessionRecorder {
    /// Lets a millisecond pass, in whole blocks.
    pub fn pass(&mut self) {
        self.device.advance(3, |_| ());
        match self.lines.last_mut() {
            Some(Line::Blocks(blocks)) => *blocks += 3,
            _ => self.lines.push(Line::Blocks(3)),
        }
    }
}

impl Peer for SessionRecorder {
    fn take(&mut self, bytes: &[u8]) {
        self.lines.push(Line::Host(bytes.to_vec()));
        self.device.feed(bytes);
    }

    fn give(&mut self, bytes: &mut Vec<u8>) {
        self.from_device.clear();
        self.device.take(&mut self.from_device);
        for frame in split(&self.from_device) {
            self.lines.push(Line::Device(frame));
        }
        bytes.extend_from_slice(&self.from_device);
    }
}

/// The frames in whole frames' bytes, each with one delimiter.
#[must_use]
pub fn split(bytes: &[u8]) -> Vec<Vec<u8>> {
    let frames = bytes.split(|&byte| byte == 0).filter(|frame| !frame.is_empty());
    frames.map(|frame| frame.iter().copied().chain([0]).collect()).collect()
}

/// What a frame holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parts {
    /// Its header.
    pub header: slipline_protocol::Header,
    /// Its body.
    pub body: Vec<u8>,
}

/// Takes a frame apart.
///
/// # Panics
/// If these bytes are not one whole frame.
#[must_use]
pub fn parts(frame: &[u8]) -> Parts {
    let mut decoder = Decoder::new();
    let mut found = frame.iter().filter_map(|&byte| {
        decoder.push(byte, |frame| Parts { header: frame.header, body: frame.body.to_vec() })
    });
    found.next().expect("a whole frame")
}

/// A recorded device: it answers what its host of then asked, and nothing else.
pub struct Scripted {
    /// What the host asked and what came, in order; each is used once.
    exchanges: VecDeque<(Parts, Parts)>,
    /// The latest status that it reported, the answer to every later question that was not recorded.
    status: Option<Parts>,
    decoder: Decoder,
    answers: Vec<u8>,
    /// What it was asked and has no answer to.
    pub unknown: Vec<Parts>,
}

impl Scripted {
    /// The device of a transcript.
    #[must_use]
    pub fn of(lines: &[Line]) -> Self {
        let mut asked: Vec<Parts> = Vec::new();
        let mut exchanges = VecDeque::new();
        for line in lines {
            match line {
                Line::Blocks(_) => {}
                Line::Host(bytes) => asked.extend(split(bytes).iter().map(|frame| parts(frame))),
                Line::Device(frame) => {
                    let answer = parts(frame);
                    let of = asked.iter().position(|it| it.header.sequence == answer.header.sequence);
                    exchanges.push_back((asked.remove(of.expect("every answer has its question")), answer));
                }
            }
        }
        let decoder = Decoder::new();
        Self { exchanges, status: None, decoder, answers: Vec::new(), unknown: Vec::new() }
    }

    fn answer(&mut self, asked: Parts) {
        const HELLO: u8 = 0x01;
        const PULSES: [u8; 2] = [0x02, 0x03];
        const STATUS: u8 = 0x83;
        let is_pulse = PULSES.contains(&asked.header.id);
        let fits = |recorded: &Parts| {
            recorded.header.id == asked.header.id
                && (recorded.body == asked.body || recorded.header.id == HELLO)
        };
        // A question about the state is answered by the state that stood here, however often it comes.
        let next_step = self.exchanges.iter().position(|(of, _)| !PULSES.contains(&of.header.id));
        let place = if is_pulse {
            let here = next_step.unwrap_or(self.exchanges.len());
            self.exchanges.iter().take(here).position(|(_, answer)| answer.header.id == STATUS)
        } else {
            self.exchanges.iter().position(|(recorded, _)| fits(recorded))
        };
        let exchange = place.and_then(|place| self.exchanges.remove(place));
        let answer = match exchange {
            Some((_, answer)) => answer,
            None if is_pulse && self.status.is_some() => self.status.clone().expect("just seen"),
            None => return self.unknown.push(asked),
        };
        if answer.header.id == STATUS {
            self.status = Some(answer.clone());
        }
        let header = slipline_protocol::Header { sequence: asked.header.sequence, ..answer.header };
        let frame = slipline_protocol::frame::encode(header, |buffer| {
            buffer[..answer.body.len()].copy_from_slice(&answer.body);
            Ok(answer.body.len())
        });
        self.answers.extend_from_slice(&frame.expect("it fitted once"));
    }
}

impl Peer for Scripted {
    fn take(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            let asked =
                self.decoder.push(byte, |frame| Parts { header: frame.header, body: frame.body.to_vec() });
            if let Some(asked) = asked {
                self.answer(asked);
            }
        }
    }

    fn give(&mut self, bytes: &mut Vec<u8>) {
        bytes.append(&mut self.answers);
    }
}
