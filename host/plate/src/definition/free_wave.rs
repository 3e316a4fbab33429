//! The free wave of a plate: K over the frequency, with the air that it carries and the loss.
//!
//! With omega_v(K) of the plate in vacuum and mu/sigma by [`AirLoad`], the inertia grows and the stiffness stays:
//!
//! ```text
//! omega(K)^2 (1 + mu(K)/sigma) = omega_v(K)^2,   mu = faces alpha g rho/K
//! membrane  T K^2 = omega^2 (sigma + mu)          bending  D K^4 = omega^2 (sigma + mu)
//! film      T K^2 + D K^4 = omega^2 (sigma + mu)
//! ```
//! mu falls with K, so omega rises with K and each has one K. At equal frequency K changes by less than in vacuum where the
//! stiffness changes: by the share d = s_v/(d ln omega/d ln K^2), with s_v of the plate in vacuum (1/2 of a membrane, 1 of
//! a thin plate, between them of a film). So the loss of K^2 is that of the plate in vacuum times d, and the air carries the share 1 - d of a
//! wave's power. Without air every number here is that of the model, to the last bit.

use super::air::AirLoad;
use super::air_along::AirAlong;
use super::model::Model;
use super::plate::Plate;
use super::spec::PlateSpec;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Steps of Newton's method: four or five for most plates; more where shear and rotary inertia bend the law.
const STEPS_MAX: usize = 60;

/// The wave of a model with its air.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FreeWave<'a> {
    pub(crate) model: &'a Model,
    pub(crate) load: Option<AirLoad>,
}

impl FreeWave<'_> {
    /// K^2 without loss at the angular frequency `omega`, 1/m^2.
    pub(crate) fn wavenumber_squared(&self, omega: f64) -> f64 {
        let vacuum = self.model.wavenumber_squared(omega);
        if self.load.is_none() || vacuum.is_nan() || vacuum <= 0.0 {
            return vacuum;
        }
        let mut log = vacuum.ln();
        for _ in 0..STEPS_MAX {
            let square = log.exp();
            let (share, fall) = self.share(square);
            let rise = 2.0 * self.slope(square) - 0.5 * fall * share / (1.0 + share);
            let step = (2.0 * (omega / self.angular_frequency(square)).ln()) / rise;
            log += step;
            if step.abs() < 1e-15 {
                break;
            }
        }
        log.exp()
    }

    /// The inverse of [`FreeWave::wavenumber_squared`], rad/s.
    pub(crate) fn angular_frequency(&self, wavenumber_squared: f64) -> f64 {
        let vacuum = self.model.angular_frequency(wavenumber_squared);
        if self.load.is_none() {
            return vacuum;
        }
        vacuum / (1.0 + self.share(wavenumber_squared).0).sqrt()
    }

    /// The angular frequency that the plate has in vacuum for K = `wavenumber`, if it has `omega` in the air.
    pub(crate) fn vacuum_of(&self, omega: f64, wavenumber: f64) -> f64 {
        if self.load.is_none() {
            return omega;
        }
        omega * (1.0 + self.share(wavenumber * wavenumber).0).sqrt()
    }

    /// The share d of the text above at `omega`; 1 without air.
    pub(crate) fn dilution(&self, omega: f64) -> f64 {
        if self.load.is_none() {
            return 1.0;
        }
        let squared = self.wavenumber_squared(omega);
        let (share, fall) = self.share(squared);
        (1.0 - 0.25 * fall * share / (self.slope(squared) * (1.0 + share))).recip()
    }

    /// d ln K^2 by d ln of the stiffness in vacuum over that of an ideal membrane, at `omega`: 1 to 1/2 of a film, as its
    /// tension or its bending carries the wave; `None` for what is no film.
    pub(crate) fn film_share(&self, omega: f64) -> Option<f64> {
        self.model.film_square()?;
        Some(0.5 / self.slope(self.wavenumber_squared(omega)))
    }

    /// The wave's course along a membrane at `omega`; `None` where K is the same all along: on plates in bending, and without
    /// air.
    pub(crate) fn along(&self, omega: f64) -> Option<AirAlong> {
        let (Model::Membrane { .. }, Some(load)) = (self.model, self.load) else { return None };
        let (wide_load, growth) = load.on_wide_plate();
        let wide_wave = Self { load: Some(wide_load), ..*self };
        let wide = wide_wave.wavenumber_squared(omega);
        let turning = self.wavenumber_squared(omega);
        let (share, stiffness) = (wide_wave.share(wide).0, 0.5 / self.slope(turning));
        let half_fall = load.half_fall(wide.sqrt());
        Some(AirAlong { wide, turning, share, growth, stiffness, half_fall })
    }

    /// mu over sigma at K^2, and d ln mu/d ln K.
    fn share(&self, wavenumber_squared: f64) -> (f64, f64) {
        let Some(load) = &self.load else { return (0.0, -1.0) };
        let vacuum = self.model.angular_frequency(wavenumber_squared);
        load.share(wavenumber_squared.sqrt(), vacuum, 2.0 * self.slope(wavenumber_squared))
    }

    /// d ln omega/d ln K^2 in vacuum at K^2, of a thin plate.
    fn slope(&self, wavenumber_squared: f64) -> f64 {
        match (self.model.bending(), self.model.film_square()) {
            (Some(_), _) => 1.0,
            (None, None) => 0.5,
            (None, Some(stiff)) => {
                let bent = stiff * wavenumber_squared;
                0.5 * (1.0 + 2.0 * bent) / (1.0 + bent)
            }
        }
    }
}

