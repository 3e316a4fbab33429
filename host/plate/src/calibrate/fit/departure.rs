//! Boundary and level errors when one plate's table drives another plate: the error of a file before a calibration.

use crate::definition::Plate;
use crate::progress::Progress;
use crate::quantity::decibels;
use crate::special::ramp::ramp;
use crate::table::level::DriveToPeak;
use crate::table::{DriveTable, TableError};

/// Knots of the table; more would not change the result.
const KNOTS: usize = 129;
/// Boundaries judged over the span.
const BOUNDARIES: usize = 33;

/// The largest errors over the table's span when it drives another plate.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Departure {
    /// Distance of the commanded from the actual boundary, metres.
    pub boundary_m: f64,
    /// Half of the range of the peak level over the span, dB. A common factor does not count: an uncalibrated sensor
    /// does not measure it.
    pub level_db: f64,
}

/// Drives `actual` with the table made for `stated`, at a sample rate in hertz. A boundary whose wave does not enter
/// `actual` counts as lying at its driven end.
///
/// ```
/// use slipline_plate::{calibrate::departure, preset};
///
/// let plate = preset("membrane").unwrap();
/// let actual = plate.with_wave_speed(0.98).unwrap();
/// let off = departure(&plate, &actual, 400e3).unwrap();
/// // d ΔV/V is 4 mm on this taper of d = 0.2 m.
/// assert!((off.boundary_m - 4e-3).abs() < 0.6e-3);
/// ```
///
/// # Errors
/// [`TableError`]: the table of `stated`, or a frequency that does not move `actual`.
pub fn departure(stated: &Plate, actual: &Plate, sample_rate_hz: f64) -> Result<Departure, TableError> {
    let table = DriveTable::build(stated, sample_rate_hz, KNOTS)?;
    let places_m: Vec<f64> = ramp(table.span_m().0, table.span_m().1, BOUNDARIES).collect();
    let frequencies_hz: Vec<f64> = places_m.iter().map(|&place_m| table.frequency_hz(place_m)).collect();
    let levels =
        DriveToPeak::unchecked(actual, sample_rate_hz).levels(&frequencies_hz, &mut Progress::unwatched())?;
    let mut boundary_m: f64 = 0.0;
    let (mut lowest_db, mut highest_db) = (f64::INFINITY, f64::NEG_INFINITY);
    for ((&place_m, &frequency_hz), level) in places_m.iter().zip(&frequencies_hz).zip(&levels) {
        let turning_m = actual.turning_point_m(frequency_hz).unwrap_or(0.0);
        boundary_m = boundary_m.max((turning_m - place_m).abs());
        let level_db = decibels(level.amplitude * table.gain(place_m));
        (lowest_db, highest_db) = (lowest_db.min(level_db), highest_db.max(level_db));
    }
    Ok(Departure { boundary_m, level_db: 0.5 * (highest_db - lowest_db) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definition::{Calibration, PlateSpec, ResponseCurve, preset};

    #[test]
    fn a_table_on_its_own_plate_is_off_by_its_own_error_alone() {
        for name in ["membrane", "al-bending"] {
            let plate = preset(name).expect("a preset");
            let spec = PlateSpec { wave_speed_tolerance: 0.0, loss_tolerance: None, ..plate.spec().clone() };
            let exact = Plate::new(spec).expect("valid");
            let off = departure(&exact, &exact, 400e3).expect("a table");
            assert!(off.boundary_m < 2e-5 && off.level_db < 0.2, "{name}: {off:?}");
        }
    }

    #[test]
    fn a_measured_gain_that_swings_by_6_db_is_3_db_to_both_sides() {
        let plate = preset("membrane").expect("a preset");
        let spec = PlateSpec { wave_speed_tolerance: 0.0, loss_tolerance: None, ..plate.spec().clone() };
        let stated = Plate::new(spec.clone()).expect("valid");
        let (low, high) = plate.band_hz();
        let points = vec![[0.9 * low, 0.0, 0.0], [low, 0.0, 0.0], [high, 6.0, 0.0], [1.1 * high, 6.0, 0.0]];
        let calibration = Calibration {
            chi2_per_n: 1.0,
            half_width_tolerance: 0.0,
            taper_tolerance: 0.0,
            level_tolerance_db: None,
            source_tolerance: None,
            correction: Some(ResponseCurve { points }),
        };
        let actual = Plate::new(PlateSpec { calibration: Some(calibration), ..spec }).expect("valid");
        let off = departure(&stated, &actual, 400e3).expect("a table");
        assert!((off.level_db - 3.0).abs() < 0.2 && off.boundary_m < 2e-5, "{off:?}");
    }
}
