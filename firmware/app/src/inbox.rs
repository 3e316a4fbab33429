//! Received bytes become commands that wait to be done. A stop takes effect here, before anything that waits.

#![cfg_attr(not(test), deny(clippy::arithmetic_side_effects))]

use embassy_sync::blocking_mutex::raw::RawMutex;
use heapless::Deque;
use slipline_protocol::event::{Counters, Fault};
use slipline_protocol::{Command, Decoder, Direction, Header, Refusal};

use crate::mailbox::{Mailbox, Stop};

/// Most commands that are decoded and wait to be done. A host waits for each reply, so more than one is an exception.
const QUEUE: usize = 8;

/// A decoded command on its way to the controller.
pub(crate) struct Incoming {
    pub(crate) header: Header,
    pub(crate) command: Result<Command, Refusal>,
    /// It is a stop, which is done already.
    pub(crate) is_stop: bool,
}

/// The decoder and the queue behind it.
pub struct Inbox {
    decoder: Decoder,
    queue: Deque<Incoming, QUEUE>,
    dropped: u32,
    stops: u32,
}

impl Default for Inbox {
    fn default() -> Self {
        Self::new()
    }
}

impl Inbox {
    /// Before the first byte.
    #[must_use]
    pub const fn new() -> Self {
        Self { decoder: Decoder::new(), queue: Deque::new(), dropped: 0, stops: 0 }
    }

    /// Decodes received bytes. A stop takes effect at once; other commands wait.
    pub fn receive<M: RawMutex>(&mut self, bytes: &[u8], mailbox: &Mailbox<M>) {
        for &byte in bytes {
            let Self { decoder, queue, dropped, stops } = self;
            decoder.push(byte, |frame| {
                // A frame to the host is an echo of one of ours.
                if frame.header.direction == Direction::ToHost {
                    return;
                }
                let command = Command::decode(frame.header.id, frame.body);
                let is_stop = stop(&command, mailbox);
                if is_stop {
                    *stops = stops.wrapping_add(1);
                    // A command that came before a stop must not start anything after it.
                    while queue.pop_front().is_some() {
                        *dropped = dropped.saturating_add(1);
                    }
                }
                if queue.push_back(Incoming { header: frame.header, command, is_stop }).is_err() {
                    *dropped = dropped.saturating_add(1);
                }
            });
        }
    }

    /// Whether a command waits.
    #[must_use]
    pub fn has_work(&self) -> bool {
        !self.queue.is_empty()
    }

    /// Whether a command waits that brings other tones, and so ends a level hold.
    #[must_use]
    pub fn has_drive(&self) -> bool {
        let is_drive = |incoming: &Incoming| {
            matches!(incoming.command, Ok(Command::Drive(_) | Command::Chord(_) | Command::Comb(_)))
        };
        self.queue.iter().any(is_drive)
    }

    /// The command that has waited longest.
    pub(crate) fn next(&mut self) -> Option<Incoming> {
        self.queue.pop_front()
    }

    /// Number of stops received. A command under way when it changes must not start anything any more.
    #[must_use]
    pub const fn stops(&self) -> u32 {
        self.stops
    }

    /// Counters of the receiving side.
    #[must_use]
    pub fn counters(&self) -> Counters {
        let decoder = self.decoder.counters();
        Counters {
            frames: decoder.frames,
            crc_errors: decoder.damaged,
            overlong: decoder.overlong,
            dropped: self.dropped,
            ..Counters::default()
        }
    }
}

/// Lets a stop take effect; returns whether it is one.
fn stop<M: RawMutex>(command: &Result<Command, Refusal>, mailbox: &Mailbox<M>) -> bool {
    match command {
        Ok(Command::Stop) => mailbox.stop_at_once(Stop::Normal),
        Ok(Command::EmergencyStop) => mailbox.fault_at_once(Fault::EmergencyStop, Stop::Emergency),
        _ => return false,
    }
    true
}
