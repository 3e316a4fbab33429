//! Reasons why a table could not be made.

use crate::definition::sample_rate::SampleRateError;
use crate::progress::Stopped;
use crate::quantity::OutOfRange;
use crate::quantity::number_format::{at_least, at_most, typed};
use thiserror::Error;

/// Largest number of knots of a table.
pub const KNOTS_MAX: usize = 1025;

/// Reason why a table could not be made.
#[derive(Debug, Clone, PartialEq, Error, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum TableError {
    /// The sample rate cannot carry the plate's band.
    #[error("{0}")]
    SampleRate(#[from] SampleRateError),
    /// The number of knots is out of range.
    #[error("{0}")]
    Knots(#[from] OutOfRange),
    /// The amplitude is zero or not finite at a position of the span.
    #[error(
        "the amplitude of the plate at {position_m} m ({frequency_hz} Hz) is zero or not finite: no gain can level it"
    )]
    Silent {
        /// Turning point, metres.
        position_m: f64,
        /// Frequency, Hz.
        frequency_hz: f64,
    },
    /// The frequencies of two knots are the same for a device with a 32-bit phase step.
    #[error(
        "the plate is nearly flat: from {} to {} m its boundary needs {} to {} Hz, which is too close together for {knots} knots; let the half-width fall more over the span, or the span be longer",
        typed(span_m.0), typed(span_m.1), typed(at_most(band_hz.0, 7)), typed(at_least(band_hz.1, 7))
    )]
    Flat {
        /// The span, metres.
        span_m: (f64, f64),
        /// The frequencies of its ends, Hz.
        band_hz: (f64, f64),
        /// Knots of the table.
        knots: usize,
    },
    /// The caller stopped the computation.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}
