//! The air's mass along a membrane, at one frequency.
//!
//! Where the plate is wide the wave is plane and its air that of an endless plane wave, alpha = 1; toward the turning point the
//! whole width swings in phase and carries more. With u = (q/sK)^2, s the half-width that turns and K that of the
//! turning point, where u is 1,
//!
//! ```text
//! alpha(u) = alpha_w + (alpha - alpha_w) S,   S = (1 + b) u^2/(1 + b u^2)
//! K(x)^2   = K_w^2 + (K^2 - K_w^2) S          the wave of alpha_w where the plate is wide
//! Omega    = 1 + m/(1 + m) (1/2 - d ln alpha/d ln k^2)   m = mu/sigma there; above a table -(d ln mu/d ln K)/2 for 1/2
//! ```
//! The power of a wave of amplitude f is T W k Omega omega |f|^2/2: that in the air beside that in the plate. Loss of the
//! stiffness takes eta K^2/Omega from k^2. What drives the plate meets the plate alone; the air takes its share of the power within
//! about 1/K. Of a film m/(1 + m) counts with the share of the stiffness in what sets K ([`super::free_wave`]), and its loss, too.

use super::air::AirLoad;

/// b: beyond the turning point alpha - alpha_w rises to (1 + b)/b of its value at the turning point.
const SATURATION: f64 = 0.5;
/// The most that the turning point's alpha is over that of a wide plate. With more a wave could turn twice.
const GROWTH_MAX: f64 = 2.5;

/// e to minus this is nothing beside 1.
const GONE: f64 = 40.0;

/// Mass of the air and wavenumber along a membrane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct AirAlong {
    /// K_w^2 and K^2, 1/m^2.
    pub(crate) wide: f64,
    pub(crate) turning: f64,
    /// m where the plate is wide.
    pub(crate) share: f64,
    /// alpha/alpha_w - 1 at the turning point.
    pub(crate) growth: f64,
    /// d ln K^2 by d ln of the stiffness in a vacuum: 1 of an ideal membrane, less of a film.
    pub(crate) stiffness: f64,
    /// -(d ln mu/d ln K)/2: a half in the open, more above a table.
    pub(crate) half_fall: f64,
}

/// The wave at one place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct InAir {
    /// K^2, 1/m^2.
    pub(crate) wavenumber_squared: f64,
    /// Omega.
    pub(crate) weight: f64,
    /// Loss factor of K^2 over that of the stiffness.
    pub(crate) loss_share: f64,
}

impl AirAlong {
    /// A wave whose K is the same all along.
    pub(crate) const fn uniform(wavenumber_squared: f64) -> Self {
        Self {
            wide: wavenumber_squared,
            turning: wavenumber_squared,
            share: 0.0,
            growth: 0.0,
            stiffness: 1.0,
            half_fall: 0.5,
        }
    }

    /// At a place whose (q/s)^2 is `width_square`, 1/m^2.
    #[inline(always)]
    pub(crate) fn at(&self, width_square: f64) -> InAir {
        let u = width_square / self.turning;
        let v = SATURATION * u * u;
        let rest = 1.0 / (1.0 + v);
        let settled = (1.0 + 1.0 / SATURATION) * v * rest;
        let alpha = 1.0 + self.growth * settled;
        let mass = self.share * alpha;
        let bend = 2.0 * self.growth * settled * rest / alpha;
        let weight = 1.0 + self.stiffness * mass / (1.0 + mass) * (self.half_fall + bend);
        InAir {
            wavenumber_squared: self.wide + (self.turning - self.wide) * settled,
            weight,
            loss_share: self.stiffness / weight,
        }
    }

    /// -d(k^2)/dx at the turning point over what it is where K does not change.
    pub(crate) fn fall_share(&self) -> f64 {
        1.0 - (1.0 - self.wide / self.turning) * 2.0 / (1.0 + SATURATION)
    }

    /// Omega as the driven end sees it: `at` of the place, and 1 at the end itself.
    pub(crate) fn weight_from_end(&self, width_square: f64, x: f64) -> f64 {
        let exponent = self.turning * x * x;
        let near = if exponent < GONE { (-exponent).exp() } else { 0.0 };
        1.0 + (self.at(width_square).weight - 1.0) * (1.0 - near)
    }
}

impl AirLoad {
    /// The load where the plate is wide, and alpha of this load over that, less 1.
    pub(crate) fn on_wide_plate(self) -> (Self, f64) {
        let growth = self.alpha().clamp(1.0, GROWTH_MAX) - 1.0;
        (self.over(1.0 + growth), growth)
    }
}

#[cfg(test)]
mod tests {
    use crate::definition::air::{Air, AirMounting, Faces, Gas};
    use crate::definition::plate::Plate;
    use crate::definition::presets::preset;
    use crate::definition::spec::PlateSpec;

    fn in_air(name: &str, alpha: f64) -> Plate {
        let mounting = AirMounting::Coefficient { alpha, faces: Faces::Two };
        let air = Some(Air::Around { gas: Gas::ROOM, mounting, gap_m: None });
        Plate::new(PlateSpec { air, ..preset(name).expect("a preset").spec().clone() }).expect("valid")
    }

    #[test]
    fn the_wave_has_the_coefficient_of_its_turning_point_and_1_where_the_plate_is_wide() {
        let (plate, wide) = (in_air("membrane", 2.0), in_air("membrane", 1.0));
        let (mode, frequency_hz) = (plate.width_mode(1), 150.0);
        let air = mode.air(frequency_hz).expect("a membrane in air");
        let turning = plate.wavenumber_squared(frequency_hz);
        let there = air.at(turning).wavenumber_squared;
        assert!((there / turning - 1.0).abs() < 1e-12 && mode.air(frequency_hz).is_some());
        let far = air.at(1e-9).wavenumber_squared;
        assert!((far / wide.wavenumber_squared(frequency_hz) - 1.0).abs() < 1e-12, "{far}");
        // k falls to 0 at the turning point and nowhere before, by the slope that kappa has.
        let x0 = plate.turning_point_m(frequency_hz).expect("enters");
        let k2 = |x: f64| mode.wavenumber_squared(x, frequency_hz);
        assert!((1..100).all(|i| k2(x0 * f64::from(i) / 100.0) > 0.0) && k2(x0 + 1e-3) < 0.0);
        let slope = (k2(x0 - 1e-5) - k2(x0 + 1e-5)) / 2e-5;
        let kappa = plate.kappa_per_m(frequency_hz).expect("enters");
        assert!((kappa.powi(3) / slope - 1.0).abs() < 1e-3, "{kappa} {slope}");
    }

    #[test]
    fn the_air_of_a_plane_wave_is_constant_along_the_plate() {
        let plate = in_air("membrane", 1.0);
        let air = plate.width_mode(1).air(150.0).expect("a membrane in air");
        for width_square in [10.0, 1e3, 1e5] {
            let here = air.at(width_square);
            assert!((here.wavenumber_squared / plate.wavenumber_squared(150.0) - 1.0).abs() < 1e-12);
            // The air's share of the power dilutes the loss.
            assert!((here.weight * plate.dilution(150.0) - 1.0).abs() < 1e-9, "{}", here.weight);
        }
        assert!(in_air("al-bending", 2.0).width_mode(1).air(30e3).is_none());
    }
}
