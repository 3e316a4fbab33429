//! The resistance that absorbs the returning wave at the driven end.
//!
//! A wave of amplitude A on the centre line carries the power P = (1/2) Z omega^2 A^2 with the wave impedance
//! Z = rho h v_g (integral of the width mode's square over z), v_g = d omega/d k at x = 0. For a membrane Z is
//! T k0/omega with T = (tension per width) x W. In the one-mode equation a source on the centre line with the
//! mechanical resistance Z absorbs the returning wave completely. Z changes with the frequency and a real damper does
//! not, so the match is made where the two ends of the band are wrong by the same factor.
//!
//! A real plate in bending also has an evanescent near field at the driven end, which the one-mode equation leaves out
//! and a damper does not absorb: with R = Z at a free end about 0.57 of the returning amplitude is still reflected.
//! There Z is a first value to start from; measure and adjust.

use crate::spec::plate::Plate;
use serde::Serialize;

/// The damper at the driven end, matched in the one-mode equation. At the driven end of a plate in bending it is only a
/// first value: a real end has a near field that the equation leaves out.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Damper {
    /// Mechanical resistance R, N s/m.
    pub resistance_n_s_per_m: f64,
    /// Frequency at which it matches exactly (r = 1), Hz.
    pub match_frequency_hz: f64,
    /// Smallest and largest r = R omega/(T k0) over the band.
    pub ratio_range: (f64, f64),
}

/// Number of frequencies in the band at which r is evaluated.
const BAND_PLACES: usize = 201;

/// The frequency of the band, Hz, where omega/k0 is closest to the geometric mean of its extremes; and the smallest and
/// the largest r over the band for a damper that matches there.
pub(super) fn best_match(plate: &Plate, band_hz: (f64, f64)) -> (f64, (f64, f64)) {
    let width_mode = plate.width_mode(1);
    let slowness = |frequency_hz: f64| {
        frequency_hz / width_mode.wavenumber_squared(0.0, frequency_hz).max(1e-300).sqrt()
    };
    let places: Vec<(f64, f64)> = (0..BAND_PLACES)
        .map(|i| {
            let t = i as f64 / (BAND_PLACES - 1) as f64;
            let frequency_hz = band_hz.0 * (band_hz.1 / band_hz.0).powf(t);
            (frequency_hz, slowness(frequency_hz))
        })
        .collect();
    let (low, high) = places
        .iter()
        .fold((f64::INFINITY, 0.0_f64), |(low, high), place| (low.min(place.1), high.max(place.1)));
    let middle = (low * high).sqrt();
    let nearest =
        |a: &&(f64, f64), b: &&(f64, f64)| (a.1 / middle).ln().abs().total_cmp(&(b.1 / middle).ln().abs());
    let at = places.iter().min_by(nearest).map_or(band_hz.0, |place| place.0);
    let matched = slowness(at);
    (at, (low / matched, high / matched))
}
