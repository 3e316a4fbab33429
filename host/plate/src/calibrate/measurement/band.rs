//! The frequencies that a calibration needs.

use crate::definition::Plate;
use crate::frequency::respond_range;
use crate::quantity::Range;

/// Relative error of the file's wave speed up to which the measured band still covers the span.
const SPEED: f64 = 0.06;
/// The frequencies to measure for a calibration of a plate, Hz: the band of its span, widened for an error of 6 % in
/// wave speed. Levels are measured at these frequencies only.
///
/// ```
/// use slipline_plate::{calibrate, preset};
///
/// let plate = preset("membrane").unwrap();
/// let (low_hz, high_hz) = calibrate::band_hz(&plate);
/// assert!(low_hz < 0.95 * plate.band_hz().0 && high_hz > 1.05 * plate.band_hz().1);
/// ```
#[must_use]
pub fn band_hz(plate: &Plate) -> (f64, f64) {
    let at =
        |speed: f64| plate.with_wave_speed(speed).map_or_else(|_| plate.band_hz(), |other| other.band_hz());
    let allowed: Range = respond_range(plate);
    // Close to the cut-off the driven end hardly moves the plate.
    let low = at(1.0 - SPEED).0.max(1.01 * allowed.low).min(plate.band_hz().0);
    (low, at(1.0 + SPEED).1.min(allowed.high))
}
