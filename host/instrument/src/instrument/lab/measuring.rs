//! A measurement with the connected device: one request after the other, without blocking. STOP, a fault, a
//! lost device and another plate end it; its last request is a stop.

use super::measurements::Measurements;
use super::rig::Rig;
use super::signal::{Looks, SENSOR_INPUT};
use super::so_far::Course;
use super::{LOOK, Lab, MeasureDraft, Reach, is_at_bench};
use crate::hold::HoldEnd;
use crate::instrument::drive::Obstacle;
use crate::instrument::shown::{LiveScene, Progress};
use crate::jobs::rig::RigJob;
use crate::measure::{
    AfterCheck, CURRENT_INPUT, DriveChecking, MeasureError, Measured, Measuring, Plan, Run, Sensor, Wanted,
    remaining_samples,
};
use slipline_link::protocol::listen::InputsReport;
use slipline_link::{DeviceTable, Severity, Ticket};
use slipline_model::jobs::compare::CompareJob;
use slipline_plate::Plate;
use slipline_plate::calibrate::DriveCheck;
use slipline_plate::quantity::show_place;
use std::sync::Arc;

/// What is said after a measurement that has ended a drive: nothing but a press of Drive starts it again.
const DRIVE_ENDED: &str = " The drive was stopped for it: press Drive to resume.";

/// A measurement under way.
struct UnderWay {
    measuring: Run<AfterCheck<Measuring>>,
    plate: Arc<Plate>,
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
    course: Course,
}

impl UnderWay {
    /// The share that is done, 0 to 1, and the samples that it still takes, when the device is at sample `now`.
    fn progress(&self, now: u64) -> (f64, f64) {
        let share = self.measuring.progress(now);
        let elapsed = now.saturating_sub(self.began) as f64;
        (share, remaining_samples(self.planned, share, elapsed))
    }
}

/// The state of the measurements with the device.
#[derive(Default)]
pub(super) struct Live {
    pub(super) draft: MeasureDraft,
    run: Option<UnderWay>,
    /// Why the last measurement failed.
    failed: Option<String>,
    /// Short captures of the input while the sensor is being placed.
    pub(super) looks: Looks,
    /// Whether measuring has ended a drive that the user has neither begun again nor stopped since.
    owes_drive: bool,
}

impl Live {
    pub(super) fn scene(&self, (now, rate_hz): (u64, f64), rig: &Rig, is_drive_known: bool) -> LiveScene<'_> {
        let run = self.run.as_ref().map(|run| run.progress(now));
        let progress =
            run.map(|(share, left)| Progress { share: share as f32, left_s: Some(left / rate_hz) });
        LiveScene {
            draft: &self.draft,
            progress: progress.or(rig.is_awaited().then_some(Progress { share: 0.0, left_s: None })),
            so_far: self.run.as_ref().map(|run| run.course.scene()),
            is_checking: self.run.as_ref().is_some_and(|run| run.measuring.is_checking()),
            is_drive_known,
            failed: self.failed.as_deref(),
            signal: self.looks.latest,
            is_secret: rig.is_secret(),
            is_secret_measured: rig.truth().is_some_and(|(_, is_measured)| is_measured),
        }
    }

    /// What the plate's model is asked for by the measurement under way.
    pub(super) fn wanted_model(&self) -> Option<&CompareJob> {
        self.run.as_ref()?.course.wanted()
    }

    /// Takes the model's answers, if they are there.
    pub(super) fn take_model(&mut self, measurements: &Measurements) {
        let Some(run) = &mut self.run else { return };
        if let Some(answers) = run.course.wanted().and_then(|planned| measurements.model(planned)) {
            run.course.take(answers);
        }
    }

    /// Whether the measurement under way handles this request's outcome.
    pub(super) fn awaits(&self, ticket: Ticket) -> bool {
        self.run.as_ref().is_some_and(|run| run.measuring.awaited() == Some(ticket))
            || self.looks.awaits(ticket)
    }

    /// Whether the device is measuring.
    pub(super) const fn is_running(&self) -> bool {
        self.run.is_some()
    }
}

