//! The requests of the page of measurements.

use crate::measure::KnownDrive;
use crate::measure::circuit::TOLERANCE;
use crate::measured_file::ForeignMetadata;
use slipline_plate::calibrate::{DriveCircuit, DriveLoad, SensorKind};

/// What is to be measured with the device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasureDraft {
    /// Where the sensor stands, metres from the driven end.
    pub place_m: f64,
    /// What the sensor shows.
    pub kind: SensorKind,
    /// What the amplitudes of all tones together may be, as a share of full scale.
    pub level: f64,
    /// Whether quiet tones tell first that the drive is on.
    pub is_checked: bool,
    /// The drive as data sheets tell it; the rig of the simulated device tells its own.
    pub drive: KnownDrive,
}

impl Default for MeasureDraft {
    fn default() -> Self {
        let load = DriveLoad::Coil { resistance_ohm: 4.0 };
        let circuit = DriveCircuit { full_scale_v: 2.0, load, tolerance: TOLERANCE };
        Self {
            place_m: 0.03,
            kind: SensorKind::Acceleration,
            level: 0.5,
            is_checked: false,
            drive: KnownDrive { circuit, full_scale_a: 1.65 },
        }
    }
}

/// A request of the page of measurements. Measurements are named by their numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MeasureIntent {
    /// Choose one, and draw it.
    Choose(u64),
    /// Draw one, or draw it no more.
    Show(u64, bool),
    /// Remove one from the list.
    Remove(u64),
    /// Choose a file of a measurement.
    OpenFile,
    /// Tell what a file by another program does not.
    Describe(ForeignMetadata),
    /// Tell the channel of a recording.
    Channel(usize),
    /// Take that file as it was told.
    TakeAsked,
    /// Leave that file.
    LeaveAsked,
    /// Save one as CSV.
    Save(u64),
    /// Change what is to be measured with the device.
    Draft(MeasureDraft),
    /// Measure it, for the calibration's place of this number if there is one.
    Begin(Option<usize>),
    /// Have the simulated device stand on a plate that is a few per cent off, which nobody knows; or on the one of the file.
    Secret(bool),
    /// Give the measurement under way up.
    Cancel,
}
