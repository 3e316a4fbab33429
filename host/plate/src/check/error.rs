//! Why a plate could not be checked.

use crate::definition::limits;
use crate::definition::plate::Plate;
use crate::progress::Stopped;
use crate::quantity::{OutOfRange, Range};
use crate::table::error::TableError;
use thiserror::Error;

/// Why a plate could not be checked.
#[derive(Debug, Clone, PartialEq, Error, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum CheckError {
    /// A boundary is not on the plate.
    #[error("{0}, on the plate")]
    Boundary(OutOfRange),
    /// The level or the linear share is out of its range.
    #[error(transparent)]
    Level(OutOfRange),
    /// The sample rate cannot carry the plate's band, or the plate has no amplitude at a boundary.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The caller stopped the check.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// Refuses a boundary that is not on the plate: 0.001 to 1 of its length.
pub(super) fn on_plate(plate: &Plate, field: &'static str, boundary_m: f64) -> Result<(), CheckError> {
    let range = Range { high: plate.length_m(), ..limits::span_start(plate.length_m()) };
    OutOfRange::check(field, boundary_m, range).map_err(CheckError::Boundary)
}
