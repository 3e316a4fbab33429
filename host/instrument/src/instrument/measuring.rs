//! A measurement with the connected device: one request after the other, without blocking. STOP, a fault, a
//! lost device and another plate end it; its last request is a stop.

use super::Instrument;
use super::MeasureDraft;
use super::rig::Rig;
use super::shown::LiveScene;
use super::signal::{Looks, SENSOR_INPUT};
use super::start::Obstacle;
use crate::hold::HoldEnd;
use crate::measure::{
    AfterCheck, CURRENT_INPUT, DriveChecking, MeasureError, Measured, Measuring, Plan, Run, Sensor, Wanted,
};
use slipline_link::{Severity, Ticket};
use slipline_plate::Plate;
use slipline_plate::calibrate::DriveCheck;
use slipline_plate::quantity::show_place;
use std::sync::Arc;
use std::time::Duration;

/// Time between two updates of the progress.
const LOOK: Duration = Duration::from_millis(50);

/// What is said after a measurement that has ended a drive: nothing but a press of Drive starts it again.
const DRIVE_ENDED: &str = " The drive was stopped for it: press Drive to resume.";

/// A measurement under way.
struct UnderWay {
    measuring: Run<AfterCheck<Measuring>>,
    plate: Arc<Plate>,
    name: String,
    /// The calibration's place that it measures, 0 or 1.
    answers: Option<usize>,
    /// Whether it has ended a drive.
    has_stopped_drive: bool,
}

/// The state of the measurements with the device.
#[derive(Default)]
pub(crate) struct Live {
    pub(crate) draft: MeasureDraft,
    run: Option<UnderWay>,
    /// Why the last measurement failed.
    failed: Option<String>,
    /// The rig of the simulated device.
    pub(crate) rig: Rig,
    /// Short captures of the input while the sensor is being placed.
    pub(crate) looks: Looks,
    /// Number of runs so far, for their names.
    count: u32,
}

