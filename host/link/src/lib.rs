//! The link to a Slipline device: the client's side of the protocol, the journal of changes that the device
//! has accepted, and the mirror that replays it.
//!
//! ```text
//! Request --> connection --> commands --> channel --> frames --> transport ==bytes==> device
//!                 |             |            |                                          (real, emulated,
//! Snapshot <------+-- journal <-+<-- reply <-+<----- frames <-- transport <==bytes==     or simulator)
//!                        |
//!                        +--> mirror (the device's own renderer) --> DAC codes
//! ```
//! [`connection`] is the state machine (connect, lose, look again); below it `commands` selects the next
//! command and `channel` numbers, times out and repeats (stop-and-wait ARQ). All receive the time from their
//! caller and own no thread, so tests, the simulation and a browser can run them. With the feature `native`,
//! a worker thread runs them on this computer's serial ports and sockets; `driver_watch` ends the drive when
//! the program that drives through that thread hangs. The features `mirror` and `simulator`, on by default, bring the device
//! application along; a client builds without them: `examples/client.rs`. Requests and snapshots are plain data, for a program
//! whose link runs in another worker of a browser: [`SnapshotUpdate`].
//!
//! # Rooms
//!
//! Short paths are below `src/`. `Tests:` names those that do not lie beside the code.
//!
//! - `connection.rs`, `rediscovery.rs`: opens a port, waits for a missing one, finds a lost device again. Tests:
//!   `tests/tests/reconnecting.rs`
//! - `commands.rs`: the order of commands, what a stop drops, and the replies. Tests: `tests/tests/link.rs`,
//!   `tests/tests/stopping.rs`
//! - `channel.rs`: numbers, times out and repeats commands. Tests: `tests/tests/repeats.rs`
//! - `request.rs`, `awaited.rs`, `snapshot.rs`, `snapshot_update.rs`: what a program asks for, the outcomes that are kept for
//!   waiting callers, what it sees, and what passes to another worker
//! - `error.rs`, `refusal.rs`, `out_of_range.rs`: errors and refusals in words. Tests: `tests/tests/port_errors.rs`,
//!   `tests/tests/limits.rs`
//! - `drive.rs`, `chord.rs`, `comb.rs`, `harmonic.rs`, `hold.rs`, `listen.rs`, `table.rs`, `played.rs`, `sounding.rs`:
//!   the bodies of requests in metres, shares and seconds, and their conversion to the device's units
//! - `journal.rs`, `mirror.rs`: the accepted changes, and their replay (what makes it inexact:
//!   `mirror/replay/exactness.rs`). Tests: `tests/tests/mirror.rs`, `tests/tests/verify.rs`
//! - `lease.rs`, `undecided.rs`, `trigger_outcome.rs`, `foldback.rs`: what the link makes of a lease, of a drive that
//!   waits for the trigger input, and of heat. Tests: `tests/tests/lease.rs`, `tests/tests/trigger_input.rs`,
//!   `tests/tests/foldback.rs`
//! - `simulator/`: the simulated device. Tests: `tests/tests/mirror.rs`; one digest on every processor:
//!   `simulator/tests/fixed_script.rs`
//! - `native/`: thread, serial ports, sockets, and a second program at a device (`native/second_program.rs`). Tests:
//!   `tests/tests/ports.rs`
//! - `driver_watch.rs`: notices a program that hangs. Tests: `tests/tests/driver_watch.rs`
//! - `transport.rs`, `port.rs`, `clock.rs`, `recorder.rs`: byte stream, ports, the caller's time, and the upkeep of a snapshot
//! - `system_words.rs`: the operating system's errors in Slipline's words
//! - `udev.rs`: the rules of Linux that let the user open a board
//! - `log.rs`, `trace.rs`, `upkeep.rs`, `remedy.rs`: the common log, the trace of frames, texts about maintenance and faults
//!
//! Run an example of `host/link/examples/` with `cargo run -p slipline-link --example replay`.

#![forbid(unsafe_code)]
// The crate is part of the browser build: clippy.toml lists what browsers do not support.
#![cfg_attr(not(test), warn(clippy::disallowed_methods, clippy::expect_used, clippy::unwrap_used))]
// A new command, request or job must be handled wherever these are matched: a drive that matches a wildcard
// could survive a stop.
#![warn(clippy::wildcard_enum_match_arm)]

mod awaited;
mod channel;
mod chord;
mod clock;
mod comb;
mod commands;
pub mod connection;
mod drive;
mod driver_watch;
mod error;
pub mod foldback;
mod harmonic;
mod hold;
mod journal;
mod lease;
mod listen;
mod log;
#[cfg(feature = "mirror")]
pub mod mirror;
#[cfg(feature = "native")]
#[cfg_attr(
    not(test),
    expect(clippy::disallowed_methods, reason = "this computer's thread, clock, ports and sockets")
)]
pub mod native;
mod out_of_range;
mod played;
mod port;
mod recorder;
mod rediscovery;
mod refusal;
mod remedy;
mod request;
#[cfg(feature = "simulator")]
pub mod simulator;
mod snapshot;
mod snapshot_update;
mod sounding;
mod system_words;
mod table;
mod trace;
pub mod transport;
mod trigger_outcome;
pub mod udev;
mod undecided;
pub mod upkeep;

pub use chord::ChordRequest;
pub use clock::Clock;
pub use comb::CombRequest;
pub use drive::{DriveError, DriveRequest, ToneRequest};
pub use driver_watch::{SIGN_PATIENCE, SIGN_PERIOD};
pub use error::LinkError;
pub use harmonic::HarmonicRequest;
pub use hold::{HeldTone, HoldLimit, HoldLoss, HoldProgress, HoldRequest, HoldState, HoldToneRequest};
pub use journal::{Acknowledged, Change};
pub use listen::{CaptureRequest, Captured, ListenRequest, Listened, WindowShape};
pub use log::{LogEntry, Severity};
pub use out_of_range::OutOfRange;
pub use played::{Played, PlayedTone};
pub use port::{Port, PortInfo, PortNameError, USB_PRODUCT, USB_VENDOR};
pub use refusal::Refusal;
pub use remedy::remedy;
pub use request::{Outcome, Request, Ticket};
pub use snapshot::{
    DeviceView, DriveView, LinkCounters, LinkState, LinkView, RecordView, RoundTrip, Snapshot, TableView,
    UploadProgress,
};
pub use snapshot_update::SnapshotUpdate;
pub use sounding::Sounding;
pub use system_words::{capitalized, system_words};
pub use table::{DeviceTable, DeviceTableError, level, span_m};
pub use trace::{FRAMES, FRAMES_KEPT, TracedFrame, TracedMessage};
pub use trigger_outcome::TriggerOutcome;

/// The messages, units and limits that the link's own types are made of.
pub use slipline_protocol as protocol;
/// Codes of one block: the device takes up changes between blocks.
pub use slipline_protocol::limits::BLOCK;

// The example opens the simulated device by this computer's worker.
#[cfg(all(doctest, feature = "native", feature = "simulator"))]
#[doc = include_str!("../README.md")]
struct Readme;
