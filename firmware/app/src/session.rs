//! Sessions: which frames are valid, which are repeats, and what is answered.
//!
//! ```text
//! bytes --> Inbox --step--> Controller --> replies --> unsent() --> link
//! ```
//! A hello with a new nonce begins a session and ends the last one; its reply carries the session's number in its
//! header. Numbered commands count from 1 and wrap. A repeat of the last number gets the cached reply; any other
//! number is refused with the one expected. The device sends replies only, never anything of its own accord.

#![cfg_attr(not(test), deny(clippy::arithmetic_side_effects))]

use embassy_sync::blocking_mutex::raw::RawMutex;
use heapless::Deque;
use slipline_protocol::command::Hello;
use slipline_protocol::event::{Accepted, Counters};
use slipline_protocol::frame::{CRC, Encoded};
use slipline_protocol::units::SampleIndex;
use slipline_protocol::version::{Minor, Version};
use slipline_protocol::{Command, Event, Refusal};

use crate::controller::Controller;
use crate::inbox::{Inbox, Incoming};
use crate::mailbox::Mailbox;
use crate::ports::{FlashPages, System};

/// Most replies that wait to be sent; one more drops the oldest.
const OUTBOX: usize = 8;

/// The state of the session, and its outbox of replies.
pub struct Session {
    outbox: Deque<Encoded, OUTBOX>,
    /// Bytes of the outbox's first reply that have been sent.
    sent: usize,
    /// A reply was sent in part and then dropped: a delimiter goes before the next reply, or the host would take both
    /// for one frame.
    owes_delimiter: bool,
    /// When the outbox's first reply began to wait.
    waiting_since: SampleIndex,
    /// 0 before the first hello.
    id: u32,
    nonce: [u8; 4],
    sessions: u32,
    may_drive: bool,
    /// The minor version that this session's host and this device share.
    minor: Minor,
    expected: u16,
    last_reply: Option<(u16, Event)>,
    duplicates: u32,
    dropped: u32,
}