impl Live {
    pub(crate) fn scene(&self, now: u64, is_drive_known: bool) -> LiveScene<'_> {
        let run = self.run.as_ref().map(|run| run.measuring.progress(now) as f32);
        let progress = run.or(self.rig.is_awaited().then_some(0.0));
        LiveScene {
            draft: &self.draft,
            progress,
            is_checking: self.run.as_ref().is_some_and(|run| run.measuring.is_checking()),
            is_drive_known,
            failed: self.failed.as_deref(),
            signal: self.looks.latest,
            is_secret: self.rig.is_secret(),
            is_secret_measured: self.rig.truth().is_some_and(|(_, is_measured)| is_measured),
        }
    }

    /// Whether the measurement under way handles this request's outcome.
    pub(crate) fn awaits(&self, ticket: Ticket) -> bool {
        self.run.as_ref().is_some_and(|run| run.measuring.awaited() == Some(ticket))
            || self.looks.awaits(ticket)
    }

    /// Whether the device's input is listened to.
    pub(crate) fn is_heard(&self) -> bool {
        self.is_under_way() || self.looks.is_looking()
    }

    pub(crate) fn is_under_way(&self) -> bool {
        self.run.is_some() || self.rig.is_awaited()
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

impl Instrument {
    /// Starts a measurement, or reports the obstacle.
    pub(crate) fn begin_measuring(&mut self, answers: Option<usize>) {
        if self.live.is_under_way() {
            return;
        }
        self.live.failed = None;
        match self.prepared_measuring() {
            Err(refused) => self.notices.hinder(refused.to_string()),
            Ok(_) if self.snapshot.is_simulated() && !self.is_rig_standing() => {
                self.put_rig_together(answers);
            }
            Ok(measuring) => {
                self.end_hold(HoldEnd::Measured);
                self.make_ready();
                let has_stopped_drive = self.autopilot.wants_drive();
                self.autopilot.stopped();
                self.end_replay();
                self.live.count += 1;
                let place = show_place(self.live.draft.place_m);
                let name = format!("{place}, run {}", self.live.count);
                let plate = Arc::clone(&self.setup.plate);
                self.note(Severity::Info, format!("Measuring at {place}."));
                let measuring = Run::of(measuring);
                self.live.run = Some(UnderWay { measuring, plate, name, answers, has_stopped_drive });
            }
        }
    }

    /// The measurement of the draft, or why the device cannot carry it out now.
    fn prepared_measuring(&self) -> Result<AfterCheck<Measuring>, MeasuringRefused> {
        if let Some(obstacle) = self.obstacle() {
            return Err(obstacle.into());
        }
        let inputs = self.snapshot.inputs.filter(|inputs| inputs.inputs > SENSOR_INPUT);
        let inputs = inputs.ok_or(MeasuringRefused::NoSensorInput)?;
        let made = self.screen_table().filter(|_| self.is_table_there());
        let made = made.ok_or(MeasuringRefused::NoTable)?;
        let MeasureDraft { place_m, kind, level, is_checked, drive } = self.live.draft;
        let plate = &self.setup.plate;
        if !(0.0..=plate.length_m()).contains(&place_m) {
            return Err(MeasuringRefused::OffThePlate { place_m });
        }
        let wanted = Wanted { level, ..Wanted::of(plate) };
        let plan = Plan::new(plate, &wanted, self.sample_rate_hz(), usize::from(inputs.lock_ins))?;
        let sensor = Sensor { place_m, kind, input: SENSOR_INPUT };
        let table = &made.device_table;
        let measuring = Measuring::new(plan, Arc::clone(table), sensor, &inputs)?;
        if !is_checked {
            return Ok(AfterCheck::new(None, measuring));
        }
        if inputs.inputs <= CURRENT_INPUT {
            return Err(MeasuringRefused::NoCurrentInput);
        }
        let drive = if self.is_at_bench() { self.live.rig.known_drive() } else { Some(drive) };
        let check =
            |drive| DriveChecking::new(plate, drive, Arc::clone(table), self.sample_rate_hz(), &inputs);
        // Without a drive the rig is put together first.
        let checking = drive.map(check).transpose()?;
        Ok(AfterCheck::new(checking, measuring))
    }

    /// Cancels the measurement under way.
    pub(crate) fn cancel_measuring(&mut self) {
        self.live.rig.awaited_for = None;
        if let Some(run) = &mut self.live.run {
            run.measuring.cancel();
        }
    }

    /// Passes the device's outcomes on, and sends the next request.
    pub(crate) fn update_measuring(&mut self) {
        self.take_rig();
        if self.update_signal() {
            self.wake_after(LOOK);
        }
        let Some(run) = &mut self.live.run else { return };
        if !Arc::ptr_eq(&run.plate, &self.setup.plate) {
            run.measuring.cancel();
        }
        let was_checking = run.measuring.is_checking();
        if !run.measuring.turn(&self.snapshot, |request| self.link.send(request)) {
            return self.measured();
        }
        if was_checking && !run.measuring.is_checking() {
            self.note(Severity::Info, DriveCheck::On.to_string());
        }
        self.wake_after(LOOK);
    }

    /// Stores the measurement, or reports why it failed.
    fn measured(&mut self) {
        let Some(under_way) = self.live.run.take() else { return };
        let UnderWay { measuring, name, answers, has_stopped_drive, .. } = under_way;
        let next = if has_stopped_drive { DRIVE_ENDED } else { "" };
        match measuring.finish() {
            Ok(measured) => self.take_measured(&name, measured, answers, next),
            Err(MeasureError::Cancelled) => {
                self.notices.post(format!("The measurement was cancelled.{next}"));
            }
            Err(error) => {
                let text = format!("{}{next}", not_measured(&error));
                self.live.failed = Some(text.clone());
                self.fail(text);
            }
        }
    }

    fn take_measured(&mut self, name: &str, measured: Measured, answers: Option<usize>, next: &str) {
        let Measured { measurement, warnings, .. } = measured;
        let count = measurement.points.len();
        self.note_measured();
        match self.measures.add(name, measurement) {
            Ok(number) => {
                if let Some(sensor) = answers {
                    self.take_answer(sensor, number);
                }
            }
            Err(error) => return self.fail(slipline_link::capitalized(&error.to_string())),
        }
        let sentences: Vec<String> = warnings.iter().map(|warning| warning.sentence()).collect();
        for sentence in &sentences {
            self.note(Severity::Warning, sentence.clone());
        }
        let text = format!("Measured {name}: {count} answers.");
        match sentences.first() {
            Some(first) => self.fail(format!("{text} {first}{next}")),
            None => self.notices.post(format!("{text}{next}")),
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
