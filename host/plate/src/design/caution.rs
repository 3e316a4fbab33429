//! What a finished design does on a table that no light shows: a stretched film as a thermometer, a finger that sinks in.
//!
//! A film between stiff frames is stretched in both directions, so its strain is T (1 - nu)/(E h). One kelvin changes the
//! tension by E h/(1 - nu) times the difference of the expansions of frame and film; the boundary at the middle of the span of a
//! plate with that tension lies elsewhere. (With nothing but the tension it would move by (dT/T)/(2 d) with the taper's rate d,
//! since c^2 is proportional to T; the film's own stiffness and the air hold it back.) Rubber is no such film: its tension comes from its
//! entropy and its strain is some per cent.
//!
//! A static force F on a contact of radius r sinks into a membrane of half-width R by F/(2 pi T) ln(R/r) (Green's function of
//! a membrane that is held on a circle).

use super::Design;
use crate::definition::model::Model;
use crate::definition::plate::Plate;
use crate::quantity::number_format::significant;
use crate::quantity::show_length;
use std::f64::consts::TAU;

/// Strain below which temperature counts.
const STRAIN: f64 = 3e-3;
/// Difference of the thermal expansions of film and frame, 1/K: polyester (17 ppm) in aluminium (23 ppm).
const EXPANSION_PER_K: f64 = 6e-6;
/// The change of temperature whose shift is computed, kelvin: small against the stretch of any film.
const KELVIN: f64 = 1e-3;
/// Boundary shift per kelvin below which nothing is said, metres.
const SHIFT_M: f64 = 5e-4;
/// Tension below which a finger's press counts, N/m; its force, N, and the radius of its contact, metres.
const SLACK_N_PER_M: f64 = 100.0;
const PRESS_N: f64 = 0.5;
const CONTACT_RADIUS_M: f64 = 5e-3;

impl Design {
    /// Strain of the stretched film, and the shift of a boundary by one kelvin, metres; `None` for a plate that is no stretched
    /// film.
    #[must_use]
    pub fn strain(&self) -> Option<(f64, f64)> {
        let Model::Membrane { tension_n_per_m: Some(tension), film: Some(film), .. } =
            &self.plate.spec().model
        else {
            return None;
        };
        let stiffness = film.youngs_modulus_pa * film.thickness_m / (1.0 - film.poisson_ratio);
        let strain = tension / stiffness;
        let boundary_m = self.middle_m();
        let hertz = self.plate.frequency_for_boundary_hz(boundary_m);
        let mut warm = self.plate.spec().clone();
        if let Model::Membrane { wave_speed_m_per_s, tension_n_per_m: Some(tension), .. } = &mut warm.model {
            let more = KELVIN * EXPANSION_PER_K / strain;
            *tension *= 1.0 + more;
            *wave_speed_m_per_s *= (1.0 + more).sqrt();
        }
        let warm_m = Plate::new(warm).ok()?.turning_point_m(hertz)?;
        Some((strain, (boundary_m - warm_m).abs() / KELVIN))
    }

    /// The middle of the span, metres.
    fn middle_m(&self) -> f64 {
        0.5 * (self.low.boundary_m + self.high.boundary_m)
    }

    /// The static deflection under a finger that presses with 0.5 N at the middle of the span, metres; `None` for a plate that
    /// is no membrane.
    #[must_use]
    pub fn press_m(&self) -> Option<f64> {
        let spread = (self.plate.half_width_m(self.middle_m()) / CONTACT_RADIUS_M).max(1.0).ln();
        self.tension_n_per_m.map(|tension| PRESS_N / (TAU * tension) * spread)
    }

    /// What to know before it is built, in sentences; `None` where there is nothing.
    #[must_use]
    pub fn caution(&self) -> Option<String> {
        let warm = self.strain().filter(|(strain, shift_m)| *strain < STRAIN && *shift_m > SHIFT_M).map(
            |(strain, shift_m)| {
                format!(
                    "This film is stretched by {} ppm alone and is a thermometer: in a frame that expands by 6 ppm per kelvin \
                     more or less than it, one kelvin moves the boundary by {}. Take a thinner film, a faster wave, or rubber.",
                    significant(1e6 * strain, 2),
                    show_length(shift_m)
                )
            },
        );
        let is_slack = self.tension_n_per_m.is_some_and(|tension| tension < SLACK_N_PER_M);
        let soft = self.press_m().filter(|_| is_slack).map(|press_m| {
            format!(
                "A finger that presses with 0.5 N sinks in by {}, which stretches the sheet and moves the boundary: stroke it, or \
                 take more tension.",
                show_length(press_m)
            )
        });
        let both: Vec<String> = [warm, soft].into_iter().flatten().collect();
        (!both.is_empty()).then(|| both.join(" "))
    }
}
