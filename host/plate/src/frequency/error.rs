//! Reasons why no amplitude was computed at a frequency.

use crate::definition::error::PlateError;
use crate::definition::plate::Plate;
use crate::quantity::number_format::{at_least, at_most, typed};
use crate::quantity::{OutOfRange, Range, must_be};
use thiserror::Error;

/// Reason why the amplitude was not computed.
#[derive(Debug, Clone, PartialEq, Error, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum RespondError {
    /// The frequency is below the cut-off at the driven end: no wave propagates.
    #[error("{}", must_be(
        format_args!("frequency = {} Hz cannot enter the plate {:?}", typed(at_most(*.frequency_hz, 6)), .plate),
        format_args!("above {} Hz, the cut-off at its wide end", typed(at_least(*.cut_off_hz, 5))),
    ))]
    CannotEnter {
        /// Name of the plate, because a table made for one plate can be used on another.
        plate: String,
        /// The requested frequency, Hz.
        frequency_hz: f64,
        /// Lowest frequency that enters, Hz.
        cut_off_hz: f64,
    },
    /// The frequency is too low, too high or not a number.
    #[error("{0} for this plate")]
    Frequency(OutOfRange),
    /// The plate file does not state the surface density, which a finger needs.
    #[error("{0}")]
    Unstated(PlateError),
    /// The number of points or of width modes, the sample rate, or a field of the finger, is out of range.
    #[error("{0}")]
    OutOfRange(#[from] OutOfRange),
}

impl RespondError {
    pub(crate) fn frequency(frequency_hz: f64, low_hz: f64, high_hz: f64) -> Self {
        let range = Range::new(low_hz, high_hz, "Hz");
        Self::Frequency(OutOfRange { field: "frequency", value: frequency_hz, range })
    }

    pub(crate) fn cannot_enter(plate: &Plate, frequency_hz: f64) -> Self {
        Self::CannotEnter { plate: plate.name().to_owned(), frequency_hz, cut_off_hz: plate.cut_off_hz() }
    }
}
