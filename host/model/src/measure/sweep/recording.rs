//! What one sweep was: the codes that were played, the values that were captured, and what they make together.

use super::deconvolution::{Gate, Recorded, responses};
use super::plan::{GATE_AFTER, SweepPlan};
use super::table;
use crate::measure::answers::{CODES, LAST_CODE, Measured, Sensor};
use crate::measure::error::MeasureError;
use slipline_link::DeviceTable;
use slipline_plate::Complex64;
use slipline_plate::calibrate::MeasuredPoint;
use std::f64::consts::TAU;

/// Where W begins and ends to rise, as shares of the margin from the sweep's end: where the sweep is nearly as loud as in the
/// band.
const WEIGHED: (f64, f64) = (0.3, 0.7);
/// Share of the input's range beyond which a sine is clipped.
const CLIPPED: f64 = 0.98;

/// What was played and heard.
#[derive(Default)]
pub(super) struct Recording {
    /// The DAC's codes from the sweep's beginning on.
    pub(super) codes: Vec<u16>,
    /// The input in silence: means of codes, less mid-scale.
    pub(super) quiet: Vec<f64>,
    /// The input from the sweep's beginning on, in the same unit.
    pub(super) heard: Vec<f64>,
}

impl Recording {
    /// The responses. `lag_s` is the device's own, `level` that of the tone.
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
        let ((first, last), (below, above)) = (plan.ends_hz, plan.margins_hz());
        let gate = Gate {
            rises_hz: (first + WEIGHED.0 * below, first + WEIGHED.1 * below),
            falls_hz: (last - WEIGHED.1 * above, last - WEIGHED.0 * above),
            ring_s: plan.ring_s,
            fade_s: GATE_AFTER * plan.ring_s,
        };
        let frequencies: Vec<f64> =
            (0..plan.wanted.points).map(|point| plan.wanted.frequency_hz(point)).collect();
        let answers = responses(&recorded, &gate, &frequencies).ok_or(MeasureError::Unknown)?;
        let point = |(&frequency_hz, (response, noise)): (&f64, (Complex64, f64))| {
            let swing =
                response.norm() * level * table::gain(plan, table, frequency_hz) + offset.abs() / CODES;
            MeasuredPoint {
                frequency_hz,
                response: response * Complex64::cis(-TAU * frequency_hz * lag_s),
                noise,
                headroom_db: Some(if swing < CLIPPED { -20.0 * swing.max(1e-6).log10() } else { 0.0 }),
            }
        };
        let mut points: Vec<MeasuredPoint> = frequencies.iter().zip(answers).map(point).collect();
        self.mark_clipped(plan, &mut points);
        let noise_codes = (mean_square(&noise) * codes_each as f64).sqrt();
        let same = |values: &[f64]| values.windows(2).all(|two| two[0] == two[1]);
        let is_stuck = same(&self.heard) && same(&self.quiet);
        let measured = Measured::told(sensor, plan.rate_hz, points, noise_codes, is_stuck);
        measured.measurement.check()?;
        Ok(measured)
    }

    /// A value at an end of the input's range is one of clipped codes: marks the frequency that was played then.
    fn mark_clipped(&self, plan: &SweepPlan, points: &mut [MeasuredPoint]) {
        let codes_each = f64::from(1_u32 << plan.log2_codes);
        for (place, value) in self.heard.iter().enumerate() {
            let code = value + CODES;
            if code > 0.5 && code < f64::from(LAST_CODE) - 0.5 {
                continue;
            }
            let played_hz = plan.frequency_hz(place as f64 * codes_each);
            let after = points.partition_point(|point| point.frequency_hz < played_hz);
            if let Some(point) = points.get_mut(after.min(plan.wanted.points - 1)) {
                point.headroom_db = Some(0.0);
            }
        }
    }
}

/// The mean of some codes, less mid-scale.
fn mean_of_codes(codes: &[u16]) -> f64 {
    codes.iter().map(|&code| f64::from(code)).sum::<f64>() / codes.len() as f64 - CODES
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn mean_square(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>() / values.len().max(1) as f64
}
