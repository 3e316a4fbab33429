//! The link's state machine: open a port, talk, lose it, look for it again.
//!
//! ```text
//! Disconnected --Connect--> Connecting --hello answered--> Connected --error, silence--> Lost --> Reconnecting
//!      ^                      |  | no answer                  | Disconnect                        |  ^      ^
//!      +----------------------+--+----------------------------+            found: hello again <---+  | not  |
//!                             | no such port                                                         | yet  |
//!                             +----------------------------------------------------------------------+------+
//! ```
//! It owns no thread and no clock: the caller runs [`Connection::step`] with the time, again no later than
//! [`Connection::deadline`]. After a loss the link looks for the device; it also looks for a port that is
//! missing when it is to be opened. Other errors of opening are not retried: a busy port must not be taken
//! from another program, and a missing permission requires the user. A device that returns is disarmed; only
//! the user arms it again.

mod bootloader;
mod driver;
mod opening;

use self::bootloader::BootloaderEntry;
#[cfg(feature = "native")]
use crate::awaited::Awaited;
use crate::commands::{CommandQueue, Next};
use crate::driver_watch::DriverWatch;
use crate::error::LinkError;
use crate::log::Severity;
use crate::port::Port;
use crate::recorder::Recorder;
use crate::rediscovery::Rediscovery;
use crate::request::{Outcome, Request, Ticket};
use crate::snapshot::{LinkState, Snapshot};
use crate::transport::{Opener, Transport, Waker};
use std::io;
use std::time::Duration;

/// Time between two searches for a lost device or a missing port; a board is back on the bus 0.2 s after a
/// reset.
pub const SEEK_PERIOD: Duration = Duration::from_millis(250);
/// Reads per step, at most, so that a device that sends continuously cannot delay the handling of requests.
const READS: usize = 16;
/// Time after which bytes are written again that the port did not accept.
const WRITE_PAUSE: Duration = Duration::from_millis(1);

/// Generates the four bytes that distinguish one session's hello from another's.
pub type Nonces = Box<dyn FnMut() -> [u8; 4] + Send>;

struct Open<T> {
    transport: T,
    queue: CommandQueue,
    /// The caller has not yet registered this transport with its poll.
    is_new: bool,
}

enum Phase<T> {
    Closed,
    Open(Box<Open<T>>),
    Seeking { next: Duration },
}

/// The link to at most one device.
///
/// The caller brings the ports, the time and the random numbers:
/// ```
/// use slipline_link::connection::Connection;
/// use slipline_link::simulator::realtime::{RealtimeDevice, RealtimeLine};
/// use slipline_link::simulator::{Options, SimulatedDevice};
/// use slipline_link::transport::{Opener, Waker};
/// use slipline_link::{LinkError, Outcome, Port, PortInfo, Request, Ticket};
/// use std::sync::atomic::{AtomicU64, Ordering};
/// use std::sync::{Arc, Mutex};
/// use std::time::Duration;
///
/// struct OnlySimulated(Arc<Mutex<RealtimeDevice>>);
///
/// impl Opener for OnlySimulated {
///     type Transport = RealtimeLine;
///     fn list(&mut self) -> Vec<PortInfo> {
///         vec![PortInfo::simulated()]
///     }
///     fn open(&mut self, port: &Port, waker: &Waker) -> Result<RealtimeLine, LinkError> {
///         match port {
///             Port::Simulated => Ok(RealtimeLine::new(self.0.clone(), waker.clone())),
///             other => Err(LinkError::NoSuchPort(other.clone())),
///         }
///     }
/// }
///
/// // Milliseconds since the start, counted by the loop below.
/// let time = Arc::new(AtomicU64::new(0));
/// let clock = time.clone();
/// let clock = Arc::new(move || Duration::from_millis(clock.load(Ordering::Relaxed)));
/// let device = RealtimeDevice::new(SimulatedDevice::new(Options::default()), clock);
/// let opener = OnlySimulated(Arc::new(Mutex::new(device)));
/// let mut connection = Connection::new(opener, Waker::new(|| ()), Box::new(|| *b"demo"));
///
/// let connect = Ticket(1);
/// connection.request(connect, Request::Connect(Port::Simulated), Duration::ZERO);
/// for ms in 0..100 {
///     time.store(ms, Ordering::Relaxed);
///     connection.step(Duration::from_millis(ms));
/// }
/// assert!(connection.view().is_connected());
/// assert!(matches!(connection.view().outcome(connect), Some(Outcome::Done { .. })));
/// ```
pub struct Connection<O: Opener> {
    opener: O,
    waker: Waker,
    nonces: Nonces,
    phase: Phase<O::Transport>,
    rediscovery: Option<Rediscovery>,
    /// A device that was sent into its bootloader.
    entry: Option<BootloaderEntry>,
    /// The port was missing when it was to be opened, and no device has answered there yet.
    waits_for_port: bool,
    /// The port to open once the present device is closed.
    next: Option<(Ticket, Port)>,
    leave: Option<Ticket>,
    recorder: Recorder,
    keeps_frames: bool,
    /// There may be more to read than one step has read.
    has_more: bool,
    opened_at: Duration,
    /// Consecutive sessions that other programs have ended soon after their beginning.
    short_lives: u32,
    /// The watch over the driver; `None` if the driver itself calls [`Connection::step`].
    driver: Option<DriverWatch>,
    /// Those that wait for the device to answer, each until when.
    awaiting: Vec<(Ticket, Duration)>,
}

