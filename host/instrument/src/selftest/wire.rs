//! Steps by a wire from the DAC's pin to the sensor's: codes against codes, and the lag between them.

use super::course::{Course, SENSOR, reading};
use super::limits::step;
use super::report::StepResult;
use crate::measure::{MeasureError, ended_by};
use slipline_link::{ListenRequest, Outcome, Request, WindowShape};
use std::f64::consts::TAU;

/// Period of the slow sine that runs through the codes, in blocks: 5 Hz at 400 kS/s; and of a short test, 25 Hz.
const SWEEP_BLOCKS: u16 = 625;
const SHORT_SWEEP_BLOCKS: u16 = 125;
/// Codes that a value of the sweep sums up, as a binary logarithm, and values in a block of 128.
const SWEEP_LOG2: u8 = 5;
const VALUES: u16 = 4;
/// Stretches of codes whose mean departure from the line is the nonlinearity.
const STRETCHES: usize = 64;
/// Codes on each side of mid-scale.
const HALF: f64 = 2048.0;
/// Share of the linear part over which the line is fitted: its ends are rounded.
const FITTED: f64 = 0.98;
/// Departure from the line beyond which a code is no longer within the linear part, codes.
const LINEAR_CODES: f64 = 8.0;
/// Period of the comb of the lag, in blocks, and its frequencies with their quantities.
const LAG_BLOCKS: u16 = 40;
const LAGS: [(f64, &str); 4] =
    [(5e3, "lag at 5 kHz"), (20e3, "lag at 20 kHz"), (40e3, "lag at 40 kHz"), (80e3, "lag at 80 kHz")];
/// Periods over which the lag is measured.
const PERIODS: u16 = 5;

impl Course {
    /// Runs a slow sine of the largest level through the codes of the DAC, and compares what the sensor's input reads.
    pub(super) async fn dac_to_adc(&self) -> Result<StepResult, MeasureError> {
        let blocks = if self.request.is_short { SHORT_SWEEP_BLOCKS } else { SWEEP_BLOCKS };
        let risen = self.comb(blocks, [(1, self.most)]).await?;
        let captured = self.capture(risen, SWEEP_LOG2, blocks * VALUES, false).await?;
        let length = 1 << SWEEP_LOG2;
        let sent = self.dialogue.codes(captured.from, captured.values.len() as u64 * length).await?;
        self.dialogue.stop().await?;
        let mean =
            |codes: &[u16]| codes.iter().map(|&code| f64::from(code)).sum::<f64>() / codes.len() as f64;
        let pairs: Vec<(f64, f64)> =
            sent.chunks(length as usize).map(|codes| mean(codes) - HALF).zip(captured.codes()).collect();
        let line = Line::through(&pairs, FITTED * HALF * self.linear.min(self.most));
        let name = step::DAC_TO_ADC;
        let readings = vec![
            reading(name, "slope", line.slope),
            reading(name, "offset", line.offset),
            reading(name, "nonlinearity", line.nonlinearity),
            reading(name, "lowest linear code", (HALF + line.ends.0).round()),
            reading(name, "highest linear code", (HALF + line.ends.1).round().min(2.0 * HALF - 1.0)),
        ];
        let good = format!("The input reads the DAC's codes, by {STRETCHES} stretches of a slow sine.");
        Ok(StepResult::judged(name, readings, good))
    }

    /// Measures the phase of four tones at the sensor's input: its lag behind the codes, beyond what the device states.
    pub(super) async fn delay(&self) -> Result<StepResult, MeasureError> {
        let base_hz = self.rate_hz / (slipline_link::BLOCK as f64 * f64::from(LAG_BLOCKS));
        let harmonics = LAGS.map(|(hz, _)| (hz / base_hz).round() as u16);
        let level = self.clean() / LAGS.len() as f64;
        let risen = self.comb(LAG_BLOCKS, harmonics.map(|harmonic| (harmonic, level))).await?;
        let listen = |from| {
            Request::Listen(ListenRequest {
                from: Some(from),
                blocks: LAG_BLOCKS * if self.request.is_short { 1 } else { PERIODS },
                shape: WindowShape::Rectangular,
                slots: 0b1111,
                input: SENSOR,
            })
        };
        let outcome = self.in_time(risen, None, listen).await?;
        let Outcome::Listened(listened) = outcome else { return Err(ended_by(&outcome)) };
        self.dialogue.stop().await?;
        let name = step::DELAY;
        let mut readings = Vec::new();
        for ((harmonic, (_, quantity)), answer) in harmonics.into_iter().zip(LAGS).zip(listened.answers) {
            let (re, im) = answer.ok_or(MeasureError::Unknown)?;
            let hz = f64::from(harmonic) * base_hz;
            readings.push(reading(name, quantity, -im.atan2(re) / TAU / hz * 1e6));
        }
        readings.push(reading(name, "stated delay", self.inputs.delay_ns as f64 * 1e-3));
        Ok(StepResult::judged(name, readings, "The input lags behind the codes as little as it should."))
    }
}

