//! A device with a plate's table, and procedures that run with it.

use super::device::Device;
use super::{Failure, progress};
use slipline_instrument::measure::{Procedure, Step};
use slipline_link::protocol::event::State;
use slipline_link::protocol::listen::InputsReport;
use slipline_link::{DeviceTable, Request};
use slipline_plate::Plate;
use std::sync::Arc;
use std::time::Duration;

/// Time between two looks at the device.
const GLANCE: Duration = Duration::from_millis(50);

/// Looks until what sounds must have faded.
const FADING: usize = 100;

/// A device that holds a plate's table.
#[derive(Clone)]
pub(super) struct Bench<'a> {
    pub(super) device: &'a Device,
    pub(super) plate: &'a Plate,
    pub(super) table: Arc<DeviceTable>,
    pub(super) rate_hz: f64,
}

impl<'a> Bench<'a> {
    /// Has the device hold the plate's table.
    pub(super) fn new(device: &'a Device, plate: &'a Plate) -> Result<Self, Failure> {
        let rate_hz = f64::from(device.identity()?.sample_rate_hz);
        Ok(Self { device, plate, table: device.use_table(plate)?, rate_hz })
    }

    /// What the device tells of its inputs.
    pub(super) fn inputs(&self) -> InputsReport {
        self.device.snapshot().inputs.unwrap_or_default()
    }
}

/// Arms the device, runs a procedure to its end, and disarms the device.
pub(super) fn run<P: Procedure>(
    device: &Device,
    what: &'static str,
    mut procedure: P,
) -> Result<P::Found, Failure> {
    device.arm()?;
    progress::watched(what, |progress| {
        let mut ticket = None;
        loop {
            let snapshot = device.snapshot();
            procedure.watch(&snapshot);
            // Nobody asks for an end by the progress.
            let _ = progress.at(procedure.progress(snapshot.status.map_or(0, |status| status.now)));
            match procedure.step() {
                Step::Ask(request) => ticket = Some(device.handle().send(request)),
                Step::Wait => {
                    let outcome = ticket.and_then(|ticket| device.wait(ticket, GLANCE));
                    if let Some(outcome) = outcome {
                        procedure.take(&outcome);
                    }
                }
                Step::Ended => break,
            }
        }
    });
    device.check_attended()?;
    let found = procedure.finish().map_err(Failure::failed)?;
    disarm(device)?;
    Ok(found)
}

/// Disarms a device, and waits until what sounded has faded: it is armed again in silence only.
fn disarm(device: &Device) -> Result<(), Failure> {
    device.perform(Request::Disarm)?;
    for _ in 0..FADING {
        device.perform(Request::Refresh)?;
        if device.snapshot().status.is_some_and(|status| status.state != State::Stopping) {
            break;
        }
        device.pause(GLANCE);
    }
    Ok(())
}
