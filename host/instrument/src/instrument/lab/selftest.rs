//! The self-test of the connected board, as `slipline selftest` makes it. What ends a measurement ends it, too.

use super::{LOOK, Reach};
use crate::instrument::drive::Obstacle;
use crate::instrument::shell::Page;
use crate::instrument::shown::{Progress, SelftestScene};
use crate::measure::{MeasureError, Run};
use crate::selftest::{SelftestReport, SelftestRequest, Selftesting, Verdict};
use slipline_link::{Severity, Ticket};
use slipline_plate::Plate;
use std::sync::Arc;

/// The test under way with the plate on the screen, whose table it gives back, and the report of the latest one.
#[derive(Default)]
pub(super) struct BoardTest {
    request: SelftestRequest,
    running: Option<(Run<Selftesting>, Arc<Plate>)>,
    report: Option<SelftestReport>,
    failed: Option<String>,
    /// Whether it begins once the simulated device has its plate, which its amplifier drives.
    pub(super) awaits_rig: bool,
}

impl BoardTest {
    /// Sets what is to be tested.
    pub(super) const fn draft(&mut self, request: SelftestRequest) {
        self.request = request;
    }

    /// Whether it can begin; otherwise reports the obstacle. Where the amplifier is tested, the user must have armed the device, after
    /// the question that belongs to it.
    pub(super) fn may_begin(&self, reach: &mut Reach<'_>) -> bool {
        let Some(obstacle) = reach.drive.obstacle_to_test(self.request.is_amplifier_on) else { return true };
        reach.out.hinder(obstacle.to_string());
        if obstacle == Obstacle::Muted && !reach.attention.has_page {
            reach.out.open(Page::Arm);
        }
        false
    }

    /// Begins: ends the drive and a replay.
    pub(super) fn begin(&mut self, reach: &mut Reach<'_>) {
        self.awaits_rig = false;
        reach.drive.give_up();
        reach.desk.end_replay();
        (self.report, self.failed) = (None, None);
        reach.drive.note(Severity::Info, "Testing the board.".to_owned());
        // Each test has other drives: the index of the device's sample differs.
        let seed = reach.drive.snapshot().drive.status.map_or(1, |status| status.now);
        let run = Run::of(Selftesting::new(SelftestRequest { seed, ..self.request }));
        self.running = Some((run, Arc::clone(reach.desk.plate())));
    }

    /// Passes the device's outcomes on, and sends the next request.
    pub(super) fn update(&mut self, reach: &mut Reach<'_>) {
        let Some((run, plate)) = &mut self.running else { return };
        if !Arc::ptr_eq(plate, reach.desk.plate()) {
            run.cancel();
        }
        let drive = &*reach.drive;
        if run.turn(drive.snapshot(), |request| drive.send(request)) {
            return reach.out.wake_after(LOOK);
        }
        let Some((run, _)) = self.running.take() else { return };
        match run.finish() {
            Ok(report) => {
                let red = report.named(Verdict::Red).collect::<Vec<_>>().join(", ");
                if red.is_empty() {
                    let shown = report.steps.iter().filter(|step| step.verdict != Verdict::Skipped).count();
                    reach.out.post(format!(
                        "The board passes {shown} of {} steps; the others are not shown.",
                        report.steps.len()
                    ));
                } else {
                    reach.out.fail(format!("The board's self-test has red steps: {red}."));
                }
                reach.drive.note(Severity::Info, report.line());
                self.report = Some(report);
            }
            Err(MeasureError::Cancelled) => reach.out.post("The self-test was cancelled.".to_owned()),
            Err(error) => {
                let text = format!("The board was not tested: {error}.");
                self.failed = Some(text.clone());
                reach.out.fail(text);
            }
        }
    }

    /// Whether it needs the amplifier.
    pub(super) const fn needs_amplifier(&self) -> bool {
        self.request.is_amplifier_on
    }

    /// Cancels it.
    pub(super) fn cancel(&mut self) {
        self.awaits_rig = false;
        if let Some((run, _)) = &mut self.running {
            run.cancel();
        }
    }

    pub(super) const fn is_running(&self) -> bool {
        self.running.is_some() || self.awaits_rig
    }

    /// How far it is, when the device is at sample `now`.
    pub(super) fn progress(&self, now: u64) -> Option<Progress> {
        let share = self.running.as_ref().map(|(run, _)| run.progress(now) as f32);
        share.or(self.awaits_rig.then_some(0.0)).map(|share| Progress { share, left_s: None })
    }

    /// Whether it handles this request's outcome.
    pub(super) fn awaits(&self, ticket: Ticket) -> bool {
        self.running.as_ref().is_some_and(|(run, _)| run.awaits(ticket))
    }

    /// Its page.
    pub(super) fn scene(&self, now: u64) -> SelftestScene<'_> {
        SelftestScene {
            request: self.request,
            progress: self.progress(now),
            prompt: self.running.as_ref().and_then(|(run, _)| run.prompt()),
            report: self.report.as_ref(),
            failed: self.failed.as_deref(),
        }
    }
}
