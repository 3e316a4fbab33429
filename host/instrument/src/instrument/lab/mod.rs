//! The lab: measurements and their list, the level hold, calibration, and the rig of the simulated device. It acts on the desk
//! and on the drive by their named methods: a measurement ends a replay and a drive.

mod calibrate_intent;
mod calibrating;
mod harmonics;
mod level_hold;
mod measure_intent;
mod measurements;
mod measuring;
mod plate_lists;
mod rig;
mod selftest;
mod signal;
mod so_far;
mod under_way;
mod verification;

pub use calibrate_intent::CalibrateIntent;
pub use measure_intent::{MeasureDraft, MeasureIntent};
pub use so_far::SoFar;

use super::desk::Desk;
use super::drive::{Drive, USUAL_RATE_HZ};
use super::outbox::Outbox;
use super::shell::Attention;
use super::shown::{CalibrateScene, HoldScene, MeasureScene, Progress, SelftestScene};
use super::work::Jobs;
use crate::bench::Bench;
use crate::measure::Verifying;
use calibrating::Calibrating;
use harmonics::Harmonics;
use level_hold::LevelHold;
use measurements::Measurements;
use measuring::Live;
use rig::{Awaiting, Rig};
use selftest::BoardTest;
use slipline_link::{Port, Snapshot, Ticket};
use slipline_plate::calibrate::Measurement;
use slipline_plate::{Finger, Plate};
use std::sync::Arc;
use std::time::Duration;
use under_way::UnderWay;

/// Time between two updates of what runs.
const LOOK: Duration = Duration::from_millis(50);

/// Measurements of the plate, and what needs its sensor.
pub(crate) struct Lab {
    measurements: Measurements,
    live: Live,
    rig: Rig,
    calibration: Calibrating,
    hold: LevelHold,
    verification: UnderWay<Verifying>,
    board_test: BoardTest,
    harmonics: Harmonics,
}

/// What the lab acts on.
pub(crate) struct Reach<'a> {
    pub(crate) desk: &'a mut Desk,
    pub(crate) drive: &'a mut Drive,
    pub(crate) attention: &'a Attention,
    pub(crate) out: &'a mut Outbox,
}

/// Whether the device is this program's simulated device, whose inputs are wired to the rig.
fn is_at_bench(snapshot: &Snapshot) -> bool {
    snapshot.is_simulated() && snapshot.link.port == Some(Port::Simulated)
}

impl Lab {
    /// A lab for this plate, whose simulated device is wired to this bench; it takes its queues from `jobs`.
    pub(crate) fn new(plate: &Plate, bench: Bench, jobs: &mut Jobs) -> Self {
        Self {
            measurements: Measurements::new(plate, jobs),
            live: Live::default(),
            rig: Rig::on(bench, jobs),
            calibration: Calibrating::new(jobs),
            hold: LevelHold::default(),
            verification: UnderWay::default(),
            board_test: BoardTest::default(),
            harmonics: Harmonics::default(),
        }
    }

    /// Advances the level hold, the measurement and the rig. `load` is the finger that loads the plate on the screen.
    pub(crate) fn turn(&mut self, load: Option<Finger>, reach: &mut Reach<'_>) {
        self.update_hold(load, reach);
        self.update_measuring(reach);
        self.verification.update(reach);
        self.board_test.update(reach);
        self.harmonics.update(reach);
        let is_heard = self.is_measuring() || self.live.looks.is_looking() || self.hold.needs_sensor();
        self.rig.rest(!is_heard);
        match self.live.wanted_model() {
            Some(planned) => self.measurements.ask_model(planned),
            None => self.measurements.compare(reach.desk.plate(), reach.attention),
        }
    }

    /// Handles the results of its work in the background.
    pub(crate) fn take_results(&mut self, reach: &mut Reach<'_>) {
        self.calibration.take_result();
        let recorded = self.measurements.take_results();
        self.live.take_model(&self.measurements);
        if let Some(recorded) = recorded {
            self.take_recorded(recorded, reach);
        }
    }

