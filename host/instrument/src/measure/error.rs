//! Why a plate was not measured.

use slipline_link::{DeviceTableError, Refusal};
use slipline_plate::calibrate::{CalibrateError, DriveCheck};
use slipline_plate::quantity::number_format::with_decimals;
use slipline_plate::quantity::{OutOfRange, show_frequency};

/// Why a plate was not measured.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MeasureError {
    /// A number is out of its range.
    #[error("{}", .0.in_suitable_units())]
    OutOfRange(#[from] OutOfRange),
    /// The device cannot measure.
    #[error("this device has no input for measurements: its firmware or its board has none")]
    NoInputs,
    /// The band has no room for this number of points.
    #[error("{points} frequencies from {} to {} are too close to be separated: ask for fewer, or for a wider band", show_frequency(*.low_hz), show_frequency(*.high_hz))]
    Crowded {
        /// Number of points.
        points: usize,
        /// Lowest, Hz.
        low_hz: f64,
        /// Highest, Hz.
        high_hz: f64,
    },
    /// The plate rings too long for a sweep.
    #[error("the plate rings for {} s, too long for a sweep over this band: measure it by steps, or over a narrower band", with_decimals(*.seconds, 2))]
    Rings {
        /// Its ringing time.
        seconds: f64,
    },
    /// The codes that the device has played are not completely known.
    #[error("it is not known which codes the device has played: the link lost some of its reports")]
    Unknown,
    /// The digest of a window of codes was not received.
    #[error("the device gave no digest")]
    NoDigest,
    /// The two sweeps were not played alike.
    #[error("the device turned its tones down between two sweeps: let it cool, or lower the level")]
    TurnedDown,
    /// The table of the sweep is not valid for a device.
    #[error(transparent)]
    Table(#[from] DeviceTableError),
    /// The device or the link refused a step.
    #[error(transparent)]
    Refused(#[from] Refusal),
    /// The link returned another outcome.
    #[error("the device does not measure: its firmware is too old")]
    TooOld,
    /// The link was lost.
    #[error("the device disconnected")]
    Lost,
    /// The device stopped the tones; the text names its faults.
    #[error("the device stopped: {0}")]
    Fault(String),
    /// The device had stopped before the procedure began; the text names its faults.
    #[error(
        "the device has stopped: {0}; clear that fault first: *Clear fault* in the window, `slipline board clear-faults`, or `device.clear_faults()` in Python"
    )]
    StandingFault(String),
    /// Another drive was played meanwhile.
    #[error("the tones were stopped before they were measured")]
    Stopped,
    /// Blocks of the inputs were lost repeatedly.
    #[error("the inputs lost samples in {tries} windows one after the other: is the processor overloaded?")]
    Overrun {
        /// Number of attempts with the same comb.
        tries: u32,
    },
    /// The drive is not on, or is not the stated one.
    #[error("{0}")]
    NotOn(DriveCheck),
    /// The input was at an end of its range while harmonics were measured, which adds harmonics of its own.
    #[error("the input is clipped, which adds harmonics of its own: lower the level or the input's gain")]
    Clipped,
    /// The sensor receives the plate at no two of the frequencies at twice and three times the frequency.
    #[error(
        "at less than two frequencies the sensor receives twice or three times the frequency clearly: put it nearer to the driven end, or raise the level"
    )]
    NoHarmonics,
    /// The user cancelled it.
    #[error("cancelled")]
    Cancelled,
    /// The measured data are not a valid measurement.
    #[error(transparent)]
    Measurement(#[from] CalibrateError),
}
