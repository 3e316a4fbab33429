//! The wave model: material, edge and local wavenumber.
//!
//! Every model uses the amplitude equation f'' + (W'/W) f' + k^2 f = 0 with k^2 = a (K^2 - (q/W)^2):
//!
//! | model | a | q (first width mode) | K |
//! |---|---|---|---|
//! | stretched membrane, SH wave, fixed edges | 1 | pi/2 | omega/V |
//! | thin plate in bending, simply supported edges | 1 | pi/2 | sqrt(omega) (rho h/D)^(1/4) |
//! | thin plate in bending, clamped edges | 1.81858 | 2.36502 | the same |
//!
//! A membrane with the stiffness of its film has K^2 (1 + (s K)^2) = (omega/V)^2, s^2 = D/T, and a smaller half-width: see
//! [`super::film`].
//!
//! With clamped edges this holds near the cut-off only; farther from it the exact law is
//! p tan p + r tanh r = 0 with p^2, r^2 = W^2 (K^2 -+ k^2), and a is its slope at k = 0.

use crate::definition::error::PlateError;
use crate::definition::film::Film;
use std::f64::consts::{FRAC_PI_2, PI};

/// Material, edge and wave of a plate.
#[derive(Debug, Clone, PartialEq)]
pub enum Model {
    /// A stretched membrane between fixed edges.
    Membrane {
        /// Wave speed sqrt(tension stress/density), m/s (0.1 to 20 000).
        wave_speed_m_per_s: f64,
        /// Tension T, N per metre of width (1e-9 to 1e13). With the wave speed it gives the surface density T/V^2. `None`
        /// if it is not known: then nothing that has a unit of force can be computed.
        tension_n_per_m: Option<f64>,
        /// The film's own stiffness, which needs the tension; `None` for an ideal membrane.
        film: Option<Film>,
    },
    /// The shear-horizontal wave of the paper, fixed edges: V = sqrt(mu/rho).
    ShearHorizontal {
        /// Shear modulus mu, Pa (100 to 1e12).
        shear_modulus_pa: f64,
        /// Density rho, kg/m^3 (1 to 30 000).
        density_kg_per_m3: f64,
        /// Thickness h, metres (1e-6 to 0.1); as the membrane's tension it may be unknown.
        thickness_m: Option<f64>,
    },
    /// A plate in bending, edges simply supported.
    BendingSupported(Bending),
    /// A plate in bending, edges clamped.
    BendingClamped(Bending),
}

/// An elastic plate in bending.
#[derive(Debug, Clone, PartialEq)]
pub struct Bending {
    /// Young's modulus E, Pa (1000 to 1e13).
    pub youngs_modulus_pa: f64,
    /// Poisson's ratio nu (0 to 0.499).
    pub poisson_ratio: f64,
    /// Density rho, kg/m^3 (1 to 30 000).
    pub density_kg_per_m3: f64,
    /// Thickness h, metres (1e-6 to 0.1).
    pub thickness_m: f64,
    /// Whether shear and rotary inertia are included (Mindlin, kappa^2 = pi^2/12) or not (Kirchhoff).
    pub thick_plate: bool,
}

impl Bending {
    /// Bending stiffness D = E h^3/(12 (1 - nu^2)), N m.
    pub fn stiffness_n_m(&self) -> f64 {
        self.youngs_modulus_pa * self.thickness_m.powi(3) / (12.0 * (1.0 - self.poisson_ratio.powi(2)))
    }

    /// sqrt(D/(rho h)), m^2/s. In a thin plate omega is this times kb^2.
    pub fn spread_m2_per_s(&self) -> f64 {
        (self.stiffness_n_m() / (self.density_kg_per_m3 * self.thickness_m)).sqrt()
    }

    /// The free plate's squared flexural wavenumber kb^2 at angular frequency `omega`, 1/m^2.
    ///
    /// Thin: omega/sqrt(D/rho h). Thick: the lower branch of Mindlin's relation,
    /// kb^2 = (omega^2/2)(1/cs^2 + 1/cp^2) + sqrt((omega^4/4)(1/cs^2 - 1/cp^2)^2 + omega^2 rho h/D)
    /// with cs^2 = kappa^2 G/rho and cp^2 = E/(rho (1 - nu^2)).
    pub fn wavenumber_squared(&self, omega: f64) -> f64 {
        let thin = omega / self.spread_m2_per_s();
        if !self.thick_plate {
            return thin;
        }
        let (shear, stretch) = self.thick_speeds_squared();
        let square = omega * omega;
        let half_difference = 0.5 * square * (1.0 / shear - 1.0 / stretch);
        0.5 * square * (1.0 / shear + 1.0 / stretch) + (half_difference.powi(2) + thin * thin).sqrt()
    }

