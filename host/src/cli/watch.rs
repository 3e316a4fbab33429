//! `slipline watch`: the device's status as lines of JSON. It arms nothing and drives nothing.

use super::destination::ForceArgument;
use super::device::Device;
use super::failure::Failure;
use super::output;
use super::rig::PortArgument;
use crate::signals;
use clap::Args;
use serde_json::{Value, json};
use slipline_link::protocol::event::Status;
use slipline_link::{LinkState, Snapshot};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Time between two looks for a new status; the link requests one every fifth of a second.
const GLANCE: Duration = Duration::from_millis(50);

/// `watch`.
#[derive(Debug, Args)]
pub struct WatchArguments {
    #[command(flatten)]
    port: PortArgument,
    // For the trace, which main writes.
    #[command(flatten)]
    force: ForceArgument,
}

/// Prints each status until a signal comes or the reader of the lines leaves.
pub(super) fn run(arguments: &WatchArguments) -> Result<(), Failure> {
    let port = arguments.port.port()?;
    let ended = Arc::new(AtomicBool::new(false));
    let is_ended = Arc::clone(&ended);
    let device = Device::observe(&port, arguments.port.rig(None)?.as_ref())?;
    let _closing = signals::end_normally_by(move || is_ended.store(true, Ordering::Relaxed));
    let mut before = None;
    while !ended.load(Ordering::Relaxed) {
        let snapshot = device.snapshot();
        if let LinkState::Lost(trouble) = &snapshot.link.state {
            return Err(Failure::Failed(trouble.to_string()));
        }
        if let Some(status) = snapshot.drive.status.filter(|status| before != Some(status.now)) {
            before = Some(status.now);
            if !output::line(&value(&port.to_string(), &snapshot, &status))? {
                return Ok(());
            }
        }
        device.pause(GLANCE);
    }
    Ok(())
}

fn value(port: &str, snapshot: &Snapshot, status: &Status) -> Value {
    let rate_hz = snapshot.sample_rate_hz();
    let faults: Vec<_> = status.faults.iter().map(|fault| snapshot.fault_text(fault)).collect();
    json!({
        "port": port,
        "now_samples": status.now,
        // JSON: Time of the device's present sample
        "now_s": rate_hz.map(|rate_hz| status.now as f64 / rate_hz),
        "state": format!("{:?}", status.state),
        "faults": faults,
        "heat": f64::from(status.heat_per_mille) / 1e3,
        "clipped_samples": status.counters.clips,
        "underruns": status.counters.underruns,
        "crc_errors": status.counters.crc_errors,
        "table": { "crc": snapshot.table.report.active.map(|table| format!("{:08x}", table.crc)) },
        "round_trip_s": snapshot.link.round_trip.last.as_secs_f64(),
    })
}
