//! A source with a mechanical impedance of its own, and the damped lead-in behind it.

use crate::definition::error::PlateError;
use crate::definition::impedance::Impedance;
use crate::definition::limits;
use crate::definition::model::Model;
use serde::Serialize;

/// A force F on a driven end that carries a damper, a mass and a spring: F - Z_s v acts on the plate, with v the velocity
/// of the centre line and Z_s an [`Impedance`].
///
/// The force is distributed over the width like the first width mode, so it excites that mode alone. A drive of 1 is
/// the constant force F = 2 omega Z at `at_frequency_hz`, where Z is the plate's wave impedance
/// ([`crate::Plate::wave_impedance_n_s_per_m`]). It launches a wave of amplitude 1 at that frequency if the end
/// absorbs the returning wave, Z_s = Z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Source {
    /// Z_s.
    pub impedance: Impedance,
    /// Frequency at which the force is stated, Hz (above the cut-off at x = 0).
    pub at_frequency_hz: f64,
    /// Condition on the slope of an end in bending; `None` for membranes and shear waves, whose end has no slope.
    pub slope: Option<EndSlope>,
    /// The strip behind a driven end in bending; `None` if the plate ends there.
    pub lead_in: Option<LeadIn>,
}

/// Condition on the slope of a driven end in bending.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EndSlope {
    /// Free: no moment acts on the end (hinged or free).
    Free,
    /// Held by a guide: the end cannot turn, f'(0) = 0.
    Held,
}

/// A strip of the half-width W(0) and of the plate's material behind the drive, with a lossy layer. It absorbs the
/// waves that the driven end transmits: the broadband match of a plate in bending.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, serde::Deserialize)]
pub struct LeadIn {
    /// Length, metres (0.001 to 10).
    // JSON: Length
    pub length_m: f64,
    /// Loss factor of the strip with its layer (0 to 2).
    pub loss_factor: f64,
    /// Resistance of a damper at its far end, whose slope is free, N s/m (0 to 1e9; 0 is a free end).
    // JSON: Resistance at the far end of the lead-in
    pub end_resistance_n_s_per_m: f64,
}

impl EndSlope {
    /// Both, in the order in which messages list [`EndSlope::word`].
    pub const ALL: [Self; 2] = [Self::Free, Self::Held];

    /// Its word in a plate file: `free` or `held`.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Free => "free",
            Self::Held => "held",
        }
    }
}

impl Source {
    /// A force on an end of zero impedance, with a free slope in bending.
    pub fn soft(model: &Model, at_frequency_hz: f64) -> Self {
        Self {
            impedance: Impedance::default(),
            at_frequency_hz,
            slope: model.bending().map(|_| EndSlope::Free),
            lead_in: None,
        }
    }

    pub(crate) fn validate(&self, model: &Model) -> Result<(), PlateError> {
        match model {
            Model::BendingSupported(_) | Model::BendingClamped(_) if self.slope.is_none() => {
                Err(PlateError::Missing {
                    field: "drive.slope".to_owned(),
                    needed: "a plate in bending needs it: \"free\" or \"held\"".to_owned(),
                })
            }
            Model::BendingSupported(_) | Model::BendingClamped(_) => Ok(()),
            Model::Membrane { .. } | Model::ShearHorizontal { .. } if self.slope.is_some() => {
                Err(PlateError::unexpected("drive.slope", BENDING_ONLY))
            }
            Model::Membrane { .. } | Model::ShearHorizontal { .. } if self.lead_in.is_some() => {
                Err(PlateError::unexpected(
                    "drive.lead_in",
                    "only a plate in bending has one: a damper matches other waves",
                ))
            }
            Model::Membrane { .. } | Model::ShearHorizontal { .. } => {
                model.surface_density("a source").map(drop)
            }
        }
    }
}

impl LeadIn {
    pub(crate) fn validate(&self) -> Result<(), PlateError> {
        limits::LEAD_IN_LENGTH.check("drive.lead_in.length_m", self.length_m)?;
        limits::LEAD_IN_LOSS.check("drive.lead_in.loss_factor", self.loss_factor)?;
        let field = "drive.lead_in.end_resistance_n_s_per_m";
        limits::MECHANICAL_RESISTANCE.check(field, self.end_resistance_n_s_per_m)
    }
}

/// Reason why a slope or a lead-in is refused for membranes and shear waves.
pub(super) const BENDING_ONLY: &str = "only the end of a plate in bending has a slope";
