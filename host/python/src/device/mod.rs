//! The device.
//!
//! ```text
//! Python's call --attention--> call.rs, detached from the interpreter --> native client --> link's thread --> device
//!       Ctrl-C --every 50 ms--> the drive is stopped, the exception raised in the thread that has received it
//! slipline._alive (a Python thread) --sign--> sign of life; after `unattended_s` without a call: stop and disarm
//! ```
//! Where Python cannot run, no sign comes, and the link's thread stops and disarms the device within a second; where that
//! thread cannot run either, the device's own dead-man does.

mod attention;
mod call;
mod drive;
mod failure;
mod lab;
mod log;
mod measure;
mod methods;
mod step;
mod wait;

pub(crate) use call::{connect, ports};

use crate::error::Failure;
use attention::Attention;
use call::take_signal;
use pyo3::prelude::*;
use slipline_instrument::native::{ArmingConsent, Client, ClientError, InterruptibleLink};
use slipline_instrument::rig::PreparedRig;
use slipline_link::{DeviceTable, LogEntry, Port};
use slipline_plate::{DriveTable, Plate};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A connected device.
///
/// It is driven inside a ``with`` block, and is stopped and disarmed when the block is left, by whatever way: its end, an
/// exception, Ctrl-C. Any call renews ``unattended_s``: after so long without one the device is stopped and disarmed, and the
/// next call raises :class:`slipline.Unattended`. ``time.sleep`` and a debugger's prompt are no calls. Where no Python code
/// can run at all, as in C code that keeps the interpreter's lock, the drive ends within a second.
///
/// Any thread may call it, also while another waits: each call has its own answer, a newer drive supersedes one that the device
/// has not accepted yet, and a stop or a disarm ends the waits and measurements of other threads.
#[pyclass(frozen, weakref, module = "slipline")]
pub(crate) struct Device {
    client: Client<InterruptibleLink>,
    port: Port,
    rig: Option<PreparedRig>,
    attention: Attention,
    /// The process that has connected: a fork of it has no link.
    process: u32,
    state: Mutex<State>,
    /// Held by the thread that connects again.
    reconnecting: Mutex<()>,
    /// The latest line of the link's log that `logging` has.
    latest_log: Mutex<Option<LogEntry>>,
}

/// The present use of the device.
#[derive(Default)]
struct State {
    block: Block,
    loaded: Option<Loaded>,
    /// The consent of the latest `arm()`.
    consent: ArmingConsent,
    /// The sample index at which the latest drive begins.
    began: Option<u64>,
    /// The index of acceptance of the latest drive that waits for the trigger.
    accepted: Option<u64>,
}

/// The plate in use, with its tables.
#[derive(Clone)]
struct Loaded {
    plate: Arc<Plate>,
    table: Arc<DriveTable>,
    on_device: Arc<DeviceTable>,
}

/// The `with` block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Block {
    #[default]
    Before,
    Inside,
    Closed,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // Each value under these locks is complete at any time.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Device {
    /// Refuses what arms the device outside the block.
    fn check_block(&self, call: &str) -> Result<(), Failure> {
        match lock(&self.state).block {
            Block::Inside => Ok(()),
            Block::Closed => Err(closed()),
            Block::Before => Err(Failure::refused(format_args!(
                "{call} is refused outside the block: write `with connect(...) as device:`"
            ))),
        }
    }

    /// The plate in use.
    fn loaded(&self) -> Result<Loaded, Failure> {
        let loaded = lock(&self.state).loaded.clone();
        loaded.ok_or_else(|| Failure::refused("the device has no plate: call use(plate) first"))
    }
}

fn closed() -> Failure {
    Failure::refused("the device is closed: its block was left; connect again")
}

fn may_be_armed(client: &Client<InterruptibleLink>, consent: ArmingConsent) -> Result<(), Failure> {
    client.may_be_armed(consent).map_err(|error| {
        let option = if matches!(error, ClientError::Unguarded(_)) {
            "despite_brown_out_level"
        } else if matches!(error, ClientError::NoProfile) {
            "despite_no_profile"
        } else {
            return error.into();
        };
        Failure::refused(format_args!("{error} To arm it anyway: arm({option}=True)."))
    })
}
