//! The link's state machine: open a port, talk, lose it, look for it again.
//!
//! ```text
//! Disconnected --Connect--> Connecting --greeted--> Connected --error, silence--> Lost --> Reconnecting
//!      ^                        | no answer             | Disconnect                          |  ^
//!      +------------------------+-----------------------+                 found: greet again <+  | not yet
//! ```
//! It owns no thread and no clock: whoever runs it calls [`Connection::step`] with the time and waits no longer than
//! [`Connection::deadline`]. After a loss the device is looked for; it comes back disarmed, and arming it again is
//! left to the user.

use crate::commands::{CommandQueue, Next};
use crate::error::LinkError;
use crate::log::Severity;
use crate::port::{Port, PortInfo};
use crate::recorder::Recorder;
use crate::rediscovery::Rediscovery;
use crate::request::{Outcome, Request, Ticket};
use crate::snapshot::{LinkState, Snapshot};
use crate::transport::{Opener, Transport, Waker};
use std::io;
use std::time::Duration;

/// A lost device is looked for this often; a board is back on the bus 0.2 s after a reset.
pub const SEEK_PERIOD: Duration = Duration::from_millis(250);
/// Reads per step, at most, so that a babbling device cannot keep the worker from its requests.
const READS: usize = 16;
/// What does not fit the port now is tried again after so long.
const WRITE_PAUSE: Duration = Duration::from_millis(1);

/// A session that lives shorter than this was ended by another program rather than by a restart...
const SHORT_LIFE: Duration = Duration::from_secs(5);
/// ...if it happens so often in a row: two programs that take a device from each other would stop its drive for ever.
const SHORT_LIVES: u32 = 3;

/// Draws the number that makes one session's hello differ from another's.
pub type Nonces = Box<dyn FnMut() -> [u8; 4] + Send>;

struct Open<T> {
    transport: T,
    queue: CommandQueue,
    /// Nobody has seen this transport yet: it is to be registered with the poll.
    is_new: bool,
}

enum Phase<T> {
    Closed,
    Open(Box<Open<T>>),
    Seeking { next: Duration },
}

/// The link to at most one device.
pub struct Connection<O: Opener> {
    opener: O,
    waker: Waker,
    nonces: Nonces,
    phase: Phase<O::Transport>,
    rediscovery: Option<Rediscovery>,
    /// What to open once the present device is left.
    next: Option<(Ticket, Port)>,
    leave: Option<Ticket>,
    recorder: Recorder,
    /// There may be more to read than one step took.
    has_more: bool,
    opened_at: Duration,
    /// Sessions in a row that others have ended soon after their beginning.
    short_lives: u32,
}

impl<O: Opener> Connection<O> {
    /// A link with no port open. `waker` is given to the ports it opens.
    pub fn new(opener: O, waker: Waker, nonces: Nonces) -> Self {
        let mut recorder = Recorder::default();
        recorder.view.auto_reconnect = true;
        Self {
            opener,
            waker,
            nonces,
            phase: Phase::Closed,
            rediscovery: None,
            next: None,
            leave: None,
            recorder,
            has_more: false,
            opened_at: Duration::ZERO,
            short_lives: 0,
        }
    }

    /// What is known now.
    #[must_use]
    pub const fn view(&self) -> &Snapshot {
        &self.recorder.view
    }

