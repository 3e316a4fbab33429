//! Levels of an amplitude in decibels.

/// The level of an amplitude over another, 20 log10(`ratio`), in decibels.
#[inline]
#[must_use]
pub fn decibels(ratio: f64) -> f64 {
    20.0 * ratio.log10()
}

/// The ratio of two amplitudes whose levels differ by this many decibels: the inverse of [`decibels`].
#[inline]
#[must_use]
pub fn from_decibels(decibels: f64) -> f64 {
    10_f64.powf(decibels / 20.0)
}
