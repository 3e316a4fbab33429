//! The part of a plate's drive that is given by measured curves instead of a resonance.

use crate::definition::actuator::Actuator;
use crate::definition::plate::Plate;
use crate::definition::response_curve::ResponseCurve;
use num_complex::Complex64;
use std::f64::consts::{LN_2, LN_10, PI};

/// [`Plate::drive_response`] over the actuator's resonance: a measured actuator times the correction of a calibration.
pub(crate) struct DriveCurve<'a> {
    curves: Vec<&'a ResponseCurve>,
    field: &'static str,
}

impl<'a> DriveCurve<'a> {
    /// `None` if the plate's drive has no measured curve.
    pub(crate) fn of(plate: &'a Plate) -> Option<Self> {
        let spec = plate.spec();
        let measured = match &spec.actuator {
            Some(Actuator::Measured(curve)) => Some(curve),
            Some(Actuator::Resonator(_)) | None => None,
        };
        let correction = spec.calibration.as_ref().and_then(|it| it.correction.as_ref());
        let field = match (measured, correction) {
            (None, None) => return None,
            (Some(_), None) => "actuator.points",
            (None, Some(_)) => "calibration.points",
            (Some(_), Some(_)) => "actuator.points times calibration.points",
        };
        Some(Self { curves: measured.into_iter().chain(correction).collect(), field })
    }

    /// The fields of a plate file with the curve.
    pub(crate) const fn field(&self) -> &'static str {
        self.field
    }

    /// Complex response at `frequency_hz`, without a unit.
    pub(crate) fn response(&self, frequency_hz: f64) -> Complex64 {
        self.curves.iter().map(|curve| curve.response(frequency_hz)).product()
    }

    /// The response of a minimum-phase drive with the same gain.
    ///
    /// Bode's relation gives it: with u = ln(f/f0) the phase at f0 is 1/pi times the integral of d(ln |H|)/du
    /// ln coth(|u|/2) over all u. Between two points of a curve d(ln |H|)/du is constant, beyond its ends it is zero.
    pub(crate) fn least_phase_response(&self, frequency_hz: f64) -> Complex64 {
        let mut lead = 0.0;
        for curve in &self.curves {
            let mut before: Option<[f64; 3]> = None;
            for [hz, gain_db, _] in &curve.points {
                let u = (hz / frequency_hz).ln();
                let here = [u, bode_integral(u), gain_db * LN_10 / 20.0];
                if let Some([u, integral, nepers]) = before {
                    lead += (here[2] - nepers) / (here[0] - u) * (here[1] - integral) / PI;
                }
                before = Some(here);
            }
        }
        Complex64::from_polar(self.response(frequency_hz).norm(), -lead)
    }

    /// Frequencies of the points between two frequencies, Hz: the corners of the curves.
    pub(crate) fn corners_hz(&self, (low_hz, high_hz): (f64, f64)) -> impl Iterator<Item = f64> {
        let points = self.curves.iter().flat_map(|curve| &curve.points);
        points.map(|point| point[0]).filter(move |hz| *hz >= low_hz && *hz <= high_hz)
    }
}

/// Integral of ln coth(|v|/2) over v from 0 to u; odd in u.
fn bode_integral(u: f64) -> f64 {
    let size = u.abs();
    let value = if size < 0.5 {
        // ln coth(v/2) = -ln(v/2) + v^2/12 - 7 v^4/1440 + ...
        let log = if size > 0.0 { size * (1.0 + LN_2 - size.ln()) } else { 0.0 };
        log + size.powi(3) / 36.0 - 7.0 * size.powi(5) / 7200.0
    } else {
        // ln coth(v/2) = 2 sum over odd k of e^(-k v)/k; the sum of 1/k^2 over odd k is pi^2/8.
        let step = (-2.0 * size).exp();
        let (mut power, mut odd, mut sum) = ((-size).exp(), 1.0, 0.0);
        while power > f64::EPSILON {
            sum += power / (odd * odd);
            power *= step;
            odd += 2.0;
        }
        PI * PI / 4.0 - 2.0 * sum
    };
    value.copysign(u)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definition::actuator::Resonator;

    #[test]
    fn the_gain_of_a_resonator_has_its_phase_as_the_least_phase() {
        let resonator = Resonator { resonance_hz: 100.0, quality: 3.0, travel: None };
        let point = |hz: f64| [hz, 20.0 * resonator.response(hz).norm().log10(), 0.0];
        let points = (0..=2000).map(|i| point(0.01 * 1e8_f64.powf(f64::from(i) / 2000.0))).collect();
        let curve = ResponseCurve { points };
        let drive = DriveCurve { curves: vec![&curve], field: "" };
        for hz in [30.0, 80.0, 99.0, 101.0, 150.0, 400.0] {
            let (found, exact) = (drive.least_phase_response(hz), resonator.response(hz));
            assert!((found / exact - 1.0).norm() < 5e-3, "{hz}: {found} for {exact}");
            assert!(drive.response(hz).im.abs() < 1e-12, "the curve itself has no phase");
        }
    }

    #[test]
    fn both_ways_of_the_integral_meet() {
        assert!((bode_integral(0.499_999_9) - bode_integral(0.5)).abs() < 1e-5);
        assert_eq!(bode_integral(-0.3), -bode_integral(0.3));
        assert!((bode_integral(50.0) - PI * PI / 4.0).abs() < 1e-12);
    }
}
