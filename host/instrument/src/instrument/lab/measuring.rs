//! A measurement with the connected device: one request after the other, without blocking. STOP, a fault, a
//! lost device and another plate end it; its last request is a stop.

use super::measurements::Measurements;
use super::rig::{Awaiting, Rig};
use super::signal::{Looks, SENSOR_INPUT};
use super::so_far::Answers;
use super::under_way::UnderWay;
use super::{LOOK, Lab, MeasureDraft, Reach, harmonics, is_at_bench, verification};
use crate::hold::HoldEnd;
use crate::instrument::drive::Obstacle;
use crate::instrument::shell::Page;
use crate::instrument::shown::{LiveScene, Progress};
use crate::jobs::rig::RigJob;
use crate::measure::{
    AfterCheck, CURRENT_INPUT, DriveChecking, HarmonicsPlan, MeasureError, Measured, Measuring,
    MeasuringHarmonics, Plan, Procedure, Run, Sensor, Verifying, Wanted, remaining_samples,
};
use slipline_link::protocol::limits::MAX_TONES;
use slipline_link::protocol::listen::InputsReport;
use slipline_link::{DeviceTable, Severity, Ticket};
use slipline_model::jobs::compare::CompareJob;
use slipline_plate::calibrate::DriveCheck;
use slipline_plate::quantity::show_place;
use std::sync::Arc;

/// What is said after a measurement that has ended a drive: nothing but a press of Drive starts it again.
const DRIVE_ENDED: &str = " The drive was stopped for it: press Drive to resume.";

/// What is known of the measurement under way.
#[derive(Default)]
struct Course {
    /// Where its sensor stands, in words.
    place: String,
    /// The calibration's place that it measures, 0 or 1.
    answers: Option<usize>,
    /// Whether it has ended a drive.
    has_stopped_drive: bool,
    /// Samples that it needs by its plan.
    planned: f64,
    /// The device's sample at its start.
    began: u64,
    answers_so_far: Option<Answers>,
}

/// The state of the measurements with the device.
#[derive(Default)]
pub(super) struct Live {
    pub(super) draft: MeasureDraft,
    pub(super) under_way: UnderWay<AfterCheck<Measuring>>,
    course: Course,
    /// Why the last measurement failed.
    failed: Option<String>,
    /// Short captures of the input while the sensor is being placed.
    pub(super) looks: Looks,
    /// Whether measuring has ended a drive that the user has neither begun again nor stopped since.
    owes_drive: bool,
}

impl Live {
    pub(super) fn scene(&self, progress: Option<Progress>, rig: &Rig, is_drive_known: bool) -> LiveScene<'_> {
        LiveScene {
            draft: &self.draft,
            progress,
            so_far: self
                .course
                .answers_so_far
                .as_ref()
                .filter(|_| self.under_way.is_running())
                .map(Answers::scene),
            is_checking: self.is_checking(),
            is_drive_known,
            failed: self.failed.as_deref(),
            signal: self.looks.latest,
            is_secret: rig.is_secret(),
            is_secret_measured: rig.truth().is_some_and(|(_, is_measured)| is_measured),
        }
    }

    /// What the plate's model is asked for by the measurement under way.
    pub(super) fn wanted_model(&self) -> Option<&CompareJob> {
        self.course.answers_so_far.as_ref()?.wanted()
    }

    /// Takes the model's answers once they are computed.
    pub(super) fn take_model(&mut self, measurements: &Measurements) {
        let Some(answers) = &mut self.course.answers_so_far else { return };
        if let Some(computed) = answers.wanted().and_then(|planned| measurements.model(planned)) {
            answers.take_model(computed);
        }
    }

    fn is_checking(&self) -> bool {
        self.under_way.run().is_some_and(Run::is_checking)
    }

    /// The samples that the measurement under way still takes, when the device is at sample `now`.
    pub(super) fn remaining_samples(&self, now: u64) -> Option<f64> {
        let elapsed = now.saturating_sub(self.course.began) as f64;
        self.under_way.share(now).map(|share| remaining_samples(self.course.planned, share, elapsed))
    }

    /// Whether the measurement under way handles this request's outcome.
    pub(super) fn awaits(&self, ticket: Ticket) -> bool {
        self.under_way.awaits(ticket) || self.looks.awaits(ticket)
    }
}

