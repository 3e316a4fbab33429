//! A finger on the plate: a mechanical impedance at a place on the centre line.
//!
//! ```text
//! Finger -> respond_touched, predict_envelope: the plate's own field plus that of the finger's force         (touch)
//!                                              the near field of that force                                  (contact)
//! a sensor that weighs -> what it leaves of the motion under it, for every driven end                     (receptance)
//! ```
//!
//! The finger moves with the plate under it and exerts the force F = -Z v, Z = R - j omega m, where v is the velocity
//! under its contact, a square of side a. It acts locally, with the same impedance per area Z/a^2 everywhere in the
//! contact. All values are illustrative: fingers differ, and one finger differs from minute to minute.

mod contact;
mod receptance;
mod touch;

use super::error::RespondError;
use crate::definition::impedance::Impedance;
use crate::definition::limits;
use crate::definition::plate::Plate;
use crate::quantity::{OutOfRange, Range};

pub(crate) use receptance::{Receptance, Receptances, receptances};
pub(crate) use touch::{share_left, solve_each_touched, touched};

/// Side of the contact of a fingertip, metres.
pub(crate) const CONTACT_M: f64 = 0.01;

/// A finger that rests on the plate.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Finger {
    /// Middle of the contact on the centre line, metres from the driven end (0 to the plate's length).
    pub place_m: f64,
    /// Damping R, N s/m (0 to 1e9).
    pub resistance_n_s_per_m: f64,
    /// Mass m that moves with the plate, kg (0 to 1000).
    pub mass_kg: f64,
    /// Side a of the square contact, metres (0.0005 to 0.1).
    pub contact_m: f64,
}

impl Finger {
    /// A light touch, as of a finger that strokes: 0.1 N s/m, 0.01 g. Illustrative.
    pub fn light(place_m: f64) -> Self {
        Self { place_m, resistance_n_s_per_m: 0.1, mass_kg: 1e-5, contact_m: CONTACT_M }
    }

    /// A firm press: 1 N s/m, 0.1 g. Illustrative.
    pub fn firm(place_m: f64) -> Self {
        Self { place_m, resistance_n_s_per_m: 1.0, mass_kg: 1e-4, contact_m: CONTACT_M }
    }

    /// Its mechanical impedance R - j omega m.
    pub fn impedance(&self) -> Impedance {
        let Self { resistance_n_s_per_m, mass_kg, .. } = *self;
        Impedance { resistance_n_s_per_m, mass_kg, stiffness_n_per_m: 0.0 }
    }

    /// Load of the finger on the plate's wave: |Z| over the wave impedance at the driven end, at `frequency_hz`.
    ///
    /// A finger of much less than 1 hardly changes the wave; one of more than 1 lowers the peak.
    ///
    /// # Errors
    /// [`RespondError::Unstated`] if the plate file does not state the inputs of the wave impedance.
    pub fn load(&self, plate: &Plate, frequency_hz: f64) -> Result<f64, RespondError> {
        plate.spec().model.surface_density("a finger").map_err(RespondError::Unstated)?;
        let wave = plate.wave_impedance_n_s_per_m(frequency_hz).unwrap_or(f64::NAN);
        Ok(self.impedance().at_n_s_per_m(frequency_hz).norm() / wave)
    }

    /// Refuses fields out of range, and a plate whose file does not state its surface density.
    pub(crate) fn check(&self, plate: &Plate) -> Result<(), RespondError> {
        let places = Range::new(0.0, plate.length_m(), "m");
        OutOfRange::check("finger place", self.place_m, places)?;
        let resistances = limits::MECHANICAL_RESISTANCE;
        OutOfRange::check("finger resistance", self.resistance_n_s_per_m, resistances)?;
        OutOfRange::check("finger mass", self.mass_kg, limits::MOVING_MASS)?;
        OutOfRange::check("finger contact", self.contact_m, limits::CONTACT)?;
        plate.spec().model.surface_density("a finger").map(drop).map_err(RespondError::Unstated)
    }

    /// Extent of the contact to each side of the centre line at `x`, metres: at most the plate's half-width.
    fn half_across(&self, plate: &Plate, x: f64) -> f64 {
        (0.5 * self.contact_m).min(plate.half_width_m(x))
    }

    /// Start and end of the contact on the plate, metres.
    pub(crate) fn reach(&self, plate: &Plate) -> (f64, f64) {
        let half = 0.5 * self.contact_m;
        ((self.place_m - half).max(0.0), (self.place_m + half).min(plate.length_m()))
    }
}
