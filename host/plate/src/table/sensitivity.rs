//! Change of the peak's height where the real plate differs from the plate of the table.

use super::drive_table::DriveTable;
use super::error::{KNOTS_MAX, TableError};
use super::level::DriveToPeak;
use crate::definition::plate::Plate;
use crate::progress::Progress;
use crate::quantity::decibels;
use crate::special::ramp::ramp;

/// Error of the peak when a table made for one plate drives another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensitivity {
    /// Largest rise of the peak above its level, dB (0 or more).
    pub highest_db: f64,
    /// Largest fall of the peak below its level, dB (0 or less).
    pub lowest_db: f64,
    /// The larger of the two magnitudes, dB.
    pub worst_db: f64,
    /// Boundary with the largest magnitude, metres.
    pub worst_at_m: f64,
}

/// Number of boundaries over the span at which a sensitivity is evaluated.
const PLACES: usize = 801;

/// Applies a table of `table_plate` to `actual_plate` and compares the peaks over the span with the table's level.
///
/// # Errors
/// [`TableError::Silent`] if the actual plate has no amplitude at one of the table's frequencies.
pub fn table_sensitivity(
    table: &DriveTable,
    table_plate: &Plate,
    actual_plate: &Plate,
) -> Result<Sensitivity, TableError> {
    watched(table, table_plate, actual_plate, &mut Progress::unwatched())
}

fn watched(
    table: &DriveTable,
    table_plate: &Plate,
    actual_plate: &Plate,
    progress: &mut Progress<'_>,
) -> Result<Sensitivity, TableError> {
    let intended = table.peak_at_full_scale_m() / table_plate.spec().full_scale_m;
    // The sample rate must carry the table's frequencies; the band of the actual plate may end higher.
    let drive_to_peak = DriveToPeak::unchecked(actual_plate, table.sample_rate_hz());
    let mut result =
        Sensitivity { highest_db: 0.0, lowest_db: 0.0, worst_db: 0.0, worst_at_m: table.span_m().0 };
    let places = ramp(table.span_m().0, table.span_m().1, PLACES);
    let frequencies: Vec<f64> = places.clone().map(|x| table.frequency_hz(x)).collect();
    for (x, level) in places.zip(drive_to_peak.levels(&frequencies, progress)?) {
        let error_db = decibels(level.amplitude * table.gain(x) / intended);
        result.highest_db = result.highest_db.max(error_db);
        result.lowest_db = result.lowest_db.min(error_db);
        if error_db.abs() > result.worst_db {
            (result.worst_db, result.worst_at_m) = (error_db.abs(), x);
        }
    }
    Ok(result)
}

/// The largest change of the peak when the wave speed is 1 % higher or 1 % lower than a table made for `plate` assumes, at
/// the sample rate of `table`. The table itself is used if it has 1025 knots, the largest number; otherwise one with 1025
/// knots is built.
///
/// # Errors
/// As [`DriveTable::build_watched`].
pub fn sensitivity_per_percent(
    table: &DriveTable,
    plate: &Plate,
    progress: &mut Progress<'_>,
) -> Result<Sensitivity, TableError> {
    if table.knots().len() == KNOTS_MAX {
        return per_percent(table, plate, progress);
    }
    let rate_hz = table.sample_rate_hz();
    let finest = DriveTable::build_watched(plate, rate_hz, KNOTS_MAX, &mut progress.part(0.0, 0.8))?;
    per_percent(&finest, plate, &mut progress.part(0.8, 1.0))
}

fn per_percent(
    table: &DriveTable,
    plate: &Plate,
    progress: &mut Progress<'_>,
) -> Result<Sensitivity, TableError> {
    let mut result: Option<Sensitivity> = None;
    for (factor, from) in [(1.01, 0.0), (0.99, 0.5)] {
        // At the limits of a model's fields one of the two speeds is out of range.
        let Ok(actual) = plate.with_wave_speed(factor) else { continue };
        let found = watched(table, plate, &actual, &mut progress.part(from, from + 0.5))?;
        if result.is_none_or(|best| found.worst_db > best.worst_db) {
            result = Some(found);
        }
    }
    result.ok_or(TableError::Silent { position_m: plate.span_m().0, frequency_hz: plate.band_hz().0 })
}
