//! The device worker: the link, the simulated device and the boards by USB, apart from all that computes.
//!
//! The page's thread may be busy or stuck, and this worker still sends the keep-alives; so the link watches whether
//! the page's thread is alive, as it does with a window, and stops and disarms the device if it is not.

use crate::clock::now;
use crate::keep_alives::KeepAlives;
use crate::message::{self, FromDevice, ToDevice};
use crate::ports::PagePorts;
use crate::serial::SerialGlue;
use js_sys::{Function, Uint8Array};
use serde::Serialize;
use slipline_instrument::rig::RigCopy;
use slipline_link::connection::Connection;
use slipline_link::protocol::Command;
use slipline_link::transport::Waker;
use slipline_link::{LinkState, Request, Severity, Snapshot, SnapshotUpdate, Ticket, TracedMessage};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

/// Steps follow each other for this long while the device answers at once. A STOP that arrives meanwhile is handled
/// after it.
const STEPS_LAST: Duration = Duration::from_millis(20);
/// The ticket of requests that nobody waits for: those of the page's thread are numbered from 1.
const UNAWAITED: Ticket = Ticket(0);

/// The device worker's entry.
#[wasm_bindgen]
pub struct DeviceWorker {
    connection: Connection<PagePorts>,
    ports: PagePorts,
    /// Has the browser's ports.
    glue: SerialGlue,
    /// Whether the device has answered since the latest step.
    is_woken: Arc<AtomicBool>,
    /// The latest rig on the bench.
    rig: Option<RigCopy>,
    is_passing_over: bool,
    /// The snapshot that the page's thread has.
    published: Snapshot,
    /// Sends what is new to the page's thread.
    publish: Function,
    /// Asks the page's thread for a sign of life.
    ask: Function,
    latest_sign: Duration,
    keep_alives: KeepAlives,
}

#[wasm_bindgen]
impl DeviceWorker {
    /// A worker with no port open. `publish` gets what is new for the page's thread, as bytes; `ask` asks it for a
    /// sign of life; `glue` has the browser's ports. `nonce` is random.
    #[wasm_bindgen(constructor)]
    #[must_use]
    pub fn new(publish: Function, ask: Function, glue: SerialGlue, nonce: u32) -> Self {
        let is_woken = Arc::new(AtomicBool::new(false));
        let woken = Arc::clone(&is_woken);
        let waker = Waker::new(move || woken.store(true, Ordering::Relaxed));
        let mut nonce = nonce;
        let nonces = Box::new(move || {
            nonce = nonce.wrapping_add(1);
            nonce.to_le_bytes()
        });
        let ports = PagePorts::default();
        let mut connection = Connection::new(ports.clone(), waker, nonces);
        connection.keep_frames();
        connection.watch_driver();
        Self {
            connection,
            ports,
            glue,
            is_woken,
            rig: None,
            is_passing_over: false,
            published: Snapshot::default(),
            publish,
            ask,
            latest_sign: Duration::ZERO,
            keep_alives: KeepAlives::default(),
        }
    }

    /// Takes a message of the page's thread.
    pub fn take(&mut self, bytes: &[u8]) {
        match message::read(bytes) {
            Some(ToDevice::Request(ticket, request)) => self.connection.request(ticket, request, now()),
            Some(ToDevice::Bench(change)) => self.ports.bench.carry_out(change, &mut self.rig),
            None => {}
        }
    }

    /// Stops the drive.
    pub fn stop(&mut self) {
        self.connection.request(UNAWAITED, Request::Stop, now());
    }

    /// Stops and disarms because nobody sees the page any more; the log says why.
    pub fn leave(&mut self, reason: &str) {
        let now = now();
        let was_armed = self.connection.view().is_armed();
        self.connection.request(UNAWAITED, Request::Stop, now);
        self.connection.request(UNAWAITED, Request::Disarm, now);
        if was_armed {
            let text = format!("{reason}: stopped and disarmed.");
            self.connection.request(UNAWAITED, Request::Note(Severity::Warning, text), now);
        }
    }

    /// The page's thread is alive.
    pub fn sign(&mut self) {
        self.latest_sign = now();
    }

    /// Takes the boards that this page may open now: for each the glue's id, its USB vendor and its USB product.
    #[wasm_bindgen(js_name = boardsListed)]
    pub fn boards_listed(&self, boards: &[u32]) {
        self.ports.boards.listed(boards);
    }

    /// The user has chosen the board of this id.
    #[wasm_bindgen(js_name = boardChosen)]
    pub fn board_chosen(&self, id: u32) {
        self.ports.boards.choose(id);
    }

    /// A line to a board is open.
    #[wasm_bindgen(js_name = boardOpened)]
    pub fn board_opened(&self, line: u32) {
        self.ports.boards.opened(line);
    }

    /// A board has sent bytes.
    #[wasm_bindgen(js_name = boardReceived)]
    pub fn board_received(&self, line: u32, bytes: &[u8]) {
        self.ports.boards.received(line, bytes);
    }

