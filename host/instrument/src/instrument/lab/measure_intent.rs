//! The requests of the page of measurements.

use crate::measure::circuit::TOLERANCE;
use crate::measure::{Bandwidths, KnownDrive};
use crate::measured_file::ForeignMetadata;
use crate::selftest::SelftestRequest;
use slipline_plate::calibrate::{DriveCircuit, DriveLoad, SensorBody, SensorKind};
use slipline_plate::text_table::Quantity;

/// Settings of a measurement with the device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasureDraft {
    /// Where the sensor stands, metres from the driven end.
    pub place_m: f64,
    /// What the sensor shows.
    pub kind: SensorKind,
    /// What it weighs; `None` for one that does not touch the plate.
    pub body: Option<SensorBody>,
    /// Largest sum of all tones' amplitudes, as a share of full scale.
    pub level: f64,
    /// Whether quiet tones check first that the drive is on.
    pub is_checked: bool,
    /// The drive circuit by its data sheets; the rig of the simulated device states its own.
    pub drive: KnownDrive,
}

impl Default for MeasureDraft {
    fn default() -> Self {
        let load = DriveLoad::Coil { resistance_ohm: 4.0 };
        let circuit = DriveCircuit { full_scale_v: 2.0, load, tolerance: TOLERANCE };
        Self {
            place_m: 0.03,
            kind: SensorKind::Acceleration,
            body: None,
            level: 0.5,
            is_checked: false,
            drive: KnownDrive { circuit, full_scale_a: 1.65, bandwidths: Bandwidths::default() },
        }
    }
}

/// A request of the page of measurements. Measurements are referred to by their numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MeasureIntent {
    /// Choose and draw one.
    Choose(u64),
    /// Draw one, or hide it.
    Show(u64, bool),
    /// Remove one from the list.
    Remove(u64),
    /// Choose a file of a measurement.
    OpenFile,
    /// Set the metadata that a file by another program lacks.
    Describe(ForeignMetadata),
    /// Set what a column of that file is, by its number from 0: a quantity and its unit, or left out.
    Column(usize, Option<(Quantity, &'static str)>),
    /// Set the sensor's channel of a recording.
    Channel(usize),
    /// Accept that file with the stated metadata.
    TakeAsked,
    /// Discard that file.
    LeaveAsked,
    /// Save one as CSV.
    Save(u64),
    /// Set what is to be measured with the device.
    Draft(MeasureDraft),
    /// Start the measurement, for the calibration's place of this number if there is one.
    Begin(Option<usize>),
    /// Measure the harmonics that the drive adds to tones, with the sensor and the level of the draft; the plate states them then.
    Harmonics,
    /// Have the simulated device use an unknown plate near that of the file; or that of the file.
    Secret(bool),
    /// Tap on the simulated plate.
    Tap,
    /// Compare the device's codes with the mirror's: sixteen tones start, sound, glide and stop within two seconds.
    Verify,
    /// Set what the self-test of the board is to do.
    SelftestDraft(SelftestRequest),
    /// Test the board by itself; it is disarmed then.
    Selftest,
    /// Cancel the measurement, the comparison or the self-test under way.
    Cancel,
}
