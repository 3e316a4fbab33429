//! The harmonics that a drive adds to a tone: their measured level and phase, and how they rise with the level.
//!
//! A force factor Bl(x) and a suspension Kms(x) that change with the coil's displacement add a second harmonic in proportion to the
//! square of the level and a third in proportion to its cube, so relative to the fundamental
//! ```text
//! h2(L) = h2(L0) (L/L0),   h3(L) = h3(L0) (L/L0)^2
//! ```
//! with the level L0 of the measurement (W. Klippel, J. Audio Eng. Soc. 54, 907, 2006). The law is that of small distortion: it
//! knows neither the end of a coil's travel nor an amplifier that clips. Several tones have products, too
//! ([`crate::intermodulation`]).

use crate::definition::error::PlateError;
use crate::definition::limits;
use crate::definition::response_curve::ResponseCurve;
use num_complex::Complex64;

/// The harmonics of a drive.
///
/// A harmonic of the order n is stated relative to the drive at the fundamental: at the frequency f of the fundamental, `points`
/// have the amplitude of the drive at n f over that at f in dB, and the degrees by which it leads n times the fundamental's phase.
/// The drive is the one that [`crate::DriveEnd`] has, with the actuator's response already in it: the displacement of the end,
/// the force on it, or the amplitude of the launched wave.
///
/// ```
/// use slipline_plate::{Harmonics, ResponseCurve};
///
/// // 1 % at the level 0.8, at every frequency.
/// let second = ResponseCurve { points: vec![[50.0, -40.0, 0.0], [500.0, -40.0, 0.0]] };
/// let harmonics = Harmonics { level: 0.8, second: Some(second), third: None };
/// let ratio = harmonics.ratio(2, 100.0, 0.4).unwrap();
/// assert!((ratio.norm() - 0.005).abs() < 1e-12);
/// assert_eq!(harmonics.ratio(3, 100.0, 0.4), None);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Harmonics {
    /// The level of the tone at which they were measured (0.001 to 1 of the turning-point table's full scale).
    pub level: f64,
    /// The second harmonic over the frequency of the fundamental; `None` if the file does not state it.
    pub second: Option<ResponseCurve>,
    /// The third one.
    pub third: Option<ResponseCurve>,
}

impl Harmonics {
    /// The orders that a file can state.
    pub const ORDERS: [u8; 2] = [2, 3];

    pub(crate) fn validate(&self) -> Result<(), PlateError> {
        for order in Self::ORDERS {
            if let Some(curve) = self.curve(order) {
                curve.validate_in(&format!("actuator.harmonic_{order}_points"), limits::HARMONIC)?;
            }
        }
        Ok(())
    }

    /// The curve of a harmonic; `None` if the file does not state it.
    #[must_use]
    pub fn curve(&self, order: u8) -> Option<&ResponseCurve> {
        match order {
            2 => self.second.as_ref(),
            3 => self.third.as_ref(),
            _ => None,
        }
    }

    /// The drive at `order` times the frequency over the drive at `frequency_hz`, for a tone of this level (0 to 1); a lag is a
    /// positive argument. `None` if the file does not state this harmonic.
    #[must_use]
    pub fn ratio(&self, order: u8, frequency_hz: f64, level: f64) -> Option<Complex64> {
        let rise = (level / self.level).powi(i32::from(order) - 1);
        Some(self.curve(order)?.response(frequency_hz) * rise)
    }

    /// The drive at `order` times the frequency that a drive of this complex amplitude brings along. The harmonic keeps its place in the
    /// period: its phase turns `order` times as far as that of the fundamental.
    #[must_use]
    pub fn drive(&self, order: u8, frequency_hz: f64, level: f64, drive: Complex64) -> Option<Complex64> {
        let turned = Complex64::cis(f64::from(order) * drive.arg());
        Some(self.ratio(order, frequency_hz, level)? * drive.norm() * turned)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn of_points(points: [f64; 3]) -> ResponseCurve {
        ResponseCurve { points: vec![points, [10.0 * points[0], points[1], points[2]]] }
    }

    /// The amplitude of a signal's part at a multiple of its period, with the time factor e^(-j omega t).
    fn part(signal: impl Fn(f64) -> f64, order: u8) -> Complex64 {
        let turns = (0..4096).map(|n| f64::from(n) / 4096.0);
        let sum: Complex64 =
            turns.map(|turn| signal(turn) * Complex64::cis(TAU * f64::from(order) * turn)).sum();
        sum / 2048.0
    }

    #[test]
    fn a_coil_with_quadratic_and_cubic_terms_follows_the_law_of_the_level_and_of_the_phase() {
        // The force u (1 + b u + c u^2) of the current u: b a/2 of second harmonic, c a^2/4 of third (and 3/4 c a^2 of the
        // fundamental, which is left out of the ratio).
        let (b, c) = (0.02, 0.03);
        let stated = 0.8;
        let harmonics = Harmonics {
            level: stated,
            second: Some(of_points([50.0, 20.0 * (0.5 * b * stated).log10(), 0.0])),
            third: Some(of_points([50.0, 20.0 * (0.25 * c * stated * stated).log10(), 0.0])),
        };
        for (level, phase) in [(0.8, 0.0), (0.4, 0.3), (0.1, -2.0), (1.0, 1.1)] {
            let current = |turn: f64| level * (TAU * turn - phase).cos();
            let force = |turn: f64| {
                let u = current(turn);
                u * (1.0 + b * u + c * u * u)
            };
            let drive = part(current, 1);
            for order in Harmonics::ORDERS {
                let is = harmonics.drive(order, 100.0, level, drive).expect("stated");
                let wanted = part(force, order);
                assert!((is - wanted).norm() < 1e-9 * level, "{order} at {level}: {is} for {wanted}");
            }
        }
    }

    #[test]
    fn a_stated_lead_turns_the_harmonic_against_n_times_the_fundamental() {
        let harmonics = Harmonics { level: 1.0, second: Some(of_points([50.0, -40.0, 30.0])), third: None };
        let drive = harmonics.drive(2, 70.0, 1.0, Complex64::cis(0.25)).expect("stated");
        assert!((drive - 0.01 * Complex64::cis(0.5 - 30_f64.to_radians())).norm() < 1e-12, "{drive}");
    }
}
