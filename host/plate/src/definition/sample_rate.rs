//! Sample rates that carry a plate's band. The drive table and the time-domain line use the same rule.

use crate::definition::plate::Plate;
use crate::quantity::{OutOfRange, Range};
use thiserror::Error;

/// Highest frequency of a table over the sample rate; the device refuses higher ones.
pub(crate) const FREQUENCY_TO_RATE_MAX: f64 = 0.45;
/// Highest sample rate of any computation, Hz.
pub(crate) const SAMPLE_RATE_MAX_HZ: f64 = 1e8;

/// A sample rate that cannot carry the plate's band.
#[derive(Debug, Clone, PartialEq, Error, serde::Serialize, serde::Deserialize)]
#[error("{refused}, the plate's band ends at {highest_hz:.1} Hz")]
pub struct SampleRateError {
    /// The rate that was given, and the rates that carry the band, Hz.
    pub refused: OutOfRange,
    /// Highest frequency of the plate's span, Hz.
    pub highest_hz: f64,
}

/// The sample rates that carry the band of this plate, Hz: from highest frequency/0.45 to 1e8.
pub fn sample_rates(plate: &Plate) -> Range {
    // The factor 1 + 1e-9 keeps the highest frequency below its limit in spite of rounding.
    Range::new(plate.band_hz().1 / FREQUENCY_TO_RATE_MAX * (1.0 + 1e-9), SAMPLE_RATE_MAX_HZ, "Hz")
}

/// Gain of the DAC's zero-order hold at a frequency above 0: sinc(f/fs).
pub(crate) fn hold_droop(frequency_hz: f64, sample_rate_hz: f64) -> f64 {
    let turn = std::f64::consts::PI * frequency_hz / sample_rate_hz;
    turn.sin() / turn
}

/// Refuses a sample rate that does not carry the plate's band.
pub(crate) fn check(plate: &Plate, sample_rate_hz: f64) -> Result<(), SampleRateError> {
    OutOfRange::check("sample rate", sample_rate_hz, sample_rates(plate))
        .map_err(|refused| SampleRateError { refused, highest_hz: plate.band_hz().1 })
}
