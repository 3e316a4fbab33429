//! The numbers that a plate's fields may have: one place for those who check them and those who tell of them.

use crate::quantity::numeral::{at_least, at_most, typed};
use crate::spec::error::{Origin, PlateError};
use std::fmt;

/// The numbers that a field may have, both ends included; an infinite end bounds nothing. Written as `0.005 to 10 m`,
/// each end as a person would type it: rounded to five digits, and inwards, so that what is named is allowed.
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

    /// From `low` up.
    pub const fn at_least(low: f64, unit: &'static str) -> Self {
        Self::new(low, f64::INFINITY, unit)
    }

    /// Up to `high`.
    pub const fn at_most(high: f64, unit: &'static str) -> Self {
        Self::new(f64::NEG_INFINITY, high, unit)
    }

    /// The same with its ends rounded inwards to five digits: what may be told of it.
    #[must_use]
    pub fn rounded(self) -> Self {
        Self { low: at_least(self.low, 5), high: at_most(self.high, 5), unit: self.unit }
    }

    /// The range in words, with its ends written by `number` (which is given a finite one) and without its unit.
    pub fn in_words(self, number: impl Fn(f64) -> String) -> String {
        let Self { low, high, .. } = self;
        match (low.is_finite(), high.is_finite()) {
            (false, true) => format!("at most {}", number(high)),
            (true, false) => format!("at least {}", number(low)),
            _ => format!("{} to {}", number(low), number(high)),
        }
    }

    /// Whether a number is allowed; NaN never is.
    pub fn contains(self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// Refuses what is not allowed, naming the field.
    pub(crate) fn check(self, field: &str, value: f64) -> Result<(), PlateError> {
        if self.contains(value) { Ok(()) } else { Err(self.refuse(field, value, None)) }
    }

    /// As [`Range::check`], naming what moves the range too.
    pub(crate) fn check_from(self, origin: Origin, field: &str, value: f64) -> Result<(), PlateError> {
        if self.contains(value) { Ok(()) } else { Err(self.refuse(field, value, Some(origin))) }
    }

    pub(crate) fn refuse(self, field: &str, value: f64, origin: Option<Origin>) -> PlateError {
        PlateError::OutOfRange { field: field.to_owned(), value, range: self, origin }
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.rounded().in_words(typed))?;
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
pub const HALF_WIDTH: Range = Range::new(1e-5, 10.0, "m");
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
pub const FREQUENCY: Range = Range::new(0.5, 1e7, "Hz");
/// An actuator's resonance.
pub const RESONANCE: Range = Range::new(0.1, 1e7, "Hz");
/// An actuator's quality factor.
pub const QUALITY: Range = Range::new(0.1, 1000.0, "");
/// Width of the frame's rim of a design.
pub const RIM: Range = Range::new(0.01, 0.5, "m");

/// The nearest boundaries that a plate of this length may offer, metres from the driven end.
pub fn span_start(length_m: f64) -> Range {
    Range::new(1e-3 * length_m, 0.999 * length_m, "m")
}

/// How long a text or a list may be, both ends included. Written as `1 to 80`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Count {
    /// Fewest.
    pub least: usize,
    /// Most.
    pub most: usize,
    /// Of what.
    pub of: Counted,
}

/// What a [`Count`] counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Counted {
    /// Characters of a text that stands on one line, without control characters.
    Characters,
    /// Points of a list.
    Points,
}

impl Count {
    const fn new(least: usize, most: usize, of: Counted) -> Self {
        Self { least, most, of }
    }

    /// Whether so many are allowed.
    pub fn contains(self, count: usize) -> bool {
        (self.least..=self.most).contains(&count)
    }

    /// Whether a text is as long as is allowed and stands on one line.
    pub fn allows(self, text: &str) -> bool {
        self.contains(text.chars().count()) && !text.chars().any(char::is_control)
    }

    /// Refuses a text that is not allowed, naming the field.
    pub(crate) fn check_text(self, field: &str, text: &str) -> Result<(), PlateError> {
        if self.allows(text) { Ok(()) } else { Err(self.refuse(field, text.chars().count())) }
    }

    pub(crate) fn refuse(self, field: &str, count: usize) -> PlateError {
        PlateError::WrongCount { field: field.to_owned(), count, allowed: self }
    }
}

impl fmt::Display for Count {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} to {}", self.least, self.most)
    }
}

impl fmt::Display for Counted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Characters => "characters",
            Self::Points => "points",
        })
    }
}

/// Name of a plate.
pub const NAME: Count = Count::new(1, 80, Counted::Characters);
/// What a plate is, on one line.
pub const DESCRIPTION: Count = Count::new(0, 400, Counted::Characters);
/// Points of a sampled taper.
pub const TAPER_POINTS: Count = Count::new(2, 10_000, Counted::Points);

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
        assert_eq!(Range::at_most(28.312_34, "1/m").to_string(), "at most 28.312 1/m");
        assert_eq!(Range::at_least(0.3, "m").to_string(), "at least 0.3 m");
    }
}
