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
mod verification;

pub use calibrate_intent::CalibrateIntent;
pub use measure_intent::{MeasureDraft, MeasureIntent};
pub use so_far::SoFar;

use super::desk::Desk;
use super::drive::{Drive, USUAL_RATE_HZ};
use super::outbox::Outbox;
use super::shell::Attention;
use super::shown::{CalibrateScene, HoldScene, MeasureScene, SelftestScene};
use super::work::Jobs;
use crate::bench::Bench;
use crate::hold::HoldEnd;
use crate::measure::{AfterCheck, HarmonicsPlan, MeasuringHarmonics};
use calibrating::Calibrating;
use harmonics::Harmonics;
use level_hold::LevelHold;
use measurements::Measurements;
use measuring::{Live, MeasuringRefused};
use rig::Rig;
use selftest::BoardTest;
use slipline_link::{Port, Snapshot, Ticket};
use slipline_plate::calibrate::Measurement;
use slipline_plate::{Finger, Plate};
use std::sync::Arc;
use std::time::Duration;
use verification::Verification;

/// Time between two updates of what runs.
const LOOK: Duration = Duration::from_millis(50);

/// Measurements of the plate, and what needs its sensor.
pub(crate) struct Lab {
    measurements: Measurements,
    live: Live,
    rig: Rig,
    calibration: Calibrating,
    hold: LevelHold,
    verification: Verification,
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
            verification: Verification::default(),
            board_test: BoardTest::default(),
            harmonics: Harmonics::default(),
        }
    }

    /// Advances the level hold, the measurement and the rig. `load` is the finger that loads the plate on the screen.
    pub(crate) fn turn(&mut self, load: Option<Finger>, reach: &mut Reach<'_>) {
        self.update_hold(load, reach);
        self.update_measuring(reach);
        self.verification.update(reach);
        self.update_selftest(reach);
        self.update_harmonics(reach);
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
        self.live.is_running()
            || self.rig.is_awaited()
            || self.verification.is_running()
            || self.board_test.is_running()
            || self.harmonics.is_running()
    }

    /// Whether the lab handles this request's outcome.
    pub(crate) fn awaits(&self, ticket: Ticket) -> bool {
        self.live.awaits(ticket)
            || self.hold.holding.awaits(ticket)
            || self.verification.awaits(ticket)
            || self.board_test.awaits(ticket)
            || self.harmonics.awaits(ticket)
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
        let now = snapshot.drive.status.map_or(0, |status| status.now);
        let clock = (now, snapshot.sample_rate_hz().unwrap_or(USUAL_RATE_HZ));
        let mut live = self.live.scene(clock, &self.rig, is_at_bench(snapshot));
        let other = self.verification.progress(now).or(self.board_test.progress(now));
        let other = other.or(self.harmonics.progress(now));
        live.progress = live.progress.or(other);
        self.measurements.scene(live)
    }

    /// The page of the self-test.
    pub(crate) fn selftest_scene(&self, snapshot: &Snapshot) -> SelftestScene<'_> {
        self.board_test.scene(snapshot.drive.status.map_or(0, |status| status.now))
    }

    /// The level hold.
    pub(crate) fn hold_scene<'a>(&'a self, snapshot: &'a Snapshot) -> HoldScene<'a> {
        self.hold.scene(snapshot, is_at_bench(snapshot), self.live.draft.place_m)
    }

    /// The calibration under way.
    pub(crate) fn calibration_scene(&self) -> Option<CalibrateScene<'_>> {
        self.calibration.scene()
    }

    /// Tests the board. The amplifier of the simulated device drives its plate, which is put on the bench first.
    pub(super) fn begin_selftest(&mut self, reach: &mut Reach<'_>) {
        if self.is_measuring() || !self.board_test.may_begin(reach) {
            return;
        }
        self.end_hold(HoldEnd::Measured, reach.out);
        let needs_rig = self.board_test.needs_amplifier() && is_at_bench(reach.drive.snapshot());
        if needs_rig && !self.is_rig_standing(reach) {
            self.board_test.awaits_rig = true;
            self.rig.refused = None;
            return self.put_rig_up(reach);
        }
        self.board_test.begin(reach);
    }

    /// Begins the test that waits for the plate of the simulated device, and continues the one under way.
    pub(super) fn update_selftest(&mut self, reach: &mut Reach<'_>) {
        if self.board_test.awaits_rig && self.is_rig_standing(reach) {
            self.board_test.begin(reach);
        }
        if self.board_test.awaits_rig {
            reach.out.wake_after(LOOK);
        }
        self.board_test.update(reach);
    }

    /// Starts the measurement of the drive's harmonics at the place and level of the draft, or reports the obstacle.
    pub(super) fn begin_harmonics(&mut self, reach: &mut Reach<'_>) {
        if self.is_measuring() {
            return;
        }
        match self.prepared_harmonics(reach) {
            Err(refused) => reach.out.hinder(refused.to_string()),
            Ok(_) if is_at_bench(reach.drive.snapshot()) && !self.is_rig_standing(reach) => {
                self.harmonics.awaits_rig = true;
                self.rig.refused = None;
                self.put_rig_up(reach);
            }
            Ok(measuring) => {
                self.harmonics.awaits_rig = false;
                self.end_hold(HoldEnd::Measured, reach.out);
                self.harmonics.begin(measuring, reach);
            }
        }
    }

    /// The measurement of the draft, or why the device cannot carry it out now.
    fn prepared_harmonics(
        &self,
        reach: &Reach<'_>,
    ) -> Result<AfterCheck<MeasuringHarmonics>, MeasuringRefused> {
        let (inputs, table, sensor) = self.sensor_and_table(reach)?;
        let plate = reach.desk.plate();
        let plan = HarmonicsPlan::new(
            plate,
            harmonics::POINTS,
            self.live.draft.level,
            reach.drive.sample_rate_hz(),
        )?;
        let measuring = MeasuringHarmonics::new(plate, plan, Arc::clone(&table), sensor, &inputs)?;
        Ok(AfterCheck::new(self.checking(reach, &inputs, table)?, measuring))
    }

    /// Begins the measurement that waits for the simulated plate, and continues the one under way.
    pub(super) fn update_harmonics(&mut self, reach: &mut Reach<'_>) {
        if std::mem::take(&mut self.harmonics.awaits_rig) {
            if self.is_rig_standing(reach) {
                self.begin_harmonics(reach);
            } else {
                self.harmonics.awaits_rig = true;
                reach.out.wake_after(LOOK);
            }
        }
        self.harmonics.update(reach);
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
