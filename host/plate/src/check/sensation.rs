//! Thresholds of vibration and the friction law for a finger. All values are illustrative: calibrate them on your own
//! plate.
//!
//! Below 20 kHz a finger feels a tone as vibration, above the threshold at its frequency. From 20 kHz on, the squeeze
//! film of air can make the plate slippery. The model that uses both is [`crate::feeling`]. Source and spread of every
//! number are in PHYSICS.md, section 5.

/// Lowest frequency, Hz, of a tone that can make the plate slippery; tones below are felt as vibration. No source: the
/// upper limit of hearing, a round value.
pub const SLIPPERY_FROM_HZ: f64 = 20e3;

/// The friction curve mu/mu0 = r + (1 - r) e^(-(a/a0)^p) over the displacement amplitude a. Defaults: a0 = 1 um,
/// r = 0.2, p = 1.5; no source, round values. Reductions of the friction by up to 95 % have been measured
/// (M. Wiertlewski, R. Fenton Friesen and J. Colgate, PNAS 113, 9210, 2016).
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FrictionCurve {
    /// Amplitude scale a0, metres (above 0).
    pub scale_m: f64,
    /// Residual friction r, 0 to 1.
    pub residual: f64,
    /// Exponent p (above 0).
    pub exponent: f64,
}

impl Default for FrictionCurve {
    fn default() -> Self {
        Self { scale_m: 1e-6, residual: 0.2, exponent: 1.5 }
    }
}

impl FrictionCurve {
    /// mu/mu0 at a displacement amplitude in metres.
    pub fn ratio(&self, amplitude_m: f64) -> f64 {
        let depth = (amplitude_m.abs() / self.scale_m).powf(self.exponent);
        self.residual + (1.0 - self.residual) * (-depth).exp()
    }
}

/// Threshold of vibration, as a displacement amplitude in metres: 10 um up to 40 Hz, then falling by 12 dB per octave
/// to 0.256 um at 250 Hz, then rising by 12 dB per octave.
///
/// The shape up to 250 Hz is that of R. Verrillo, J. Acoust. Soc. Am. 35, 1962 (1963). The rise above 250 Hz and the
/// absolute level have no source; a finger that presses or grasps has lower thresholds (Brisben et al., J.
/// Neurophysiol. 81, 1548, 1999).
pub fn threshold_m(frequency_hz: f64) -> f64 {
    const FLAT_M: f64 = 10e-6;
    const CORNER_HZ: f64 = 40.0;
    const BEST_HZ: f64 = 250.0;
    let best_m = FLAT_M * (CORNER_HZ / BEST_HZ).powi(2);
    if frequency_hz <= CORNER_HZ {
        FLAT_M
    } else if frequency_hz <= BEST_HZ {
        FLAT_M * (CORNER_HZ / frequency_hz).powi(2)
    } else {
        best_m * (frequency_hz / BEST_HZ).powi(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::decibels;

    #[test]
    fn friction_falls_from_one_to_its_residual() {
        let curve = FrictionCurve::default();
        assert_eq!(curve.ratio(0.0), 1.0);
        assert!((curve.ratio(1e-6) - (0.2 + 0.8 * (-1.0_f64).exp())).abs() < 1e-12);
        assert!((curve.ratio(1e-4) - 0.2).abs() < 1e-9);
    }

    #[test]
    fn the_threshold_is_flat_then_falls_12_db_per_octave_to_its_best() {
        assert_eq!(threshold_m(30.0), threshold_m(40.0));
        let octave = decibels(threshold_m(100.0) / threshold_m(200.0));
        assert!((octave - 12.04).abs() < 0.01, "{octave}");
        assert!(threshold_m(250.0) < threshold_m(150.0) && threshold_m(250.0) < threshold_m(400.0));
    }
}
