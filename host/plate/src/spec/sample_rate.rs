//! Which sample rates carry a plate's band: one rule for its table, its line and whoever asks for either.

use crate::quantity::Range;
use crate::quantity::number_format::typed;
use crate::spec::plate::Plate;
use thiserror::Error;

/// Largest frequency that is played, as a part of the sample rate; the device refuses higher ones in a table.
pub(crate) const FREQUENCY_TO_RATE_MAX: f64 = 0.45;
/// Highest sample rate of anything that is computed, Hz.
pub(crate) const SAMPLE_RATE_MAX_HZ: f64 = 1e8;

/// A sample rate that cannot carry the plate's band.
#[derive(Debug, Clone, PartialEq, Error)]
#[error(
    "sample rate = {} Hz: must be {allowed}, the plate's band ends at {highest_hz:.1} Hz",
    typed(*.sample_rate_hz)
)]
pub struct SampleRateError {
    /// The rate that was given, Hz.
    pub sample_rate_hz: f64,
    /// The rates that carry the band.
    pub allowed: Range,
    /// Highest frequency of the plate's span, Hz.
    pub highest_hz: f64,
}

/// The sample rates that carry the band of this plate.
pub fn sample_rates(plate: &Plate) -> Range {
    // A little more than it takes: no rounding may lift the highest frequency over its part of the rate.
    Range::new(plate.band_hz().1 / FREQUENCY_TO_RATE_MAX * (1.0 + 1e-9), SAMPLE_RATE_MAX_HZ, "Hz")
}

/// Refuses a sample rate that does not carry the plate's band.
pub(crate) fn check(plate: &Plate, sample_rate_hz: f64) -> Result<(), SampleRateError> {
    let allowed = sample_rates(plate);
    if allowed.contains(sample_rate_hz) {
        return Ok(());
    }
    Err(SampleRateError { sample_rate_hz, allowed, highest_hz: plate.band_hz().1 })
}
