//! The errors of a link: one sentence each, with its remedy.

use crate::port::Port;
use crate::system_words::system_words;
use std::io::{self, ErrorKind};

/// An error of the link.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum LinkError {
    /// The port does not exist.
    #[error("there is no port {0}: is the device plugged in?")]
    NoSuchPort(Port),
    /// Another program uses the port.
    #[error("{0} is in use by another program: close it there first")]
    Busy(Port),
    /// The user has no permission to open the port.
    #[error(
        "no permission to open {0}: on Linux \"slipline udev\" prints the rules that permit it; or join the group dialout and log \
         in again"
    )]
    NoPermission(Port),
    /// The name exists but is not a serial port.
    #[error("{0} is not a serial port; the socket of a served device is written unix:PATH")]
    NotSerial(Port),
    /// The port opened but nothing answered the hello.
    #[error("{0} opened but no Slipline device answers there")]
    NoAnswer(Port),
    /// A command was repeated as often as allowed and never answered.
    #[error("the device stopped answering")]
    Silent,
    /// The port disappeared: unplugged, reset, or closed at the other end.
    #[error("the device disconnected: unplugged or restarted")]
    Gone,
    /// The device no longer knows this session.
    #[error("the device was restarted, or another program took it over")]
    SessionEnded,
    /// The link's own thread has failed and cannot continue.
    #[error("the link itself has failed; the device stops by itself: start Slipline again")]
    Crashed,
    /// Any other error of the system.
    #[error("the port failed: {0}")]
    Io(String),
}

impl LinkError {
    /// The error for a system error while a port is opened.
    #[must_use]
    #[expect(clippy::wildcard_enum_match_arm, reason = "the system's kinds of errors grow with each Rust")]
    pub fn opening(port: &Port, error: &io::Error) -> Self {
        match error.kind() {
            ErrorKind::NotFound | ErrorKind::ConnectionRefused => Self::NoSuchPort(port.clone()),
            ErrorKind::PermissionDenied => Self::NoPermission(port.clone()),
            ErrorKind::ResourceBusy | ErrorKind::AddrInUse => Self::Busy(port.clone()),
            _ => Self::Io(system_words(error)),
        }
    }

    /// The error for a system error while reading or writing; `None` for errors that only mean "not yet".
    #[must_use]
    #[expect(clippy::wildcard_enum_match_arm, reason = "the system's kinds of errors grow with each Rust")]
    pub fn transfer(error: &io::Error) -> Option<Self> {
        match error.kind() {
            ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted => None,
            ErrorKind::BrokenPipe
            | ErrorKind::UnexpectedEof
            | ErrorKind::ConnectionReset
            | ErrorKind::ConnectionAborted
            | ErrorKind::NotConnected
            | ErrorKind::NotFound => Some(Self::Gone),
            _ => match error.raw_os_error() {
                // EIO and ENXIO: a tty gives them after its device was unplugged.
                Some(5 | 6) if cfg!(unix) => Some(Self::Gone),
                _ => Some(Self::Io(system_words(error))),
            },
        }
    }
}
