//! Errors of the client.

use crate::hold::HoldEnd;
use crate::measure::{CheckedDrive, MeasureError};
use slipline_link::protocol::event::{Fault, Faults};
use slipline_link::protocol::version::Compatibility;
use slipline_link::{LinkError, Port, Refusal, SIGN_PATIENCE, system_words, upkeep};
use std::time::Duration;

/// Latched faults.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StandingFaults {
    /// The set.
    pub faults: Faults,
    /// Each in words.
    pub text: String,
}

/// Why a client's request failed.
#[derive(Debug, thiserror::Error)]
pub enum ClientError {
    /// The system cannot start a thread.
    #[error("{}", system_words(.0))]
    Thread(#[from] std::io::Error),
    /// There is no device, or it does not answer the handshake.
    #[error("{0} does not answer")]
    NoAnswer(Port),
    /// The device, or the link on its behalf, refuses.
    #[error(transparent)]
    Refused(#[from] Refusal),
    /// The link has stopped and disarmed the device, because this program gave no sign of life.
    #[error(
        "this program was held up for {} s, so the device was stopped and disarmed: run it again",
        SIGN_PATIENCE.as_secs_f64()
    )]
    HeldUp,
    /// The device has disarmed itself: nothing was driven for as long as its lease.
    #[error("the device disarmed itself: no drive began for {} s", .0.as_secs_f64())]
    LeaseOver(Duration),
    /// Firmware and program are incompatible.
    #[error("{}", .0.sentence())]
    Mismatch(Compatibility),
    /// The board must not be armed before its user has read this warning.
    #[error("{0}")]
    Unguarded(&'static str),
    /// The board keeps no profile of its actuator; its user must read this warning before it is armed.
    #[error("{}", upkeep::NO_PROFILE)]
    NoProfile,
    /// After its restart the device's option bytes are not those that it has written.
    #[error(
        "the device's option bytes are {found:#010x} after its restart, not {written:#010x} as it has written them: do not use this \
         board before a probe has shown why"
    )]
    OptionsDiffer {
        /// As they were read back before the restart.
        written: u32,
        /// As they are now.
        found: u32,
    },
    /// The connection was lost for this reason.
    #[error(transparent)]
    Lost(LinkError),
    /// The device is no longer connected.
    #[error("the device disconnected")]
    Gone,
    /// There was no answer in time.
    #[error("the device did not answer in time")]
    Late,
    /// The outcome belongs to another request.
    #[error("the device's reply belongs to another request")]
    Unexpected,
    /// The user has interrupted the call; the drive is stopped.
    #[error("interrupted: the drive was stopped")]
    Interrupted,
    /// The levels are not held, for this reason.
    #[error("{}", .0.as_ref().map_or_else(|| "nothing is held".to_owned(), ToString::to_string))]
    NotHeld(Option<HoldEnd>),
    /// The drive is not on, or not as stated.
    #[error("{}", .0.check)]
    NotOn(Box<CheckedDrive>),
    /// The mirror does not know the device's codes: the device stopped by itself, with this fault, or changes are missing.
    #[error("{}", .0.map_or_else(
        || "not every change in the window reached this program, so its codes cannot be compared".to_owned(),
        |fault| format!("the device stopped by itself, so its codes cannot be compared: {}", fault.text())
    ))]
    NotComparable(Option<Fault>),
    /// The device stopped by itself, with these faults, or a fault is latched still.
    #[error("the device stopped: {}", .0.text)]
    Stopped(StandingFaults),
    /// A newer drive or a stop, of another thread, took the place of the request before the device had accepted it.
    #[error("a newer request or a stop took its place before the device had accepted it")]
    Superseded,
    /// A call of another thread stopped or disarmed the device.
    #[error("another thread of this program stopped the device")]
    StoppedByCall,
    /// The drive was dropped before the trigger input rose.
    #[error("the device dropped the drive before the trigger")]
    Dropped,
    /// A procedure failed.
    #[error(transparent)]
    Procedure(#[from] MeasureError),
}
