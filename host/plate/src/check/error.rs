//! Why a plate could not be checked.

use crate::progress::Stopped;
use crate::spec::limits;
use crate::spec::plate::Plate;
use crate::table::error::TableError;
use thiserror::Error;

/// Why a plate could not be checked.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CheckError {
    /// A boundary is not on the plate.
    #[error("{field} = {boundary_m} m: must be {low} to {high} m, on the plate")]
    Boundary {
        /// Which one: `boundary` or `other boundary`.
        field: &'static str,
        /// The boundary that was asked for, metres.
        boundary_m: f64,
        /// Nearest allowed, metres.
        low: f64,
        /// Farthest allowed, metres.
        high: f64,
    },
    /// The level is no level.
    #[error("level = {level}: must be 0 to 1")]
    Level {
        /// The level that was given.
        level: f64,
    },
    /// The plate cannot be driven at this sample rate.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The check was given up.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// Refuses a boundary that is not on the plate.
pub(super) fn on_plate(plate: &Plate, field: &'static str, boundary_m: f64) -> Result<(), CheckError> {
    let (low, high) = (limits::span_start(plate.length_m()).low, plate.length_m());
    if (low..=high).contains(&boundary_m) {
        return Ok(());
    }
    Err(CheckError::Boundary { field, boundary_m, low, high })
}
