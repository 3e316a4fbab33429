//! One session's channel to a device: numbering, time-outs and repeats (stop-and-wait ARQ). It has no clock and no port:
//! its caller passes the time and moves the bytes.
//!
//! A command travels in one of three lanes, each with at most one unanswered command: [`Lane::Urgent`] for
//! the stops, which never wait; [`Lane::Periodic`] for hello, keep-alives and status; [`Lane::Ordered`] for
//! all numbered commands. A numbered command is repeated under its own number, so the device executes it
//! once. An unanswered keep-alive is replaced by a new one, because a repeated one does not reset the
//! dead-man.

use crate::snapshot::LinkCounters;
use crate::trace::{FRAMES, TracedFrame, TracedMessage};
use slipline_protocol::board::BrownOutOrder;
use slipline_protocol::frame::DecoderCounters;
use slipline_protocol::limits::{KEEP_ALIVE_PERIOD_MS, MAX_RETRIES, REPLY_TIMEOUT_MS};
use slipline_protocol::version::{Minor, Version};
use slipline_protocol::{Command, Decoder, Direction, Event, Refusal, command, event};
use std::time::Duration;

/// Time without a reply after which a command is sent again.
const REPLY_TIMEOUT: Duration = Duration::from_millis(REPLY_TIMEOUT_MS as u64);
/// Time between two keep-alives.
pub(crate) const KEEP_ALIVE_PERIOD: Duration = Duration::from_millis(KEEP_ALIVE_PERIOD_MS as u64);
/// Time without a reply after which a command that writes to flash is sent again: erasing and writing a slot takes the
/// slowest board, the H743, up to 4.2 s.
const FLASH_PATIENCE: Duration = Duration::from_secs(6);

/// Whether a device writes its flash for this command: it does not answer for seconds, and not while anything sounds.
pub(crate) const fn writes_flash(command: &Command) -> bool {
    matches!(
        command,
        Command::Store
            | Command::Forget
            | Command::WriteProfile(_)
            | Command::BrownOut(BrownOutOrder { is_written: true })
    )
}

/// Which queue a command travels in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Lane {
    /// Stop and emergency stop.
    Urgent,
    /// Hello, keep-alive, status.
    Periodic,
    /// All numbered commands.
    Ordered,
}

impl Lane {
    const fn of(command: &Command) -> Self {
        if matches!(command, Command::Stop | Command::EmergencyStop) {
            Self::Urgent
        } else if command.is_sequenced() {
            Self::Ordered
        } else {
            Self::Periodic
        }
    }
}

/// A reply with the command that it answers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Answer {
    /// The command.
    pub(crate) command: Command,
    /// The device's reply.
    pub(crate) reply: Reply,
    /// Time since the command was last sent.
    pub(crate) round_trip: Duration,
}

/// The content of a reply.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Reply {
    /// The device's version, and the rest of its identity where this program can read it.
    Hello(Version, Option<Box<event::Identity>>),
    /// Any other event.
    Event(Box<Event>),
}

/// The device has not answered although the command was sent as often as allowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct RetriesExhausted;

#[derive(Clone, Debug)]
struct Pending {
    command: Command,
    /// It is never sent again: a harmless command is sent under its number.
    is_withdrawn: bool,
    sequence: u16,
    sent: Duration,
    repeats: u32,
}

/// The host's half of one session.
#[derive(Debug, Default)]
pub(crate) struct Channel {
    nonce: [u8; 4],
    /// The session's number on the wire: 0 until the header of the device's hello has stated it.
    session: u32,
    /// The protocol version that this program and the device share.
    minor: Minor,
    sequence: u16,
    keep_alives: u32,
    unsequenced_number: u16,
    urgent: Option<Pending>,
    periodic: Option<Pending>,
    ordered: Option<Pending>,
    decoder: Decoder,
    out: Vec<u8>,
    /// Whether `traced` is filled.
    keeps_frames: bool,
    /// The frames since the last call of [`Channel::take_traced`].
    traced: Vec<TracedFrame>,
    counters: LinkCounters,
}

impl Channel {
    /// A channel that begins with a hello of this nonce. `keeps_frames`: whether it keeps every frame for
    /// [`Channel::take_traced`].
    pub(crate) fn new(nonce: [u8; 4], keeps_frames: bool) -> Self {
        Self {
            nonce,
            // A session's first numbered command has number 1.
            sequence: 1,
            // Each session begins at another number, so that a reply to an earlier hello is not taken for one
            // to this hello.
            unsequenced_number: u16::from_le_bytes([nonce[0], nonce[1]]),
            // Ends a frame that an earlier host left unfinished, so that the hello need not be sent twice.
            out: vec![0],
            keeps_frames,
            ..Self::default()
        }
    }

    /// The hello of this session.
    pub(crate) const fn hello(&self) -> Command {
        Command::Hello(command::Hello { version: Version::OURS, nonce: self.nonce })
    }

