//! Numbers at equal distances.

/// `count` (2 and more) numbers from `low` to `high`, both included.
pub(crate) fn ramp(low: f64, high: f64, count: usize) -> impl Iterator<Item = f64> + Clone + use<> {
    (0..count).map(move |i| low + (high - low) * i as f64 / (count - 1) as f64)
}
