//! The driven end: the boundary condition that the actuator imposes at x = 0.
//!
//! Time convention e^(-j omega t): a wave that travels into the plate is e^(+j k x).

use crate::spec::error::PlateError;
use crate::spec::limits;
use crate::spec::travel::Travel;

/// Boundary condition at x = 0 for a drive of 1; the solvers' amplitudes are relative to the drive.
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
}

impl DriveEnd {
    pub(crate) fn validate(&self) -> Result<(), PlateError> {
        match self {
            Self::Resistance { ratio, .. } => limits::DRIVE_RATIO.check("drive.ratio", *ratio),
            Self::Displacement | Self::Force { .. } => Ok(()),
        }
    }

    /// The frequency for which the end's parameters are given, Hz; `None` for a displacement drive.
    pub fn at_frequency_hz(&self) -> Option<f64> {
        match self {
            Self::Displacement => None,
            Self::Force { at_frequency_hz } | Self::Resistance { at_frequency_hz, .. } => {
                Some(*at_frequency_hz)
            }
        }
    }
}

/// The actuator between the DAC and the driven end: a second-order resonator with a gain of 1 at 0 Hz,
/// H = 1/(1 - (f/f0)^2 - j f/(f0 Q)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Actuator {
    /// Resonance f0, Hz (0.1 to 1e7).
    pub resonance_hz: f64,
    /// Quality factor Q (0.1 to 1000).
    pub quality: f64,
    /// How far it may move; `None` if nothing limits its travel.
    pub travel: Option<Travel>,
}

impl Actuator {
    pub(crate) fn validate(&self) -> Result<(), PlateError> {
        limits::RESONANCE.check("actuator.resonance_hz", self.resonance_hz)?;
        limits::QUALITY.check("actuator.quality", self.quality)?;
        self.travel.as_ref().map_or(Ok(()), Travel::validate)
    }

    /// Complex response H at `frequency_hz`, relative to the response at 0 Hz.
    pub fn response(&self, frequency_hz: f64) -> num_complex::Complex64 {
        let ratio = frequency_hz / self.resonance_hz;
        num_complex::Complex64::new(1.0 - ratio * ratio, -ratio / self.quality).inv()
    }
}
