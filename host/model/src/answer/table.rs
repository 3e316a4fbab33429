//! The drive table of a plate.

use crate::field::simulation;
use serde::Serialize;
use slipline_link::{DeviceTable, DeviceTableError};
use slipline_plate::{DriveTable, Knot, Plate, Progress, Sensitivity, TableError, sensitivity_per_percent};

/// A table, in physical and in device units, and what it loses on a plate that differs.
#[derive(Clone, Debug)]
pub struct BuiltTable {
    /// The table.
    pub table: DriveTable,
    /// The same in the device's units.
    pub device_table: DeviceTable,
    /// Error of its levels for each per cent of the wave speed.
    pub sensitivity: Sensitivity,
}

/// Why there is no table.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BuildError {
    /// The plate has none.
    #[error("{0}")]
    Table(#[from] TableError),
    /// It does not fit the device's units.
    #[error("{0}")]
    DeviceTable(#[from] DeviceTableError),
}

impl BuiltTable {
    /// Builds the table of a plate.
    ///
    /// # Errors
    /// [`BuildError`]: the unsuitable value and its range, or that the caller has cancelled it.
    pub fn build(
        plate: &Plate,
        sample_rate_hz: f64,
        knots: usize,
        progress: &mut Progress<'_>,
    ) -> Result<Self, BuildError> {
        let table = DriveTable::build_watched(plate, sample_rate_hz, knots, &mut progress.part(0.0, 0.8))?;
        let sensitivity = sensitivity_per_percent(&table, plate, &mut progress.part(0.8, 1.0))?;
        let device_table = simulation::device_table(&table)?;
        Ok(Self { table, device_table, sensitivity })
    }

    /// Its fields.
    #[must_use]
    pub fn answer<'a>(&'a self, plate: &'a Plate) -> TableAnswer<'a> {
        let Self { table, device_table, sensitivity } = self;
        TableAnswer {
            plate: plate.name(),
            sample_rate_hz: table.sample_rate_hz(),
            span_start_m: table.span_m().0,
            span_end_m: table.span_m().1,
            knots: table.knots(),
            peak_at_full_scale_m: table.peak_at_full_scale_m(),
            worst_error_db: table.worst_error_db(),
            worst_shift_m: table.worst_shift_m(),
            swing_without_gain_db: table.swing_without_gain_db(),
            travel_over_peak_travel: table.travel().map(|travel| travel.largest_share),
            lowered_by_travel_db: table.travel().map(|travel| travel.lowered_db()),
            knots_without_peak: table.knots_without_peak(),
            sensitivity_db_per_percent: sensitivity.worst_db,
            sensitivity_at_m: sensitivity.worst_at_m,
            crc: format!("{:08x}", device_table.crc()),
        }
    }
}

/// The fields of `slipline table --json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TableAnswer<'a> {
    /// Name of the plate.
    pub plate: &'a str,
    /// JSON: Sample rate
    pub sample_rate_hz: f64,
    /// JSON: Nearest turning point of the table
    pub span_start_m: f64,
    /// JSON: Farthest turning point of the table
    pub span_end_m: f64,
    /// The knots.
    pub knots: &'a [Knot],
    /// Amplitude of the peak at level 1.
    pub peak_at_full_scale_m: f64,
    /// JSON: Largest error of the level between the knots
    pub worst_error_db: f64,
    /// JSON: Largest shift of the peak between the knots
    pub worst_shift_m: f64,
    /// JSON: Swing of the level over the span without the gains
    pub swing_without_gain_db: f64,
    /// JSON, 1: Travel at level 1 over the peak travel; null without a limit
    pub travel_over_peak_travel: Option<f64>,
    /// JSON: By how much the table is lower to keep the peak travel; null without a limit
    pub lowered_by_travel_db: Option<f64>,
    /// JSON, count: Knots where loss leaves no peak
    pub knots_without_peak: usize,
    /// JSON, dB: Change of the level per 1 % of wave speed
    pub sensitivity_db_per_percent: f64,
    /// Where the level is most sensitive.
    pub sensitivity_at_m: f64,
    /// JSON, text: CRC-32 of the table, eight hexadecimal digits
    pub crc: String,
}
