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

/// How far a tone moves the actuator.
///
/// The moving part is a mass on a spring. A force that would displace it by `static_m` at rest moves it at the frequency f
/// by
/// ```text
/// x(f) = static_m / sqrt((1 - r^2)^2 + (r/Q)^2),    r = f/f0
/// ```
/// in the steady state: `static_m` far below the resonance f0, Q `static_m` at it, `static_m` (f0/f)^2 far above it.
/// Travels of several tones add up, because their phases may meet.
impl Actuator {
    /// Steady travel of a tone at DAC full scale, as a share of the peak travel; 1 or less may be played at full scale.
    /// `None` if the plate file does not limit the travel.
    pub fn travel_share(&self, frequency_hz: f64) -> Option<f64> {
        let Travel { peak_m, static_m } = self.travel?;
        Some(static_m / peak_m * self.response(frequency_hz).norm())
    }

    /// The largest [`Actuator::travel_share`] of all frequencies from one to another, in either order.
    pub fn largest_travel_share(&self, from_hz: f64, to_hz: f64) -> Option<f64> {
        let at_ends = self.travel_share(from_hz)?.max(self.travel_share(to_hz)?);
        // |H| rises up to its peak at f0 sqrt(1 - 1/(2 Q^2)) and falls beyond it; without a peak it only falls.
        let square = 1.0 - 0.5 / (self.quality * self.quality);
        let peak_hz = self.resonance_hz * square.max(0.0).sqrt();
        if (from_hz.min(to_hz)..=from_hz.max(to_hz)).contains(&peak_hz) {
            Some(at_ends.max(self.travel_share(peak_hz)?))
        } else {
            Some(at_ends)
        }
    }

    /// Largest amplitude of a steady tone, as a share of DAC full scale (0 to 1), that keeps the peak travel. `None` if
    /// the plate file does not limit the travel.
    pub fn largest_amplitude(&self, frequency_hz: f64) -> Option<f64> {
        Some(self.travel_share(frequency_hz)?.recip().min(1.0))
    }
}