    /// The inverse of [`Bending::wavenumber_squared`]: the angular frequency, rad/s, for kb^2 in 1/m^2.
    pub fn angular_frequency(&self, wavenumber_squared: f64) -> f64 {
        let spread = self.spread_m2_per_s();
        if !self.thick_plate {
            return spread * wavenumber_squared;
        }
        // Mindlin: (k^2 - w^2/cs^2)(k^2 - w^2/cp^2) = w^2/spread^2, a quadratic in w^2; the lower root is A0.
        let (shear, stretch) = self.thick_speeds_squared();
        let k2 = wavenumber_squared;
        let a = 1.0 / (shear * stretch);
        let b = k2 / shear + k2 / stretch + 1.0 / (spread * spread);
        let c = k2 * k2;
        (2.0 * c / (b + (b * b - 4.0 * a * c).max(0.0).sqrt())).sqrt()
    }

    fn thick_speeds_squared(&self) -> (f64, f64) {
        let shear_modulus = self.youngs_modulus_pa / (2.0 * (1.0 + self.poisson_ratio));
        let correction = PI * PI / 12.0;
        (
            correction * shear_modulus / self.density_kg_per_m3,
            self.youngs_modulus_pa / (self.density_kg_per_m3 * (1.0 - self.poisson_ratio.powi(2))),
        )
    }
}

/// q of the first width mode between clamped edges: half of the first root of cos(bL) cosh(bL) = 1.
const CLAMPED_FIRST: f64 = 2.365_020_372_431_352;

impl Model {
    /// Makes the wave `factor` times as fast.
    pub(crate) fn speed_up(&mut self, factor: f64) {
        match self {
            Self::Membrane { wave_speed_m_per_s, tension_n_per_m, .. } => {
                *wave_speed_m_per_s *= factor;
                if let Some(tension) = tension_n_per_m {
                    *tension *= factor * factor;
                }
            }
            Self::ShearHorizontal { shear_modulus_pa, .. } => *shear_modulus_pa *= factor * factor,
            // The phase speed omega/kb is proportional to the fourth root of the bending stiffness.
            Self::BendingSupported(bending) | Self::BendingClamped(bending) => {
                bending.youngs_modulus_pa *= factor.powi(4);
            }
        }
    }

    pub(crate) fn validate(&self) -> Result<(), PlateError> {
        self.film().map_or(Ok(()), |_| self.surface_density("the film's stiffness").map(drop))
    }

    /// Whether the edges neither move nor turn.
    #[must_use]
    pub fn is_clamped(&self) -> bool {
        matches!(self, Self::BendingClamped(_))
    }

    /// The material of a plate in bending; `None` for the other models.
    pub fn bending(&self) -> Option<&Bending> {
        match self {
            Self::BendingSupported(bending) | Self::BendingClamped(bending) => Some(bending),
            _ => None,
        }
    }

    /// The film of a membrane; `None` for an ideal membrane and the other models.
    pub fn film(&self) -> Option<&Film> {
        match self {
            Self::Membrane { film, .. } => film.as_ref(),
            _ => None,
        }
    }

    /// s^2 = D/T of a membrane with the stiffness of its film, m^2; `None` for all others.
    pub(crate) fn film_square(&self) -> Option<f64> {
        match self {
            Self::Membrane { tension_n_per_m: Some(tension), film: Some(film), .. } => {
                Some(film.stiffness_n_m() / tension)
            }
            _ => None,
        }
    }

    /// Wave speed of the membrane or the shear wave, m/s; `None` for bending and for a film with a stiffness of its own, whose
    /// speed depends on frequency.
    pub fn wave_speed_m_per_s(&self) -> Option<f64> {
        match self {
            Self::Membrane { film: Some(_), .. } => None,
            Self::Membrane { wave_speed_m_per_s, film: None, .. } => Some(*wave_speed_m_per_s),
            Self::ShearHorizontal { shear_modulus_pa, density_kg_per_m3, .. } => {
                Some((shear_modulus_pa / density_kg_per_m3).sqrt())
            }
            _ => None,
        }
    }

    /// Mass per area, kg/m^2: T/V^2 of a membrane, rho h of the others.
    ///
    /// # Errors
    /// [`PlateError::Missing`] if the plate file does not state the tension or the thickness; `needed_by` says what needs
    /// it ("a source").
    pub(crate) fn surface_density(&self, needed_by: &str) -> Result<f64, PlateError> {
        let missing = |field: &str, meaning: &str| PlateError::Missing {
            field: field.to_owned(),
            needed: format!("{needed_by} needs it: {meaning}"),
        };
        match self {
            Self::Membrane { wave_speed_m_per_s, tension_n_per_m, .. } => tension_n_per_m
                .map(|tension| tension / wave_speed_m_per_s.powi(2))
                .ok_or_else(|| missing("model.tension_n_per_m", "the force per metre of width, in N/m")),
            Self::ShearHorizontal { density_kg_per_m3, thickness_m, .. } => thickness_m
                .map(|thickness| density_kg_per_m3 * thickness)
                .ok_or_else(|| missing("model.thickness_m", "the thickness of the sheet, in m")),
            Self::BendingSupported(bending) | Self::BendingClamped(bending) => {
                Ok(bending.density_kg_per_m3 * bending.thickness_m)
            }
        }
    }

