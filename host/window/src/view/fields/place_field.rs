//! The place of a line as it is typed: a place where the line can be, or a frequency of the plate.

use crate::scene::Scene;
use slipline_model::field::line::{limits_m, turning_point_m};
use slipline_model::setup::ToneSetup;
use slipline_plate::quantity::{self, PlaceOrFrequency, show_frequency};

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

/// The turning point of a tone whose line is to be at a typed place, or whose frequency is typed; or the problem, and what
/// is allowed.
pub(crate) fn typed_position(scene: &Scene<'_>, tone: &ToneSetup, text: &str) -> Result<f64, String> {
    let limits_m = limits_m(scene.setup, tone, scene.drive_table);
    let refused = |reason: &str| format!("{reason}. Type {}.", allowed(scene, limits_m));
    let plate = &scene.setup.plate;
    match quantity::place_or_frequency(text).map_err(|error| refused(&error.to_string()))? {
        PlaceOrFrequency::Place(place_m) => {
            if !(limits_m.0 - ROUNDING_M..=limits_m.1 + ROUNDING_M).contains(&place_m) {
                return Err(format!("outside {}", allowed(scene, limits_m)));
            }
            let place_m = place_m.clamp(limits_m.0, limits_m.1);
            Ok(turning_point_m(scene.setup, tone, scene.drive_table, place_m))
        }
        PlaceOrFrequency::Frequency(hertz) => {
            let position_m = plate.turning_point_m(hertz).ok_or_else(|| {
                let cut_off = show_frequency(plate.cut_off_hz());
                refused(&format!(
                    "{} cannot enter this plate: its cut-off is {cut_off}",
                    show_frequency(hertz)
                ))
            })?;
            let (start_m, end_m) = plate.span_m();
            if (start_m - ROUNDING_M..=end_m + ROUNDING_M).contains(&position_m) {
                Ok(position_m)
            } else {
                Err(format!("outside {}", allowed(scene, limits_m)))
            }
        }
    }
}