impl PlateSpec {
    /// The free wave of a valid specification.
    pub(crate) fn free_wave(&self) -> FreeWave<'_> {
        FreeWave { model: &self.model, load: AirLoad::of(self.air.as_ref(), &self.model) }
    }
}

impl Plate {
    /// The plate's free wave.
    pub(crate) fn free_wave(&self) -> FreeWave<'_> {
        FreeWave { model: &self.spec().model, load: self.air_load }
    }

    /// Whether air swings with the plate.
    pub fn carries_air(&self) -> bool {
        self.air_load.is_some()
    }

    /// K^2 of the plate's free wave with its air, without loss, at `frequency_hz`, 1/m^2.
    pub fn wavenumber_squared(&self, frequency_hz: f64) -> f64 {
        self.free_wave().wavenumber_squared(TAU * frequency_hz)
    }

    /// eta of the amplitude equation at `frequency_hz`: [`Plate::wave_loss`] times the share of the stiffness in what sets
    /// the wavenumber, which air makes less than 1, and the bending of a film.
    pub fn wave_loss_at(&self, frequency_hz: f64) -> f64 {
        let loss = self.sheet_loss_at(frequency_hz);
        self.free_wave().film_share(TAU * frequency_hz).map_or(loss, |share| loss * share)
    }

    /// eta of the stiffness that has the loss of [`Plate::wave_loss_at`] where the air is a mass that does not depend on K.
    pub(crate) fn sheet_loss_at(&self, frequency_hz: f64) -> f64 {
        self.stiffness_loss_at(frequency_hz) * self.dilution(frequency_hz)
    }

    /// The frequency at which the plate in vacuum has the wavenumber that it has in its air at `frequency_hz`, Hz. What is
    /// elastic in the plate depends on the wavenumber, so it is that of vacuum at this frequency.
    pub(crate) fn vacuum_frequency_hz(&self, frequency_hz: f64) -> f64 {
        let wave = self.free_wave();
        let omega = TAU * frequency_hz;
        if wave.load.is_none() {
            return frequency_hz;
        }
        wave.vacuum_of(omega, wave.wavenumber_squared(omega).sqrt()) / TAU
    }

    /// 1 + j eta, the factor of K^2 by loss at `frequency_hz`.
    pub(crate) fn lossy(&self, frequency_hz: f64) -> Complex64 {
        Complex64::new(1.0, self.wave_loss_at(frequency_hz))
    }

    /// 1 + j eta of the plate's own stiffness at a frequency; without loss it is 1.
    pub(crate) fn lossy_compliance(&self, frequency_hz: f64) -> Complex64 {
        Complex64::new(1.0, self.stiffness_loss_at(frequency_hz))
    }

    /// By how much a change of the stiffness changes K at `frequency_hz`, over the same in vacuum.
    pub(crate) fn dilution(&self, frequency_hz: f64) -> f64 {
        self.free_wave().dilution(TAU * frequency_hz)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definition::air::{Air, AirMounting, Faces, Gas};
    use crate::definition::presets::preset;

    fn air(alpha: f64) -> Air {
        let gas = Gas::Given { density_kg_per_m3: 1.2, sound_speed_m_per_s: 343.0 };
        Air::Around { gas, mounting: AirMounting::Coefficient { alpha, faces: Faces::Two }, gap_m: None }
    }

    fn models() -> Vec<Model> {
        let named = |name: &str| preset(name).expect("a preset").spec().model.clone();
        let thin = named("al-bending");
        let mut film = thin.bending().expect("bending").clone();
        film.thickness_m = 1e-4;
        let mut thick = film.clone();
        (thick.thickness_m, thick.thick_plate) = (5e-3, true);
        vec![
            named("membrane"),
            named("membrane-heavy"),
            thin,
            Model::BendingClamped(film),
            Model::BendingSupported(thick),
        ]
    }

    #[test]
    fn wavenumber_and_frequency_are_each_others_inverse_and_rise_together() {
        for model in models() {
            for alpha in [0.0, 1.3, 10.0] {
                let wave = FreeWave { model: &model, load: AirLoad::of(Some(&air(alpha)), &model) };
                let mut before = 0.0;
                for i in 0..60 {
                    let omega = 10.0 * 1.25_f64.powi(i);
                    let square = wave.wavenumber_squared(omega);
                    let back = wave.angular_frequency(square);
                    assert!((back / omega - 1.0).abs() < 1e-13, "{model:?} {alpha} {omega}: {back}");
                    assert!(square > before && square >= model.wavenumber_squared(omega) * (1.0 - 1e-12));
                    before = square;
                }
            }
        }
    }

    #[test]
    fn a_membrane_meets_the_cubic_of_its_air_and_the_limits_of_light_and_heavy() {
        let membrane = |tension: f64, speed: f64| Model::Membrane {
            wave_speed_m_per_s: speed,
            tension_n_per_m: Some(tension),
            film: None,
        };
        let (omega, alpha, density) = (TAU * 100.0, 1.9, 1.2);
        for (tension, speed) in [(40.0, 12.0), (400.0, 12.0), (40.0, 60.0)] {
            let model = membrane(tension, speed);
            let wave = FreeWave { model: &model, load: AirLoad::of(Some(&air(alpha)), &model) };
            let k = wave.wavenumber_squared(omega).sqrt();
            let g = 1.0 / (1.0 + (speed / (HALF * 343.0)).powi(3));
            let inertia = tension / (speed * speed) + 2.0 * alpha * density * g / k;
            assert!((tension * k * k / (omega * omega * inertia) - 1.0).abs() < 1e-12, "{tension} {speed}");
        }
        // Without a mass of its own, K^3 = 2 alpha rho omega^2/T; with a large one, that of vacuum.
        let light = membrane(1e-3, 100.0);
        let wave = FreeWave { model: &light, load: AirLoad::of(Some(&air(alpha)), &light) };
        let k = wave.wavenumber_squared(omega).sqrt();
        let g = 1.0 / (1.0 + (100.0 / (HALF * 343.0_f64)).powi(3));
        let limit = (2.0 * alpha * density * g * omega * omega / 1e-3).cbrt();
        assert!((k / limit - 1.0).abs() < 1e-3, "{k} {limit}");
        let heavy = membrane(1e9, 12.0);
        let wave = FreeWave { model: &heavy, load: AirLoad::of(Some(&air(alpha)), &heavy) };
        assert!((wave.wavenumber_squared(omega).sqrt() * 12.0 / omega - 1.0).abs() < 1e-6);
    }

    /// Speed over that of sound at which half of the mass is left.
    const HALF: f64 = 0.65;

    #[test]
    fn a_timpani_head_without_its_kettle_has_the_measured_ratios_within_5_percent() {
        // T. D. Rossing, Acoustics of Timpani, Percussionist 19(3), 1982: modes (1,1) to (5,1) of a head of 26 inch without
        // its kettle, over (1,1). They are K = j_m1/radius; the head is polyester of 0.2 mm.
        let ratios = [1.48, 1.92, 2.36, 2.78];
        let zeros = [3.831_71, 5.135_62, 6.380_16, 7.588_34, 8.771_48];
        let (radius_m, speed, density) = (0.33, 110.0, 1390.0 * 0.2e-3);
        let model = Model::Membrane {
            wave_speed_m_per_s: speed,
            tension_n_per_m: Some(density * speed * speed),
            film: None,
        };
        let ratio = |air: Option<&Air>, mode: usize| {
            let wave = FreeWave { model: &model, load: AirLoad::of(air, &model) };
            let omega = |zero: f64| wave.angular_frequency((zero / radius_m).powi(2));
            omega(zeros[mode]) / omega(zeros[0])
        };
        for (mode, measured) in (1..).zip(ratios) {
            let (found, still) = (ratio(Some(&Air::ROOM), mode), ratio(None, mode));
            assert!((found / measured - 1.0).abs() < 0.05, "({}, 1): {found} for {measured}", mode + 1);
            assert!(still / measured < 0.91, "{still}");
        }
    }

    #[test]
    fn the_dilution_matches_a_change_of_the_stiffness() {
        for model in models().into_iter().take(4) {
            let load = AirLoad::of(Some(&air(1.9)), &model);
            for omega in [600.0, 6e3, 6e4] {
                let k = |model: &Model| FreeWave { model, load }.wavenumber_squared(omega).ln();
                let in_vacuum = |model: &Model| model.wavenumber_squared(omega).ln();
                let mut stiffer = model.clone();
                match &mut stiffer {
                    Model::Membrane { wave_speed_m_per_s, .. } => *wave_speed_m_per_s *= 1.0 + 1e-5,
                    Model::BendingSupported(it) | Model::BendingClamped(it) => {
                        it.youngs_modulus_pa *= 1.0 + 1e-5;
                    }
                    Model::ShearHorizontal { .. } => {}
                }
                let found = (k(&stiffer) - k(&model)) / (in_vacuum(&stiffer) - in_vacuum(&model));
                // Where the wave is not slow against sound, the stiffness also changes g.
                let wanted = FreeWave { model: &model, load }.dilution(omega);
                assert!((found / wanted - 1.0).abs() < 0.01, "{model:?} {omega}: {found} {wanted}");
                assert!(wanted <= 1.0 && wanted > 2.0 / 3.0, "{wanted}");
            }
        }
    }
}
