//! The driven end: the boundary condition that the actuator imposes at x = 0.
//!
//! Time convention e^(-j omega t): a wave that travels into the plate is e^(+j k x).

use crate::definition::error::PlateError;
use crate::definition::model::Model;
use crate::definition::source::{BENDING_ONLY, EndSlope, Source};

/// Boundary condition at x = 0 for a drive of 1; the solvers' amplitudes are relative to the drive.
///
/// The amplitude equation is of second order and takes one condition. A plate in bending has two, deflection and slope
/// (or force and moment), and a near field at its end. So for bending `Displacement`, `Force` and `Resistance` are
/// approximations that leave the near field out; `DisplacementAndSlope` and `Source` have both conditions. For membranes
/// and shear waves there is one condition, and every end is exact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DriveEnd {
    /// The displacement is prescribed: f(0) = 1. It reflects every returning wave, so the plate is a resonator.
    Displacement,
    /// The force is prescribed: f'(0) = -k0(`at_frequency_hz`), the force that launches a wave of amplitude 1 at
    /// that frequency.
    Force {
        /// Frequency at which the drive launches a unit wave, Hz (above the cut-off at x = 0).
        at_frequency_hz: f64,
    },
    /// A source behind a mechanical resistance R: f'(0) + j k0 r f(0) = 2 j k0 r with k0 r = R omega/T.
    /// With r = 1 the incident wave has amplitude 1 and the reflected wave is absorbed: a matched drive.
    Resistance {
        /// r = R omega/(T k0) at `at_frequency_hz` (0.01 to 100). R is constant, so r changes over the band.
        ratio: f64,
        /// Frequency at which `ratio` holds, Hz (above the cut-off at x = 0).
        at_frequency_hz: f64,
    },
    /// The displacement of an end in bending is prescribed, f(0) = 1, and its slope is free or held: hinged and moved,
    /// or clamped and moved.
    DisplacementAndSlope {
        /// Condition on the slope.
        slope: EndSlope,
    },
    /// A force on a driven end with a mechanical impedance of its own, and in bending with a lead-in behind it.
    Source(Source),
}

impl DriveEnd {
    pub(crate) fn validate(&self, model: &Model) -> Result<(), PlateError> {
        match self {
            Self::Displacement | Self::Force { .. } | Self::Resistance { .. } => Ok(()),
            Self::DisplacementAndSlope { .. } => match model {
                Model::BendingSupported(_) | Model::BendingClamped(_) => Ok(()),
                Model::Membrane { .. } | Model::ShearHorizontal { .. } => {
                    Err(PlateError::unexpected("drive.slope", BENDING_ONLY))
                }
            },
            Self::Source(source) => source.validate(model),
        }
    }

    /// The frequency for which the end's parameters are given, Hz; `None` if the displacement is prescribed.
    pub fn at_frequency_hz(&self) -> Option<f64> {
        match self {
            Self::Displacement | Self::DisplacementAndSlope { .. } => None,
            Self::Force { at_frequency_hz }
            | Self::Resistance { at_frequency_hz, .. }
            | Self::Source(Source { at_frequency_hz, .. }) => Some(*at_frequency_hz),
        }
    }
}
