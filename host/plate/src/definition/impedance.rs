//! A mechanical impedance: of a driven end, a damper or a fingertip.

use crate::definition::limits;
use crate::quantity::Range;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// A mechanical impedance, force over velocity: Z = R - j omega m + j s/omega with time as e^(-j omega t), in N s/m.
///
/// ```
/// use slipline_plate::Impedance;
///
/// let coil = Impedance { resistance_n_s_per_m: 0.15, mass_kg: 1e-3, stiffness_n_per_m: 600.0 };
/// // At its resonance mass and stiffness cancel.
/// let resonance_hz = (600.0_f64 / 1e-3).sqrt() / std::f64::consts::TAU;
/// assert!((coil.at_n_s_per_m(resonance_hz) - 0.15).norm() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Impedance {
    /// Resistance R, N s/m (0 to 1e9).
    pub resistance_n_s_per_m: f64,
    /// Moving mass m, kg (0 to 1000).
    pub mass_kg: f64,
    /// Stiffness s against the frame, N/m (0 to 1e12).
    pub stiffness_n_per_m: f64,
}

impl Impedance {
    /// A damper of the resistance R in N s/m, without mass and spring.
    #[must_use]
    pub const fn damper(resistance_n_s_per_m: f64) -> Self {
        Self { resistance_n_s_per_m, mass_kg: 0.0, stiffness_n_per_m: 0.0 }
    }

    /// Z at `frequency_hz`, N s/m.
    #[must_use]
    pub fn at_n_s_per_m(&self, frequency_hz: f64) -> Complex64 {
        let omega = TAU * frequency_hz;
        Complex64::new(self.resistance_n_s_per_m, self.stiffness_n_per_m / omega - omega * self.mass_kg)
    }

    /// Force per deflection at angular frequency `omega`: -j omega Z = s - omega^2 m - j omega R, N/m.
    pub(crate) fn dynamic_stiffness(&self, omega: f64) -> Complex64 {
        let elastic = self.stiffness_n_per_m - omega * omega * self.mass_kg;
        Complex64::new(elastic, -omega * self.resistance_n_s_per_m)
    }

    /// Whether all three are zero.
    pub(crate) fn is_nothing(&self) -> bool {
        *self == Self::default()
    }

    /// Each field's name, value and range.
    pub(crate) fn fields(&self) -> [(&'static str, f64, Range); 3] {
        [
            ("resistance_n_s_per_m", self.resistance_n_s_per_m, limits::MECHANICAL_RESISTANCE),
            ("mass_kg", self.mass_kg, limits::MOVING_MASS),
            ("stiffness_n_per_m", self.stiffness_n_per_m, limits::END_STIFFNESS),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_dynamic_stiffness_is_the_impedance_times_the_velocity_of_a_deflection() {
        let impedance = Impedance { resistance_n_s_per_m: 3.0, mass_kg: 2e-3, stiffness_n_per_m: 5e4 };
        for frequency_hz in [20.0, 700.0, 30e3] {
            let omega = TAU * frequency_hz;
            // v = -j omega w.
            let found = impedance.dynamic_stiffness(omega);
            let wanted = Complex64::new(0.0, -omega) * impedance.at_n_s_per_m(frequency_hz);
            assert!((found / wanted - 1.0).norm() < 1e-12, "{frequency_hz}: {found} {wanted}");
        }
        // The force of a mass is -omega^2 m per deflection; that of a damper opposes the velocity.
        let mass = Impedance { mass_kg: 1.0, ..Impedance::default() };
        assert_eq!(mass.dynamic_stiffness(2.0), Complex64::new(-4.0, 0.0));
        assert_eq!(Impedance::damper(3.0).at_n_s_per_m(10.0), Complex64::from(3.0));
        assert!(Impedance::default().is_nothing() && !mass.is_nothing());
    }
}
