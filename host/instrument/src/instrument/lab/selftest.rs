//! The self-test of the connected board, as `slipline selftest` makes it. What ends a measurement ends it, too.

use super::Reach;
use super::under_way::UnderWay;
use crate::instrument::shown::{Progress, SelftestScene};
use crate::measure::{MeasureError, Run};
use crate::selftest::{SelftestReport, SelftestRequest, Selftesting, Verdict};
use slipline_link::Severity;

/// What is tested, the test under way, and the report of the latest one.
#[derive(Default)]
pub(super) struct BoardTest {
    pub(super) request: SelftestRequest,
    pub(super) under_way: UnderWay<Selftesting>,
    report: Option<SelftestReport>,
    failed: Option<String>,
}

impl BoardTest {
    /// Begins.
    pub(super) fn begin(&mut self, reach: &mut Reach<'_>) {
        (self.report, self.failed) = (None, None);
        // Each test has other drives: the index of the device's sample differs.
        let seed = reach.drive.snapshot().drive.status.map_or(1, |status| status.now);
        let testing = Selftesting::new(SelftestRequest { seed, ..self.request });
        self.under_way.begin(testing, "Testing the board.".to_owned(), reach);
    }

    /// Continues the test under way, and reports its end.
    pub(super) fn update(&mut self, reach: &mut Reach<'_>) {
        let Some((report, _)) = self.under_way.turn(reach) else { return };
        match report {
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

    /// Its page. `progress` is that of what is under way.
    pub(super) fn scene(&self, progress: Option<Progress>) -> SelftestScene<'_> {
        SelftestScene {
            request: self.request,
            progress,
            prompt: self.under_way.run().and_then(Run::prompt),
            report: self.report.as_ref(),
            failed: self.failed.as_deref(),
        }
    }
}
