//! A procedure under way on the device. Another plate on the screen ends it, as does what ends a measurement.

use super::{LOOK, Reach};
use crate::measure::{MeasureError, Procedure, Run};
use slipline_link::{Severity, Ticket};
use slipline_plate::Plate;
use std::sync::Arc;

/// The result of a procedure, and its plate.
type Ended<T> = (Result<T, MeasureError>, Arc<Plate>);

/// A procedure with the plate that was on the screen at its beginning, or none.
pub(super) struct UnderWay<P: Procedure>(Option<(Run<P>, Arc<Plate>)>);

impl<P: Procedure> Default for UnderWay<P> {
    fn default() -> Self {
        Self(None)
    }
}

impl<P: Procedure> UnderWay<P> {
    /// Begins the procedure: ends the drive and a replay. `text` is its line of the log.
    pub(super) fn begin(&mut self, procedure: P, text: String, reach: &mut Reach<'_>) {
        reach.drive.give_up();
        reach.desk.end_replay();
        reach.drive.note(Severity::Info, text);
        self.0 = Some((Run::of(procedure), Arc::clone(reach.desk.plate())));
    }

    /// Passes the device's outcomes on and sends the next request. Returns the result of a procedure that has ended, and its plate.
    pub(super) fn turn(&mut self, reach: &mut Reach<'_>) -> Option<Ended<P::Found>> {
        let (run, plate) = self.0.as_mut()?;
        if !Arc::ptr_eq(plate, reach.desk.plate()) {
            run.cancel();
        }
        let drive = &*reach.drive;
        if run.turn(drive.snapshot(), |request| drive.send(request)) {
            reach.out.wake_after(LOOK);
            return None;
        }
        let (run, plate) = self.0.take()?;
        Some((run.finish(), plate))
    }

    /// Cancels it.
    pub(super) fn cancel(&mut self) {
        if let Some((run, _)) = &mut self.0 {
            run.cancel();
        }
    }

    /// Ends it, and leaves the port as the user wants it.
    pub(super) fn leave_port(&mut self) {
        if let Some((run, _)) = &mut self.0 {
            run.leave_port();
        }
    }

    /// What runs.
    pub(super) fn run(&self) -> Option<&Run<P>> {
        self.0.as_ref().map(|(run, _)| run)
    }

    /// Whether it runs.
    pub(super) const fn is_running(&self) -> bool {
        self.0.is_some()
    }

    /// Whether it handles this request's outcome.
    pub(super) fn awaits(&self, ticket: Ticket) -> bool {
        self.run().is_some_and(|run| run.awaits(ticket))
    }

    /// The share that is done, 0 to 1, when the device is at sample `now`.
    pub(super) fn share(&self, now: u64) -> Option<f64> {
        self.run().map(|run| run.progress(now))
    }
}
