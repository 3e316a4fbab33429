//! Reasons why a place cannot be sensed.

use crate::quantity::OutOfRange;

/// Largest error of an output over the exact band, relative to the response at the same frequency.
pub(super) const ERROR_MAX: f64 = 5e-3;
/// Largest error where the drive is a measured curve, whose points have noise, and in a baffle, where the pressure at a distance
/// is known to a fifth.
pub(super) const CURVE_ERROR_MAX: f64 = 3e-2;
/// Largest error between clamped edges. No sum of decaying resonances follows the strip's law in the tail, and where
/// the second even width mode begins to propagate at the driven end, the response near it has a jump.
pub(super) const CLAMPED_ERROR_MAX: f64 = 0.1;

/// Reason why a place cannot be sensed.
#[derive(Debug, Clone, PartialEq, thiserror::Error, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum SenseError {
    /// The place or the delay is out of range.
    #[error("{0}")]
    OutOfRange(#[from] OutOfRange),
    /// A strain sensor on a membrane or a shear wave.
    #[error(
        "a membrane or a shear wave strains its surface only with the square of its slope: sense displacement, velocity or acceleration"
    )]
    NoStrain,
    /// The response at this place is not a sum of decaying resonances.
    #[error("the response at this place cannot be simulated in time: it is off by {:.2} % of itself, at most {:.2} % is allowed", .error * 100.0, .most * 100.0)]
    Unfit {
        /// Largest error over the exact band, relative to the response.
        error: f64,
        /// Largest allowed error.
        most: f64,
    },
}
