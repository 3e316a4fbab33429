//! Reasons why no two-dimensional field was computed.

use crate::definition::error::PlateError;
use crate::frequency::RespondError;
use crate::quantity::{OutOfRange, must_be, number_format::typed};
use thiserror::Error;

/// Reason why the two-dimensional field was not computed.
#[derive(Debug, Clone, PartialEq, Error, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum PlaneError {
    /// The frequency does not enter the plate, or the frequency or the number of points is out of range.
    #[error("{0}")]
    Respond(#[from] RespondError),
    /// A number of the setup is out of range.
    #[error("{0}")]
    OutOfRange(#[from] OutOfRange),
    /// A number of the lead-in is out of range, or a force in newtons acts on a membrane or SH plate whose tension or
    /// thickness is not stated.
    #[error("{0}")]
    Plate(#[from] PlateError),
    /// A lead-in on a membrane or SH plate.
    #[error("{}", must_be("drive.lead_in on a plate that is not in bending", "absent"))]
    LeadInWithoutBending,
    /// The equations of the sheet with its air did not converge.
    #[error("{}", must_be(
        format_args!("the air around the sheet at {} Hz", typed(*.frequency_hz)),
        "lighter against the sheet: its equations were not solved in 200 steps",
    ))]
    AirNotSolved {
        /// The frequency, Hz.
        frequency_hz: f64,
    },
    /// The air on the sheet has too many panels.
    #[error("{}", must_be(
        format_args!("panels of the air at {} Hz = {panels}", typed(*.frequency_hz)),
        format_args!("at most {most}"),
    ))]
    TooManyPanels {
        /// The frequency, Hz.
        frequency_hz: f64,
        /// Number of panels.
        panels: usize,
        /// Largest allowed number.
        most: usize,
    },
    /// The field has too many waves along and across the plate.
    #[error("{}", must_be(
        format_args!("unknowns of the two-dimensional field at {} Hz = {unknowns}", typed(*.frequency_hz)),
        format_args!("at most {most}"),
    ))]
    TooFine {
        /// The frequency, Hz.
        frequency_hz: f64,
        /// Number of unknowns of the field.
        unknowns: usize,
        /// Largest allowed number for a band of this width.
        most: usize,
    },
}
