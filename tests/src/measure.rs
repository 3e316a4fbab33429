//! Measurements on recorded codes.

use crate::rig::MID;

/// The largest distance from mid-scale, in codes.
#[must_use]
pub fn peak(codes: &[u16]) -> u16 {
    codes.iter().map(|code| code.abs_diff(MID)).max().unwrap_or(0)
}

/// The largest step from one code to the next.
#[must_use]
pub fn largest_step(codes: &[u16]) -> u16 {
    codes.windows(2).map(|pair| pair[0].abs_diff(pair[1])).max().unwrap_or(0)
}

/// The peak of each window of `length` codes.
#[must_use]
pub fn envelope(codes: &[u16], length: usize) -> Vec<u16> {
    codes.chunks(length).map(peak).collect()
}

/// The mean square of the distance from mid-scale, in squared codes.
#[must_use]
pub fn mean_square(codes: &[u16]) -> f64 {
    let sum: f64 = codes.iter().map(|&code| (f64::from(code) - f64::from(MID)).powi(2)).sum();
    sum / codes.len().max(1) as f64
}
