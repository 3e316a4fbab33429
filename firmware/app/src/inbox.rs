//! Received bytes become commands that wait to be done. A stop takes effect here, before anything that waits.

#![cfg_attr(not(test), deny(clippy::arithmetic_side_effects))]

use embassy_sync::blocking_mutex::raw::RawMutex;
use heapless::{Deque, Vec};
use slipline_protocol::event::{Counters, Fault};
use slipline_protocol::limits::MAX_BODY;
use slipline_protocol::{Command, Decoder, Direction, Header, Refusal};

use crate::mailbox::{Mailbox, Stop};

/// Most commands that wait to be done. A host waits for each reply, so more than one is an exception.
const QUEUE: usize = 8;
/// The ids of the stops, and of the commands that bring other tones.
const STOPS: [u8; 2] = [Command::Stop.id(), Command::EmergencyStop.id()];
const DRIVES: [u8; 3] = [0x12, 0x19, 0x1a];

/// A command that waits. It is decoded when its turn comes: a drive takes thousands of cycles, in which no stop is looked for.
struct Waiting {
    header: Header,
    body: Vec<u8, MAX_BODY>,
    is_stop: bool,
}

/// A command on its way to the controller.
pub(crate) struct Incoming {
    pub(crate) header: Header,
    pub(crate) command: Result<Command, Refusal>,
    /// It is a stop, which is done already.
    pub(crate) is_stop: bool,
}

/// The decoder and the queue behind it.
pub struct Inbox {
    decoder: Decoder,
    queue: Deque<Waiting, QUEUE>,
    dropped: u32,
    stops: u32,
}

impl Inbox {
    /// Before the first byte.
    #[must_use]
    pub const fn new() -> Self {
        Self { decoder: Decoder::new(), queue: Deque::new(), dropped: 0, stops: 0 }
    }

    /// Finds the commands in received bytes. A stop takes effect at once; other commands wait.
    pub fn receive<M: RawMutex>(&mut self, bytes: &[u8], mailbox: &Mailbox<M>) {
        for &byte in bytes {
            let Self { decoder, queue, dropped, stops } = self;
            decoder.push(byte, |frame| {
                // A frame to the host is an echo of one of ours.
                if frame.header.direction == Direction::ToHost {
                    return;
                }
                let header = frame.header;
                let is_stop =
                    STOPS.contains(&header.id) && stop(&Command::decode(header.id, frame.body), mailbox);
                if is_stop {
                    *stops = stops.wrapping_add(1);
                    // A command that came before a stop must not start anything after it.
                    while queue.pop_front().is_some() {
                        *dropped = dropped.saturating_add(1);
                    }
                }
                // A frame's body fits.
                let waits = Vec::from_slice(frame.body)
                    .is_ok_and(|body| queue.push_back(Waiting { header, body, is_stop }).is_ok());
                if !waits {
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
        self.queue.iter().any(|waiting| DRIVES.contains(&waiting.header.id))
    }

    /// The command that has waited longest.
    pub(crate) fn next(&mut self) -> Option<Incoming> {
        let Waiting { header, body, is_stop } = self.queue.pop_front()?;
        Some(Incoming { header, command: Command::decode(header.id, &body), is_stop })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ids_match_the_commands() {
        let ids = |names: &[&str]| {
            let rows = Command::TABLE.iter().filter(|row| names.contains(&row.name));
            rows.map(|row| row.id).collect::<std::vec::Vec<_>>()
        };
        assert_eq!(ids(&["Drive", "Chord", "Comb"]), DRIVES);
        assert_eq!(ids(&["Stop", "EmergencyStop"]), STOPS);
    }
}
