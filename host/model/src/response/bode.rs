//! The curves of a response: its level in dB and its phase, unwrapped.

use slipline_plate::Complex64;
use slipline_plate::calibrate::Measurement;
use slipline_plate::quantity::decibels;
use std::f64::consts::{PI, TAU};

/// Responses below this multiple of their noise have no phase.
pub(crate) const SHOWN_OVER_NOISE: f64 = 2.0;
/// Standard deviations of a 95 % interval.
const INTERVAL: f64 = 1.96;

/// The curves of a measurement; each list has a value for each of its points.
#[derive(Debug, Clone, PartialEq)]
pub struct Bode {
    /// Frequencies, Hz, rising.
    pub frequency_hz: Vec<f64>,
    /// Magnitude, dB of the response's unit.
    pub level_db: Vec<f64>,
    /// Standard deviation of the noise, dB of the same unit.
    pub noise_db: Vec<f64>,
    /// Half of the magnitude's 95 % interval due to noise, dB.
    pub spread_db: Vec<f64>,
    /// Phase by which the sensor lags the drive, degrees, unwrapped; `None` where the response is noise.
    pub phase_deg: Vec<Option<f64>>,
}

impl Bode {
    /// The curves of a measurement.
    #[must_use]
    pub fn of(measurement: &Measurement) -> Self {
        let points = &measurement.points;
        let answers: Vec<Option<Complex64>> = points.iter().map(|point| Some(point.response)).collect();
        let heard = points.iter().map(|point| {
            Some(point.response).filter(|response| response.norm() >= SHOWN_OVER_NOISE * point.noise)
        });
        let heard: Vec<Option<Complex64>> = heard.collect();
        let spread = |point: &slipline_plate::calibrate::MeasuredPoint| {
            decibel(1.0 + INTERVAL * point.noise / point.response.norm().max(point.noise))
        };
        Self {
            frequency_hz: points.iter().map(|point| point.frequency_hz).collect(),
            level_db: levels_db(&answers).into_iter().flatten().collect(),
            noise_db: points.iter().map(|point| decibel(point.noise)).collect(),
            spread_db: points.iter().map(spread).collect(),
            phase_deg: unwrapped_deg(&heard),
        }
    }
}

/// A ratio in dB; that of a zero ratio is the smallest finite number.
fn decibel(ratio: f64) -> f64 {
    decibels(ratio.max(f64::MIN_POSITIVE))
}

/// Magnitudes in dB.
#[must_use]
pub fn levels_db(responses: &[Option<Complex64>]) -> Vec<Option<f64>> {
    responses.iter().map(|response| response.map(|response| decibel(response.norm()))).collect()
}

/// Arguments in degrees, each within half a turn of the previous one; absent values are skipped.
#[must_use]
pub fn unwrapped_deg(responses: &[Option<Complex64>]) -> Vec<Option<f64>> {
    let mut last: Option<f64> = None;
    let unwrap = |response: &Option<Complex64>| {
        let argument = response.as_ref()?.arg();
        let next = last.map_or(argument, |last| argument + TAU * ((last - argument) / TAU).round());
        last = Some(next);
        Some(next * 180.0 / PI)
    };
    responses.iter().map(unwrap).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_plate::calibrate::{MeasuredPoint, SensorKind};

    /// A delay of 3 ms and a level of 0.5, with noise of 0.05, and one response that is noise.
    fn delayed() -> Measurement {
        let point = |i: u32| {
            let frequency_hz = 100.0 + 20.0 * f64::from(i);
            let magnitude = if i == 4 { 0.06 } else { 0.5 };
            let response = Complex64::from_polar(magnitude, TAU * frequency_hz * 3e-3);
            MeasuredPoint { frequency_hz, response, noise: 0.05, headroom_db: None }
        };
        Measurement::at(0.03, SensorKind::Velocity, (0..40).map(point).collect())
    }

    #[test]
    fn a_delay_is_a_straight_line_of_phase_and_noise_has_none() {
        let bode = Bode::of(&delayed());
        let first = bode.phase_deg[0].unwrap();
        for (i, phase) in bode.phase_deg.iter().enumerate() {
            match phase {
                Some(phase) => assert!((phase - first - 21.6 * i as f64).abs() < 1e-9, "{i}: {phase}"),
                None => assert_eq!(i, 4),
            }
        }
        assert!(bode.phase_deg[39].unwrap() > 720.0);
        let half_db = decibels(0.5);
        assert!((bode.level_db[0] - half_db).abs() < 1e-12);
        assert!((bode.noise_db[0] - half_db + 20.0).abs() < 1e-9);
        // 1.96 standard deviations of a tenth.
        assert!((bode.spread_db[0] - decibels(1.196)).abs() < 1e-9);
    }

    #[test]
    fn an_answer_of_zero_has_a_finite_level() {
        let mut silent = delayed();
        silent.points[0].response = Complex64::ZERO;
        let bode = Bode::of(&silent);
        assert!(bode.level_db[0].is_finite() && bode.spread_db[0].is_finite());
        assert_eq!(bode.phase_deg[0], None);
    }
}
