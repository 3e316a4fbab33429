//! Codes played and values captured in one sweep, and their responses.

use super::deconvolution::{Recorded, responses};
use super::plan::SweepPlan;
use super::table;
use crate::measure::answers::{CODES, LAST_CODE, Measured, Sensor};
use crate::measure::error::MeasureError;
use slipline_link::DeviceTable;
use slipline_plate::Complex64;
use slipline_plate::calibrate::MeasuredPoint;
use slipline_plate::quantity::decibels;
use std::f64::consts::TAU;

/// Share of the input's range above which a sine counts as clipped.
const CLIPPED: f64 = 0.98;

/// Played codes and captured values.
#[derive(Default)]
pub(super) struct Recording {
    /// The DAC's codes from the sweep's beginning.
    pub(super) codes: Vec<u16>,
    /// The input in silence: means of codes, minus mid-scale.
    pub(super) quiet: Vec<f64>,
    /// The input from the sweep's beginning, in the same unit.
    pub(super) heard: Vec<f64>,
}

impl Recording {
    /// The responses. `lag_s` is the device's own lag, `level` that of the tone.
    pub(super) fn measured(
        &self,
        plan: &SweepPlan,
        table: &DeviceTable,
        sensor: &Sensor,
        lag_s: f64,
        level: f64,
    ) -> Result<Measured, MeasureError> {
        let codes_each = 1_usize << plan.log2_codes;
        let played: Vec<f64> = self.codes.chunks_exact(codes_each).map(mean_of_codes).collect();
        let offset = mean(&self.quiet);
        let less = |values: &[f64]| values.iter().map(|value| value - offset).collect::<Vec<f64>>();
        let (heard, noise) = (less(&self.heard), less(&self.quiet));
        let recorded = Recorded {
            played: &played,
            heard: &heard,
            noise: &noise,
            rounding: (12.0 * codes_each as f64).recip(),
            rate_hz: plan.value_rate_hz(),
        };
        let chirp = &plan.chirp;
        let frequencies = chirp.measured_hz();
        let answers = responses(&recorded, &chirp.gate(), &frequencies).ok_or(MeasureError::Unknown)?;
        let point = |(&frequency_hz, (response, noise)): (&f64, (Complex64, f64))| {
            let swing =
                response.norm() * level * table::gain(chirp, table, frequency_hz) + offset.abs() / CODES;
            MeasuredPoint {
                frequency_hz,
                response: response * Complex64::cis(-TAU * frequency_hz * lag_s),
                noise,
                headroom_db: Some(headroom_db(swing)),
            }
        };
        let mut points: Vec<MeasuredPoint> = frequencies.iter().zip(answers).map(point).collect();
        self.mark_clipped(plan, &mut points);
        let noise_codes = (mean_square(&noise) * codes_each as f64).sqrt();
        let same = |values: &[f64]| values.windows(2).all(|two| two[0] == two[1]);
        let is_stuck = same(&self.heard) && same(&self.quiet);
        let measured = Measured::judged(sensor, chirp.rate_hz, points, noise_codes, is_stuck);
        measured.measurement.check()?;
        Ok(measured)
    }

    /// Marks the frequency that was played when a value was at an end of the input's range.
    fn mark_clipped(&self, plan: &SweepPlan, points: &mut [MeasuredPoint]) {
        let codes_each = f64::from(1_u32 << plan.log2_codes);
        for (place, value) in self.heard.iter().enumerate() {
            let code = value + CODES;
            if code > 0.5 && code < f64::from(LAST_CODE) - 0.5 {
                continue;
            }
            let played_hz = plan.chirp.frequency_hz(place as f64 * codes_each);
            mark_clipped_at(played_hz, points);
        }
    }
}

/// Marks as clipped the response at the nearest frequency above this one, or the last response.
pub(super) fn mark_clipped_at(played_hz: f64, points: &mut [MeasuredPoint]) {
    let after = points.partition_point(|point| point.frequency_hz < played_hz);
    let last = points.len().saturating_sub(1);
    if let Some(point) = points.get_mut(after.min(last)) {
        point.headroom_db = Some(0.0);
    }
}

/// Headroom above a sine of this amplitude, dB, where 1 is the end of the input's range: 0 if it is clipped.
pub(super) fn headroom_db(swing: f64) -> f64 {
    if swing < CLIPPED { -decibels(swing.max(1e-6)) } else { 0.0 }
}

/// The mean of codes, minus mid-scale.
fn mean_of_codes(codes: &[u16]) -> f64 {
    codes.iter().map(|&code| f64::from(code)).sum::<f64>() / codes.len() as f64 - CODES
}

pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

pub(super) fn mean_square(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>() / values.len().max(1) as f64
}
