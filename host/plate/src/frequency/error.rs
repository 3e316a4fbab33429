//! Why the plate has no amplitude at a frequency.

use crate::quantity::number_format::{at_least, at_most, typed};
use crate::quantity::range::Range;
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
    /// The frequency is absurd.
    #[error("frequency = {} Hz: must be {} for this plate", typed(*.frequency_hz), Range::new(*.low, *.high, "Hz"))]
    Frequency {
        /// The frequency that was asked for, Hz.
        frequency_hz: f64,
        /// Lowest allowed, Hz.
        low: f64,
        /// Highest allowed, Hz.
        high: f64,
    },
    /// The number of points is not usable.
    #[error("points = {points}: must be {low} to {high}")]
    Points {
        /// The number that was asked for.
        points: usize,
        /// Fewest.
        low: usize,
        /// Most.
        high: usize,
    },
    /// The number of width modes is not usable.
    #[error("modes = {modes}: must be {low} to {high}")]
    Modes {
        /// The number that was asked for.
        modes: usize,
        /// Fewest.
        low: usize,
        /// Most.
        high: usize,
    },
}

impl RespondError {
    pub(crate) fn cannot_enter(plate: &Plate, frequency_hz: f64) -> Self {
        Self::CannotEnter { plate: plate.name().to_owned(), frequency_hz, cut_off_hz: plate.cut_off_hz() }
    }
}
