//! The measurement of the drive's harmonics, as `slipline measure --harmonics` makes it. What ends a measurement ends it, too.

use super::{LOOK, Reach};
use crate::instrument::shown::Progress;
use crate::measure::{AfterCheck, MeasureError, MeasuringHarmonics, Run};
use slipline_link::{Severity, Ticket};
use slipline_plate::Plate;
use std::sync::Arc;

/// Number of fundamentals.
pub(super) const POINTS: usize = 8;

/// The measurement under way, and the plate that it measures.
#[derive(Default)]
pub(super) struct Harmonics {
    run: Option<(Run<AfterCheck<MeasuringHarmonics>>, Arc<Plate>)>,
    /// Whether it begins once the simulated device has its sensor.
    pub(super) awaits_rig: bool,
    /// The plate with the measured harmonics, until it is in the setup.
    pub(super) found: Option<Arc<Plate>>,
}

impl Harmonics {
    /// Begins.
    pub(super) fn begin(&mut self, measuring: AfterCheck<MeasuringHarmonics>, reach: &mut Reach<'_>) {
        reach.drive.make_ready();
        reach.drive.give_up();
        reach.desk.end_replay();
        reach.drive.note(Severity::Info, "Measuring the drive's harmonics.".to_owned());
        self.run = Some((Run::of(measuring), Arc::clone(reach.desk.plate())));
    }

    pub(super) const fn is_running(&self) -> bool {
        self.run.is_some() || self.awaits_rig
    }

    /// How far it is, when the device is at sample `now`.
    pub(super) fn progress(&self, now: u64) -> Option<Progress> {
        let share = self.run.as_ref().map(|(run, _)| run.progress(now) as f32);
        share.or(self.awaits_rig.then_some(0.0)).map(|share| Progress { share, left_s: None })
    }

    /// Whether it handles this request's outcome.
    pub(super) fn awaits(&self, ticket: Ticket) -> bool {
        self.run.as_ref().is_some_and(|(run, _)| run.awaits(ticket))
    }

    /// Cancels it.
    pub(super) fn cancel(&mut self) {
        self.awaits_rig = false;
        if let Some((run, _)) = &mut self.run {
            run.cancel();
        }
    }

    /// Passes the device's outcomes on, and sends the next request.
    pub(super) fn update(&mut self, reach: &mut Reach<'_>) {
        let Some((run, plate)) = &mut self.run else { return };
        if !Arc::ptr_eq(plate, reach.desk.plate()) {
            run.cancel();
        }
        let drive = &*reach.drive;
        if run.turn(drive.snapshot(), |request| drive.send(request)) {
            return reach.out.wake_after(LOOK);
        }
        let Some((run, plate)) = self.run.take() else { return };
        let found = match run.finish() {
            Ok(found) => found,
            Err(MeasureError::Cancelled) => {
                return reach.out.post("The measurement was cancelled.".to_owned());
            }
            Err(error) => return reach.out.fail(format!("Not measured: {error}.")),
        };
        for sentence in found.warnings() {
            reach.drive.note(Severity::Warning, sentence);
        }
        match found.on(&plate) {
            Ok(measured) => {
                let each = found.words().into_iter().map(|(name, words)| format!("{name}: {words}"));
                let text = each.collect::<Vec<_>>().join(". ");
                reach.out.post(format!("{text}. The plate states them now; Undo takes it back."));
                self.found = Some(Arc::new(measured));
            }
            Err(error) => reach.out.fail(format!("Not measured: {error}.")),
        }
    }
}
