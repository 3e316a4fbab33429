//! What a model of the source must state for a fit of plate and source together.

use super::data::Datum;
use crate::calibrate::fit::response::plate_response::PlateResponse;
use num_complex::Complex64;

/// What lies between the code and the response beside the plate, with coordinates of its own; the first three are
/// resistance, mass and stiffness in units of the plate.
pub(crate) trait SourceModel {
    /// Whether every valley must be followed, because another plate may fit nearly as well; and then none may.
    const ALL: bool = false;
    /// What is known of the coordinates beforehand, about 0; infinite for nothing.
    fn deviations(&self) -> Vec<f64>;
    /// The response at a place (the index in [`PlateResponse::seen`]).
    fn response(&self, answer: &PlateResponse, place: usize, source: &[f64]) -> Complex64;
    /// The sum of the squares that the best source leaves on such a plate, each over the deviation with `model_error`.
    fn suited(&self, data: &[Datum], answers: &[PlateResponse], model_error: f64) -> Option<f64>;
    /// Coordinates of sources to begin with on such a plate, the most promising first.
    fn starts(&self, data: &[Datum], answers: &[PlateResponse]) -> Vec<Vec<f64>>;
}