impl<O: Opener> Connection<O> {
    /// A link with no port open. `waker` is given to the ports it opens.
    pub fn new(opener: O, waker: Waker, nonces: Nonces) -> Self {
        let mut recorder = Recorder::default();
        recorder.view.link.auto_reconnect = true;
        Self {
            opener,
            waker,
            nonces,
            phase: Phase::Closed,
            rediscovery: None,
            entry: None,
            waits_for_port: false,
            next: None,
            leave: None,
            recorder,
            keeps_frames: false,
            has_more: false,
            opened_at: Duration::ZERO,
            short_lives: 0,
            driver: None,
            awaiting: Vec::new(),
        }
    }

    /// Keeps the latest frames of future sessions in [`RecordView::frames`](crate::RecordView::frames). It clones every message, so a
    /// simulation that runs faster than real time leaves it off.
    pub const fn keep_frames(&mut self) {
        self.keeps_frames = true;
    }

    /// Keeps the outcomes of these requests until their callers have them.
    #[cfg(feature = "native")]
    pub(crate) fn keep_awaited(&mut self, awaited: Awaited) {
        self.recorder.awaited = awaited;
    }

    /// The present state.
    #[must_use]
    pub const fn view(&self) -> &Snapshot {
        &self.recorder.view
    }

    /// Whether anything changed, and whether a repaint is worthwhile, since the last call.
    pub fn take_changes(&mut self) -> (bool, bool) {
        self.recorder.take_changes()
    }

    /// Whether a port is open.
    #[must_use]
    pub const fn is_open(&self) -> bool {
        matches!(self.phase, Phase::Open(_))
    }

    /// A transport that has just been opened, once.
    pub fn take_new_transport(&mut self) -> Option<&mut O::Transport> {
        let Phase::Open(open) = &mut self.phase else { return None };
        std::mem::take(&mut open.is_new).then_some(&mut open.transport)
    }

