//! Why a study cannot begin.

use slipline_plate::plane::PlaneError;
use slipline_plate::texture::TextureError;
use slipline_plate::{NoBoundary, PlateFileError, TableError};

/// Why a study cannot begin.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The nominal plate has no table.
    #[error("{0}")]
    Table(#[from] TableError),
    /// The nominal plate has no boundary at a place.
    #[error("turning_point_m = {place_m}: {why}")]
    Place {
        /// The place, metres.
        place_m: f64,
        /// Why.
        why: NoBoundary,
    },
    /// The nominal plate is not solved in two dimensions at a place.
    #[error("turning_point_m = {place_m}: {why}")]
    Plane {
        /// The place, metres.
        place_m: f64,
        /// Why.
        why: PlaneError,
    },
    /// The nominal plate has no solid area up to a place.
    #[error("turning_point_m = {place_m}: {why}")]
    Area {
        /// The place, metres.
        place_m: f64,
        /// Why.
        why: TextureError,
    },
    /// The specification's plate is refused.
    #[error("plate: {0}")]
    Plate(#[from] PlateFileError),
}
