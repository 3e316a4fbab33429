//! The driven end: what the actuator does to the plate at x = 0.
//!
//! Time convention e^(-j omega t): a wave that runs into the plate is e^(+j k x).

use crate::spec::error::PlateError;
use crate::spec::limits;

/// What is held at x = 0, for a drive of 1 (the amplitudes of the solvers are relative to it).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DriveEnd {
    /// The displacement is prescribed: f(0) = 1. Every reflection comes back: a resonator.
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
        /// r = R omega/(T k0) at `at_frequency_hz` (0.01 to 100); R itself is constant, so r drifts over the band.
        ratio: f64,
        /// Frequency at which `ratio` holds, Hz (above the cut-off at x = 0).
        at_frequency_hz: f64,
    },
}

impl DriveEnd {
    pub(crate) fn validate(&self) -> Result<(), PlateError> {
        match self {
            Self::Resistance { ratio, .. } => limits::DRIVE_RATIO.check("drive.ratio", *ratio),
            Self::Displacement | Self::Force { .. } => Ok(()),
        }
    }

    /// The frequency this end is specified at, if it has one, Hz.
    pub fn at_frequency_hz(&self) -> Option<f64> {
        match self {
            Self::Displacement => None,
            Self::Force { at_frequency_hz } | Self::Resistance { at_frequency_hz, .. } => {
                Some(*at_frequency_hz)
            }
        }
    }
}

/// The actuator between the DAC and the driven end, a second-order resonator of unit gain at rest:
/// H = 1/(1 - (f/f0)^2 - j f/(f0 Q)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Actuator {
    /// Resonance f0, Hz (0.1 to 1e7).
    pub resonance_hz: f64,
    /// Quality factor Q (0.1 to 1000).
    pub quality: f64,
}

impl Actuator {
    pub(crate) fn validate(&self) -> Result<(), PlateError> {
        limits::RESONANCE.check("actuator.resonance_hz", self.resonance_hz)?;
        limits::QUALITY.check("actuator.quality", self.quality)
    }

    /// Complex response at `frequency_hz`, relative to rest.
    pub fn response(&self, frequency_hz: f64) -> num_complex::Complex64 {
        let ratio = frequency_hz / self.resonance_hz;
        num_complex::Complex64::new(1.0 - ratio * ratio, -ratio / self.quality).inv()
    }
}