    /// Handles a request. A request that cannot be carried out now ends at once.
    pub fn request(&mut self, ticket: Ticket, request: Request, now: Duration) {
        self.recorder.set_time(now);
        let is_of_many =
            matches!(request, Request::Play(_) | Request::Listen(_) | Request::Refresh | Request::Note(..));
        if !is_of_many {
            self.recorder.log(Severity::Detail, format!("Request: {}.", request.name()));
        }
        if matches!(request, Request::Connect(_) | Request::Disconnect) {
            self.end_entry();
        }
        match request {
            Request::Connect(port) => {
                if let Some((older, _)) = self.next.replace((ticket, port)) {
                    self.recorder.finish(Some(older), Outcome::Superseded);
                }
                self.short_lives = 0;
                match &mut self.phase {
                    Phase::Open(open) => open.queue.leave(&mut self.recorder, now),
                    Phase::Closed | Phase::Seeking { .. } => self.open_next(now),
                }
            }
            Request::Disconnect => {
                // A port that was to be opened after the closing.
                let next = self.next.take().map(|(ticket, _)| ticket);
                self.recorder.finish(next, Outcome::Superseded);
                if let Phase::Open(open) = &mut self.phase {
                    open.queue.leave(&mut self.recorder, now);
                    let older = self.leave.replace(ticket);
                    self.recorder.finish(older, Outcome::Superseded);
                } else {
                    self.phase = Phase::Closed;
                    self.recorder.link(LinkState::Disconnected);
                    self.recorder.finish(Some(ticket), Outcome::Done { at: 0 });
                }
            }
            Request::AutoReconnect(on) => {
                self.recorder.view.link.auto_reconnect = on;
                self.recorder.touch();
                match (&self.recorder.view.link.state, on) {
                    (LinkState::Lost(error), true) => {
                        let error = error.clone();
                        self.seek(error, now);
                    }
                    (LinkState::Reconnecting(error), false) => {
                        let error = error.clone();
                        self.shut(&Outcome::NotConnected);
                        // A device that has never answered is not lost.
                        let never_there = std::mem::take(&mut self.waits_for_port);
                        let state =
                            if never_there { LinkState::Disconnected } else { LinkState::Lost(error) };
                        self.recorder.link(state);
                    }
                    (LinkState::Lost(_), false)
                    | (LinkState::Reconnecting(_), true)
                    | (LinkState::Disconnected | LinkState::Connecting | LinkState::Connected, _) => {}
                }
                self.recorder.finish(Some(ticket), Outcome::Done { at: 0 });
            }
            Request::Observe => {
                self.recorder.view.link.observes_only = true;
                self.recorder.touch();
                self.recorder.finish(Some(ticket), Outcome::Done { at: 0 });
            }
            Request::Await(patience) => self.awaiting.push((ticket, now + patience)),
            Request::Note(severity, text) => {
                self.recorder.log(severity, text);
                self.recorder.finish(Some(ticket), Outcome::Done { at: 0 });
            }
            Request::Arm
            | Request::ArmFor(_)
            | Request::Bench(_)
            | Request::Disarm
            | Request::Play(_)
            | Request::Listen(_)
            | Request::Capture(_)
            | Request::Hold(_)
            | Request::Stop
            | Request::EmergencyStop
            | Request::ClearFaults
            | Request::Upload(_)
            | Request::CancelUpload
            | Request::ReadBack
            | Request::Store
            | Request::Forget
            | Request::WriteProfile(_)
            | Request::Bootloader
            | Request::MutePin(_)
            | Request::ReadBoard
            | Request::ReadClock
            | Request::Stall
            | Request::BrownOut(_)
            | Request::FaultToken
            | Request::FaultOrder(_)
            | Request::Refresh
            | Request::Digest(_) => self.request_of_device(ticket, request, now),
        }
    }

    /// Passes a request on to the device, if there is one.
    fn request_of_device(&mut self, ticket: Ticket, request: Request, now: Duration) {
        match &mut self.phase {
            Phase::Open(open) => open.queue.request(ticket, request, &mut self.recorder, now),
            Phase::Closed | Phase::Seeking { .. } => {
                self.recorder.finish(Some(ticket), Outcome::NotConnected);
            }
        }
    }

    /// Performs all due steps: reads, evaluates replies, sends, writes, looks for a lost device.
    pub fn step(&mut self, now: Duration) {
        self.recorder.set_time(now);
        if self.recorder.view.link.auto_reconnect
            && let LinkState::Lost(error) = &self.recorder.view.link.state
        {
            let error = error.clone();
            self.seek(error, now);
        }
        if let Phase::Seeking { next } = self.phase
            && now >= next
        {
            self.look(now);
        }
        let verdict = self.exchange(now);
        match verdict {
            Next::Continue => {}
            Next::Close => self.close(now),
            Next::EnterBootloader(ticket, at) => self.enter_bootloader(ticket, at, now),
            Next::Lose(error) => self.lose(error, now),
        }
        self.watch_entry(now);
        self.end_awaiting(now);
    }