/// Why the device cannot carry out a measurement now.
#[derive(Debug, thiserror::Error)]
enum MeasuringRefused {
    #[error(transparent)]
    NoDrive(#[from] Obstacle),
    #[error("This device has no input for a sensor: its board or its firmware has none.")]
    NoSensorInput,
    #[error("The device does not hold this plate's table yet: wait for it, or upload it.")]
    NoTable,
    #[error("The sensor at {} is not on the plate.", show_place(*.place_m))]
    OffThePlate { place_m: f64 },
    #[error("This device has no input for the drive's current: measure without the check.")]
    NoCurrentInput,
    #[error("Not measured: {0}.")]
    Measure(#[from] MeasureError),
}

impl Lab {
    /// Whether measuring has ended a drive that is to go on; the answer settles it.
    pub(crate) const fn take_owed_drive(&mut self) -> bool {
        std::mem::replace(&mut self.live.owes_drive, false)
    }

    /// Starts a measurement, or reports the obstacle.
    pub(super) fn begin_measuring(&mut self, answers: Option<usize>, reach: &mut Reach<'_>) {
        let level = self.live.draft.level;
        let measuring =
            self.prepared(Awaiting::Measurement(answers), reach, |reach, inputs, table, sensor| {
                let (plate, rate_hz) = (reach.desk.plate(), reach.drive.sample_rate_hz());
                let wanted = Wanted { level, ..Wanted::of(plate) };
                let plan = Plan::new(plate, &wanted, rate_hz, usize::from(inputs.lock_ins))?;
                Measuring::new(plan, table, sensor, inputs)
            });
        let Some(measuring) = measuring else { return };
        reach.drive.make_ready();
        let has_stopped_drive = reach.drive.is_wanted();
        self.live.owes_drive |= has_stopped_drive;
        let place = show_place(self.live.draft.place_m);
        let text = format!("Measuring at {place}.");
        let planned = measuring.planned_samples();
        let began = reach.drive.snapshot().drive.status.map_or(0, |status| status.now);
        let answers_so_far = Some(Answers::new(reach.desk.plate(), measuring.planned()));
        self.live.course = Course { place, answers, has_stopped_drive, planned, began, answers_so_far };
        self.live.under_way.begin(measuring, text, reach);
    }

    /// Measures the drive's harmonics at the place and level of the draft, or reports the obstacle.
    pub(super) fn begin_harmonics(&mut self, reach: &mut Reach<'_>) {
        let level = self.live.draft.level;
        let measuring = self.prepared(Awaiting::Harmonics, reach, |reach, inputs, table, sensor| {
            let plate = reach.desk.plate();
            let plan = HarmonicsPlan::new(plate, harmonics::POINTS, level, reach.drive.sample_rate_hz())?;
            MeasuringHarmonics::new(plate, plan, table, sensor, inputs)
        });
        if let Some(measuring) = measuring {
            reach.drive.make_ready();
            let text = "Measuring the drive's harmonics.".to_owned();
            self.harmonics.under_way.begin(measuring, text, reach);
        }
    }

    /// Compares the codes if the device may drive and holds the table of this plate; otherwise reports the obstacle.
    pub(super) fn begin_verification(&mut self, reach: &mut Reach<'_>) {
        if self.is_measuring() {
            return;
        }
        let obstacle = match reach.drive.obstacle() {
            Some(obstacle) => Some(obstacle.into()),
            None => (!reach.drive.is_table_there()).then_some(MeasuringRefused::NoTable),
        };
        if let Some(obstacle) = obstacle {
            return reach.out.hinder(obstacle.to_string());
        }
        self.end_hold(HoldEnd::Measured, reach.out);
        reach.drive.make_ready();
        let rate_hz = reach.drive.sample_rate_hz();
        let verifying = Verifying::new(reach.desk.plate(), MAX_TONES as u8, verification::WINDOW_S, rate_hz);
        let text = "Comparing the device's codes with the mirror's.".to_owned();
        self.verification.begin(verifying, text, reach);
    }

    /// Tests the board, or reports the obstacle. Where the amplifier is tested, the user must have armed the device, after the
    /// question that belongs to it; that of the simulated device drives its plate, which is put on the bench first.
    pub(super) fn begin_selftest(&mut self, reach: &mut Reach<'_>) {
        if self.is_measuring() {
            return;
        }
        let is_amplifier_on = self.board_test.request.is_amplifier_on;
        if let Some(obstacle) = reach.drive.obstacle_to_test(is_amplifier_on) {
            reach.out.hinder(obstacle.to_string());
            if obstacle == Obstacle::Muted && !reach.attention.has_page {
                reach.out.open(Page::Arm);
            }
            return;
        }
        if is_amplifier_on && self.awaits_rig(Awaiting::Selftest, reach) {
            return;
        }
        self.end_hold(HoldEnd::Measured, reach.out);
        self.board_test.begin(reach);
    }

    /// A procedure with the sensor of the draft, which may begin now: the level hold has ended. `None` while another one is under way,
    /// where it waits for the rig, and where the device cannot carry it out, which is reported.
    fn prepared<P: Procedure>(
        &mut self,
        awaiting: Awaiting,
        reach: &mut Reach<'_>,
        make: impl FnOnce(&Reach<'_>, &InputsReport, Arc<DeviceTable>, Sensor) -> Result<P, MeasureError>,
    ) -> Option<AfterCheck<P>> {
        if self.is_measuring() {
            return None;
        }
        self.live.failed = None;
        let ready = self.sensor_and_table(reach);
        if ready.is_ok() && self.awaits_rig(awaiting, reach) {
            return None;
        }
        let made = ready.and_then(|(inputs, table, sensor)| {
            let procedure = make(reach, &inputs, Arc::clone(&table), sensor)?;
            Ok(AfterCheck::new(self.checking(reach, &inputs, table)?, procedure))
        });
        match made {
            Ok(_) => self.end_hold(HoldEnd::Measured, reach.out),
            Err(ref refused) => reach.out.hinder(refused.to_string()),
        }
        made.ok()
    }

    /// The inputs of the device, the plate's table that it holds, and the sensor of the draft, or why the device cannot measure now.
    fn sensor_and_table(
        &self,
        Reach { desk, drive, .. }: &Reach<'_>,
    ) -> Result<(InputsReport, Arc<DeviceTable>, Sensor), MeasuringRefused> {
        if let Some(obstacle) = drive.obstacle() {
            return Err(obstacle.into());
        }
        let inputs = drive.snapshot().device.inputs.filter(|inputs| inputs.inputs > SENSOR_INPUT);
        let inputs = inputs.ok_or(MeasuringRefused::NoSensorInput)?;
        let made = drive.table_made().filter(|_| drive.is_table_there());
        let table = Arc::clone(&made.ok_or(MeasuringRefused::NoTable)?.device_table);
        let MeasureDraft { place_m, kind, body, .. } = self.live.draft;
        if !(0.0..=desk.plate().length_m()).contains(&place_m) {
            return Err(MeasuringRefused::OffThePlate { place_m });
        }
        Ok((inputs, table, Sensor { place_m, kind, input: SENSOR_INPUT, body }))
    }

    /// The check of the drive, if the draft asks for one.
    fn checking(
        &self,
        Reach { desk, drive, .. }: &Reach<'_>,
        inputs: &InputsReport,
        table: Arc<DeviceTable>,
    ) -> Result<Option<DriveChecking>, MeasuringRefused> {
        let MeasureDraft { is_checked, drive: known_drive, .. } = self.live.draft;
        if !is_checked {
            return Ok(None);
        }
        if inputs.inputs <= CURRENT_INPUT {
            return Err(MeasuringRefused::NoCurrentInput);
        }
        let known_drive =
            if is_at_bench(drive.snapshot()) { self.rig.known_drive() } else { Some(known_drive) };
        let check = |known| DriveChecking::new(desk.plate(), known, table, drive.sample_rate_hz(), inputs);
        // Without a drive the rig is put together first.
        Ok(known_drive.map(check).transpose()?)
    }

    /// The rig that the draft needs.
    fn wanted_rig(&self, reach: &Reach<'_>) -> RigJob {
        self.rig.wanted(reach.desk.plate(), &self.live.draft, reach.drive.sample_rate_hz())
    }

    /// Whether that rig is on the bench; moves its sensor to the place of the draft.
    pub(super) fn is_rig_standing(&self, reach: &Reach<'_>) -> bool {
        self.rig.is_standing(&self.wanted_rig(reach))
    }

    /// Puts that rig on the bench of a simulated device.
    pub(super) fn put_rig_up(&mut self, reach: &Reach<'_>) {
        if is_at_bench(reach.drive.snapshot()) && !self.is_rig_standing(reach) {
            self.rig.look_for(self.wanted_rig(reach));
        }
    }

    /// Whether this waits for the rig of the simulated device, which is put together then.
    fn awaits_rig(&mut self, awaiting: Awaiting, reach: &mut Reach<'_>) -> bool {
        let waits = is_at_bench(reach.drive.snapshot()) && !self.is_rig_standing(reach);
        if waits {
            self.end_hold(HoldEnd::Measured, reach.out);
            self.rig.awaited_for = Some(awaiting);
            self.rig.refused = None;
            self.put_rig_up(reach);
        }
        waits
    }

    /// Begins what waits for the rig, once it stands.
    fn begin_awaiting(&mut self, reach: &mut Reach<'_>) {
        let Some(awaiting) = self.rig.awaited_for else { return };
        if is_at_bench(reach.drive.snapshot()) && !self.is_rig_standing(reach) {
            self.put_rig_up(reach);
            return reach.out.wake_after(LOOK);
        }
        self.rig.awaited_for = None;
        match awaiting {
            Awaiting::Measurement(answers) => self.begin_measuring(answers, reach),
            Awaiting::Harmonics => self.begin_harmonics(reach),
            Awaiting::Selftest => self.begin_selftest(reach),
        }
    }

    /// Cancels what is under way or waits for the rig.
    pub(crate) fn cancel_measuring(&mut self) {
        self.rig.awaited_for = None;
        self.live.under_way.cancel();
        self.verification.cancel();
        self.board_test.under_way.cancel();
        self.harmonics.under_way.cancel();
    }

    /// The user ends the connection or opens another: a self-test, which closes the port and waits for a board that restarts, would
    /// open the port again.
    pub(crate) fn leave_port(&mut self) {
        self.board_test.under_way.leave_port();
    }

    /// Begins what waits for the rig, continues the measurement under way, and reports its end.
    pub(super) fn update_measuring(&mut self, reach: &mut Reach<'_>) {
        if let Err(reason) = self.rig.take(self.hold.holding.is_on()) {
            self.hold.awaits_rig = false;
            self.rig.awaited_for = None;
            reach.out.fail(format!("The simulated plate cannot be measured: {reason}"));
        }
        self.begin_awaiting(reach);
        self.look_at_sensor(reach);
        let was_checking = self.live.is_checking();
        match self.live.under_way.turn(reach) {
            Some((measured, _)) => self.measured(measured, reach),
            None if was_checking && !self.live.is_checking() => {
                reach.drive.note(Severity::Info, DriveCheck::On.to_string());
            }
            None => {}
        }
        if let Some((answers, run)) = self.live.course.answers_so_far.as_mut().zip(self.live.under_way.run())
        {
            answers.take_measured(run.so_far());
        }
    }

    /// Captures the sensor's signal while a page of the calibration shows it.
    fn look_at_sensor(&mut self, reach: &mut Reach<'_>) {
        let is_wanted = reach.attention.is_calibration_open
            && self.calibration.has_sensor_in_hand()
            && reach.drive.snapshot().is_connected()
            && !self.is_measuring();
        let Some(next) = Looks::next(reach.drive).filter(|_| is_wanted) else {
            self.live.looks = Looks::default();
            return;
        };
        self.end_hold(HoldEnd::Measured, reach.out);
        self.put_rig_up(reach);
        self.live.looks.update(next, reach.drive);
        reach.out.wake_after(LOOK);
    }

    /// Stores the measurement, or reports why it failed.
    fn measured(&mut self, measured: Result<Measured, MeasureError>, reach: &mut Reach<'_>) {
        let Course { place, answers, has_stopped_drive, .. } = std::mem::take(&mut self.live.course);
        let next = if has_stopped_drive { DRIVE_ENDED } else { "" };
        let Measured { measurement, warnings, .. } = match measured {
            Ok(measured) => measured,
            Err(MeasureError::Cancelled) => {
                return reach.out.post(format!("The measurement was cancelled.{next}"));
            }
            Err(error) => {
                let text = format!("{}{next}", not_measured(&error));
                self.live.failed = Some(text.clone());
                return reach.out.fail(text);
            }
        };
        let count = measurement.points.len();
        self.rig.note_measured();
        // A run without a result has no number.
        let name = format!("{place}, run {}", self.measurements.lists.count_run());
        match self.measurements.add(&name, measurement) {
            Ok(number) => {
                if let Some(sensor) = answers {
                    self.take_answer(sensor, number);
                }
            }
            Err(error) => return reach.out.fail(slipline_link::capitalized(&error.to_string())),
        }
        let sentences: Vec<String> = warnings.iter().map(|warning| warning.sentence()).collect();
        for sentence in &sentences {
            reach.drive.note(Severity::Warning, sentence.clone());
        }
        let text = format!("Measured {name}: {count} answers.");
        match sentences.first() {
            Some(first) => reach.out.fail(format!("{text} {first}{next}")),
            None => reach.out.post(format!("{text}{next}")),
        }
    }
}

/// The message for a failed measurement.
fn not_measured(error: &MeasureError) -> String {
    let MeasureError::NotOn(check) = error else { return format!("Not measured: {error}.") };
    if matches!(check, DriveCheck::TooQuiet { .. }) {
        format!("Not measured. {check} Slipline plays nothing louder until it knows that the drive is on.")
    } else {
        format!("Not measured. {check}")
    }
}
