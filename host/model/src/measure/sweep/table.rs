//! The table of a sweep: its places are frequencies, rising exponentially.

use super::deconvolution::smooth;
use super::plan::SweepPlan;
use crate::measure::error::MeasureError;
use crate::measure::loudness;
use slipline_link::DeviceTable;
use std::sync::Arc;

/// Intervals between knots.
const INTERVALS: u32 = 512;
/// The ends of the table, metres: they are no places of a plate.
pub(super) const ENDS_M: (f64, f64) = (0.0, 1.0);
/// Gain at the ends: far below a code.
const SILENT: f64 = 1e-8;
/// The share of the margins in which the gain rises and falls.
pub(super) const FADE: f64 = 0.5;

/// How loud the sweep is at a frequency, over level 1: the plate's table, and the fades.
pub(super) fn gain(plan: &SweepPlan, table: &DeviceTable, frequency_hz: f64) -> f64 {
    let ((first, last), (below, above)) = (plan.ends_hz, plan.margins_hz());
    let rise = smooth(frequency_hz, (first, first + FADE * below));
    let fall = 1.0 - smooth(frequency_hz, (last - FADE * above, last));
    loudness::gain(table, frequency_hz / plan.rate_hz) * rise * fall
}

/// The table that has the device sweep, with the limit of the travel of the plate's.
pub(super) fn of(plan: &SweepPlan, table: &DeviceTable) -> Result<Arc<DeviceTable>, MeasureError> {
    let knots = (0..=INTERVALS).map(|knot| {
        let samples = f64::from(knot) / f64::from(INTERVALS) * plan.sweep_samples as f64;
        let frequency_hz = plan.frequency_hz(samples);
        (frequency_hz, gain(plan, table, frequency_hz).max(SILENT))
    });
    let peak_m = table.peak_at_full_scale_m();
    let sweep = DeviceTable::from_knots(ENDS_M, plan.rate_hz, knots, peak_m)?;
    Ok(Arc::new(sweep.with_travel_limit_of(table)))
}