    /// Ends the waits for the device: it answers, or has not in time.
    fn end_awaiting(&mut self, now: Duration) {
        let is_connected = self.recorder.view.is_connected();
        let recorder = &mut self.recorder;
        self.awaiting.retain(|&(ticket, until)| {
            let waits = !is_connected && now < until;
            if !waits {
                let outcome = if is_connected { Outcome::Done { at: 0 } } else { Outcome::NotConnected };
                recorder.finish(Some(ticket), outcome);
            }
            waits
        });
    }

    /// The latest time of the next [`Connection::step`]; `None` while nothing is pending.
    #[must_use]
    pub fn deadline(&self, now: Duration) -> Option<Duration> {
        if self.has_more {
            return Some(now);
        }
        let due = match &self.phase {
            Phase::Closed => {
                let is_lost = matches!(self.recorder.view.link.state, LinkState::Lost(_));
                (is_lost && self.recorder.view.link.auto_reconnect).then_some(now)
            }
            Phase::Seeking { next } => Some(*next),
            // It wakes the worker.
            Phase::Open(open) if !open.transport.is_open() => None,
            Phase::Open(open) => {
                let unwritten = !open.queue.is_written();
                let watch = self.driver.as_ref().and_then(DriverWatch::deadline);
                let deadline = watch.into_iter().fold(open.queue.deadline(), Duration::min);
                Some(if unwritten { deadline.min(now + WRITE_PAUSE) } else { deadline })
            }
        };
        let awaiting = self.awaiting.iter().map(|&(_, until)| until);
        due.into_iter().chain(self.entry_deadline()).chain(awaiting).min()
    }

    fn exchange(&mut self, now: Duration) -> Next {
        let Phase::Open(open) = &mut self.phase else {
            self.has_more = false;
            return Next::Continue;
        };
        if !open.transport.is_open() {
            return self.await_opening();
        }
        let mut buffer = [0; 4096];
        self.has_more = true;
        for _ in 0..READS {
            match open.transport.read(&mut buffer) {
                Ok(0) => return Next::Lose(LinkError::Gone),
                Ok(count) => {
                    let bytes = buffer.get(..count).unwrap_or_default();
                    let verdict = open.queue.receive(bytes, &mut self.recorder, now);
                    if verdict != Next::Continue {
                        return verdict;
                    }
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => match LinkError::transfer(&error) {
                    None => {
                        self.has_more = false;
                        break;
                    }
                    Some(error) => return Next::Lose(error),
                },
            }
        }
        if let Some(driver) = &mut self.driver {
            driver.watch(&mut open.queue, &mut self.recorder, now);
        }
        let verdict = open.queue.send_due(&mut self.recorder, now);
        if verdict != Next::Continue {
            return verdict;
        }
        self.recorder.count(open.queue.channel());
        let output = open.queue.output();
        while !output.is_empty() {
            match open.transport.write(output) {
                Ok(0) => return Next::Lose(LinkError::Gone),
                Ok(count) => drop(output.drain(..count.min(output.len()))),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => match LinkError::transfer(&error) {
                    None => break,
                    Some(error) => return Next::Lose(error),
                },
            }
        }
        self.verify_identity()
    }

    /// Drops the transport; pending requests end with `outcome`.
    fn shut(&mut self, outcome: &Outcome) {
        self.has_more = false;
        if let Phase::Open(open) = std::mem::replace(&mut self.phase, Phase::Closed) {
            open.queue.end(&mut self.recorder, outcome);
        }
    }

    /// The closing is complete.
    fn close(&mut self, now: Duration) {
        self.shut(&Outcome::NotConnected);
        self.recorder.forget_device(None);
        self.recorder.link(LinkState::Disconnected);
        self.recorder.log(Severity::Info, "Disconnected.");
        self.recorder.finish(self.leave.take(), Outcome::Done { at: 0 });
        self.open_next(now);
    }
}