    /// The bytes for a board are written.
    #[wasm_bindgen(js_name = boardWritten)]
    pub fn board_written(&self, line: u32) {
        self.ports.boards.written(line);
    }

    /// A line could not be opened or has failed: the name and the text of the browser's error.
    #[wasm_bindgen(js_name = boardEnded)]
    pub fn board_ended(&self, line: u32, name: &str, text: &str) {
        self.ports.boards.ended(line, name, text);
    }

    /// Performs what is due. Returns after how many milliseconds it must be called again; infinite while nothing is
    /// pending.
    pub fn step(&mut self) -> f64 {
        let began = now();
        loop {
            self.is_woken.store(false, Ordering::Relaxed);
            self.connection.sign_of_life(self.latest_sign);
            self.connection.step(now());
            if !self.is_woken.load(Ordering::Relaxed) || now().saturating_sub(began) > STEPS_LAST {
                break;
            }
        }
        let render_after = self.ports.render_due();
        self.ports.boards.carry_out(&self.glue);
        if let Some(boards) = self.ports.boards.take_list() {
            self.send(&FromDevice::Ports(PagePorts::with_simulated(boards)), true);
        }
        if let Some(port) = self.ports.boards.take_chosen() {
            self.send(&FromDevice::Chosen(port), true);
        }
        if self.connection.take_sign_wanted() {
            let _ = self.ask.call0(&JsValue::NULL);
        }
        let (is_changed, is_loud) = self.connection.take_changes();
        if is_changed {
            self.keep_alives.attend(self.connection.view());
            let update = SnapshotUpdate::between(&self.published, self.connection.view());
            self.published = self.connection.view().clone();
            self.send(&FromDevice::Update(Box::new(update)), is_loud);
        }
        let was_passing_over =
            std::mem::replace(&mut self.is_passing_over, self.ports.bench.is_passing_over());
        if was_passing_over && !self.is_passing_over {
            self.send(&FromDevice::PassedOver, true);
        }
        if self.is_woken.load(Ordering::Relaxed) {
            return 0.0;
        }
        let now = now();
        let deadline = self.connection.deadline(now).map(|deadline| deadline.saturating_sub(now));
        let after = [deadline, render_after].into_iter().flatten().min();
        after.map_or(f64::INFINITY, |after| after.as_secs_f64() * 1e3)
    }

    fn send(&self, message: &FromDevice, is_loud: bool) {
        let bytes = message::bytes(message);
        let state = message::json(&State::of(self.connection.view(), &self.keep_alives));
        let _ = self.publish.call3(
            &JsValue::NULL,
            &Uint8Array::from(bytes.as_slice()),
            &is_loud.into(),
            &state.into(),
        );
    }
}

/// The state of link and device, for `window.slipline.state()`. Times are those of this worker, in milliseconds; the
/// keep-alives are those since the device was armed.
#[derive(Serialize)]
struct State<'a> {
    revision: u64,
    link: &'static str,
    device_state: Option<String>,
    armed: bool,
    driver_stalls: u32,
    port: Option<String>,
    board: Option<&'a str>,
    error: Option<String>,
    table_verified: Option<bool>,
    commands: u32,
    stops_sent_ms: Vec<f64>,
    disarms_sent_ms: Vec<f64>,
    keep_alives: u32,
    keep_alive_longest_gap_ms: f64,
}

impl<'a> State<'a> {
    fn of(view: &'a Snapshot, keep_alives: &KeepAlives) -> Self {
        // All in the trace: the window sends its own after one that was sent past it.
        let sent_at = |is_it: fn(&Command) -> bool| {
            let sent = view.record.frames.iter().filter(|frame| match &frame.message {
                TracedMessage::Command(command) => is_it(command),
                TracedMessage::Event(_) | TracedMessage::Unknown { .. } => false,
            });
            sent.map(|frame| milliseconds(frame.time)).collect()
        };
        Self {
            revision: view.revision,
            link: match view.link.state {
                LinkState::Disconnected => "disconnected",
                LinkState::Connecting => "connecting",
                LinkState::Connected => "connected",
                LinkState::Lost(_) => "lost",
                LinkState::Reconnecting(_) => "reconnecting",
            },
            device_state: view.drive.status.map(|status| format!("{:?}", status.state)),
            armed: view.is_armed(),
            driver_stalls: view.link.driver_stalls,
            port: view.link.port.as_ref().map(ToString::to_string),
            board: view.device.identity.as_ref().map(|identity| identity.board.as_str()),
            error: view.link.error.as_ref().map(ToString::to_string),
            table_verified: view.table.upload_verified,
            commands: view.link.counters.commands,
            stops_sent_ms: sent_at(|command| matches!(command, Command::Stop)),
            disarms_sent_ms: sent_at(|command| matches!(command, Command::Disarm)),
            keep_alives: keep_alives.count,
            keep_alive_longest_gap_ms: milliseconds(keep_alives.longest_gap),
        }
    }
}

/// A time in milliseconds, to a thousandth.
fn milliseconds(time: Duration) -> f64 {
    (time.as_secs_f64() * 1e6).round() / 1e3
}
