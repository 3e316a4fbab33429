//! Reasons why a texture could not be made.

use crate::feeling::FeltEdge;
use crate::progress::Stopped;
use crate::quantity::OutOfRange;
use crate::table::TableError;
use thiserror::Error;

/// Reason why a texture could not be made.
#[derive(Debug, Clone, PartialEq, Error, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum TextureError {
    /// A value is outside its range.
    #[error("{0}")]
    OutOfRange(#[from] OutOfRange),
    /// The plate has no table.
    #[error("{0}")]
    Table(#[from] TableError),
    /// A field is not finite or the wave does not enter.
    #[error("the amplitude of the plate is not finite or no wave enters: no texture can be made")]
    Silent,
    /// There is no room for an even area.
    #[error(
        "turning point = {turning_point_m} m: the edge there is {edge_width_m} m wide, which leaves no even area before it"
    )]
    TooShort {
        /// Turning point, metres.
        turning_point_m: f64,
        /// Edge width, metres.
        edge_width_m: f64,
    },
    /// A profile's breakpoint is not usable.
    #[error("breakpoint {number} of the profile: {reason}")]
    Profile {
        /// Number of the breakpoint, from 1.
        number: usize,
        /// The mistake.
        #[serde(with = "crate::static_text")]
        reason: crate::StaticText,
    },
    /// No turning point of the span has a felt edge on the plate.
    #[error("{}", match .edge {
        FeltEdge::PlateEnd => "even the shortest area is felt to the plate's end: lower the level, or give its turning point",
        FeltEdge::At(_) | FeltEdge::Nowhere => "nothing is felt: raise the plate's full scale, or give the turning point",
    })]
    NotFelt {
        /// The felt edge of the shortest area.
        edge: FeltEdge,
    },
    /// The caller stopped the computation.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}
