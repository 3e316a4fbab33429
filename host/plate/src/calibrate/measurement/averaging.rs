//! The time for which tones that are played together are measured.
//!
//! The noise of a mean over n windows is 1/sqrt(n) of that of one. Tones that are played together share their windows,
//! so the weakest answer decides, except for those that no permitted number of windows would make clear: a sensor in a
//! node, or one that is unplugged, does not answer more clearly for being asked longer.

/// Largest number of windows.
pub const WINDOWS_MAX: u16 = 32;
/// Amplitude of a clear answer over the standard deviation of its noise.
const CLEAR: f64 = 40.0;

/// Number of windows, 1 to [`WINDOWS_MAX`], over which the answers of tones that are played together are averaged.
/// `over_noise` are their amplitudes over the standard deviation of the noise of one window.
///
/// ```
/// use slipline_plate::calibrate::windows;
///
/// // 32 dB is clear at once, 26 dB takes four windows, and 14 dB would take more than 32.
/// assert_eq!([windows([40.0]), windows([40.0, 20.0]), windows([40.0, 5.0])], [1, 4, 1]);
/// ```
pub fn windows(over_noise: impl IntoIterator<Item = f64>) -> u16 {
    let wanted = over_noise.into_iter().map(|answer| (CLEAR / answer).powi(2).ceil());
    wanted.filter(|wanted| *wanted <= f64::from(WINDOWS_MAX)).fold(1.0, f64::max) as u16
}
