//! The name of a calibrated plate.

use slipline_plate::Plate;

/// Appended to the name of a plate that was calibrated.
const CALIBRATED: &str = ", calibrated";

/// A calibrated plate under a name of its own: `al-bending, calibrated`. A name that says so already stays.
#[must_use]
pub fn named_calibrated(plate: &Plate) -> Plate {
    let mut spec = plate.spec().clone();
    spec.mark_name(CALIBRATED);
    Plate::new(spec).unwrap_or_else(|_| plate.clone())
}
