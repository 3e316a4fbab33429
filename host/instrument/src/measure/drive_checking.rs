//! Check whether the drive is on, with quiet tones far below the plate's cut-off, by the current through the
//! drive.
//!
//! ```text
//! Plan::of_drive --Measuring--> current --check_drive--> too weak to judge? louder, up to a tenth of full scale, and longer
//!                                                    \-> DriveCheck: on, open, shorted, no amplifier, another drive
//! ```

use super::answers::Sensor;
use super::dialogue::Dialogue;
use super::error::MeasureError;
use super::images::Bandwidths;
use super::measuring::Measuring;
use super::plan::Plan;
use super::procedure::{Evaluation, Procedure, evaluated};
use slipline_link::DeviceTable;
use slipline_link::protocol::listen::InputsReport;
use slipline_plate::Plate;
use slipline_plate::calibrate::{DriveCheck, DriveCircuit, Measurement, SensorKind, check_drive};
use slipline_plate::quantity::{decibels, from_decibels};
use std::sync::Arc;

/// The device's input that samples the current through the drive, by a shunt.
pub(crate) const CURRENT_INPUT: u8 = 1;
/// Sum of the first tones' amplitudes, as a share of full scale: -40 dB.
const QUIET: f64 = 0.01;
/// Largest sum of the amplitudes: -20 dB.
const LOUDEST: f64 = 0.1;
/// Margin added to the level or window that would just suffice, dB.
const ROOM_DB: f64 = 2.0;
/// Shortest and longest window, seconds.
const WINDOW_S: (f64, f64) = (0.1, 2.0);

/// Level of the tones, and length of their window.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Effort {
    level: f64,
    window_s: f64,
}

impl Effort {
    const FIRST: Self = Self { level: QUIET, window_s: WINDOW_S.0 };

    /// Raises signal over noise by this number of dB: first the level, then the window; `None` if both are at
    /// their limits.
    fn more(self, louder_db: f64) -> Option<Self> {
        if self.level >= LOUDEST && self.window_s >= WINDOW_S.1 {
            return None;
        }
        let wanted_db = louder_db + ROOM_DB;
        let level = (self.level * from_decibels(wanted_db)).min(LOUDEST);
        let rest_db = wanted_db - decibels(level / self.level);
        let window_s = (self.window_s * 10_f64.powf(rest_db / 10.0)).min(WINDOW_S.1);
        Some(Self { level, window_s })
    }
}

/// The shunt as a sensor; its place and kind are not used.
#[must_use]
pub const fn current_sensor() -> Sensor {
    Sensor { place_m: 0.0, kind: SensorKind::Displacement, input: CURRENT_INPUT, body: None }
}

/// The drive circuit by its data sheets, and the scale of its current in the device's input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownDrive {
    /// The circuit from the code to the drive.
    pub circuit: DriveCircuit,
    /// Current at the end of the input's range, ampere.
    pub full_scale_a: f64,
    /// What bounds the images that fold onto the current.
    pub bandwidths: Bandwidths,
}

/// Result of a drive check.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckedDrive {
    /// Its state.
    pub check: DriveCheck,
    /// The measured current, ampere per code.
    pub current: Measurement,
    /// Sum of the tones' amplitudes, as a share of full scale.
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
    /// A check with a device that must be armed and hold `table`, the table of `plate`; `inputs` is the
    /// device's report of its inputs.
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
    type Found = CheckedDrive;

    async fn carry_out(self, dialogue: Dialogue) -> Result<Evaluation<CheckedDrive>, MeasureError> {
        let mut effort = Effort::FIRST;
        loop {
            let measured = self.measuring(effort)?.carry_out(dialogue.clone()).await?()?;
            let current =
                Measurement { unit_per_response: Some(self.drive.full_scale_a), ..measured.measurement };
            let check = check_drive(&self.plate, &self.drive.circuit, &current)?;
            if let DriveCheck::TooQuiet { louder_db } = check
                && let Some(more) = effort.more(louder_db)
            {
                effort = more;
            } else {
                return Ok(evaluated(CheckedDrive { check, current, level: effort.level }));
            }
        }
    }
}
