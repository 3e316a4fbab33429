//! Why the plate has no amplitude at a frequency.

use crate::quantity::number_format::{at_least, at_most, typed};
use crate::quantity::{OutOfRange, Range};
use crate::spec::plate::Plate;
use thiserror::Error;

/// Why a plate did not answer.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum RespondError {
    /// The frequency is below the cut-off at the driven end: nothing runs.
    #[error(
        "frequency = {} Hz cannot enter the plate {plate:?}: must be above {} Hz, the cut-off at its wide end",
        typed(at_most(*.frequency_hz, 6)), typed(at_least(*.cut_off_hz, 5))
    )]
    CannotEnter {
        /// Name of the plate: a table made for one may be played on another.
        plate: String,
        /// The frequency that was asked for, Hz.
        frequency_hz: f64,
        /// Lowest frequency that enters, Hz.
        cut_off_hz: f64,
    },
    /// The frequency is too low, too high or not a number.
    #[error("{0} for this plate")]
    Frequency(OutOfRange),
    /// The number of points or of width modes is out of range.
    #[error(transparent)]
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
