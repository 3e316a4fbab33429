//! The place of a line as it is typed: a place where the line can be, or a frequency of the plate.

use crate::scene::Scene;
use slipline_model::field::line::{limits_m, turning_point_m};
use slipline_model::setup::ToneSetup;
use slipline_plate::quantity::{self, PlaceOrFrequency, QuantityError, show_frequency};
use thiserror::Error;

/// A place at a limit must not be refused because of rounding in the text, which shows tenths of a millimetre.
const ROUNDING_M: f64 = 6e-5;

/// The places and the frequencies that a line can have, as text.
pub(crate) fn allowed(scene: &Scene<'_>, (low_m, high_m): (f64, f64)) -> String {
    let (low_hz, high_hz) = scene.setup.plate.band_hz();
    format!(
        "{:.0} to {:.0} mm, or {} to {}",
        low_m * 1e3,
        high_m * 1e3,
        show_frequency(low_hz),
        show_frequency(high_hz)
    )
}

/// Why a typed place is not taken; each with what is allowed.
#[derive(Debug, Error)]
pub(crate) enum PlaceRefusal {
    #[error("{0}. Type {1}.")]
    Unreadable(QuantityError, String),
    #[error("{} cannot enter this plate: its cut-off is {}. Type {allowed}.", show_frequency(*.hz), show_frequency(*.cut_off_hz))]
    CutOff { hz: f64, cut_off_hz: f64, allowed: String },
    #[error("outside {0}")]
    Outside(String),
}

/// The turning point of a tone whose line is to be at a typed place, or whose frequency is typed.
pub(crate) fn typed_position(scene: &Scene<'_>, tone: &ToneSetup, text: &str) -> Result<f64, PlaceRefusal> {
    let limits_m = limits_m(scene.setup, tone, scene.drive_table);
    let allowed = || allowed(scene, limits_m);
    let plate = &scene.setup.plate;
    match quantity::place_or_frequency(text).map_err(|error| PlaceRefusal::Unreadable(error, allowed()))? {
        PlaceOrFrequency::Place(place_m) => {
            if !(limits_m.0 - ROUNDING_M..=limits_m.1 + ROUNDING_M).contains(&place_m) {
                return Err(PlaceRefusal::Outside(allowed()));
            }
            let place_m = place_m.clamp(limits_m.0, limits_m.1);
            Ok(turning_point_m(scene.setup, tone, scene.drive_table, place_m))
        }
        PlaceOrFrequency::Frequency(hertz) => {
            let position_m = plate.turning_point_m(hertz).ok_or_else(|| PlaceRefusal::CutOff {
                hz: hertz,
                cut_off_hz: plate.cut_off_hz(),
                allowed: allowed(),
            })?;
            let (start_m, end_m) = plate.span_m();
            if (start_m - ROUNDING_M..=end_m + ROUNDING_M).contains(&position_m) {
                Ok(position_m)
            } else {
                Err(PlaceRefusal::Outside(allowed()))
            }
        }
    }
}
