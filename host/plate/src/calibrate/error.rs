//! Why no calibration was made.

use crate::quantity::{OutOfRange, WrongCount};
use thiserror::Error;

/// Why no calibration was made.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CalibrateError {
    /// A number of a measurement is outside its range.
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
    /// A measurement has too few points or too many.
    #[error(transparent)]
    WrongCount(#[from] WrongCount),
}
