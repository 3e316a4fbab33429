//! Length of the measuring window, and tones that it does not resolve.

/// Periods of the lowest tone, and of the smallest difference of two tones, in the measuring window.
const PERIODS: f64 = 12.0;
/// Longest window, in seconds.
pub(super) const MAX_WINDOW_S: f64 = 2.0;
/// Least periods of two tones' difference frequency in the measuring window so that the window resolves them:
/// the Hann window then passes less than 1/100 of one tone into the other.
const PERIODS_APART: f64 = 4.0;

/// Two tones that beat so slowly that the measuring window does not resolve them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlowBeat {
    /// The frequencies of the two tones, in Hz; the same number twice for tones of one frequency.
    pub between_hz: (f64, f64),
    /// Window that would resolve them, in seconds; infinite for tones of one frequency.
    pub needed_s: f64,
}

/// A window long enough to separate each tone from the constant part, from its own mirror image and from the other
/// tones.
pub(super) fn window_s(frequencies: &[f64]) -> f64 {
    let lowest = frequencies.iter().copied().fold(f64::INFINITY, f64::min);
    let mut sorted = frequencies.to_vec();
    sorted.sort_by(f64::total_cmp);
    let nearest =
        sorted.windows(2).map(|pair| pair[1] - pair[0]).filter(|&gap| gap > 0.0).fold(lowest, f64::min);
    (PERIODS / nearest.max(1e-3)).clamp(0.01, MAX_WINDOW_S)
}

/// Whether a window of `window_s` seconds is too short to resolve two frequencies.
pub(super) fn is_blurred(one_hz: f64, other_hz: f64, window_s: f64) -> bool {
    (one_hz - other_hz).abs() * window_s < PERIODS_APART
}

/// The two frequencies that are nearest to each other, if the window does not resolve them.
pub(super) fn slow_beat(frequencies: &[f64], window_s: f64) -> Option<SlowBeat> {
    let mut sorted = frequencies.to_vec();
    sorted.sort_by(f64::total_cmp);
    let pairs = sorted.windows(2).map(|pair| (pair[0], pair[1]));
    let nearest = pairs.min_by(|a, b| (a.1 - a.0).total_cmp(&(b.1 - b.0)))?;
    is_blurred(nearest.0, nearest.1, window_s)
        .then(|| SlowBeat { between_hz: nearest, needed_s: PERIODS_APART / (nearest.1 - nearest.0) })
}
