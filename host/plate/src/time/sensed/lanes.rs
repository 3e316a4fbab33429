//! Memory layout of resonators and outputs: whole vectors.

/// Number of resonators computed together.
pub(super) const LANES: usize = 8;
/// A vector.
pub(super) type Lanes = [f64; LANES];

/// Values in whole vectors; the last one is padded with zeros.
pub(super) fn in_lanes(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.resize(values.len().next_multiple_of(LANES), 0.0);
    values
}
