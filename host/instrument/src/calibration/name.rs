//! The name of a calibrated plate.

use slipline_plate::{Plate, PlateSpec};

/// Appended to the name of a plate that was calibrated.
const CALIBRATED: &str = ", calibrated";
/// Most characters of a plate's name.
const LONGEST_NAME: usize = 80;

/// A calibrated plate under a name of its own: `al-bending, calibrated`. A name that says so already stays.
#[must_use]
pub fn named_calibrated(plate: &Plate) -> Plate {
    if plate.name().ends_with(CALIBRATED) {
        return plate.clone();
    }
    let room = LONGEST_NAME - CALIBRATED.chars().count();
    let name: String = plate.name().chars().take(room).chain(CALIBRATED.chars()).collect();
    Plate::new(PlateSpec { name, ..plate.spec().clone() }).unwrap_or_else(|_| plate.clone())
}
