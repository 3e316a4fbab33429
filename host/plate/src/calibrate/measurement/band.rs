//! The frequencies that a calibration needs.

use crate::definition::Plate;
use crate::frequency::respond_range;
use crate::quantity::Range;

/// How far the wave speed may be from the file's for the measured band to cover the span still.
const SPEED: f64 = 0.06;
/// The frequencies to measure on a plate that is calibrated, Hz: the band of its span, wider by what 6 % of wave speed
/// would move it. Levels are measured for these frequencies only.
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