    /// Whether the device knows this command: a command that is newer than its firmware is never sent.
    pub(crate) fn is_known(&self, command: &Command) -> bool {
        command.is_known(self.minor)
    }

    /// Whether a numbered command may be sent now.
    pub(crate) const fn is_free(&self) -> bool {
        self.ordered.is_none()
    }

    /// Whether a hello, keep-alive or status waits for its answer.
    pub(crate) const fn awaits_periodic(&self) -> bool {
        self.periodic.is_some()
    }

    /// The stop that waits for its answer.
    pub(crate) fn pending_stop(&self) -> Option<&Command> {
        self.urgent.as_ref().map(|pending| &pending.command)
    }

    /// The counters of this channel.
    pub(crate) const fn counters(&self) -> LinkCounters {
        self.counters
    }

    /// The counters of the decoder.
    pub(crate) const fn decoder(&self) -> DecoderCounters {
        self.decoder.counters()
    }

    /// Sends a command. It replaces an unanswered command of its lane; numbered commands may be sent only
    /// while [`Channel::is_free`].
    pub(crate) fn send(&mut self, command: Command, now: Duration) {
        self.counters.commands = self.counters.commands.saturating_add(1);
        let lane = Lane::of(&command);
        let sequence = if lane == Lane::Ordered { self.sequence } else { self.unsequenced() };
        self.queue(&command, sequence, now);
        let pending = Pending { command, is_withdrawn: false, sequence, sent: now, repeats: 0 };
        *self.lane_mut(lane) = Some(pending);
    }

    /// Sends the next keep-alive. It replaces an unanswered one, because a repeated keep-alive does not reset
    /// the dead-man.
    pub(crate) fn keep_alive(&mut self, now: Duration) {
        let unanswered = self.periodic.as_ref().map(|pending| pending.repeats);
        self.keep_alives = self.keep_alives.wrapping_add(1);
        self.send(Command::KeepAlive(command::KeepAlive { beat: self.keep_alives }), now);
        let in_flash = self.in_flash();
        if let (Some(repeats), Some(pending)) = (unanswered, &mut self.periodic) {
            pending.repeats = if in_flash { repeats } else { repeats + 1 };
            self.counters.timeouts = self.counters.timeouts.saturating_add(1);
            self.counters.retries = self.counters.retries.saturating_add(1);
        }
    }

    /// Never sends an unanswered numbered command again: if it was lost, a harmless command is sent under its
    /// number. For a drive that a stop has overtaken.
    pub(crate) fn withdraw(&mut self) {
        if let Some(pending) = &mut self.ordered {
            pending.is_withdrawn = true;
        }
    }

    /// Decodes bytes from the device; returns the replies with their commands.
    pub(crate) fn receive(&mut self, bytes: &[u8], now: Duration) -> Vec<Answer> {
        let mut answers = Vec::new();
        for &byte in bytes {
            let received = self.decoder.push(byte, |frame| {
                if frame.header.direction != Direction::ToHost {
                    return None;
                }
                let event = Event::decode(frame.header.id, frame.body);
                Some((frame.header, frame.body.len(), event, foreign_version(frame.header.id, frame.body)))
            });
            let Some(Some((header, length, event, foreign))) = received else { continue };
            self.trace(now, header.sequence, || match &event {
                Ok(event) => TracedMessage::Event(event.clone()),
                Err(_) => TracedMessage::Unknown { id: header.id, length },
            });
            let reply = match event {
                Ok(Event::Hello(identity)) => Some(Reply::Hello(identity.version, Some(Box::new(identity)))),
                Ok(event) => Some(Reply::Event(Box::new(event))),
                Err(_) => foreign.map(|version| Reply::Hello(version, None)),
            };
            let is_hello = matches!(reply, Some(Reply::Hello(..)));
            let answer = reply
                .filter(|_| is_hello || header.session == self.session)
                .and_then(|reply| self.match_reply(header.sequence, reply, now));
            match answer {
                Some(answer) => {
                    if let Reply::Hello(version, _) = &answer.reply {
                        self.session = header.session;
                        self.minor = Version::OURS.shared_minor(*version);
                    }
                    answers.push(answer);
                }
                None => self.counters.unmatched = self.counters.unmatched.saturating_add(1),
            }
        }
        answers
    }

    /// Repeats overdue commands. Keep-alives are not repeated: [`Channel::keep_alive`] is called
    /// periodically.
    ///
    /// # Errors
    /// [`RetriesExhausted`] once a command has been sent and repeated as often as allowed.
    pub(crate) fn tick(&mut self, now: Duration) -> Result<(), RetriesExhausted> {
        for lane in [Lane::Urgent, Lane::Ordered, Lane::Periodic] {
            let patience = self.patience();
            let Some(pending) = self.lane_mut(lane) else { continue };
            if now < pending.sent + patience {
                continue;
            }
            if pending.repeats >= MAX_RETRIES {
                return Err(RetriesExhausted);
            }
            if matches!(pending.command, Command::KeepAlive(_) | Command::Status) {
                continue;
            }
            pending.repeats += 1;
            pending.sent = now;
            let command = if pending.is_withdrawn { Command::TableDigest } else { pending.command.clone() };
            let sequence = pending.sequence;
            self.queue(&command, sequence, now);
            self.counters.timeouts = self.counters.timeouts.saturating_add(1);
            self.counters.retries = self.counters.retries.saturating_add(1);
        }
        Ok(())
    }

