//! Why a table could not be made.

use crate::progress::Stopped;
use crate::quantity::OutOfRange;
use crate::spec::sample_rate::SampleRateError;
use thiserror::Error;

/// Most knots of a table.
pub const KNOTS_MAX: usize = 1025;

/// Why a table could not be made.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum TableError {
    /// The sample rate cannot carry the plate's band.
    #[error(transparent)]
    SampleRate(#[from] SampleRateError),
    /// The number of knots is out of range.
    #[error(transparent)]
    Knots(#[from] OutOfRange),
    /// The amplitude is zero or not finite at a position of the span.
    #[error("the plate does not answer at {position_m} m ({frequency_hz} Hz): nothing to level there")]
    Silent {
        /// Turning point, metres.
        position_m: f64,
        /// Frequency, Hz.
        frequency_hz: f64,
    },
    /// The caller stopped the computation.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}