/// Why the device cannot carry out a measurement now.
#[derive(Debug, thiserror::Error)]
pub(super) enum MeasuringRefused {
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
        if self.is_measuring() {
            return;
        }
        self.live.failed = None;
        match self.prepared_measuring(reach) {
            Err(refused) => reach.out.hinder(refused.to_string()),
            Ok(_) if reach.drive.snapshot().is_simulated() && !self.is_rig_standing(reach) => {
                self.rig.put_together(self.wanted_rig(reach), answers);
            }
            Ok(measuring) => {
                self.end_hold(HoldEnd::Measured, reach.out);
                reach.drive.make_ready();
                let has_stopped_drive = reach.drive.is_wanted();
                self.live.owes_drive |= has_stopped_drive;
                reach.drive.give_up();
                reach.desk.end_replay();
                let place = show_place(self.live.draft.place_m);
                let plate = Arc::clone(reach.desk.plate());
                reach.drive.note(Severity::Info, format!("Measuring at {place}."));
                let planned = measuring.planned_samples();
                let began = reach.drive.snapshot().drive.status.map_or(0, |status| status.now);
                let course = Course::new(&plate, measuring.planned());
                let measuring = Run::of(measuring);
                self.live.run = Some(UnderWay {
                    measuring,
                    plate,
                    place,
                    answers,
                    has_stopped_drive,
                    planned,
                    began,
                    course,
                });
            }
        }
    }

    /// The measurement of the draft, or why the device cannot carry it out now.
    fn prepared_measuring(&self, reach: &Reach<'_>) -> Result<AfterCheck<Measuring>, MeasuringRefused> {
        let (inputs, table, sensor) = self.sensor_and_table(reach)?;
        let (plate, rate_hz) = (reach.desk.plate(), reach.drive.sample_rate_hz());
        let wanted = Wanted { level: self.live.draft.level, ..Wanted::of(plate) };
        let plan = Plan::new(plate, &wanted, rate_hz, usize::from(inputs.lock_ins))?;
        let measuring = Measuring::new(plan, Arc::clone(&table), sensor, &inputs)?;
        Ok(AfterCheck::new(self.checking(reach, &inputs, table)?, measuring))
    }

    /// The inputs of the device, the plate's table that it holds, and the sensor of the draft, or why the device cannot measure now.
    pub(super) fn sensor_and_table(
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
    pub(super) fn checking(
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

    /// Cancels the measurement or the comparison of codes under way.
    pub(crate) fn cancel_measuring(&mut self) {
        self.verification.cancel();
        self.board_test.cancel();
        self.harmonics.cancel();
        self.rig.awaited_for = None;
        if let Some(run) = &mut self.live.run {
            run.measuring.cancel();
        }
    }

    /// Passes the device's outcomes on, and sends the next request.
    pub(super) fn update_measuring(&mut self, reach: &mut Reach<'_>) {
        match self.rig.take(self.hold.holding.is_on()) {
            Ok(Some(answers)) => self.begin_measuring(answers, reach),
            Ok(None) => {}
            Err(reason) => {
                self.hold.awaits_rig = false;
                self.board_test.awaits_rig = false;
                self.harmonics.awaits_rig = false;
                reach.out.fail(format!("The simulated plate cannot be measured: {reason}"));
            }
        }
        self.look_at_sensor(reach);
        let Some(run) = &mut self.live.run else { return };
        if !Arc::ptr_eq(&run.plate, reach.desk.plate()) {
            run.measuring.cancel();
        }
        let was_checking = run.measuring.is_checking();
        let drive = &*reach.drive;
        if !run.measuring.turn(drive.snapshot(), |request| drive.send(request)) {
            return self.measured(reach);
        }
        run.course.hear(run.measuring.so_far());
        if was_checking && !run.measuring.is_checking() {
            drive.note(Severity::Info, DriveCheck::On.to_string());
        }
        reach.out.wake_after(LOOK);
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
    fn measured(&mut self, reach: &mut Reach<'_>) {
        let Some(under_way) = self.live.run.take() else { return };
        let UnderWay { measuring, place, answers, has_stopped_drive, .. } = under_way;
        let next = if has_stopped_drive { DRIVE_ENDED } else { "" };
        let Measured { measurement, warnings, .. } = match measuring.finish() {
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
