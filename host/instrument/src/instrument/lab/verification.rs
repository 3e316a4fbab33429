//! The comparison of the device's codes with the mirror's, as `slipline verify` makes it. What ends a measurement ends it, too.

use super::measuring::MeasuringRefused;
use super::{LOOK, Reach};
use crate::instrument::shown::Progress;
use crate::measure::{MeasureError, Run, Verified, VerifiedWindow, Verifying};
use slipline_link::protocol::limits::MAX_TONES;
use slipline_link::{Severity, Ticket};
use slipline_plate::Plate;
use std::sync::Arc;

/// Length of each window of codes, in seconds.
const WINDOW_S: f64 = 0.1;

/// The comparison under way, and the plate whose table it uses.
#[derive(Default)]
pub(super) struct Verification(Option<(Run<Verifying>, Arc<Plate>)>);

impl Verification {
    /// Whether it can begin: the device may drive, and holds the table of this plate. Otherwise reports the obstacle.
    pub(super) fn may_begin(reach: &mut Reach<'_>) -> bool {
        let obstacle = match reach.drive.obstacle() {
            Some(obstacle) => obstacle.into(),
            None if !reach.drive.is_table_there() => MeasuringRefused::NoTable,
            None => return true,
        };
        reach.out.hinder(obstacle.to_string());
        false
    }

    /// Begins: ends the drive and a replay.
    pub(super) fn begin(&mut self, reach: &mut Reach<'_>) {
        reach.drive.make_ready();
        reach.drive.give_up();
        reach.desk.end_replay();
        let plate = Arc::clone(reach.desk.plate());
        let verifying = Verifying::new(&plate, MAX_TONES as u8, WINDOW_S, reach.drive.sample_rate_hz());
        reach.drive.note(Severity::Info, "Comparing the device's codes with the mirror's.".to_owned());
        self.0 = Some((Run::of(verifying), plate));
    }

    /// Passes the device's outcomes on, and sends the next request.
    pub(super) fn update(&mut self, reach: &mut Reach<'_>) {
        let Some((run, plate)) = &mut self.0 else { return };
        if !Arc::ptr_eq(plate, reach.desk.plate()) {
            run.cancel();
        }
        let drive = &*reach.drive;
        if run.turn(drive.snapshot(), |request| drive.send(request)) {
            return reach.out.wake_after(LOOK);
        }
        let Some((run, _)) = self.0.take() else { return };
        match run.finish() {
            Ok(Verified { equal: true, windows }) => reach.out.post(format!(
                "The device sends the mirror's codes: {} windows of {MAX_TONES} tones are equal.",
                windows.len()
            )),
            Ok(Verified { windows, .. }) => reach.out.fail(format!(
                "The device's codes differ from the mirror's: {}.",
                different(&windows).join(", ")
            )),
            Err(MeasureError::Cancelled) => {
                reach.out.post("The comparison of the codes was cancelled.".to_owned());
            }
            Err(error) => reach.out.fail(format!("The codes were not compared: {error}.")),
        }
    }

    /// Cancels it.
    pub(super) fn cancel(&mut self) {
        if let Some((run, _)) = &mut self.0 {
            run.cancel();
        }
    }

    pub(super) const fn is_running(&self) -> bool {
        self.0.is_some()
    }

    /// How far it is, when the device is at sample `now`.
    pub(super) fn progress(&self, now: u64) -> Option<Progress> {
        self.0.as_ref().map(|(run, _)| Progress { share: run.progress(now) as f32, left_s: None })
    }

    /// Whether it handles this request's outcome.
    pub(super) fn awaits(&self, ticket: Ticket) -> bool {
        self.0.as_ref().is_some_and(|(run, _)| run.awaited() == Some(ticket))
    }
}

/// The stages whose windows differ.
fn different(windows: &[VerifiedWindow]) -> Vec<&'static str> {
    windows.iter().filter(|window| !window.equal).map(|window| window.stage).collect()
}
