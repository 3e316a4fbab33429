//! Positions and gains of a table's knots, for a device that interpolates linearly between them.

use super::level::{DriveToPeak, Level};

/// Shifted positions of the knots, in metres, with each sharp resonance on a knot. The shift is zero at both ends and
/// linear between resonances.
///
/// A resonance is a local maximum of `levels` at `halves` (the `places` of the knots and the positions half-way between
/// them) that stands 2 % above the mean of its neighbours.
pub(super) fn move_onto_resonances(
    drive_to_peak: &DriveToPeak,
    places: &[f64],
    halves: &[f64],
    levels: &[Level],
) -> Vec<f64> {
    let spacing = places[1] - places[0];
    let mut anchors: Vec<(usize, f64)> = vec![(0, 0.0)];
    for i in 1..halves.len() - 1 {
        let (before, here, after) = (levels[i - 1].amplitude, levels[i].amplitude, levels[i + 1].amplitude);
        if here < before || here <= after || 2.0 * here < 1.02 * (before + after) {
            continue;
        }
        let at = |x: f64| {
            let frequency = drive_to_peak.plate.frequency_for_boundary_hz(x);
            drive_to_peak.level(frequency).map_or(0.0, |level| level.amplitude)
        };
        let top = golden_maximum(halves[i - 1], halves[i + 1], at);
        let knot = ((top - places[0]) / spacing).round() as usize;
        let last = anchors.last().map_or(0, |anchor| anchor.0);
        if knot > last + 2 && knot + 2 < places.len() {
            anchors.push((knot, top - places[knot]));
        }
    }
    anchors.push((places.len() - 1, 0.0));
    let mut shifted = places.to_vec();
    for pair in anchors.windows(2) {
        let ((left, from), (right, to)) = (pair[0], pair[1]);
        for (k, place) in shifted.iter_mut().enumerate().take(right + 1).skip(left) {
            let t = (k - left) as f64 / (right - left) as f64;
            *place = places[k] + from * (1.0 - t) + to * t;
        }
    }
    shifted
}

/// The maximum of a function with one maximum between `low` and `high`, by golden-section search; 14 steps narrow the
/// interval by a factor of 800.
fn golden_maximum(mut low: f64, mut high: f64, value: impl Fn(f64) -> f64) -> f64 {
    let ratio = 0.618_033_988_749_895;
    let (mut a, mut b) = (high - ratio * (high - low), low + ratio * (high - low));
    let (mut at_a, mut at_b) = (value(a), value(b));
    for _ in 0..14 {
        if at_a > at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - ratio * (high - low);
            at_a = value(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + ratio * (high - low);
            at_b = value(b);
        }
    }
    0.5 * (low + high)
}

/// Makes the frequencies strictly increasing, as the device requires, where rounding has made two of them equal.
pub(super) fn make_increasing(frequency: &mut [f64]) {
    for k in 1..frequency.len() {
        frequency[k] = frequency[k].max(frequency[k - 1] * (1.0 + 1e-12));
    }
}

/// Adjusts the gains so that the error half-way between two knots and the errors at the knots are equal and opposite.
/// `between` holds the levels half-way between the knots.
pub(super) fn balance_errors(gain: &mut [f64], at_knots: &[Level], between: &[Level]) {
    for _ in 0..3 {
        let error: Vec<f64> = between
            .iter()
            .enumerate()
            .map(|(k, level)| (0.5 * (gain[k] + gain[k + 1]) * level.amplitude).ln())
            .collect();
        for k in 0..gain.len() {
            let left = if k > 0 { error[k - 1] } else { error[0] };
            let right = error.get(k).copied().unwrap_or(left);
            let own = (gain[k] * at_knots[k].amplitude).ln();
            // A change of the gain moves both errors (in nepers) by about the same amount, so minus half of their sum
            // makes them equal and opposite. Three rounds settle the influence of the neighbours.
            let worst = if left.abs() > right.abs() { left } else { right };
            gain[k] *= (-0.5 * (worst + own)).exp();
        }
    }
}
