//! What Slipline's device and host say to each other.
//!
//! ```text
//! Command --encode_body--> frame::encode --bytes--> frame::Decoder --Frame--> Command::decode
//!                                                                                  |
//! Event::decode <--Frame-- frame::Decoder <--bytes-- frame::encode <--encode_body-- Event
//! ```
//! Types, bytes, units and the turning-point table's arithmetic; no behaviour, no allocation, no floats. Both ends
//! use this crate, so they cannot disagree. `PROTOCOL.md` beside it is generated from the message tables here, and
//! `wire/v1.snap` holds the golden bytes of every message.
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

pub mod command;
pub mod event;
pub mod fault;
pub mod frame;
pub mod limits;
mod message;
pub mod refusal;
pub mod table;
pub mod units;
pub mod version;

pub use command::Command;
pub use event::Event;
pub use frame::{Decoder, Direction, Encoded, Frame, FrameError, Header};
pub use refusal::Refusal;

impl Command {
    /// The command as bytes for the link.
    ///
    /// # Errors
    /// [`FrameError::TooLong`]; no command that its types allow is (a test encodes the largest ones).
    pub fn frame(&self, session: u32, sequence: u16) -> Result<Encoded, FrameError> {
        let header = Header { direction: Direction::ToDevice, session, sequence, id: self.id() };
        frame::encode(header, |buffer| self.encode_body(buffer))
    }

    /// Whether commands of this kind are numbered: repeated ones are answered from a cache and not done twice.
    #[must_use]
    pub const fn is_sequenced(&self) -> bool {
        !matches!(self, Self::Hello(_) | Self::KeepAlive(_) | Self::Status | Self::Stop | Self::EmergencyStop)
    }
}

impl Event {
    /// The event as bytes for the link.
    ///
    /// # Errors
    /// [`FrameError::TooLong`]; no event that its types allow is (a test encodes the largest ones).
    pub fn frame(&self, session: u32, sequence: u16) -> Result<Encoded, FrameError> {
        let header = Header { direction: Direction::ToHost, session, sequence, id: self.id() };
        frame::encode(header, |buffer| self.encode_body(buffer))
    }
}
