//! A voice coil whose force factor and suspension change with its displacement.
//!
//! ```text
//! Kms(x) x = Bl(x) i:   x (1 + k1 x + k2 x^2) = u (1 + b1 x + b2 x^2)
//! ```
//! u is the displacement that the linear coil would have, x the real one, both over that at DAC full scale. This is the coil below
//! its resonance, where the spring decides; a tone then has a second harmonic in proportion to b1 - k1 and a third in proportion to
//! b2 - k2 (W. Klippel, J. Audio Eng. Soc. 54, 907, 2006). The plate and the actuator of a plate file follow it, both linear. The
//! shunt shows the current of a linear coil that moves like this one.

use super::error::RigError;
use slipline_plate::quantity::{OutOfRange, Range};
use std::f64::consts::TAU;

/// How far each coefficient may be from 0: beyond, Bl(x) or Kms(x) is not positive over the whole travel.
pub(super) const COEFFICIENT: Range = Range::new(-0.4, 0.4, "");
/// Steps of the iteration for x: its error falls by the coefficients' size with each.
const STEPS: usize = 12;
/// Samples of a period in which harmonics are computed.
const PERIOD: u32 = 1024;

/// The coefficients of Bl(x)/Bl(0) and Kms(x)/Kms(0); all 0 is a linear coil.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Coil {
    /// b1 and b2 of Bl(x)/Bl(0) = 1 + b1 x + b2 x^2, each -0.4 to 0.4.
    pub force_factor: [f64; 2],
    /// k1 and k2 of Kms(x)/Kms(0) = 1 + k1 x + k2 x^2, each -0.4 to 0.4.
    pub stiffness: [f64; 2],
}

impl Coil {
    /// A coil that adds `second` and `third` of harmonics to a tone of this amplitude, each relative to the fundamental: by an
    /// asymmetric force factor, and by a stiffening suspension, whose third harmonic is opposite to the fundamental.
    ///
    /// # Errors
    /// [`RigError::OutOfRange`]: no such coil.
    pub fn with_harmonics([second, third]: [f64; 2], amplitude: f64) -> Result<Self, RigError> {
        let mut coil = Self {
            force_factor: [2.0 * second / amplitude, 0.0],
            stiffness: [0.0, 4.0 * third / (amplitude * amplitude)],
        };
        // The quadratic term has a share in the third harmonic, and both change the fundamental.
        for _ in 0..STEPS {
            coil.check()?;
            let [is_second, is_third] = coil.harmonics(amplitude);
            coil.force_factor[0] += 2.0 * (second - is_second) / amplitude;
            coil.stiffness[1] += 4.0 * (third + is_third) / (amplitude * amplitude);
        }
        coil.check()?;
        Ok(coil)
    }

    pub(super) fn check(&self) -> Result<(), RigError> {
        for (field, value) in [
            ("coil.force_factor[0]", self.force_factor[0]),
            ("coil.force_factor[1]", self.force_factor[1]),
            ("coil.stiffness[0]", self.stiffness[0]),
            ("coil.stiffness[1]", self.stiffness[1]),
        ] {
            OutOfRange::check(field, value, COEFFICIENT)?;
        }
        Ok(())
    }

    /// The displacement of the coil, where a linear one would have the displacement `linear` (-1 to 1).
    #[must_use]
    pub fn displacement(&self, linear: f64) -> f64 {
        let ([b1, b2], [k1, k2]) = (self.force_factor, self.stiffness);
        (0..STEPS).fold(linear, |x, _| linear * (1.0 + x * (b1 + x * b2)) / (1.0 + x * (k1 + x * k2)))
    }

    /// The second and the third harmonic of a tone of this amplitude, over the fundamental; a negative sign is a harmonic of opposite
    /// phase.
    #[must_use]
    pub fn harmonics(&self, amplitude: f64) -> [f64; 2] {
        let turns = (0..PERIOD).map(|n| f64::from(n) / f64::from(PERIOD));
        let mut parts = [0.0; 3];
        for turn in turns {
            let x = self.displacement(amplitude * (TAU * turn).cos());
            for (part, order) in parts.iter_mut().zip(1..) {
                *part += x * (TAU * turn * f64::from(order)).cos();
            }
        }
        [parts[1] / parts[0], parts[2] / parts[0]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coil_of_given_harmonics_has_them_and_they_rise_with_the_level_and_its_square() {
        let coil = Coil::with_harmonics([0.01, 0.005], 0.8).unwrap();
        let [second, third] = coil.harmonics(0.8);
        assert!((second - 0.01).abs() < 1e-6 && (third + 0.005).abs() < 1e-6, "{second} {third}");
        let [half, quarter] = coil.harmonics(0.4);
        assert!(
            (half / second - 0.5).abs() < 0.03 && (quarter / third - 0.25).abs() < 0.02,
            "{half} {quarter}"
        );
        // Its own equation holds.
        for linear in [-1.0, -0.3, 0.0, 0.7, 1.0] {
            let x = coil.displacement(linear);
            let ([b1, _], [_, k2]) = (coil.force_factor, coil.stiffness);
            assert!((x * (1.0 + k2 * x * x) - linear * (1.0 + b1 * x)).abs() < 1e-12, "{linear}");
        }
        assert_eq!(
            Coil::default().displacement(0.37),
            0.37,
            "a linear coil moves as it is driven, to the last digit"
        );
    }

    #[test]
    fn a_coil_that_would_turn_its_force_is_refused_by_its_coefficient() {
        let refused = Coil::with_harmonics([0.3, 0.0], 0.8).unwrap_err().to_string();
        assert!(refused.contains("coil.force_factor[0]") && refused.contains("-0.4 to 0.4"), "{refused}");
    }
}
