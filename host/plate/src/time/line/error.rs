//! Reasons why a line could not be made.

use crate::definition::sample_rate::SampleRateError;
use crate::frequency::error::RespondError;
use crate::quantity::OutOfRange;
use crate::time::drive_filter::DriveCurveError;
use thiserror::Error;

/// Reason why a line could not be made.
#[derive(Debug, Clone, PartialEq, Error, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum LineError {
    /// The sample rate cannot carry the plate's band.
    #[error(transparent)]
    SampleRate(#[from] SampleRateError),
    /// No filter follows the measured curve of the plate's drive, that of its actuator or of its calibration.
    #[error(transparent)]
    Drive(#[from] DriveCurveError),
    /// The number of positions is out of range.
    #[error("{0}")]
    OutOfRange(#[from] OutOfRange),
    /// The finger is not possible on this plate.
    #[error(transparent)]
    Finger(RespondError),
    /// The field over the band is not a sum of decaying resonances.
    #[error("the plate cannot be simulated in time: the best sum of decaying resonances is off by {:.1} % of its amplitude, at most {:.1} % is allowed", .error * 100.0, .most * 100.0)]
    Unfit {
        /// Largest error, relative to the largest amplitude at the same frequency.
        error: f64,
        /// Largest allowed error.
        most: f64,
    },
}
