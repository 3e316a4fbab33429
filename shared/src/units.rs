//! The quantities on the wire. Each is an integer in a fixed unit, so that every machine computes the same bits.

use serde::{Deserialize, Serialize};

/// A position along the table's span: 0 is `span_start`, 65535 is exactly `span_end`.
///
/// `x = span_start + (span_end - span_start) * raw / 65535`. On a 260 mm span one unit is 4 um.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Position(pub u16);

impl Position {
    /// The start of the span.
    pub const START: Self = Self(0);
    /// The end of the span.
    pub const END: Self = Self(u16::MAX);

    /// The same position in Q1.31, rounded to nearest.
    #[must_use]
    pub const fn fine(self) -> FinePosition {
        // (raw * 2^31 + 65535/2) / 65535 fits u32 for every u16 and is exact at both ends.
        FinePosition((((self.0 as u64) << 31) + 32_767).div_euclid(65_535) as u32)
    }
}

/// A position along the span in Q1.31: 0 is the start, `1 << 31` the end.
///
/// Glides move in this unit, so that a slow one does not step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct FinePosition(u32);

impl FinePosition {
    /// The end of the span.
    pub const END: Self = Self(1 << 31);

    /// The position of a raw Q1.31 value; a value above 2^31 gives the end.
    #[must_use]
    pub const fn saturating(raw: u32) -> Self {
        Self(if raw > Self::END.0 { Self::END.0 } else { raw })
    }

    /// The raw Q1.31 value, 0..=2^31.
    #[must_use]
    pub const fn raw(self) -> u32 {
        self.0
    }
}

/// The phase that a tone gains per sample, in turns, Q0.64: `2^64` would be one turn per sample.
///
/// `f = step * sample_rate / 2^64`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct PhaseStep(pub u64);

/// An amplitude or a gain, Q1.31: `1 << 31` is 1, which is half the DAC's swing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Gain(pub u32);

impl Gain {
    /// Full scale: a sine from the lowest to the highest DAC code.
    pub const FULL: Self = Self(1 << 31);

    /// The product with a level, rounded down, so that a tone is never louder than its level.
    #[must_use]
    pub const fn scaled(self, level: Level) -> Self {
        // Level 65535 is 1 exactly, so the divisor is 65535.
        Self((self.0 as u64 * level.0 as u64 / 65_535) as u32)
    }

    /// The product of two gains, rounded down; a factor above 1 saturates at `u32::MAX`.
    #[must_use]
    pub const fn times(self, other: Self) -> Self {
        let product = (self.0 as u64 * other.0 as u64) >> 31;
        Self(if product > u32::MAX as u64 { u32::MAX } else { product as u32 })
    }
}

/// A tone's level, linear: 0 is silence, 65535 is 1. Equal levels give equal peaks on the plate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Level(pub u16);

impl Level {
    /// Level 1.
    pub const FULL: Self = Self(u16::MAX);
}

/// A phase offset in 1/65536 turns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Phase(pub u16);

/// A ratio of amplitudes in hundredths of a decibel: `10^(raw / 2000)`. -602 is one half.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct CentiDecibel(pub i16);

crate::schema::transparent!(Position(u16), Gain(u32), Level(u16), Phase(u16), CentiDecibel(i16));

/// An amplitude in Q1.31 as per mille of full scale, rounded up; at most 65535.
#[must_use]
pub fn per_mille(amplitude: u64) -> u16 {
    let scaled = amplitude.saturating_mul(1000).div_ceil(u64::from(Gain::FULL.0));
    u16::try_from(scaled).unwrap_or(u16::MAX)
}

/// The device's clock: the number of samples sent to the DAC since it was reset.
pub type SampleIndex = u64;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_of_the_span_are_exact_and_the_scale_is_monotonic() {
        assert_eq!(Position::START.fine().raw(), 0);
        assert_eq!(Position::END.fine(), FinePosition::END);
        for raw in 1..=u16::MAX {
            assert!(Position(raw - 1).fine() < Position(raw).fine());
        }
    }

    #[test]
    fn full_level_leaves_a_gain_as_it_is() {
        assert_eq!(Gain(0x1234_5678).scaled(Level::FULL), Gain(0x1234_5678));
        assert_eq!(Gain::FULL.times(Gain(77)), Gain(77));
    }
}
