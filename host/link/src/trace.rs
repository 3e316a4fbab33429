//! A trace of all frames between host and device: one line per frame, with time, direction, id, sequence and
//! decoded body.
//!
//! There are two listeners: a `tracing` subscriber for the target [`FRAMES`] at the level `TRACE`, and
//! [`Connection::keep_frames`](crate::connection::Connection::keep_frames), which keeps the latest
//! [`FRAMES_KEPT`] in the [`Snapshot`](crate::Snapshot), so that a report made after an error contains the
//! preceding frames. Without a listener no message is cloned, and a frame costs one comparison.

use slipline_protocol::{Command, Event};
use std::fmt;
use std::time::Duration;

/// The target of the `tracing` events: `RUST_LOG=slipline_link::frames=trace` shows them.
pub const FRAMES: &str = "slipline_link::frames";
/// Frames that a snapshot keeps: about six seconds of keep-alives and their replies.
pub const FRAMES_KEPT: usize = 64;

/// The decoded body of a frame.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum TracedMessage {
    /// From the host to the device.
    Command(Command),
    /// From the device to the host.
    Event(Event),
    /// From the device, with an id or a body that this build cannot decode.
    Unknown {
        /// The message's id.
        id: u8,
        /// Length of the body, in bytes.
        length: usize,
    },
}

/// One frame on the link.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct TracedFrame {
    /// When it was queued or received, since the worker was started.
    pub time: Duration,
    /// The sequence number in its header.
    pub sequence: u16,
    /// Its body.
    pub message: TracedMessage,
}

impl TracedFrame {
    /// Emits the frame as a `tracing` event.
    pub(crate) fn emit(&self) {
        tracing::trace!(target: FRAMES, "{self}");
    }
}

impl fmt::Display for TracedFrame {
    /// One line: the time in seconds, the direction, the id, the sequence number, the decoded body.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { time, sequence, message } = self;
        let (direction, id) = match message {
            TracedMessage::Command(command) => ("to device", command.id()),
            TracedMessage::Event(event) => ("to host", event.id()),
            TracedMessage::Unknown { id, .. } => ("to host", *id),
        };
        write!(f, "{:12.6} {direction:9} id={id:02x} sequence={sequence} ", time.as_secs_f64())?;
        match message {
            TracedMessage::Command(command) => write!(f, "{command:?}"),
            TracedMessage::Event(event) => write!(f, "{event:?}"),
            TracedMessage::Unknown { length, .. } => write!(f, "unknown body of {length} bytes"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_names_time_direction_id_sequence_and_body() {
        let time = Duration::from_micros(1_250_000);
        let line = |message| TracedFrame { time, sequence: 7, message }.to_string();
        assert_eq!(line(TracedMessage::Command(Command::Arm)), "    1.250000 to device id=10 sequence=7 Arm");
        assert_eq!(
            line(TracedMessage::Unknown { id: 0xee, length: 3 }),
            "    1.250000 to host   id=ee sequence=7 unknown body of 3 bytes"
        );
    }
}
