//! Why a rig cannot be put together.

use slipline_plate::quantity::OutOfRange;
use slipline_plate::{LineError, SenseError};

/// Why a rig cannot be put together, or its sensor cannot be moved.
#[derive(Debug, Clone, PartialEq, thiserror::Error, serde::Serialize, serde::Deserialize)]
pub enum RigError {
    /// An option is out of range.
    #[error("{0}")]
    OutOfRange(#[from] OutOfRange),
    /// A finger and a sensor that weighs.
    #[error("the sensor of a simulated plate on which a finger rests cannot weigh: leave out one of them")]
    FingerAndBody,
    /// The plate cannot be simulated in time.
    #[error(transparent)]
    Line(#[from] LineError),
    /// The sensor cannot stand at this place.
    #[error(transparent)]
    Sense(#[from] SenseError),
}
