//! A measured response, of an actuator or of a whole drive: gain and phase over frequency.

use crate::definition::error::{Origin, PlateError};
use crate::definition::limits;
use crate::quantity::{Range, from_decibels};
use num_complex::Complex64;

/// A measured response: points of frequency, gain and phase, in rising frequency.
///
/// Between two points the gain in dB and the phase are linear in the logarithm of the frequency, and the phase takes
/// the shorter way round; beyond the first and the last point both are constant.
///
/// ```
/// use slipline_plate::ResponseCurve;
///
/// // A lag of 80 degrees, as an analyser shows it, has the argument +80 degrees with the time factor e^(-j omega t).
/// let curve = ResponseCurve { points: vec![[100.0, 0.0, 0.0], [400.0, 20.0, -160.0]] };
/// let response = curve.response(200.0);
/// assert!((response.norm() - 10_f64.sqrt()).abs() < 1e-12 && (response.arg().to_degrees() - 80.0).abs() < 1e-9);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ResponseCurve {
    /// 2 to 10 000 points `[frequency_hz, gain_db, phase_deg]`: rising frequencies (0.1 to 1e7 Hz), gain in dB over the
    /// displacement at DAC full scale (-200 to 200), and the phase in degrees by which the end leads the code
    /// (-36 000 to 36 000; a lag is negative, as an analyser shows it).
    pub points: Vec<[f64; 3]>,
}

impl ResponseCurve {
    /// Refuses points that are out of their range; `name` is the list's name in a plate file.
    pub(crate) fn validate(&self, name: &str) -> Result<(), PlateError> {
        self.validate_in(name, limits::GAIN)
    }

    /// The same with another range of the gain.
    pub(crate) fn validate_in(&self, name: &str, gains: Range) -> Result<(), PlateError> {
        limits::CURVE_POINTS.check(name, self.points.len())?;
        let mut before = None;
        for (index, [frequency_hz, gain_db, phase_deg]) in self.points.iter().copied().enumerate() {
            limits::CURVE_FREQUENCY.check(format_args!("{name}[{index}][0]"), frequency_hz)?;
            if let Some(before_hz) = before {
                // A relative step of 1e-6 keeps the slope between two points finite.
                let rising = Range { low: before_hz * (1.0 + 1e-6), ..limits::CURVE_FREQUENCY };
                rising.check_from(Origin::Rising, format_args!("{name}[{index}][0]"), frequency_hz)?;
            }
            before = Some(frequency_hz);
            gains.check(format_args!("{name}[{index}][1]"), gain_db)?;
            limits::PHASE.check(format_args!("{name}[{index}][2]"), phase_deg)?;
        }
        Ok(())
    }

    /// Complex response at `frequency_hz` for signals e^(-j omega t): a lag has a positive argument.
    pub fn response(&self, frequency_hz: f64) -> Complex64 {
        let last = self.points.len().saturating_sub(1);
        let right = self.points.partition_point(|point| point[0] <= frequency_hz).clamp(1, last.max(1));
        let (Some(a), Some(b)) = (self.points.get(right - 1), self.points.get(right.min(last))) else {
            return Complex64::ONE;
        };
        let share = ((frequency_hz / a[0]).ln() / (b[0] / a[0]).ln()).clamp(0.0, 1.0);
        let share = if share.is_nan() { 0.0 } else { share };
        let turn = b[2] - a[2];
        let turn = turn - 360.0 * (turn / 360.0).round();
        let gain_db = a[1] + share * (b[1] - a[1]);
        Complex64::from_polar(from_decibels(gain_db), -(a[2] + share * turn).to_radians())
    }

    /// Whether `frequency_hz` lies between the first and the last point.
    pub fn covers(&self, frequency_hz: f64) -> bool {
        let ends = self.points.first().zip(self.points.last());
        ends.is_some_and(|(first, last)| (first[0]..=last[0]).contains(&frequency_hz))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definition::actuator::Resonator;
    use crate::quantity::decibels;

    fn curve(points: &[[f64; 3]]) -> ResponseCurve {
        ResponseCurve { points: points.to_vec() }
    }

    #[test]
    fn a_curve_measured_on_a_resonator_responds_as_the_resonator() {
        let resonator = Resonator { resonance_hz: 100.0, quality: 3.0, travel: None };
        let points = (0..=400).map(|i| {
            let frequency_hz = 10.0 * 1000_f64.powf(f64::from(i) / 400.0);
            let response = resonator.response(frequency_hz);
            [frequency_hz, decibels(response.norm()), -response.arg().to_degrees()]
        });
        let measured = ResponseCurve { points: points.collect() };
        for frequency_hz in [10.0, 33.3, 99.0, 101.7, 250.0, 9_999.0] {
            let (a, b) = (measured.response(frequency_hz), resonator.response(frequency_hz));
            assert!((a - b).norm() < 2e-3 * b.norm(), "{frequency_hz}: {a} {b}");
        }
    }

    #[test]
    fn beyond_its_ends_a_curve_keeps_them_and_a_phase_goes_the_shorter_way_round() {
        let found = curve(&[[100.0, -6.0, 170.0], [400.0, 6.0, -170.0]]);
        let degrees = |hz: f64| -found.response(hz).arg().to_degrees();
        assert!((degrees(200.0).abs() - 180.0).abs() < 1e-9, "{}", degrees(200.0));
        assert!((degrees(1.0) - 170.0).abs() < 1e-9 && (degrees(1e6) + 170.0).abs() < 1e-9);
        assert!((found.response(1.0).norm() - 10_f64.powf(-0.3)).abs() < 1e-12);
        assert!(found.covers(100.0) && found.covers(400.0) && !found.covers(99.9) && !found.covers(f64::NAN));
        assert!(found.response(f64::NAN).is_finite());
    }
}