/// The line through the codes, and the departure from it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Line {
    slope: f64,
    /// At mid-scale, codes.
    offset: f64,
    /// The largest mean departure of a stretch within the fitted part, codes.
    nonlinearity: f64,
    /// The ends of the stretches about mid-scale that follow the line, codes from mid-scale.
    ends: (f64, f64),
}

impl Line {
    /// The least squares of `(sent, received)`, one period of a sine, with `sent` within `fitted`, both in codes from mid-scale.
    fn through(pairs: &[(f64, f64)], fitted: f64) -> Self {
        // A lag moves the sine along: the part a quarter of the period behind it is no fault of the characteristic.
        let quarter = |at: usize| pairs[(at + pairs.len() / 4) % pairs.len()].0;
        let within = || pairs.iter().enumerate().filter(|(_, (sent, _))| sent.abs() <= fitted);
        let count = (within().count() as f64).max(1.0);
        let [mut mean_sent, mut mean_late, mut mean_received] = [0.0; 3];
        for (at, (sent, received)) in within() {
            mean_sent += sent / count;
            mean_late += quarter(at) / count;
            mean_received += received / count;
        }
        let [mut ss, mut sl, mut ll, mut sr, mut lr] = [0.0; 5];
        for (at, (sent, received)) in within() {
            let (s, l, r) = (sent - mean_sent, quarter(at) - mean_late, received - mean_received);
            ss += s * s;
            sl += s * l;
            ll += l * l;
            sr += s * r;
            lr += l * r;
        }
        let determinant = ss * ll - sl * sl;
        let (slope, late) = if determinant > 0.0 {
            ((sr * ll - lr * sl) / determinant, (lr * ss - sr * sl) / determinant)
        } else {
            (0.0, 0.0)
        };
        let offset = mean_received - slope * mean_sent - late * mean_late;
        let mut stretches = [(0.0, 0.0_f64); STRETCHES];
        for (place, (sent, received)) in pairs.iter().enumerate() {
            let at = ((sent / HALF + 1.0) / 2.0 * STRETCHES as f64) as usize;
            let (sum, count) = &mut stretches[at.min(STRETCHES - 1)];
            *sum += received - slope * sent - late * quarter(place) - offset;
            *count += 1.0;
        }
        let width = 2.0 * HALF / STRETCHES as f64;
        let edge = |at: usize| at as f64 * width - HALF;
        let departure = |at: usize| {
            let (sum, count) = stretches[at];
            (count > 0.0).then(|| (sum / count).abs())
        };
        let is_fitted = |at: &usize| edge(*at) >= -fitted && edge(*at + 1) <= fitted;
        let nonlinearity = (0..STRETCHES).filter(is_fitted).filter_map(departure).fold(0.0, f64::max);
        let follows = |at: &usize| departure(*at).is_some_and(|codes| codes <= LINEAR_CODES);
        let middle = STRETCHES / 2;
        let above = (middle..STRETCHES).take_while(follows).count();
        let below = (0..middle).rev().take_while(follows).count();
        Self { slope, offset, nonlinearity, ends: (edge(middle - below), edge(middle + above)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A slow sine of full scale, and what an input with this characteristic reads.
    fn pairs(reads: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
        (0..2500)
            .map(|n| 2047.0 * (TAU * f64::from(n) / 2500.0).sin())
            .map(|sent| (sent, reads(sent)))
            .collect()
    }

    #[test]
    fn slope_offset_and_nonlinearity_are_those_of_the_input() {
        let line = Line::through(&pairs(|sent| 1.01 * sent - 12.0), 1700.0);
        assert!((line.slope - 1.01).abs() < 1e-9 && (line.offset + 12.0).abs() < 1e-9, "{line:?}");
        assert!(line.nonlinearity < 1e-9 && line.ends == (-HALF, HALF), "{line:?}");
        let bent = Line::through(&pairs(|sent| sent + 10.0 * (sent / 1700.0).powi(2)), 1700.0);
        assert!((4.0..8.0).contains(&bent.nonlinearity), "{bent:?}");
        // An output that saturates: its ends are found to a stretch of 64 codes.
        let clipped = Line::through(&pairs(|sent| sent.clamp(-1800.0, 1800.0)), 1700.0);
        assert!(
            (clipped.ends.1 - 1800.0).abs() <= 64.0 && (clipped.ends.0 + 1800.0).abs() <= 64.0,
            "{clipped:?}"
        );
        // A lag of a sixth of a radian is no nonlinearity.
        let late: Vec<(f64, f64)> =
            (0..2500).map(|n| (pairs(|sent| sent)[n].0, pairs(|sent| sent)[(n + 2434) % 2500].0)).collect();
        let late = Line::through(&late, 1700.0);
        assert!(late.nonlinearity < 1e-6 && (late.slope - 0.9863).abs() < 1e-3, "{late:?}");
        // A dead input has no slope.
        let dead = Line::through(&pairs(|_| -2048.0), 1700.0);
        assert!(dead.slope.abs() < 1e-9 && dead.nonlinearity < 1e-6, "{dead:?}");
    }
}
