//! The protocol between Slipline's device and host.
//!
//! ```text
//! host:    Command --frame_for--> bytes ==> Decoder --Frame--> Command::decode   :device
//!            |                                                       |
//!          Event::decode <--Frame-- Decoder <== bytes <--frame_for-- Event
//! ```
//! Types, bytes, units and the arithmetic of the turning-point table; no behaviour, no allocation, no floats. Both
//! sides use this crate, so they cannot disagree. `PROTOCOL.md` beside it is made from the message tables here, and
//! `wire/v1.snap` holds the frozen frames of every message.
//!
//! # Rooms
//!
//! Short paths are below `src/`. `Tests:` names those that do not lie beside the code.
//!
//! - `command.rs`, `event.rs`: the messages and their bodies. Tests: `shared/tests/golden.rs`,
//!   `tests/tests/minor_versions.rs`
//! - `board.rs`, `hold.rs`, `listen.rs`, `profile.rs`: bodies of the messages about a board, a level hold, the inputs,
//!   an actuator
//! - `message.rs`, `schema.rs`: the macro that defines messages from a table, and their schema, from which
//!   `PROTOCOL.md` is made
//! - `frame.rs`: messages as bytes on a link. Tests: `tests/tests/frames.rs`
//! - `version.rs`, `minor.rs`: what two sides of different ages may send to each other
//! - `limits.rs`: limits that both ends know, such as times, ramps and sizes (`MAX_DRIVE_MS`). Tests:
//!   `tests/tests/limits.rs`
//! - `refusal.rs`: refusals and their ranges; `slipline-app` checks them, `slipline-link` words them. Tests:
//!   `tests/tests/limits.rs`
//! - `fault.rs`: faults; `slipline-app` raises them in `safety`. Tests: `tests/tests/health.rs`
//! - `timing.rs`: the times of the protocol in samples of a device
//! - `table.rs`, `units.rs`: the arithmetic of the turning-point table, and the integer units
//!
//! The Python client (`tests/protocol/`) is written from `PROTOCOL.md`, never from this code.
#![no_std]
#![forbid(unsafe_code)]
#![cfg_attr(
    not(test),
    deny(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::indexing_slicing,
        clippy::float_arithmetic
    )
)]

pub mod board;
pub mod command;
pub mod event;
pub mod fault;
pub mod frame;
pub mod hold;
pub mod limits;
pub mod listen;
mod message;
mod minor;
pub mod profile;
pub mod refusal;
pub mod schema;
pub mod table;
pub mod timing;
pub mod units;
pub mod version;

pub use command::Command;
pub use event::Event;
pub use frame::{Decoder, Direction, Encoded, Frame, FrameError, Header};
pub use refusal::Refusal;

use minor::Minor;

impl Command {
    /// The command as bytes for the link, for a device with which the host shares a minor version.
    ///
    /// ```
    /// use slipline_protocol::version::Minor;
    /// use slipline_protocol::{Command, Decoder, Direction};
    ///
    /// let bytes = Command::Arm.frame_for(Minor::OURS, 0x0403_0201, 7)?;
    /// let mut decoder = Decoder::new();
    /// let heard = bytes.iter().find_map(|&byte| {
    ///     decoder.push(byte, |frame| {
    ///         assert_eq!((frame.header.direction, frame.header.sequence), (Direction::ToDevice, 7));
    ///         Command::decode(frame.header.id, frame.body)
    ///     })
    /// });
    /// assert_eq!(heard, Some(Ok(Command::Arm)));
    /// # Ok::<(), slipline_protocol::FrameError>(())
    /// ```
    ///
    /// # Errors
    /// [`FrameError::TooNew`] for a command that the device does not know; [`FrameError::TooLong`], which no command
    /// that its types allow is (a test encodes the largest ones).
    pub fn frame_for(&self, minor: Minor, session: u32, sequence: u16) -> Result<Encoded, FrameError> {
        if !self.is_known(minor) {
            return Err(FrameError::TooNew);
        }
        let header = Header { direction: Direction::ToDevice, session, sequence, id: self.id() };
        frame::encode(header, |buffer| self.encode_body(buffer))
    }

    /// Whether a device that speaks a minor version knows the command and everything in it. One that it does not know is
    /// never sent in another form: the device would do something else.
    #[must_use]
    pub fn is_known(&self, minor: Minor) -> bool {
        self.lowered(minor).as_ref() == Some(self)
    }

    /// Whether commands of this kind are numbered: repeated ones are answered from a cache and not done twice.
    #[must_use]
    pub const fn is_sequenced(&self) -> bool {
        !matches!(self, Self::Hello(_) | Self::KeepAlive(_) | Self::Status | Self::Stop | Self::EmergencyStop)
    }
}

impl Event {
    /// The event as bytes for the link, for a host with which the device shares a minor version. A refusal or a fault
    /// that is newer goes as the older one that takes its place.
    ///
    /// ```
    /// use slipline_protocol::event::Accepted;
    /// use slipline_protocol::version::Minor;
    /// use slipline_protocol::{Decoder, Event};
    ///
    /// let event = Event::Accepted(Accepted { at: 128 });
    /// let bytes = event.frame_for(Minor::FIRST, 0x0403_0201, 7)?;
    /// let mut decoder = Decoder::new();
    /// let heard =
    ///     bytes.iter().find_map(|&byte| decoder.push(byte, |frame| Event::decode(frame.header.id, frame.body)));
    /// assert_eq!(heard, Some(Ok(event)));
    /// # Ok::<(), slipline_protocol::FrameError>(())
    /// ```
    ///
    /// # Errors
    /// [`FrameError::TooNew`] for an event that the host does not know: it answers none of the commands that the host
    /// can send. [`FrameError::TooLong`], which no event that its types allow is (a test encodes the largest ones).
    pub fn frame_for(&self, minor: Minor, session: u32, sequence: u16) -> Result<Encoded, FrameError> {
        let said = self.lowered(minor).ok_or(FrameError::TooNew)?;
        let header = Header { direction: Direction::ToHost, session, sequence, id: said.id() };
        frame::encode(header, |buffer| said.encode_body(buffer))
    }
}

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
