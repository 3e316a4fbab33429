//! An input's converter: noise, 12 bits, the ends of its range.

/// Codes from zero to either end of the range.
pub(super) const HALF: f64 = 2048.0;
/// The largest code.
pub(super) const LARGEST: u16 = 4095;

/// The code of a signal in units of full scale (1 is one end of the range), with `noise` in codes.
pub(super) fn code(signal: f64, noise: f64) -> u16 {
    // The cast saturates at 0, and converts NaN to 0.
    ((HALF + HALF * signal + noise).round() as u16).min(LARGEST)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zero_is_mid_scale_and_what_is_too_large_stays_at_the_end() {
        assert_eq!([0.0, 0.5, -0.5].map(|it| code(it, 0.0)), [2048, 3072, 1024]);
        assert_eq!([1.0, 7.0, -1.0, -9.0, f64::NAN].map(|it| code(it, 0.0)), [4095, 4095, 0, 0, 0]);
        assert_eq!([0.2, 0.6, -0.6].map(|noise| code(0.0, noise)), [2048, 2049, 2047]);
    }
}
