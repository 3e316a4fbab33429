//! "Is it on?": quiet tones far below the plate's cut-off, and what the current through the drive tells of it.
//!
//! ```text
//! Plan::of_drive --Measuring--> current --check_drive--> too quiet to tell? louder, up to a tenth of full scale, and longer
//!                                                    \-> DriveCheck: on, open, shorted, no amplifier, another drive
//! ```

use super::answers::{Measured, Sensor};
use super::error::MeasureError;
use super::measuring::Measuring;
use super::plan::Plan;
use super::procedure::{Procedure, Step};
use slipline_link::protocol::listen::InputsReport;
use slipline_link::{DeviceTable, Outcome, Snapshot};
use slipline_plate::Plate;
use slipline_plate::calibrate::{DriveCheck, DriveCircuit, Measurement, SensorKind, check_drive};
use std::sync::Arc;

/// The device's input that samples the current of the drive: the shunt.
pub const CURRENT_INPUT: u8 = 1;
/// What the first tones together are of full scale: -40 dB.
const QUIET: f64 = 0.01;
/// What they are at most: -20 dB.
const LOUDEST: f64 = 0.1;
/// How much louder than what is told to be just enough, dB.
const ROOM_DB: f64 = 2.0;
/// Shortest and longest window, seconds.
const WINDOW_S: (f64, f64) = (0.1, 2.0);

/// How loud the tones are, and for how long they are measured.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Effort {
    level: f64,
    window_s: f64,
}

impl Effort {
    const FIRST: Self = Self { level: QUIET, window_s: WINDOW_S.0 };

    /// So many dB more of signal over noise: first by the level, then by the window; nothing if there is no more.
    fn more(self, louder_db: f64) -> Option<Self> {
        if self.level >= LOUDEST && self.window_s >= WINDOW_S.1 {
            return None;
        }
        let wanted_db = louder_db + ROOM_DB;
        let level = (self.level * 10_f64.powf(wanted_db / 20.0)).min(LOUDEST);
        let rest_db = wanted_db - 20.0 * (level / self.level).log10();
        let window_s = (self.window_s * 10_f64.powf(rest_db / 10.0)).min(WINDOW_S.1);
        Some(Self { level, window_s })
    }
}

/// The sensor that is the shunt: its place and its kind do not count.
#[must_use]
pub const fn current_sensor() -> Sensor {
    Sensor { place_m: 0.0, kind: SensorKind::Displacement, input: CURRENT_INPUT }
}

/// What a drive is told to be, and what its current is in the device's input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownDrive {
    /// From the code to the drive.
    pub circuit: DriveCircuit,
    /// The current at the end of the input's range, ampere.
    pub full_scale_a: f64,
}

/// What was found of a drive.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckedDrive {
    /// Its state.
    pub check: DriveCheck,
    /// The current that tells it, ampere per code.
    pub current: Measurement,
    /// What the tones together were of full scale.
    pub level: f64,
}

/// The check of a drive under way.
pub struct DriveChecking {
    plate: Plate,
    drive: KnownDrive,
    table: Arc<DeviceTable>,
    inputs: InputsReport,
    rate_hz: f64,
    effort: Effort,
    /// Nothing once it has ended.
    measuring: Option<Measuring>,
    ended: Option<Result<CheckedDrive, MeasureError>>,
}

impl DriveChecking {
    /// A check that begins with the next step. The device must be armed and hold `table`, that of `plate`; it has told `inputs`.
    ///
    /// # Errors
    /// [`MeasureError::NoInputs`] if it has no input for the current.
    pub fn new(
        plate: &Plate,
        drive: KnownDrive,
        table: Arc<DeviceTable>,
        rate_hz: f64,
        inputs: &InputsReport,
    ) -> Result<Self, MeasureError> {
        let mut checking = Self {
            plate: plate.clone(),
            drive,
            table,
            inputs: *inputs,
            rate_hz,
            effort: Effort::FIRST,
            measuring: None,
            ended: None,
        };
        checking.begin(Effort::FIRST)?;
        Ok(checking)
    }

    /// Begins to measure.
    fn begin(&mut self, effort: Effort) -> Result<(), MeasureError> {
        let lock_ins = self.inputs.lock_ins.into();
        let load = &self.drive.circuit.load;
        let plan = Plan::of_drive(&self.plate, load, self.rate_hz, lock_ins, effort.level, effort.window_s)?;
        self.effort = effort;
        self.measuring = Some(Measuring::new(plan, self.table.clone(), current_sensor(), &self.inputs)?);
        Ok(())
    }

    /// Judges what was measured, or begins anew with more effort.
    fn judge(
        &mut self,
        measured: Result<Measured, MeasureError>,
    ) -> Result<Option<CheckedDrive>, MeasureError> {
        let current =
            Measurement { unit_per_response: Some(self.drive.full_scale_a), ..measured?.measurement };
        let check = check_drive(&self.plate, &self.drive.circuit, &current)?;
        if let DriveCheck::TooQuiet { louder_db } = check
            && let Some(effort) = self.effort.more(louder_db)
        {
            self.begin(effort)?;
            return Ok(None);
        }
        Ok(Some(CheckedDrive { check, current, level: self.effort.level }))
    }
}

impl Procedure for DriveChecking {
    type Found = CheckedDrive;

    fn step(&mut self) -> Step {
        loop {
            let Some(measuring) = &mut self.measuring else { return Step::Ended };
            match measuring.step() {
                Step::Ended => {
                    if let Some(measuring) = self.measuring.take() {
                        self.ended = self.judge(measuring.finish()).transpose();
                    }
                }
                step @ (Step::Ask(_) | Step::Wait) => return step,
            }
        }
    }

    fn take(&mut self, outcome: &Outcome) {
        if let Some(measuring) = &mut self.measuring {
            measuring.take(outcome);
        }
    }

    fn watch(&mut self, snapshot: &Snapshot) {
        if let Some(measuring) = &mut self.measuring {
            measuring.watch(snapshot);
        }
    }

    fn cancel(&mut self) {
        if let Some(measuring) = &mut self.measuring {
            measuring.cancel();
        }
    }

    fn progress(&self, now: u64) -> f64 {
        self.measuring.as_ref().map_or(1.0, |measuring| measuring.progress(now))
    }

    fn finish(self) -> Result<CheckedDrive, MeasureError> {
        self.ended.unwrap_or(Err(MeasureError::Cancelled))
    }
}
