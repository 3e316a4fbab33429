//! The table of a sweep: its places are frequencies, rising exponentially.

use super::chirp::Chirp;
use super::deconvolution::smooth;
use crate::measure::error::MeasureError;
use slipline_link::DeviceTable;
use std::sync::Arc;

/// Number of intervals between knots.
pub(super) const INTERVALS: u32 = 512;
/// The ends of the table, metres; they are no places of a plate.
pub(super) const ENDS_M: (f64, f64) = (0.0, 1.0);
/// Gain at the ends: far below a code.
const SILENT: f64 = 1e-8;
/// Share of the margins in which the gain rises and falls.
pub(super) const FADE: f64 = 0.5;

/// Gain of the sweep at a frequency, over level 1: that of the plate's table, times the fades.
pub(super) fn gain(chirp: &Chirp, table: &DeviceTable, frequency_hz: f64) -> f64 {
    let ((first, last), (below, above)) = (chirp.ends_hz, chirp.margins_hz());
    let rise = smooth(frequency_hz, (first, first + FADE * below));
    let fall = 1.0 - smooth(frequency_hz, (last - FADE * above, last));
    table.gain_of_turns(frequency_hz / chirp.rate_hz) * rise * fall
}

/// The frequencies of the knots, Hz.
pub(super) fn knots_hz(chirp: &Chirp) -> impl Iterator<Item = f64> + '_ {
    (0..=INTERVALS)
        .map(|knot| chirp.frequency_hz(f64::from(knot) / f64::from(INTERVALS) * chirp.samples as f64))
}

/// Gain of the sweep at each knot.
pub(super) fn gains(chirp: &Chirp, table: &DeviceTable) -> Vec<f64> {
    knots_hz(chirp).map(|frequency_hz| gain(chirp, table, frequency_hz).max(SILENT)).collect()
}

/// The sweep's table with these gains.
pub(super) fn with_gains(chirp: &Chirp, gains: &[f64], peak_m: f64) -> Result<DeviceTable, MeasureError> {
    let knots = knots_hz(chirp).zip(gains.iter().copied());
    Ok(DeviceTable::from_knots(ENDS_M, chirp.rate_hz, knots, peak_m)?)
}

/// The sweep's table, with the travel limit of the plate's table.
pub(super) fn of(chirp: &Chirp, table: &DeviceTable) -> Result<Arc<DeviceTable>, MeasureError> {
    let sweep = with_gains(chirp, &gains(chirp, table), table.peak_at_full_scale_m())?;
    Ok(Arc::new(sweep.with_travel_limit_of(table)))
}