    /// Whether a measurement, a comparison of codes, a self-test or a measurement of harmonics is under way, or a measurement's rig is being put together.
    pub(crate) const fn is_measuring(&self) -> bool {
        self.rig.awaited_for.is_some()
            || self.live.under_way.is_running()
            || self.verification.is_running()
            || self.board_test.under_way.is_running()
            || self.harmonics.under_way.is_running()
    }

    /// Whether the lab handles this request's outcome.
    pub(crate) fn awaits(&self, ticket: Ticket) -> bool {
        self.live.awaits(ticket)
            || self.hold.holding.awaits(ticket)
            || self.verification.awaits(ticket)
            || self.board_test.under_way.awaits(ticket)
            || self.harmonics.under_way.awaits(ticket)
    }

    /// The plate under the simulated device, where `plate` is on the screen; `None` while it is an unknown one that was not
    /// measured, and without a simulated device.
    pub(crate) fn simulated_plate<'a>(
        &'a self,
        plate: &'a Arc<Plate>,
        snapshot: &Snapshot,
    ) -> Option<&'a Arc<Plate>> {
        match self.rig.truth().filter(|_| is_at_bench(snapshot)) {
            None => snapshot.is_simulated().then_some(plate),
            Some((truth, is_measured)) => is_measured.then_some(truth),
        }
    }

    /// Whether another plate is under the simulated device, or is known now, since the last call.
    pub(crate) const fn take_other_truth(&mut self) -> bool {
        self.rig.take_other_truth()
    }

    /// Another plate is on the screen: draws another unknown plate if the one under the simulated device does not belong to it,
    /// and turns to the plate's own measurements.
    pub(crate) fn use_plate(&mut self, plate: &Arc<Plate>, out: &mut Outbox) {
        self.rig.renew(plate, out);
        self.measurements.lists.turn_to(plate, self.rig.draw());
    }

    /// The measurements that are drawn.
    pub(crate) fn drawn(&self) -> impl Iterator<Item = &Arc<Measurement>> {
        self.measurements.drawn()
    }

    /// The page of measurements.
    pub(crate) fn measure_scene(&self, snapshot: &Snapshot) -> MeasureScene<'_> {
        let progress = self.progress(snapshot);
        self.measurements.scene(self.live.scene(progress, &self.rig, is_at_bench(snapshot)))
    }

    /// The page of the self-test.
    pub(crate) fn selftest_scene(&self, snapshot: &Snapshot) -> SelftestScene<'_> {
        let is_tested =
            self.board_test.under_way.is_running() || self.rig.awaited_for == Some(Awaiting::Selftest);
        self.board_test.scene(self.progress(snapshot).filter(|_| is_tested))
    }

    /// How far what is under way is; only a measurement by a plan knows the time that it still takes.
    fn progress(&self, snapshot: &Snapshot) -> Option<Progress> {
        let now = snapshot.drive.status.map_or(0, |status| status.now);
        let share = self.live.under_way.share(now).or_else(|| self.verification.share(now));
        let share = share.or_else(|| self.board_test.under_way.share(now));
        let share = share.or_else(|| self.harmonics.under_way.share(now));
        let share = share.or_else(|| self.rig.awaited_for.map(|_| 0.0))?;
        let left = self.live.remaining_samples(now);
        let left_s = left.map(|left| left / snapshot.sample_rate_hz().unwrap_or(USUAL_RATE_HZ));
        Some(Progress { share: share as f32, left_s })
    }

    /// The level hold.
    pub(crate) fn hold_scene<'a>(&'a self, snapshot: &'a Snapshot) -> HoldScene<'a> {
        self.hold.scene(snapshot, is_at_bench(snapshot), self.live.draft.place_m)
    }

    /// The calibration under way.
    pub(crate) fn calibration_scene(&self) -> Option<CalibrateScene<'_>> {
        self.calibration.scene()
    }

    /// The plate with harmonics that were measured since the last call.
    pub(crate) fn take_measured_plate(&mut self) -> Option<Arc<Plate>> {
        let plate = self.harmonics.found.take()?;
        self.rig.is_described_by(&plate);
        self.measurements.lists.is_described_by(&plate);
        Some(plate)
    }
}

#[cfg(test)]
mod tests;
