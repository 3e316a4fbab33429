//! The interface of a source model for a joint fit of plate and source.

use super::data::Datum;
use crate::calibrate::fit::response::plate_response::PlateResponse;
use num_complex::Complex64;

/// The chain between code and response except for the plate, with its own coordinates; the first three are
/// resistance, mass and stiffness in units of the plate.
pub(crate) trait SourceModel {
    /// Whether every valley of the scan must be followed, because another plate may fit nearly as well; a second such
    /// fit is then refused.
    const ALL: bool = false;
    /// Prior standard deviations of the coordinates, about 0; infinite for no prior.
    fn deviations(&self) -> Vec<f64>;
    /// Whether the responses are to show the third width mode at the sensor.
    fn counts_third_mode(&self) -> bool {
        false
    }
    /// The response at a place (the index in [`PlateResponse::seen`]).
    fn response(&self, answer: &PlateResponse, place: usize, source: &[f64]) -> Complex64;
    /// Chi-squared of the best-fitting source for this plate; residuals weighted by noise and `model_error`.
    fn suited(&self, data: &[Datum], answers: &[PlateResponse], model_error: f64) -> Option<f64>;
    /// Starting points for the source on such a plate, the most promising first.
    fn starts(&self, data: &[Datum], answers: &[PlateResponse]) -> Vec<Vec<f64>>;
}
