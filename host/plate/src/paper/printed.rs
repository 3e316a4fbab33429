//! The paper's formulas exactly as they are printed, for the left panels.

use super::figure::{POINTS, RATE_PER_M, ramp};
use crate::special::airy;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Shear wave speed of aluminium, sqrt(mu/rho) with mu = 26 GPa and rho = 2700 kg/m^3, m/s.
pub(super) const ALUMINIUM_SPEED: f64 = 3_103.162;
/// W0 of Fig. 4, 5 and 7, metres.
pub(super) const ALUMINIUM_WIDTH_M: f64 = 0.02;

/// The paper's (24): x0 = (1/d) ln(pi Vs/(2 W0 omega)), metres. It is minus the turning point that follows from (22).
pub(super) fn turning_point_m(frequency_hz: f64, speed: f64, width_m: f64) -> f64 {
    (FRAC_PI_2 * speed / (width_m * TAU * frequency_hz)).ln() / RATE_PER_M
}

/// The paper's (33)-(36), scaled to a peak of 1. The two Bessel forms joined at x0 are one Airy function of the
/// mirrored position, Ai(-kappa (x - x0)) with kappa = (2 d (omega/Vs)^2)^(1/3). It oscillates for x > x0.
pub(super) fn amplitude(x: f64, frequency_hz: f64, speed: f64, width_m: f64) -> f64 {
    airy::ai(-kappa_per_m(frequency_hz, speed) * (x - turning_point_m(frequency_hz, speed, width_m)))
        / airy::PEAK_VALUE
}

/// [`amplitude`] in the aluminium plate of Fig. 4, 5 and 7 between two places in mm: points (x in mm, amplitude).
pub(super) fn in_aluminium(from_mm: f64, to_mm: f64, frequency_hz: f64) -> Vec<(f64, f64)> {
    let at = |x: f64| (x, amplitude(x * 1e-3, frequency_hz, ALUMINIUM_SPEED, ALUMINIUM_WIDTH_M));
    ramp(from_mm, to_mm, POINTS).map(at).collect()
}

/// [`turning_point_m`] in that plate, mm.
pub(super) fn x0_in_aluminium_mm(frequency_hz: f64) -> f64 {
    turning_point_m(frequency_hz, ALUMINIUM_SPEED, ALUMINIUM_WIDTH_M) * 1e3
}

/// kappa of the paper's (26), 1/m: k^(2/3) with k^2 = 2 d (omega/Vs)^2.
pub(super) fn kappa_per_m(frequency_hz: f64, speed: f64) -> f64 {
    (2.0 * RATE_PER_M * (TAU * frequency_hz / speed).powi(2)).cbrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_printed_turning_points_of_aluminium_have_the_wrong_sign() {
        for (frequency_hz, scaled) in [(40e3, -0.031), (20e3, 0.662), (5e3, 2.049)] {
            let found = RATE_PER_M * turning_point_m(frequency_hz, ALUMINIUM_SPEED, ALUMINIUM_WIDTH_M);
            assert!((found - scaled).abs() < 6e-4, "{frequency_hz}: {found}");
        }
    }

    #[test]
    fn the_printed_amplitude_oscillates_beyond_its_turning_point_and_dies_before_it() {
        let x0 = turning_point_m(20e3, ALUMINIUM_SPEED, ALUMINIUM_WIDTH_M);
        let kappa = kappa_per_m(20e3, ALUMINIUM_SPEED);
        let at = |z: f64| amplitude(x0 + z / kappa, 20e3, ALUMINIUM_SPEED, ALUMINIUM_WIDTH_M);
        assert!((at(1.018_793) - 1.0).abs() < 1e-9, "the peak is behind x0");
        assert!((at(0.0) - 0.6628).abs() < 1e-4);
        assert!(at(2.338_107).abs() < 1e-6 && (at(-1.710) - 0.1).abs() < 1e-3);
    }
}
