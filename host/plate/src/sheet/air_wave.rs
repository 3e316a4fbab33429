//! The wave of a sheet in air.
//!
//! Air makes K^2 a function of the frequency alone that rises more slowly than omega^2 (see the plate's free wave). It has no
//! causal law in time that is exact: K^2 is real at all frequencies and no polynomial. v_tt = c^2 (v_xx + v_zz + a v) has
//!
//! ```text
//! K^2 = a + omega^2/c^2
//! ```
//! without loss and with the same conditions at the edges and the driven end, whatever a and c are. So a line through two
//! points of K^2 over omega^2 makes two tones exact, and the tangent one tone with its group speed, by which its transients
//! travel. K^2 is concave: the line's c is below V of the plate in a vacuum, and a is positive. Motion slower than every
//! width mode would grow where K^2 < a, so a stays below (pi/2W)^2 of the widest place; where the line would need more, c
//! alone is what the tones ask for.

use crate::definition::plate::Plate;
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, TAU};

/// Largest relative error of the wavenumber in air that a sheet may have. It moves a boundary by 2.2 mm where the plate
/// narrows by 4.62 /m.
pub const WAVENUMBER_ERROR_MAX: f64 = 0.01;
/// Largest a over the least K^2 of a motion of the plate. The grid has that a little lower.
const LIFT_MAX: f64 = 0.9;
/// Frequencies at which the error in a band is computed.
const PLACES: u32 = 33;

/// c and a of the text above; of a plate without air, its wave speed and 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct AirWave {
    pub(super) speed_m_per_s: f64,
    pub(super) lift_per_m2: f64,
}

impl AirWave {
    /// The wave that has the plate's wavenumber at two frequencies, Hz, or at one with its group speed.
    pub(super) fn of(plate: &Plate, (low_hz, high_hz): (f64, f64)) -> Self {
        let vacuum = plate.spec().model.wave_speed_m_per_s().unwrap_or(f64::NAN);
        if !plate.carries_air() {
            return Self { speed_m_per_s: vacuum, lift_per_m2: 0.0 };
        }
        let point = |frequency_hz: f64| {
            let squared = (TAU * frequency_hz).powi(2);
            (squared, plate.wavenumber_squared(frequency_hz))
        };
        let ((low, k_low), (high, k_high)) = (point(low_hz), point(high_hz));
        let slope = if high > low * (1.0 + 1e-9) {
            (k_high - k_low) / (high - low)
        } else {
            // d ln K^2/d ln omega^2 is the share of the stiffness in what sets the wavenumber.
            plate.dilution(low_hz) * k_low / low
        };
        let lift = k_low - slope * low;
        let most = LIFT_MAX * (FRAC_PI_2 / plate.half_width_m(0.0)).powi(2);
        if lift <= most {
            return Self { speed_m_per_s: slope.recip().sqrt(), lift_per_m2: lift };
        }
        // As much too large at one frequency as too small at the other.
        let slope = (2.0 - most / k_low - most / k_high) / (low / k_low + high / k_high);
        Self { speed_m_per_s: slope.recip().sqrt(), lift_per_m2: most }
    }

    /// The two frequencies for these tones: those of one or two, and of more those of [`AirWave::nodes_between`].
    pub(super) fn nodes(tones_hz: &[f64]) -> Option<(f64, f64)> {
        let (low_hz, high_hz) =
            tones_hz.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), &hz| (low.min(hz), high.max(hz)));
        let is_end = |hz: &f64| *hz == low_hz || *hz == high_hz;
        match tones_hz {
            [] => None,
            tones if tones.iter().all(is_end) => Some((low_hz, high_hz)),
            _ => Some(Self::nodes_between((low_hz, high_hz))),
        }
    }

    /// The two frequencies that make the largest error in a band about least: Chebyshev's, over 1/f.
    pub(super) fn nodes_between((low_hz, high_hz): (f64, f64)) -> (f64, f64) {
        let middle = 0.5 * (low_hz.recip() + high_hz.recip());
        let aside = 0.5 * FRAC_1_SQRT_2 * (low_hz.recip() - high_hz.recip());
        ((middle + aside).recip(), (middle - aside).recip())
    }

    /// Relative error of the wavenumber at a frequency, Hz.
    pub(super) fn error_at(self, plate: &Plate, frequency_hz: f64) -> f64 {
        if !plate.carries_air() {
            return 0.0;
        }
        let squared = self.lift_per_m2 + (TAU * frequency_hz / self.speed_m_per_s).powi(2);
        ((squared / plate.wavenumber_squared(frequency_hz)).sqrt() - 1.0).abs()
    }

    /// The largest of them from one frequency to another, Hz.
    pub(super) fn error_between(self, plate: &Plate, (low_hz, high_hz): (f64, f64)) -> f64 {
        let place = |i: u32| low_hz * (high_hz / low_hz).powf(f64::from(i) / f64::from(PLACES - 1));
        (0..PLACES).map(|i| self.error_at(plate, place(i))).fold(0.0, f64::max)
    }
}
