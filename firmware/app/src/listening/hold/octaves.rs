//! Ratios of amplitudes as logarithms, in integers, so that every machine computes the same bits.

use slipline_protocol::units::Gain;

/// A ratio of two amplitudes as its logarithm to the base 2, in 1/65536: 65536 is a factor of 2 (6.02 dB), one unit is
/// 0.0001 dB.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Octaves(pub i32);

impl Octaves {
    /// A factor of 1.
    pub const NONE: Self = Self(0);
    /// A factor of 2.
    pub const ONE: Self = Self(1 << 16);
    /// 1 dB, `log2(10) / 20`.
    pub const DECIBEL: Self = Self(10_885);
    /// The largest ratio of the hold, a factor of 1024 (60.2 dB), up or down.
    pub const MAX: Self = Self(10 << 16);

    /// The logarithm of a number, rounded down: at most 1/65536 too small. 0 counts as 1.
    ///
    /// Squaring a number in 1..2 doubles its logarithm; where the square reaches 2, the next binary digit is a 1.
    #[must_use]
    pub const fn log2(number: u64) -> Self {
        let number = if number == 0 { 1 } else { number };
        let whole = number.ilog2();
        // In 1..2, with 31 fractional bits. Its square has 62, and is below 2^64.
        let mut mantissa = if whole >= 31 { number >> (whole - 31) } else { number << (31 - whole) };
        let mut digits = whole.cast_signed();
        let mut bit = 0;
        while bit < 16 {
            mantissa = (mantissa * mantissa) >> 31;
            let carry = mantissa >> 32 != 0;
            mantissa >>= carry as u32;
            digits = (digits << 1) | carry as i32;
            bit += 1;
        }
        Self(digits)
    }

    /// `gain` times this ratio, rounded down: at most two units and 2e-8 of it too small. At most full scale, at least 2^-31,
    /// since a tone that is silent cannot be measured. A ratio of 1 leaves a gain as it is.
    #[must_use]
    pub fn times(self, gain: Gain) -> Gain {
        // Between 1 and 2, 31 fractional bits: each product stays below 2^64.
        let mut factor = 1_u64 << 31;
        for (digit, root) in ROOTS.iter().enumerate() {
            if self.0 & (0x8000 >> digit) != 0 {
                factor = (factor * root) >> 31;
            }
        }
        let product = u64::from(gain.0.clamp(1, Gain::FULL.0)) * factor;
        // From 32 octaves on every gain is beyond full scale.
        let gain = match u32::try_from(31 - (self.0 >> 16)) {
            Ok(down) => product.checked_shr(down).unwrap_or(0),
            Err(_) => u64::MAX,
        };
        Gain(u32::try_from(gain).unwrap_or(u32::MAX).clamp(1, Gain::FULL.0))
    }
}

/// `2^(1/2)`, `2^(1/4)` ... `2^(1/65536)`, 31 fractional bits, rounded down.
const ROOTS: [u64; 16] = {
    let mut roots = [0; 16];
    let mut root: u64 = 1 << 32;
    let mut rest: &mut [u64] = &mut roots;
    while let [first, others @ ..] = rest {
        root = (root << 31).isqrt();
        *first = root;
        rest = others;
    }
    roots
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_logarithm_is_at_most_a_unit_too_small() {
        let numbers =
            (1..3000).chain((0..64).map(|bit| 1 << bit)).chain([u64::MAX, 1 << 31 | 12_345, 0xFFFF_FFFF]);
        for number in numbers {
            let off = (number as f64).log2() * 65_536.0 - f64::from(Octaves::log2(number).0);
            assert!((-0.001..1.001).contains(&off), "{number}: {off}");
        }
        assert_eq!(Octaves::log2(0), Octaves::NONE);
    }

    #[test]
    fn a_gain_times_a_ratio_is_never_louder_and_as_good_as_exact() {
        for octaves in (-655_360..=655_360).step_by(311) {
            for gain in [40_000_000_u32, 0x1234_5678, 1 << 31] {
                let got = f64::from(Octaves(octaves).times(Gain(gain)).0);
                let wanted =
                    (f64::from(gain) * (f64::from(octaves) / 65_536.0).exp2()).min(f64::from(1_u32 << 31));
                assert!(
                    got <= wanted && got >= wanted * (1.0 - 2e-8) - 2.0,
                    "{octaves} {gain}: {got} for {wanted}"
                );
            }
        }
        assert_eq!(Octaves::NONE.times(Gain(77)), Gain(77));
        assert_eq!(Octaves(-31 << 16).times(Gain(77)), Gain(1));
        assert_eq!(Octaves(i32::MAX).times(Gain(77)), Gain::FULL);
        assert_eq!(Octaves(i32::MIN).times(Gain::FULL), Gain(1));
    }

    #[test]
    fn the_decibel_in_octaves_is_rounded_down() {
        assert_eq!(f64::from(Octaves::DECIBEL.0), (65_536.0 * 10_f64.log2() / 20.0).floor());
    }
}
