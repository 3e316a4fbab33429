//! The wave impedance at the driven end.

use crate::definition::plate::Plate;
use std::f64::consts::TAU;

impl Plate {
    /// Wave impedance Z of the driven end at `frequency_hz`, N s/m: a wave of amplitude A on the centre line carries
    /// the power (1/2) Z omega^2 A^2 in the plate. (The air beside the plate carries the fraction 1 - d of the total
    /// power, with [`Plate::wave_loss_at`] = d [`Plate::wave_loss`].)
    ///
    /// Z = sigma v_g (integral of the width mode's square over z), with the mass per area sigma, the group speed
    /// v_g = d omega/d k at x = 0 and the width mode that is 1 on the centre line. It is T W k0/omega for a membrane of
    /// the tension T per metre, T (1 + 2 D K^2/T) W k0/omega for a film, and 2 W k0 sqrt(D rho h) for a thin supported
    /// plate. 0 if the wave cannot enter; `None` if the plate file does not state the membrane's tension or the sheet's
    /// thickness.
    pub fn wave_impedance_n_s_per_m(&self, frequency_hz: f64) -> Option<f64> {
        let surface_density = self.spec().model.surface_density("an impedance").ok()?;
        let width_mode = self.width_mode(1);
        let k0 = width_mode.wavenumber_squared(0.0, frequency_hz).max(0.0).sqrt();
        // d(k^2)/d omega: the factor of K, and that of the strip's law.
        let law = width_mode.at_frequency(frequency_hz).wavenumber_rise(0.0)
            / width_mode.axial_squared(frequency_hz);
        // At the same wavenumber and amplitude the forces in the plate are the same in air as in vacuum, at another
        // frequency.
        let surface_density = surface_density * (self.vacuum_frequency_hz(frequency_hz) / frequency_hz);
        let group_speed = 2.0 * k0 / (self.axial_rise(frequency_hz) * law);
        Some(
            surface_density
                * group_speed
                * width_mode.mode_square(0.0, frequency_hz)
                * self.swinging_half_width_m(0.0),
        )
    }

    /// The resistance at the driven end that absorbs its wave at `frequency_hz`, N s/m: Z where the end moves as its
    /// wave does; for a film T W k0/omega, as for the ideal membrane.
    pub(crate) fn matching_resistance_n_s_per_m(&self, frequency_hz: f64) -> Option<f64> {
        let impedance = self.wave_impedance_n_s_per_m(frequency_hz)?;
        let Some(square) = self.spec().model.film_square() else { return Some(impedance) };
        Some(impedance / (1.0 + 2.0 * square * self.wavenumber_squared(frequency_hz)))
    }

    /// d(a K^2)/d omega of the plate in vacuum, s/m^2, at the wavenumber that it has at `frequency_hz`; by a central
    /// difference, because K^2 is smooth in omega in every model.
    pub(crate) fn axial_rise(&self, frequency_hz: f64) -> f64 {
        let frequency_hz = self.vacuum_frequency_hz(frequency_hz);
        let model = &self.spec().model;
        let axial_squared =
            |frequency_hz: f64| model.width_slope(1) * model.wavenumber_squared(TAU * frequency_hz);
        let step = 1e-4;
        let rise = axial_squared(frequency_hz * (1.0 + step)) - axial_squared(frequency_hz * (1.0 - step));
        rise / (2.0 * step * TAU * frequency_hz)
    }
}
