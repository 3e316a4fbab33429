//! The numbers that a plate's fields may have: one place for those who check them and those who tell of them.

use crate::error::PlateError;
use crate::numeral::{at_least, at_most, typed};
use std::fmt;

/// The numbers that a field may have, both ends included. Written as `0.005 to 10 m`, each end as a person would type
/// it: rounded to five digits, and inwards, so that what is named is allowed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Least.
    pub low: f64,
    /// Most.
    pub high: f64,
    /// Unit of both; empty for a pure number.
    pub unit: &'static str,
}

impl Range {
    /// From `low` to `high` of a unit.
    pub const fn new(low: f64, high: f64, unit: &'static str) -> Self {
        Self { low, high, unit }
    }

    /// Whether a number is allowed; NaN never is.
    pub fn contains(self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// Refuses what is not allowed, naming the field.
    pub(crate) fn check(self, field: &str, value: f64) -> Result<(), PlateError> {
        if self.contains(value) {
            return Ok(());
        }
        Err(PlateError::OutOfRange { field: field.to_owned(), value, allowed: self.to_string() })
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} to {}", typed(at_least(self.low, 5)), typed(at_most(self.high, 5)))?;
        if self.unit.is_empty() { Ok(()) } else { write!(f, " {}", self.unit) }
    }
}

/// Length of a plate, and of a design's.
pub const LENGTH: Range = Range::new(0.005, 10.0, "m");
/// Loss factor of a material or a tension.
pub const LOSS_FACTOR: Range = Range::new(0.0, 0.5, "");
/// How well the wave speed is known, as a fraction.
pub const WAVE_SPEED_TOLERANCE: Range = Range::new(0.0, 0.05, "");
/// Displacement of the drive at DAC full scale.
pub const FULL_SCALE: Range = Range::new(1e-9, 0.1, "m");
/// Half-width anywhere on a plate.
pub const HALF_WIDTH: Range = Range::new(crate::HALF_WIDTH_MIN_M, crate::HALF_WIDTH_MAX_M, "m");
/// Rate of an exponential taper.
pub const TAPER_RATE: Range = Range::new(0.01, 1000.0, "1/m");
/// Place of a point of a sampled taper.
pub const TAPER_PLACE: Range = Range::new(0.0, 100.0, "m");
/// Wave speed of a membrane.
pub const WAVE_SPEED: Range = Range::new(0.1, 2e4, "m/s");
/// Shear modulus.
pub const SHEAR_MODULUS: Range = Range::new(100.0, 1e12, "Pa");
/// Young's modulus.
pub const YOUNGS_MODULUS: Range = Range::new(1e3, 1e13, "Pa");
/// Poisson's ratio.
pub const POISSON_RATIO: Range = Range::new(0.0, 0.499, "");
/// Density.
pub const DENSITY: Range = Range::new(1.0, 3e4, "kg/m^3");
/// Thickness of the sheet.
pub const THICKNESS: Range = Range::new(1e-6, 0.1, "m");
/// r of a drive end that is a resistance.
pub const DRIVE_RATIO: Range = Range::new(0.01, 100.0, "");
/// Frequency that a boundary may need.
pub const FREQUENCY: Range = Range::new(crate::FREQUENCY_RANGE_HZ.0, crate::FREQUENCY_RANGE_HZ.1, "Hz");
/// An actuator's resonance.
pub const RESONANCE: Range = Range::new(0.1, 1e7, "Hz");
/// An actuator's quality factor.
pub const QUALITY: Range = Range::new(0.1, 1000.0, "");
/// Width of the frame's rim of a design.
pub const RIM: Range = Range::new(0.01, 0.5, "m");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_of_a_range_are_written_as_they_would_be_typed_and_are_allowed() {
        assert_eq!(LENGTH.to_string(), "0.005 to 10 m");
        assert_eq!(HALF_WIDTH.to_string(), "1e-5 to 10 m");
        assert_eq!(SHEAR_MODULUS.to_string(), "100 to 1e12 Pa");
        assert_eq!(LOSS_FACTOR.to_string(), "0 to 0.5");
        for (low, high, wanted) in [
            (60.005_999_999_999_986, 1_052.621_421, "60.006 to 1052.6"),
            (59.999_999_999_999_986, 0.299_699_999_999_999_97, "60 to 0.29969"),
            (0.08 + 1e-3 * 0.3, 0.3, "0.0803 to 0.3"),
            (-2.000_001, -1e-9 / 3.0, "-2 to -3.3334e-10"),
        ] {
            let range = Range::new(low, high, "");
            assert_eq!(range.to_string(), wanted);
            assert!(at_least(low, 5) >= low && at_most(high, 5) <= high, "{wanted}");
        }
    }
}