    /// When [`Channel::tick`] must be called next.
    pub(crate) fn deadline(&self) -> Option<Duration> {
        let sent = [&self.urgent, &self.periodic, &self.ordered]
            .into_iter()
            .flatten()
            .map(|pending| pending.sent)
            .min();
        sent.map(|sent| sent + self.patience())
    }

    /// The frames since the last call, oldest first; none if the channel does not keep them.
    pub(crate) fn take_traced(&mut self) -> Vec<TracedFrame> {
        std::mem::take(&mut self.traced)
    }

    /// Traces a frame. `message` clones it, so it is called only if there is a listener.
    fn trace(&mut self, time: Duration, sequence: u16, message: impl FnOnce() -> TracedMessage) {
        if !self.keeps_frames && !tracing::enabled!(target: FRAMES, tracing::Level::TRACE) {
            return;
        }
        let frame = TracedFrame { time, sequence, message: message() };
        frame.emit();
        if self.keeps_frames {
            self.traced.push(frame);
        }
    }

    /// The bytes that wait to be written; the caller removes what it has written.
    pub(crate) const fn output(&mut self) -> &mut Vec<u8> {
        &mut self.out
    }

    /// Whether no bytes wait to be written.
    pub(crate) const fn is_written(&self) -> bool {
        self.out.is_empty()
    }

    fn in_flash(&self) -> bool {
        let sent = self.ordered.as_ref().map(|pending| &pending.command);
        sent.is_some_and(writes_flash)
    }

    fn patience(&self) -> Duration {
        if self.in_flash() { FLASH_PATIENCE } else { REPLY_TIMEOUT }
    }

    fn lane_mut(&mut self, lane: Lane) -> &mut Option<Pending> {
        match lane {
            Lane::Urgent => &mut self.urgent,
            Lane::Periodic => &mut self.periodic,
            Lane::Ordered => &mut self.ordered,
        }
    }

    /// A number that differs from those of all pending numbered commands, so that replies cannot be confused.
    fn unsequenced(&mut self) -> u16 {
        // At least 0x4000 from every numbered command that can be pending at the same time: a reply must not
        // match a command of another lane.
        self.unsequenced_number = self.unsequenced_number.wrapping_add(1);
        self.sequence.wrapping_add(0x4000 | (self.unsequenced_number & 0x3fff))
    }

    fn queue(&mut self, command: &Command, sequence: u16, now: Duration) {
        let session = if matches!(command, Command::Hello(_)) { 0 } else { self.session };
        // Every command that its types allow fits a frame, as a test of the protocol shows. If one did not,
        // it would not be sent, and the link would be lost as silent.
        if let Ok(frame) = command.frame_for(self.minor, session, sequence) {
            self.out.extend_from_slice(&frame);
            self.trace(now, sequence, || TracedMessage::Command(command.clone()));
        }
    }

    /// Matches a reply with its command.
    fn match_reply(&mut self, sequence: u16, reply: Reply, now: Duration) -> Option<Answer> {
        // A device takes every hello; where another program has the device, the hello is refused in its place.
        let is_taken =
            matches!(&reply, Reply::Event(event) if **event == Event::Refused(Refusal::StaleSession));
        let is_hello = matches!(reply, Reply::Hello(..));
        let lane = [Lane::Ordered, Lane::Urgent, Lane::Periodic].into_iter().find(|&lane| {
            self.lane_mut(lane).as_ref().is_some_and(|pending| {
                let is_pending = matches!(pending.command, Command::Hello(_));
                pending.sequence == sequence && (is_hello == is_pending || is_taken && is_pending)
            })
        })?;
        let pending = self.lane_mut(lane).take()?;
        if lane == Lane::Ordered {
            self.sequence = if let Reply::Event(event) = &reply
                && let Event::Refused(Refusal::BadSequence { expected }) = **event
            {
                // The device has not counted this command.
                expected
            } else {
                self.sequence.wrapping_add(1)
            };
        }
        Some(Answer { round_trip: now.saturating_sub(pending.sent), command: pending.command, reply })
    }
}

/// The version in the body of a hello that this program cannot decode: of another protocol version only the
/// first six bytes are defined.
fn foreign_version(id: u8, body: &[u8]) -> Option<Version> {
    const HELLO: u8 = 0x81;
    match *body {
        [major, minor, a, b, c, d, ..] if id == HELLO => Some(Version { major, minor, schema: [a, b, c, d] }),
        _ => None,
    }
}
