//! A device for one command: blocking calls to the link worker. While it waits, pauses or computes by these calls, the
//! command gives the signs of life that the link wants while the device is armed.

use super::{ArmingArgument, Failure, progress};
use crate::signals::{self, Ending};
use slipline_instrument::rig::PreparedRig;
use slipline_link::native::{Handle, SystemOpener, Worker};
use slipline_link::protocol::event::Identity;
use slipline_link::protocol::version::Compatibility;
use slipline_link::table::DeviceTable;
use slipline_link::{Outcome, Port, Request, SIGN_PATIENCE, SIGN_PERIOD, Snapshot, Ticket, upkeep};
use slipline_plate::Plate;
use std::cell::Cell;
use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// Time limit for opening a port and the handshake; usually the link gives up earlier.
const CONNECTING: Duration = Duration::from_secs(5);
/// Time limit of a request. The longest is a table over a slow link: 47 chunks of a few milliseconds each, and
/// repeats.
const PATIENCE: Duration = Duration::from_secs(30);

/// A connected device. When it is dropped, it is stopped and disarmed.
pub(super) struct Device {
    worker: Worker,
    /// How often this program had been held up when the device was armed.
    stalls_before: Cell<u32>,
    /// While this exists, a signal also stops and disarms the device.
    _ending: Ending,
}

impl Device {
    /// Connects to a device; the simulated one is wired to `rig`, if there is one. A lost link is not reconnected.
    pub(super) fn connect(port: &Port, rig: Option<&PreparedRig>) -> Result<Self, Failure> {
        let opener = rig
            .cloned()
            .map_or_else(SystemOpener::default, |rig| SystemOpener::with_inputs(move || rig.inputs()));
        let worker = Worker::spawn_with(opener, || ()).map_err(Failure::failed)?;
        let ending = signals::stop_before_end(worker.handle());
        worker.send(Request::AutoReconnect(false));
        let ticket = worker.send(Request::Connect(port.clone()));
        match worker.wait(ticket, CONNECTING) {
            Some(Outcome::Done { .. }) => Ok(Self { worker, stalls_before: Cell::new(0), _ending: ending }),
            Some(Outcome::Refused(refusal)) => Err(Failure::failed(refusal)),
            _ => Err(Failure::Failed(format!("{port} does not answer"))),
        }
    }

    pub(super) fn snapshot(&self) -> Arc<Snapshot> {
        self.worker.snapshot()
    }

    pub(super) fn handle(&self) -> Handle {
        self.worker.handle()
    }

    /// Says that this program is alive: for a loop of its own.
    pub(super) fn sign_of_life(&self) {
        self.worker.handle().sign_of_life();
    }

    /// Sleeps.
    pub(super) fn pause(&self, time: Duration) {
        self.worker.pause(time);
    }

    /// Waits for the result of a request that was sent by the handle.
    pub(super) fn wait(&self, ticket: Ticket, patience: Duration) -> Option<Outcome> {
        self.worker.wait(ticket, patience)
    }

    /// Computes something on a thread of its own, while this one gives signs of life.
    pub(super) fn during<R: Send>(&self, compute: impl FnOnce() -> R + Send) -> R {
        thread::scope(|scope| {
            let (running, ended) = channel::<()>();
            let work = scope.spawn(move || {
                let _running = running;
                compute()
            });
            self.sign_of_life();
            while let Err(RecvTimeoutError::Timeout) = ended.recv_timeout(SIGN_PERIOD) {
                self.sign_of_life();
            }
            work.join().unwrap_or_else(|panic| resume_unwind(panic))
        })
    }

    /// Arms the device.
    pub(super) fn arm(&self) -> Result<(), Failure> {
        self.stalls_before.set(self.snapshot().driver_stalls);
        self.perform(Request::Arm).map(drop)
    }

    /// Fails if the link has stopped and disarmed the device since it was armed, because this program was held up.
    pub(super) fn check_attended(&self) -> Result<(), Failure> {
        if self.snapshot().driver_stalls == self.stalls_before.get() {
            return Ok(());
        }
        Err(Failure::Failed(format!(
            "this program was held up for {} s, so the device was stopped and disarmed: run it again",
            SIGN_PATIENCE.as_secs_f64()
        )))
    }

    /// The identity of the device.
    pub(super) fn identity(&self) -> Result<Arc<Identity>, Failure> {
        let snapshot = self.snapshot();
        match (&snapshot.identity, snapshot.compatibility) {
            (Some(identity), Some(compatibility)) if compatibility.may_drive() => Ok(identity.clone()),
            (_, Some(compatibility)) => Err(Failure::Failed(compatibility.sentence().to_owned())),
            (_, None) => Err(Failure::Failed("the device went away".to_owned())),
        }
    }

    /// Makes sure that the device may be armed: its brown-out level is set, or the user knows that it is not.
    pub(super) fn may_be_armed(&self, arming: &ArmingArgument) -> Result<(), Failure> {
        let warning = self.snapshot().maintenance.as_ref().and_then(upkeep::before_arming);
        match warning {
            Some(warning) if !arming.despite_brown_out_level => {
                let text = format!("{warning} To arm it all the same, add --despite-brown-out-level.");
                Err(Failure::Failed(text))
            }
            _ => Ok(()),
        }
    }

    /// Sends a request and waits for its result.
    pub(super) fn perform(&self, request: Request) -> Result<Outcome, Failure> {
        let ticket = self.worker.send(request);
        match self.worker.wait(ticket, PATIENCE) {
            Some(Outcome::Refused(refusal)) => {
                // A device that was disarmed refuses to be driven; this is why.
                self.check_attended()?;
                Err(Failure::failed(refusal))
            }
            Some(Outcome::DeviceTooOld) => {
                Err(Failure::Failed(Compatibility::DeviceOlder.sentence().to_owned()))
            }
            Some(Outcome::NotConnected) => {
                let error = self.snapshot().error.clone();
                Err(Failure::Failed(error.map_or("the device went away".to_owned(), |it| it.to_string())))
            }
            Some(outcome) => Ok(outcome),
            None => Err(Failure::Failed("the device did not answer in time".to_owned())),
        }
    }

    /// Sends a request and returns the sample index at which its effect begins.
    pub(super) fn perform_at(&self, request: Request) -> Result<u64, Failure> {
        match self.perform(request)? {
            Outcome::Done { at } => Ok(at),
            _ => Err(Failure::Failed("the device did something else instead".to_owned())),
        }
    }

    /// Makes sure that the device holds the plate's table, made for its sample rate.
    pub(super) fn use_table(&self, plate: &Plate) -> Result<Arc<DeviceTable>, Failure> {
        let rate_hz = self.identity()?.sample_rate_hz;
        let (_, table) = self.during(|| progress::table_for(plate, rate_hz))?;
        self.perform(Request::Upload(table.clone()))?;
        if !self.snapshot().can_limit_travel() && table.travel_limit().is_some() {
            eprintln!(
                "slipline: the device does not limit the actuator's travel: its firmware is too old for it"
            );
        }
        Ok(table)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_takes_longer_than_the_links_patience_is_computed_without_losing_the_device() {
        let device = Device::connect(&Port::Simulated, None).unwrap();
        device.arm().unwrap();
        let computed = device.during(|| {
            thread::sleep(SIGN_PATIENCE + SIGN_PERIOD);
            7
        });
        assert_eq!(computed, 7);
        device.check_attended().unwrap();
    }
}
