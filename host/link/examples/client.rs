//! A client of a device: hello, table, arm, one tone for a second, stop.
//!
//! `cargo run -p slipline-link --no-default-features --features native --example client -- PORT`; PORT is the name of a serial
//! port or `unix:PATH`. With the default features it may be `sim`, the simulated device.

use slipline_link::native::Worker;
use slipline_link::{DeviceTable, DriveRequest, Outcome, Port, Request, Sounding};
use std::error::Error;
use std::sync::Arc;
use std::time::Duration;

/// Time limit of a request; the longest is the table over a slow serial port.
const PATIENCE: Duration = Duration::from_secs(30);

fn main() -> Result<(), Box<dyn Error>> {
    let port: Port = std::env::args().nth(1).ok_or("name a port")?.parse()?;
    // When the worker is dropped, also after an error, it stops and disarms the device.
    let worker = Worker::spawn(|| ())?;
    worker.send(Request::AutoReconnect(false));
    perform(&worker, Request::Connect(port))?;
    let identity =
        worker.snapshot().device.identity.clone().ok_or("the device's firmware is of another version")?;
    println!("{} at {} samples per second", identity.board, identity.sample_rate_hz);

    // A plate whose turning point moves from 0 to 100 mm while the frequency falls from 30 kHz to 20 kHz, with the same
    // peak of 1 um everywhere.
    let knots = (0..=100).map(|i| (30e3 - 100.0 * f64::from(i), 1.0));
    let table = DeviceTable::from_knots((0.0, 0.1), f64::from(identity.sample_rate_hz), knots, 1e-6)?;
    perform(&worker, Request::Upload(Arc::new(table)))?;
    perform(&worker, Request::Arm)?;

    // One tone with its peak at 50 mm and half of the full displacement.
    let at = perform(&worker, Request::Play(Sounding::Drive(DriveRequest::at(&[(0.05, 0.5)]))))?;
    println!("drives from sample {at} on");
    // The worker's own pause and wait give the signs of life that are required while the device is armed.
    worker.pause(Duration::from_secs(1));

    let at = perform(&worker, Request::Stop)?;
    println!("ramps to silence from sample {at} on");
    Ok(())
}

/// Sends a request and waits until it is done; returns the sample index at which its effect begins.
fn perform(worker: &Worker, request: Request) -> Result<u64, Box<dyn Error>> {
    let ticket = worker.send(request);
    match worker.wait(ticket, PATIENCE) {
        Some(Outcome::Done { at }) => Ok(at),
        Some(Outcome::Refused(refusal)) => Err(refusal.into()),
        other => Err(format!("the request was not done: {other:?}").into()),
    }
}
