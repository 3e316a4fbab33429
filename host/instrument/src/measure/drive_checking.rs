//! "Is it on?": quiet tones far below the plate's cut-off, and what the current through the drive tells of it.
//!
//! ```text
//! Plan::of_drive --Measuring--> current --check_drive--> too quiet to tell? louder, up to a tenth of full scale, and longer
//!                                                    \-> DriveCheck: on, open, shorted, no amplifier, another drive
//! ```

use super::answers::Sensor;
use super::dialogue::Dialogue;
use super::error::MeasureError;
use super::measuring::Measuring;
use super::plan::Plan;
use super::procedure::Procedure;
use slipline_link::DeviceTable;
use slipline_link::protocol::listen::InputsReport;
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

/// The check of a drive.
pub struct DriveChecking {
    plate: Plate,
    drive: KnownDrive,
    table: Arc<DeviceTable>,
    inputs: InputsReport,
    rate_hz: f64,
}

impl DriveChecking {
    /// A check with a device that must be armed and hold `table`, that of `plate`; its inputs are reported as `inputs`.
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
        let checking = Self { plate: plate.clone(), drive, table, inputs: *inputs, rate_hz };
        checking.measuring(Effort::FIRST)?;
        Ok(checking)
    }

    /// The measurement of the current.
    fn measuring(&self, effort: Effort) -> Result<Measuring, MeasureError> {
        let (load, lock_ins) = (&self.drive.circuit.load, self.inputs.lock_ins.into());
        let plan = Plan::of_drive(&self.plate, load, self.rate_hz, lock_ins, effort.level, effort.window_s)?;
        Measuring::new(plan, Arc::clone(&self.table), current_sensor(), &self.inputs)
    }
}

impl Procedure for DriveChecking {
    type Heard = CheckedDrive;
    type Found = CheckedDrive;

    async fn carry_out(self, dialogue: Dialogue) -> Result<CheckedDrive, MeasureError> {
        let mut effort = Effort::FIRST;
        loop {
            let measured = self.measuring(effort)?.carry_out(dialogue.clone()).await?;
            let current =
                Measurement { unit_per_response: Some(self.drive.full_scale_a), ..measured.measurement };
            let check = check_drive(&self.plate, &self.drive.circuit, &current)?;
            if let DriveCheck::TooQuiet { louder_db } = check
                && let Some(more) = effort.more(louder_db)
            {
                effort = more;
            } else {
                return Ok(CheckedDrive { check, current, level: effort.level });
            }
        }
    }

    fn found(checked: CheckedDrive) -> Result<CheckedDrive, MeasureError> {
        Ok(checked)
    }
}