    /// (changed at all, worth a repaint) since the last call.
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
        match &mut self.phase {
            Phase::Open(open) if open.is_new => {
                open.is_new = false;
                Some(&mut open.transport)
            }
            _ => None,
        }
    }

    /// Takes a request. What cannot be done now ends at once.
    pub fn request(&mut self, ticket: Ticket, request: Request, now: Duration) {
        self.recorder.set_time(now);
        if !matches!(request, Request::Drive(_) | Request::Refresh | Request::Note(..)) {
            self.recorder.log(Severity::Detail, format!("Request: {}.", request.name()));
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
                self.recorder.view.auto_reconnect = on;
                self.recorder.touch();
                match (&self.recorder.view.link, on) {
                    (LinkState::Lost(error), true) => {
                        let error = error.clone();
                        self.seek(error, now);
                    }
                    (LinkState::Reconnecting(error), false) => {
                        let error = error.clone();
                        self.shut(&Outcome::NotConnected);
                        self.recorder.link(LinkState::Lost(error));
                    }
                    _ => {}
                }
                self.recorder.finish(Some(ticket), Outcome::Done { at: 0 });
            }
            Request::Note(severity, text) => {
                self.recorder.log(severity, text);
                self.recorder.finish(Some(ticket), Outcome::Done { at: 0 });
            }
            request => match &mut self.phase {
                Phase::Open(open) => open.queue.request(ticket, request, &mut self.recorder, now),
                Phase::Closed | Phase::Seeking { .. } => {
                    self.recorder.finish(Some(ticket), Outcome::NotConnected);
                }
            },
        }
    }

    /// Does all that is due: reads, understands, speaks, writes, looks for a lost device.
    pub fn step(&mut self, now: Duration) {
        self.recorder.set_time(now);
        match self.recorder.view.link.clone() {
            LinkState::Lost(error) if self.recorder.view.auto_reconnect => self.seek(error, now),
            _ => {}
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
            Next::Lose(error) => self.lose(error, now),
        }
    }

    /// The latest time of the next [`Connection::step`]; `None` while nothing can happen by itself.
    #[must_use]
    pub fn deadline(&self, now: Duration) -> Option<Duration> {
        match &self.phase {
            _ if self.has_more => Some(now),
            Phase::Closed => match self.recorder.view.link {
                LinkState::Lost(_) if self.recorder.view.auto_reconnect => Some(now),
                _ => None,
            },
            Phase::Seeking { next } => Some(*next),
            Phase::Open(open) => {
                let unwritten = !open.queue.is_written();
                let deadline = open.queue.deadline();
                Some(if unwritten { deadline.min(now + WRITE_PAUSE) } else { deadline })
            }
        }
    }

    fn exchange(&mut self, now: Duration) -> Next {
        let Phase::Open(open) = &mut self.phase else {
            self.has_more = false;
            return Next::Continue;
        };
        let mut buffer = [0; 4096];
        self.has_more = true;
        for _ in 0..READS {
            match open.transport.read(&mut buffer) {
                Ok(0) => return Next::Lose(LinkError::Gone),
                Ok(count) => {
                    let bytes = buffer.get(..count).unwrap_or_default();
                    match open.queue.receive(bytes, &mut self.recorder, now) {
                        Next::Continue => {}
                        verdict => return verdict,
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
        match open.queue.send_due(&mut self.recorder, now) {
            Next::Continue => {}
            verdict => return verdict,
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

    /// After a reconnection: is it the same device?
    fn verify_identity(&mut self) -> Next {
        let Some(rediscovery) = &mut self.rediscovery else { return Next::Continue };
        let Some(unit) = self.recorder.view.identity.as_ref().map(|identity| identity.unit) else {
            return Next::Continue;
        };
        let is_it = rediscovery.is_it(unit, self.recorder.view.port.as_ref());
        if is_it { Next::Continue } else { Next::Lose(LinkError::Gone) }
    }

    /// Drops the transport; whatever waits ends with `outcome`.
    fn shut(&mut self, outcome: &Outcome) {
        self.has_more = false;
        if let Phase::Open(open) = std::mem::replace(&mut self.phase, Phase::Closed) {
            open.queue.end(&mut self.recorder, outcome);
        }
    }

    /// The closing is over.
    fn close(&mut self, now: Duration) {
        self.shut(&Outcome::NotConnected);
        self.recorder.forget_device(None);
        self.recorder.link(LinkState::Disconnected);
        self.recorder.log(Severity::Info, "Disconnected.");
        self.recorder.finish(self.leave.take(), Outcome::Done { at: 0 });
        self.open_next(now);
    }

    fn lose(&mut self, error: LinkError, now: Duration) {
        let was_first = self.recorder.view.link == LinkState::Connecting;
        let error = match (&self.recorder.view.port, error) {
            (Some(port), LinkError::Silent) if was_first => LinkError::NoAnswer(port.clone()),
            (_, error) => error,
        };
        let is_leaving = self.leave.is_some() || self.next.is_some();
        let outcome = if was_first { Outcome::Refused(error.clone().into()) } else { Outcome::NotConnected };
        self.shut(&outcome);
        if is_leaving {
            return self.close(now);
        }
        let is_short = error == LinkError::SessionEnded && now < self.opened_at + SHORT_LIFE;
        self.short_lives = if is_short { self.short_lives + 1 } else { 0 };
        let was_seeking = matches!(self.recorder.view.link, LinkState::Reconnecting(_));
        self.recorder.forget_device(Some(error.clone()));
        if was_first || self.short_lives >= SHORT_LIVES {
            self.recorder.link(LinkState::Disconnected);
        } else if was_seeking {
            // A port that is there but does not answer yet: it may still be starting.
            self.phase = Phase::Seeking { next: now + SEEK_PERIOD };
        } else {
            self.recorder.log(Severity::Error, format!("Connection lost: {error}."));
            self.recorder.link(LinkState::Lost(error));
        }
    }

    fn seek(&mut self, error: LinkError, now: Duration) {
        self.recorder.log(Severity::Info, "Looking for the device.");
        self.recorder.link(LinkState::Reconnecting(error));
        self.phase = Phase::Seeking { next: now };
    }

    fn open_next(&mut self, now: Duration) {
        let Some((ticket, port)) = self.next.take() else { return };
        let known = self.opener.list().into_iter().find(|info| info.port == port);
        let info = known.unwrap_or_else(|| PortInfo {
            label: port.to_string(),
            port: port.clone(),
            is_ours: false,
            usb_serial: None,
        });
        self.recorder.view.port = Some(port.clone());
        self.recorder.begin();
        self.rediscovery = Some(Rediscovery::at(info));
        self.recorder.log(Severity::Info, format!("Connecting to {port}."));
        self.recorder.link(LinkState::Connecting);
        if let Err(error) = self.open(&port, Some(ticket), now) {
            self.phase = Phase::Closed;
            self.recorder.forget_device(Some(error.clone()));
            self.recorder.link(LinkState::Disconnected);
            self.recorder.finish(Some(ticket), Outcome::Refused(error.into()));
        }
    }

    fn open(&mut self, port: &Port, ticket: Option<Ticket>, now: Duration) -> Result<(), LinkError> {
        let transport = self.opener.open(port, &self.waker)?;
        self.opened_at = now;
        let queue = CommandQueue::begin((self.nonces)(), ticket, now);
        self.phase = Phase::Open(Box::new(Open { transport, queue, is_new: true }));
        Ok(())
    }

    /// Looks for the lost device once.
    fn look(&mut self, now: Duration) {
        self.phase = Phase::Seeking { next: now + SEEK_PERIOD };
        let ports = self.opener.list();
        let Some(port) = self.rediscovery.as_mut().and_then(|lost| lost.find(ports)) else { return };
        if self.open(&port, None, now).is_ok() {
            self.recorder.view.port = Some(port);
            self.recorder.begin();
        }
    }
}