    /// K^2 (or kb^2) without loss at angular frequency `omega`, 1/m^2.
    pub fn wavenumber_squared(&self, omega: f64) -> f64 {
        match (self, self.wave_speed_m_per_s()) {
            (Self::BendingSupported(bending) | Self::BendingClamped(bending), _) => {
                bending.wavenumber_squared(omega)
            }
            (_, Some(speed)) => (omega / speed).powi(2),
            (Self::Membrane { wave_speed_m_per_s, .. }, None) => {
                let (squared, stiff) = ((omega / wave_speed_m_per_s).powi(2), self.film_square());
                // K^2 (1 + s^2 K^2) = squared; this form of the root does not cancel where s is small.
                2.0 * squared / (1.0 + (1.0 + 4.0 * stiff.unwrap_or(f64::NAN) * squared).sqrt())
            }
            (Self::ShearHorizontal { .. }, None) => f64::NAN,
        }
    }

    /// The inverse of [`Model::wavenumber_squared`], rad/s.
    pub fn angular_frequency(&self, wavenumber_squared: f64) -> f64 {
        match (self, self.wave_speed_m_per_s()) {
            (Self::BendingSupported(bending) | Self::BendingClamped(bending), _) => {
                bending.angular_frequency(wavenumber_squared)
            }
            (_, Some(speed)) => speed * wavenumber_squared.max(0.0).sqrt(),
            (Self::Membrane { wave_speed_m_per_s, .. }, None) => {
                let squared = wavenumber_squared.max(0.0);
                let stiff = self.film_square().unwrap_or(f64::NAN);
                wave_speed_m_per_s * (squared * (1.0 + stiff * squared)).sqrt()
            }
            (Self::ShearHorizontal { .. }, None) => f64::NAN,
        }
    }

    /// q of width mode `mode` (1 is the first, 0 counts as 1): the mode is cut off where K = q/W.
    pub fn width_number(&self, mode: u32) -> f64 {
        let mode = mode.max(1);
        match self {
            Self::BendingClamped(_) => clamped_root(mode),
            _ => FRAC_PI_2 * f64::from(mode),
        }
    }

    /// a of width mode `mode` (1 is the first, 0 counts as 1): k^2 = a (K^2 - (q/W)^2). It is 1 except for clamped
    /// edges.
    pub fn width_slope(&self, mode: u32) -> f64 {
        match self {
            Self::BendingClamped(_) => {
                // First-order perturbation of the clamped beam's mode: a = bL/(s (s bL - 2)) with bL = 2 q and
                // s = (cosh bL - cos bL)/(sinh bL - sin bL).
                let length = 2.0 * clamped_root(mode);
                let s = (length.cosh() - length.cos()) / (length.sinh() - length.sin());
                length / (s * (s * length - 2.0))
            }
            _ => 1.0,
        }
    }
}

/// Half of the m-th root of cos(bL) cosh(bL) = 1.
fn clamped_root(mode: u32) -> f64 {
    if mode <= 1 {
        return CLAMPED_FIRST;
    }
    // From the second root on, bL = (2m + 1) pi/2 is accurate to 1e-3, and four Newton steps give full precision.
    let mut root = (2.0 * f64::from(mode) + 1.0) * PI / 2.0;
    for _ in 0..4 {
        // cos(b) - 1/cosh(b) = 0
        let slope = -root.sin() + root.tanh() / root.cosh();
        root -= (root.cos() - 1.0 / root.cosh()) / slope;
    }
    0.5 * root
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definition::presets::preset;

    #[test]
    fn clamped_edges_have_the_slope_of_the_exact_law_at_the_cut_off() {
        let bending =
            preset("al-bending").expect("a preset").spec().model.bending().expect("bending").clone();
        let model = Model::BendingClamped(bending);
        let q = model.width_number(1);
        assert!((q * q.tan() + q * q.tanh()).abs() < 1e-12, "{q} is not at the cut-off");
        // p tan p + r tanh r = 0 with p^2, r^2 = q^2 + t -+ s, where s = (W k)^2 and t = W^2 K^2 - q^2: a is ds/dt.
        let residual = |s: f64, t: f64| {
            let (p, r) = ((q * q + t - s).sqrt(), (q * q + t + s).sqrt());
            p * p.tan() + r * r.tanh()
        };
        let h = 1e-4;
        let by_s = (residual(h, 0.0) - residual(-h, 0.0)) / (2.0 * h);
        let by_t = (residual(0.0, h) - residual(0.0, -h)) / (2.0 * h);
        let slope = model.width_slope(1);
        assert!((slope + by_t / by_s).abs() < 1e-6, "{slope} against {}", -by_t / by_s);
        assert!((slope - 1.818_58).abs() < 1e-4, "{slope}");
    }
}
