//! How much the peak moves when the real plate is not the one the table was made for.

use super::drive_table::DriveTable;
use super::error::{KNOTS_MAX, TableError};
use super::level::DriveToPeak;
use crate::progress::Progress;
use crate::spec::plate::Plate;

/// What a table made for one plate does on another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensitivity {
    /// Largest rise of the peak above its level, dB.
    pub highest_db: f64,
    /// Largest fall of the peak below its level, dB (negative).
    pub lowest_db: f64,
    /// The larger of the two magnitudes, dB.
    pub worst_db: f64,
    /// Boundary at which the worst occurs, metres.
    pub worst_at_m: f64,
}

/// Places over the span at which a sensitivity is evaluated.
const PLACES: usize = 801;

/// Plays the table of `table_plate` on `actual_plate` over the span and compares the peaks with their level.
///
/// # Errors
/// [`TableError`] as [`DriveTable::build`].
pub fn sensitivity(
    table_plate: &Plate,
    actual_plate: &Plate,
    sample_rate_hz: f64,
) -> Result<Sensitivity, TableError> {
    let table = DriveTable::build(table_plate, sample_rate_hz, KNOTS_MAX)?;
    table_sensitivity(&table, table_plate, actual_plate)
}

/// [`sensitivity`] for a table that was built already.
///
/// # Errors
/// [`TableError`] when the actual plate is silent at one of the table's frequencies.
pub fn table_sensitivity(
    table: &DriveTable,
    table_plate: &Plate,
    actual_plate: &Plate,
) -> Result<Sensitivity, TableError> {
    watched(table, table_plate, actual_plate, &mut Progress::new(&mut |_| true))
}

fn watched(
    table: &DriveTable,
    table_plate: &Plate,
    actual_plate: &Plate,
    progress: &mut Progress<'_>,
) -> Result<Sensitivity, TableError> {
    let intended = table.peak_at_full_scale_m / table_plate.spec().full_scale_m;
    // The actual plate's own band may end elsewhere: only the table's frequencies have to be carried.
    let drive_to_peak = DriveToPeak::unchecked(actual_plate, table.sample_rate_hz);
    let mut result =
        Sensitivity { highest_db: 0.0, lowest_db: 0.0, worst_db: 0.0, worst_at_m: table.span_start_m };
    let place = |i: usize| {
        table.span_start_m + (table.span_end_m - table.span_start_m) * i as f64 / (PLACES - 1) as f64
    };
    let frequencies: Vec<f64> = (0..PLACES).map(|i| table.frequency_hz(place(i))).collect();
    for (i, level) in drive_to_peak.levels(&frequencies, progress)?.into_iter().enumerate() {
        let x = place(i);
        let error_db = 20.0 * (level.amplitude * table.gain(x) / intended).log10();
        result.highest_db = result.highest_db.max(error_db);
        result.lowest_db = result.lowest_db.min(error_db);
        if error_db.abs() > result.worst_db {
            (result.worst_db, result.worst_at_m) = (error_db.abs(), x);
        }
    }
    Ok(result)
}

/// The worst change of the peak, in dB, when every wave is 1 % faster or 1 % slower than the table supposes.
///
/// # Errors
/// [`TableError`] as [`DriveTable::build`].
pub fn sensitivity_per_percent(plate: &Plate, sample_rate_hz: f64) -> Result<Sensitivity, TableError> {
    sensitivity_per_percent_watched(plate, sample_rate_hz, &mut Progress::new(&mut |_| true))
}

/// [`sensitivity_per_percent`] that tells how far it is and can be stopped.
///
/// # Errors
/// As [`DriveTable::build_watched`].
pub fn sensitivity_per_percent_watched(
    plate: &Plate,
    sample_rate_hz: f64,
    progress: &mut Progress<'_>,
) -> Result<Sensitivity, TableError> {
    let table = DriveTable::build_watched(plate, sample_rate_hz, KNOTS_MAX, &mut progress.part(0.0, 0.8))?;
    per_percent(&table, plate, &mut progress.part(0.8, 1.0))
}

/// [`sensitivity_per_percent_watched`] at the rate of a `table` that was made for the plate: it is not made again if it
/// has all the knots a table can have.
///
/// # Errors
/// As [`DriveTable::build_watched`].
pub fn sensitivity_per_percent_of(
    table: &DriveTable,
    plate: &Plate,
    progress: &mut Progress<'_>,
) -> Result<Sensitivity, TableError> {
    if table.knots.len() == KNOTS_MAX {
        per_percent(table, plate, progress)
    } else {
        sensitivity_per_percent_watched(plate, table.sample_rate_hz, progress)
    }
}

fn per_percent(
    table: &DriveTable,
    plate: &Plate,
    progress: &mut Progress<'_>,
) -> Result<Sensitivity, TableError> {
    let mut result: Option<Sensitivity> = None;
    for (factor, from) in [(1.01, 0.0), (0.99, 0.5)] {
        // A material at the very end of its allowed range has only one neighbour.
        let Ok(actual) = plate.with_wave_speed(factor) else { continue };
        let found = watched(table, plate, &actual, &mut progress.part(from, from + 0.5))?;
        if result.is_none_or(|best| found.worst_db > best.worst_db) {
            result = Some(found);
        }
    }
    result.ok_or(TableError::Silent { position_m: plate.span_m().0, frequency_hz: plate.band_hz().0 })
}
