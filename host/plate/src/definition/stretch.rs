//! What moves a stretched sheet after its frame has stretched it: temperature, humidity, age, and a finger that presses.
//!
//! A film between stiff frames is stretched in both directions, so its strain is T (1 - nu)/(E h). One kelvin changes the tension by
//! E h/(1 - nu) times the difference of the expansions of frame and film, dT/T = (a_frame - a_film)/strain; with nothing but the
//! tension a boundary moves by (dT/T)/(2 d), since c^2 is proportional to T. The film's own stiffness and the air hold it back.
//!
//! The tension of rubber comes from its entropy. Stretched to lambda both ways it is proportional to the absolute temperature and to
//! lambda^2 - lambda^-4 of a sheet that expands itself, by b per kelvin:
//!
//! ```text
//! d ln T/d temperature = 1/293 K - b (2 lambda^2 + 4 lambda^-4)/(lambda^2 - lambda^-4)
//! ```
//! A static force F on a contact of radius r sinks into a membrane of half-width R by F/(2 pi T) ln(R/r) (Green's function of
//! a membrane that is held on a circle).

use super::film::Film;
use super::model::Model;
use super::plate::Plate;
use std::f64::consts::TAU;

/// Young's modulus up to which a film is rubber, and from which on it is no plastic, Pa.
const RUBBER_PA: f64 = 1e8;
const PLASTIC_PA: f64 = 2e10;
/// Difference of the thermal expansions of film and frame, 1/K: polyester (17 ppm, DuPont Teijin's table of Mylar) in aluminium
/// (23 ppm).
pub(crate) const EXPANSION_PER_K: f64 = 6e-6;
/// Linear expansion of natural rubber, 1/K: a handbook's value.
const RUBBER_EXPANSION_PER_K: f64 = 2.2e-4;
/// Room temperature, kelvin.
const ROOM_K: f64 = 293.0;
/// Strain of a plastic film by 10 % of humidity: 8 ppm per %, from memory, no source.
const HUMID: f64 = 80e-6;
/// The kelvins that do as much.
pub(crate) const HUMID_K: f64 = HUMID / EXPANSION_PER_K;
/// Share of its tension that rubber loses while its age grows tenfold: 2 to 5 % from memory. Its law, a loss by the logarithm of
/// time, is that of A. Gent, Rubber Chem. Technol. 36, 697 (1963).
const RELAXES: f64 = 0.03;
/// The change of tension whose shift is computed: small against it.
const SMALL: f64 = 1e-4;
/// A finger's press, N, and the radius of its contact, metres. No source: round values.
pub(crate) const PRESS_N: f64 = 0.5;
const CONTACT_RADIUS_M: f64 = 5e-3;

/// How far a boundary moves, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Drift {
    /// Strain of the film; `None` of an ideal membrane.
    pub(crate) strain: Option<f64>,
    /// By one kelvin; `None` of an ideal membrane.
    pub(crate) kelvin_m: Option<f64>,
    /// Whether humidity swells it: a plastic film.
    pub(crate) swells: bool,
    /// While the sheet's age grows tenfold; `None` of a film that is no rubber.
    pub(crate) decade_m: Option<f64>,
}

impl Film {
    fn is_rubber(&self) -> bool {
        self.youngs_modulus_pa < RUBBER_PA
    }
}

impl Plate {
    /// What moves the boundary at `boundary_m` of a membrane; `None` of a plate without tension.
    pub(crate) fn drift(&self, boundary_m: f64) -> Option<Drift> {
        let Model::Membrane { tension_n_per_m, film, .. } = &self.spec().model else { return None };
        let shift_m = self.shift_by_tension_m(boundary_m);
        // By a change of the tension, as a share of it.
        let by = |share: f64| shift_m.map(|shift_m| (shift_m * share).abs());
        let stiffness = |film: &Film| film.youngs_modulus_pa * film.thickness_m / (1.0 - film.poisson_ratio);
        let strained =
            film.as_ref().zip(*tension_n_per_m).map(|(film, tension)| (film, tension / stiffness(film)));
        Some(Drift {
            strain: strained.map(|(_, strain)| strain),
            kelvin_m: strained.and_then(|(film, strain)| {
                by(if film.is_rubber() { rubber_per_kelvin(strain) } else { EXPANSION_PER_K / strain })
            }),
            swells: strained
                .is_some_and(|(film, _)| (RUBBER_PA..PLASTIC_PA).contains(&film.youngs_modulus_pa)),
            decade_m: if strained.is_none_or(|(film, _)| film.is_rubber()) { by(RELAXES) } else { None },
        })
    }

    /// Shift of a boundary over the change of the tension as a share of it, metres.
    fn shift_by_tension_m(&self, boundary_m: f64) -> Option<f64> {
        let hertz = self.frequency_for_boundary_hz(boundary_m);
        let mut tighter = self.spec().clone();
        if let Model::Membrane { wave_speed_m_per_s, tension_n_per_m, .. } = &mut tighter.model {
            *wave_speed_m_per_s *= (1.0 + SMALL).sqrt();
            if let Some(tension) = tension_n_per_m {
                *tension *= 1.0 + SMALL;
            }
        }
        let there_m = Self::with_any_band(tighter).ok()?.turning_point_m(hertz)?;
        Some((there_m - boundary_m) / SMALL)
    }

    /// The static deflection under a finger that presses with 0.5 N at `x`, metres; `None` of what is no membrane of a stated
    /// tension.
    pub(crate) fn press_m(&self, x: f64) -> Option<f64> {
        let Model::Membrane { tension_n_per_m: Some(tension), .. } = self.spec().model else { return None };
        let spread = (self.half_width_m(x) / CONTACT_RADIUS_M).max(1.0).ln();
        Some(PRESS_N / (TAU * tension) * spread)
    }
}

/// d ln T/d temperature of rubber that is stretched by this strain both ways, 1/K.
fn rubber_per_kelvin(strain: f64) -> f64 {
    let square = (1.0 + strain).powi(2);
    let thin = square.powi(-2);
    1.0 / ROOM_K - RUBBER_EXPANSION_PER_K * (2.0 * square + 4.0 * thin) / (square - thin)
}