impl Session {
    /// Before the first hello.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            outbox: Deque::new(),
            sent: 0,
            owes_delimiter: false,
            waiting_since: 0,
            id: 0,
            nonce: [0; 4],
            sessions: 0,
            may_drive: false,
            minor: Minor::FIRST,
            expected: 1,
            last_reply: None,
            duplicates: 0,
            dropped: 0,
        }
    }

    /// Does the command that has waited longest and puts its reply into the outbox.
    ///
    /// What takes long calls `receive` now and then, which gives the inbox what has come meanwhile: a stop need not wait
    /// until the command is done, and the command starts nothing after it.
    pub fn step<M: RawMutex, F: FlashPages, S: System>(
        &mut self,
        inbox: &mut Inbox,
        mut receive: impl FnMut(&mut Inbox),
        controller: &mut Controller<'_, F, S>,
        mailbox: &Mailbox<M>,
    ) {
        let Some(incoming) = inbox.next() else { return };
        let (stops, counters) = (inbox.stops(), self.counters(inbox));
        let mut is_stopped = || {
            receive(inbox);
            inbox.stops() != stops
        };
        let (session, event) = self.answer(&incoming, counters, &mut is_stopped, controller, mailbox);
        // A stop need not wait until the answer is written.
        is_stopped();
        // The host of another session may be older than this one's.
        let minor = if session == self.id { self.minor } else { Minor::FIRST };
        let sequence = incoming.header.sequence;
        // A host can read the answer to everything that it can ask. If it could not, it would get this refusal.
        let reply = event
            .frame_for(minor, session, sequence)
            .or_else(|_| Event::Refused(Refusal::NotSupported).frame_for(minor, session, sequence));
        if let Ok(reply) = reply {
            self.send(reply, mailbox.now());
        }
    }

    /// The reply and the session it goes out under.
    fn answer<M: RawMutex, F: FlashPages, S: System>(
        &mut self,
        incoming: &Incoming,
        counters: Counters,
        is_stopped: &mut dyn FnMut() -> bool,
        controller: &mut Controller<'_, F, S>,
        mailbox: &Mailbox<M>,
    ) -> (u32, Event) {
        let Incoming { header, command, is_stop } = incoming;
        if *is_stop {
            return (header.session, Event::Accepted(Accepted { at: mailbox.stopped_at() }));
        }
        if let Ok(Command::Hello(hello)) = command {
            self.begin(hello, controller, mailbox);
            return (self.id, Event::Hello(controller.identity()));
        }
        if self.id == 0 || header.session != self.id {
            return (header.session, Event::Refused(Refusal::StaleSession));
        }
        // To a host of an older minor this is a device of that minor.
        let newer = |command: &Command| Refusal::UnknownMessage { id: command.id() };
        let command = match command {
            Ok(command) if !self.minor.has(command.since()) => &Err(newer(command)),
            command => command,
        };
        let event = match command {
            Ok(Command::KeepAlive(keep_alive)) => {
                controller.keep_alive(*keep_alive, mailbox);
                Event::Status(controller.status(mailbox, counters))
            }
            Ok(Command::Status) => Event::Status(controller.status(mailbox, counters)),
            command => self.numbered(header.sequence, command, is_stopped, controller, mailbox),
        };
        (self.id, event)
    }

    /// Begins a session, unless this hello is the one that began the present one.
    fn begin<M: RawMutex, F: FlashPages, S: System>(
        &mut self,
        hello: &Hello,
        controller: &mut Controller<'_, F, S>,
        mailbox: &Mailbox<M>,
    ) {
        if self.id != 0 && hello.nonce == self.nonce {
            self.duplicates = self.duplicates.saturating_add(1);
            return;
        }
        controller.begin_session(mailbox);
        self.sessions = self.sessions.wrapping_add(1);
        let mut crc = CRC.digest();
        crc.update(&hello.nonce);
        crc.update(&self.sessions.to_le_bytes());
        crc.update(&mailbox.now().to_le_bytes());
        let drawn = crc.finalize();
        // 0 stands for no session, and the new id must differ from the last.
        self.id = if drawn == 0 || drawn == self.id { drawn.wrapping_add(1).max(1) } else { drawn };
        self.nonce = hello.nonce;
        self.may_drive = Version::OURS.may_drive(hello.version);
        self.minor = Version::OURS.shared_minor(hello.version);
        self.expected = 1;
        self.last_reply = None;
    }

    /// Answers a numbered command: from the cache, with a refusal of the number, or by doing it.
    fn numbered<M: RawMutex, F: FlashPages, S: System>(
        &mut self,
        sequence: u16,
        command: &Result<Command, Refusal>,
        is_stopped: &mut dyn FnMut() -> bool,
        controller: &mut Controller<'_, F, S>,
        mailbox: &Mailbox<M>,
    ) -> Event {
        if let Some((done, reply)) = &self.last_reply
            && *done == sequence
        {
            self.duplicates = self.duplicates.saturating_add(1);
            return reply.clone();
        }
        if sequence != self.expected {
            return Event::Refused(Refusal::BadSequence { expected: self.expected });
        }
        let result = match command {
            Err(refusal) => Err(*refusal),
            Ok(command) if !self.may_drive && !is_harmless(command) => Err(Refusal::VersionMismatch),
            Ok(command) => controller.execute(command, is_stopped, mailbox),
        };
        let event = result.unwrap_or_else(Event::Refused);
        self.expected = self.expected.wrapping_add(1);
        self.last_reply = Some((sequence, event.clone()));
        event
    }

    /// The link's counters.
    #[must_use]
    pub fn counters(&self, inbox: &Inbox) -> Counters {
        let received = inbox.counters();
        Counters {
            duplicates: self.duplicates,
            dropped: received.dropped.saturating_add(self.dropped),
            ..received
        }
    }

    fn send(&mut self, reply: Encoded, now: SampleIndex) {
        if self.outbox.is_full() {
            self.drop_first(now);
        }
        if self.outbox.is_empty() {
            self.waiting_since = now;
        }
        // There is room now.
        let _ = self.outbox.push_back(reply);
    }

    /// The bytes to send next; empty when there are none.
    ///
    /// A delimiter that is owed waits for a reply. So every failed write drops a reply, and a port that fails at once
    /// cannot keep the loop busy.
    #[must_use]
    pub fn unsent(&self) -> &[u8] {
        if self.owes_delimiter && !self.outbox.is_empty() {
            return &[0];
        }
        self.outbox.front().and_then(|reply| reply.get(self.sent..)).unwrap_or_default()
    }

    /// Notes that `bytes` of the unsent bytes have been sent.
    pub fn sent(&mut self, bytes: usize, now: SampleIndex) {
        if bytes == 0 {
            return;
        }
        self.waiting_since = now;
        if core::mem::take(&mut self.owes_delimiter) {
            return;
        }
        self.sent = self.sent.saturating_add(bytes);
        if self.unsent().is_empty() {
            self.outbox.pop_front();
            self.sent = 0;
        }
    }

    /// Drops the reply that has waited too long, if there is one.
    pub fn expire(&mut self, now: SampleIndex, after: u64) {
        if !self.outbox.is_empty() && now.saturating_sub(self.waiting_since) >= after {
            self.drop_first(now);
        }
    }

    /// Drops the oldest reply and counts it.
    pub fn drop_first(&mut self, now: SampleIndex) {
        if self.outbox.pop_front().is_some() {
            self.dropped = self.dropped.saturating_add(1);
            self.owes_delimiter |= core::mem::take(&mut self.sent) > 0;
            self.waiting_since = now;
        }
    }
}

/// The commands that a host of another version may send: identify, stop, and enter the bootloader.
const fn is_harmless(command: &Command) -> bool {
    matches!(
        command,
        Command::Hello(_)
            | Command::KeepAlive(_)
            | Command::Status
            | Command::Stop
            | Command::EmergencyStop
            | Command::Disarm
            | Command::BootloaderToken
            | Command::BootloaderEnter(_)
    )
}
