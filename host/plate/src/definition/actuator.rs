//! The actuator between the DAC and the driven end: a mass on a spring, or a measured curve.

use crate::definition::error::PlateError;
use crate::definition::response_curve::ResponseCurve;
use crate::definition::travel::Travel;
use num_complex::Complex64;

/// The transfer from the DAC to the driven end.
#[derive(Debug, Clone, PartialEq)]
pub enum Actuator {
    /// A mass on a spring.
    Resonator(Resonator),
    /// A measured curve.
    Measured(ResponseCurve),
}

impl Actuator {
    pub(crate) fn validate(&self) -> Result<(), PlateError> {
        match self {
            Self::Resonator(resonator) => resonator.travel.as_ref().map_or(Ok(()), Travel::validate),
            Self::Measured(curve) => curve.validate("actuator.points"),
        }
    }

    /// Complex response H at `frequency_hz`, relative to the displacement at DAC full scale.
    pub fn response(&self, frequency_hz: f64) -> Complex64 {
        match self {
            Self::Resonator(resonator) => resonator.response(frequency_hz),
            Self::Measured(curve) => curve.response(frequency_hz),
        }
    }

    /// The resonator; `None` for a measured curve.
    pub fn resonator(&self) -> Option<&Resonator> {
        match self {
            Self::Resonator(resonator) => Some(resonator),
            Self::Measured(_) => None,
        }
    }
}

/// A second-order resonator with a gain of 1 at 0 Hz, H = 1/(1 - (f/f0)^2 - j f/(f0 Q)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resonator {
    /// Resonance f0, Hz (0.1 to 1e7).
    pub resonance_hz: f64,
    /// Quality factor Q (0.1 to 1000).
    pub quality: f64,
    /// Its travel and the limit of it; `None` if the travel is not limited.
    pub travel: Option<Travel>,
}

impl Resonator {
    /// Complex response H at `frequency_hz`, relative to the response at 0 Hz.
    pub fn response(&self, frequency_hz: f64) -> Complex64 {
        let ratio = frequency_hz / self.resonance_hz;
        Complex64::new(1.0 - ratio * ratio, -ratio / self.quality).inv()
    }
}

/// Travel of the actuator by a tone.
///
/// The moving part is a mass on a spring. A force that would displace it by `static_m` at rest moves it at the
/// frequency f by
/// ```text
/// x(f) = static_m / sqrt((1 - r^2)^2 + (r/Q)^2),    r = f/f0
/// ```
/// in the steady state: `static_m` far below the resonance f0, Q `static_m` at it, `static_m` (f0/f)^2 far above it.
/// Travels of several tones are added, because their phases may coincide.
impl Resonator {
    /// Steady travel of a tone at DAC full scale, as a fraction of the peak travel; up to 1 it may be played at full
    /// scale.
    /// `None` if the plate file does not limit the travel.
    pub fn travel_share(&self, frequency_hz: f64) -> Option<f64> {
        let Travel { peak_m, static_m } = self.travel?;
        Some(static_m / peak_m * self.response(frequency_hz).norm())
    }

    /// The largest [`Resonator::travel_share`] of all frequencies from one to another, in either order.
    pub(crate) fn largest_travel_share(&self, from_hz: f64, to_hz: f64) -> Option<f64> {
        let at_ends = self.travel_share(from_hz)?.max(self.travel_share(to_hz)?);
        // |H| rises up to its peak at f0 sqrt(1 - 1/(2 Q^2)) and falls beyond; for Q below sqrt(1/2) it has no peak
        // and only falls.
        let square = 1.0 - 0.5 / (self.quality * self.quality);
        let peak_hz = self.resonance_hz * square.max(0.0).sqrt();
        if (from_hz.min(to_hz)..=from_hz.max(to_hz)).contains(&peak_hz) {
            Some(at_ends.max(self.travel_share(peak_hz)?))
        } else {
            Some(at_ends)
        }
    }
}
