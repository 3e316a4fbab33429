//! The link to a device: one worker thread owns the port; everything else sends requests and looks at snapshots.
//!
//! ```text
//! Request --Worker::send--> [ connection -> conversation -> frames ] --Transport--> device
//! Snapshot <--Worker::snapshot-- [          "                      ] <-------------
//! ```
//! [`connection`] is the state machine (connect, lose, look again); behind it `dialogue` knows what to say next and
//! `conversation` numbers, times out and repeats. All are told the time and own no thread, so tests and the
//! simulation run them in virtual time. [`worker`] gives them a thread; [`serial`], `socket` and [`pace`] are the ends
//! they talk through.

pub mod connection;
mod conversation;
mod dialogue;
pub mod opener;
pub mod pace;
mod port;
mod record;
mod request;
pub mod serial;
mod serial_ports;
pub mod simulated;
mod snapshot;
#[cfg(unix)]
pub mod socket;
mod sought;
pub mod transport;
mod trouble;
mod upload;
pub mod watch;
pub mod worker;

pub use port::{Port, PortInfo, PortNameError, USB_PRODUCT, USB_PRODUCT_NAME, USB_VENDOR};
pub use serial_ports::list_ports;
pub use request::{DriveError, DriveRequest, Outcome, Request, Ticket, ToneRequest};
pub use snapshot::{
    Acknowledged, Change, JOURNAL_ENTRIES, LOG_LINES, LinkCounters, LinkState, LogEntry, OUTCOMES, RoundTrip,
    Severity, Snapshot, UploadProgress,
};
pub use trouble::Trouble;
