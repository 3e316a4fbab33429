//! What the equation of one width mode misses between the driven end and a sensor near it.
//!
//! An end that moves its whole width alike, as a bar does, moves the third width mode by a third of the first, and it decays from where
//! it turns. The wave's fronts are circles about the point where the edges would meet, and the end is straight: where along the front
//! the wave begins depends on how the end moves across the width.

use super::data::Datum;
use crate::definition::Plate;
use crate::special::ramp::ramp;
use std::f64::consts::PI;

/// The third width mode's amplitude over the first one's at an end that moves its whole width alike: of 1 = sum c_n cos(q_n z/W),
/// c_n = 2 sin(q_n)/q_n.
const OF_A_BAR: f64 = 1.0 / 3.0;
/// Steps of the decay's integral.
const STEPS: usize = 64;
/// Share of the frequencies over which the signal's mean square is taken: a node is none of the third mode.
const BESIDE: f64 = 0.06;

/// Mean of z^2/(2 W^2) over the first width mode's cos(pi z/(2 W)).
const OF_FRONT: f64 = 0.5 - 4.0 / (PI * PI);

/// How far the wave's front on the centre line is ahead of its mean over the width, which an end moves that is a bar, at the driven end,
/// metres: W |W'| (1 - 8/pi^2)/2.
pub(crate) fn front_m(plate: &Plate) -> f64 {
    OF_FRONT * plate.half_width_m(0.0).powi(2) * plate.narrowing_per_m(0.0).abs()
}

/// The third width mode's amplitude at a place over that of the first one at the driven end, the most of any drive.
fn share(plate: &Plate, place_m: f64, frequency_hz: f64) -> f64 {
    let mode = plate.width_mode(3);
    let from_m = mode.turning_point_m(frequency_hz).max(0.0);
    if place_m <= from_m {
        return OF_A_BAR;
    }
    let wave = mode.at_frequency(frequency_hz);
    let step_m = (place_m - from_m) / STEPS as f64;
    let exponent: f64 = ramp(from_m + 0.5 * step_m, place_m - 0.5 * step_m, STEPS)
        .map(|x| (-wave.wavenumber_squared(x)).max(0.0).sqrt() * step_m)
        .sum();
    OF_A_BAR * (-exponent).exp()
}

/// Widens the errors of a sensor's responses by what the third width mode of `plate` may add to them at its place.
pub(crate) fn widen(data: &mut [Datum], plate: &Plate, place_m: f64, frequencies_hz: &[f64]) {
    let squares: Vec<f64> = data.iter().map(|datum| datum.response.norm_sqr()).collect();
    let beside = (BESIDE * data.len() as f64).ceil() as usize;
    for (i, (datum, &hz)) in data.iter_mut().zip(frequencies_hz).enumerate() {
        let near = &squares[i.saturating_sub(beside)..(i + beside + 1).min(squares.len())];
        let square = near.iter().sum::<f64>() / near.len() as f64;
        datum.variance += share(plate, place_m, hz).powi(2) * square;
    }
}
