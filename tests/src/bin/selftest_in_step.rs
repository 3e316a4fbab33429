//! The board's self-test in step with a device whose time is not this computer's: a model of a board, slower than the board.
//! The link, the mirror and the procedure are those of `slipline selftest`; the clock is the model's, so no verdict depends on the
//! computer's speed.
//!
//! `cargo run -p slipline-tests --bin selftest_in_step [dac=sensor] [trigger=trigger-in] [unplugged] [ask]`
//!
//! Standard input, one line for each look: `<us> <bytes>`, the time in microseconds and what the device has sent since the last
//! look, in hexadecimal, or `-`; `<us> stop` is the user's STOP.
//! Standard output, one line for each look: the bytes for the device, or `-`, and what a person is asked; last the report, as JSON,
//! or `{"error": ".."}`.

use serde_json::json;
use slipline_instrument::measure::Run;
use slipline_instrument::selftest::{SelftestRequest, Selftesting, Wire};
use slipline_link::connection::Connection;
use slipline_link::transport::{Opener, Transport, Waker, read_received};
use slipline_link::{LinkError, Port, PortInfo, Request, Ticket};
use std::fmt::Write as _;
use std::io::{self, BufRead, Write};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// The seed of the random drives: every run of a test plays the same.
const SEED: u64 = 1;

/// What is on the line at one look.
#[derive(Default)]
struct State {
    to_host: Vec<u8>,
    to_device: Vec<u8>,
}

/// The line to the device.
#[derive(Clone, Default)]
struct Line(Arc<Mutex<State>>);

impl Line {
    fn with<T>(&self, act: impl FnOnce(&mut State) -> T) -> T {
        act(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Transport for Line {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.with(|state| read_received(&mut state.to_host, buffer))
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.with(|state| state.to_device.extend_from_slice(bytes));
        Ok(bytes.len())
    }
}

impl Opener for Line {
    type Transport = Self;

    fn list(&mut self) -> Vec<PortInfo> {
        Vec::new()
    }

    fn open(&mut self, _port: &Port, _waker: &Waker) -> Result<Self, LinkError> {
        Ok(self.clone())
    }
}

/// The program at the line.
struct Program {
    connection: Connection<Line>,
    tickets: u64,
}

impl Program {
    fn new(line: &Line) -> Self {
        let mut sessions = 0;
        let nonces = move || {
            sessions += 1;
            [b's', b't', b'p', sessions]
        };
        let connection = Connection::new(line.clone(), Waker::new(|| {}), Box::new(nonces));
        let mut program = Self { connection, tickets: 0 };
        program.send(Request::AutoReconnect(false), Duration::ZERO);
        program.send(Request::Observe, Duration::ZERO);
        program
    }

    fn send(&mut self, request: Request, now: Duration) -> Ticket {
        self.tickets += 1;
        self.connection.request(Ticket(self.tickets), request, now);
        self.connection.step(now);
        Ticket(self.tickets)
    }
}

/// The request that these words ask for.
fn request(words: impl Iterator<Item = String>) -> Result<SelftestRequest, String> {
    let mut request = SelftestRequest { is_short: true, seed: SEED, ..SelftestRequest::default() };
    let mut wires = Vec::new();
    for word in words {
        match word.as_str() {
            "unplugged" => request.is_amplifier_unplugged = true,
            "ask" => request.asks = true,
            wire => wires.push(wire.parse::<Wire>().map_err(|error| format!("{wire:?}: {error}"))?),
        }
    }
    Ok(request.with_wires(&wires))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let line = Line::default();
    let mut program = Program::new(&line);
    let mut run = Run::of(Selftesting::new(request(std::env::args().skip(1))?));
    let mut is_begun = false;
    let mut out = io::stdout().lock();
    for look in io::stdin().lock().lines() {
        let look = look?;
        let (time, on_line) = look.split_once(' ').ok_or_else(|| format!("not understood: {look:?}"))?;
        let now = Duration::from_micros(time.parse()?);
        match on_line {
            "-" => {}
            "stop" => run.cancel(),
            bytes => {
                let bytes = decoded(bytes).ok_or_else(|| format!("not understood: {look:?}"))?;
                line.with(|state| state.to_host.extend(bytes));
            }
        }
        if program.tickets == 2 {
            program.send(Request::Connect(Port::Serial("model".to_owned())), now);
        }
        program.connection.step(now);
        program.connection.take_changes();
        let snapshot = program.connection.view().clone();
        is_begun |= snapshot.is_connected();
        if is_begun && !run.turn(&snapshot, |request| program.send(request, now)) {
            let result = match run.finish() {
                Ok(report) => json!(report),
                Err(error) => json!({ "error": error.to_string() }),
            };
            return Ok(writeln!(out, "{result}")?);
        }
        let mut answer = String::new();
        for byte in line.with(|state| std::mem::take(&mut state.to_device)) {
            write!(answer, "{byte:02x}")?;
        }
        let bytes = if answer.is_empty() { "-" } else { &answer };
        let prompt = run.prompt().map_or("", |prompt| prompt.sentence());
        writeln!(out, "{bytes} {prompt}")?;
        out.flush()?;
    }
    Err("the looks end before the test".into())
}

/// The bytes of hexadecimal digits.
fn decoded(digits: &str) -> Option<Vec<u8>> {
    (0..digits.len()).step_by(2).map(|at| u8::from_str_radix(digits.get(at..at + 2)?, 16).ok()).collect()
}
