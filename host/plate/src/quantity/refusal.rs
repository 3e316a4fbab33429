//! The words of a refusal: of a typed text that is no number, and of a number that is out of its range.
//!
//! An error carries the field, the value and the range as data; its sentence is made here, in the notation of whoever
//! shows it.

use super::number_format::typed;
use super::range::Range;
use std::fmt;

/// How fields and numbers are written in a sentence. Numbers come in SI units, fields as the plate file has them.
pub trait Notation {
    /// A field: `length_m`.
    fn field(&self, field: &str) -> String;
    /// A field with the number that it has: `length_m = 0.3`.
    fn given(&self, field: &str, value: f64) -> String;
    /// The numbers that a field may have, with their unit: `0.005 to 10 m`.
    fn range(&self, field: &str, range: Range) -> String;
    /// A length, with its unit.
    fn length(&self, metres: f64) -> String;
    /// A frequency, with its unit.
    fn frequency(&self, hertz: f64) -> String;
}

/// The notation of plate files: their own names, and their units.
pub(crate) struct PlateFile;

impl Notation for PlateFile {
    fn field(&self, field: &str) -> String {
        field.to_owned()
    }

    fn given(&self, field: &str, value: f64) -> String {
        format!("{field} = {}", typed(value))
    }

    fn range(&self, _field: &str, range: Range) -> String {
        range.to_string()
    }

    fn length(&self, metres: f64) -> String {
        format!("{} m", typed(metres))
    }

    fn frequency(&self, hertz: f64) -> String {
        format!("{} Hz", typed(hertz))
    }
}

/// `length_m = 11: must be 0.005 to 10 m`: what was given, and what is allowed.
pub(crate) fn must_be(given: impl fmt::Display, allowed: impl fmt::Display) -> String {
    format!("{given}: must be {allowed}")
}

/// A number that is outside its range, or not a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutOfRange {
    /// The field, as its function or type calls it.
    pub field: &'static str,
    /// The value that was given, in the range's unit.
    pub value: f64,
    /// The numbers that are allowed.
    pub range: Range,
}

impl OutOfRange {
    /// Refuses a number that is not in the range.
    ///
    /// # Errors
    /// The field, the value and the range.
    pub(crate) fn check(field: &'static str, value: f64, range: Range) -> Result<(), Self> {
        if range.contains(value) { Ok(()) } else { Err(Self { field, value, range }) }
    }

    /// As [`OutOfRange::check`], for a count.
    pub(crate) fn check_count(
        field: &'static str,
        count: usize,
        allowed: std::ops::RangeInclusive<usize>,
    ) -> Result<(), Self> {
        // Counts are far below 2^53: exact.
        Self::check(field, count as f64, Range::new(*allowed.start() as f64, *allowed.end() as f64, ""))
    }
}

impl fmt::Display for OutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let space = if self.range.unit.is_empty() { "" } else { " " };
        let value = if self.value.is_nan() { "NaN".to_owned() } else { typed(self.value) };
        let given = format!("{} = {value}{space}{}", self.field, self.range.unit);
        // A range of counts is told to the last digit: rounding would leave allowed ones out.
        let is_of_counts =
            self.range.unit.is_empty() && self.range.low.fract() == 0.0 && self.range.high.fract() == 0.0;
        if is_of_counts {
            f.write_str(&must_be(given, self.range.in_words(|end| end.to_string())))
        } else {
            f.write_str(&must_be(given, self.range))
        }
    }
}

impl std::error::Error for OutOfRange {}

/// Why a typed value is not taken.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum QuantityError {
    /// There is no number in front.
    #[error("{0:?} does not begin with a number")]
    NoNumber(String),
    /// The number is too large to be told from infinity.
    #[error("{0:?} is too large a number")]
    TooLarge(String),
    /// The unit is not one that fits here.
    #[error("{got:?} is no unit that fits here: {}", if .allowed.is_empty() { "write the number alone" } else { "use " }.to_owned() + .allowed)]
    Unit {
        /// What came.
        got: String,
        /// What would do; empty where no unit does.
        allowed: &'static str,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_out_of_range_is_refused_with_its_field_value_and_range() {
        let points = OutOfRange::check_count("points", 4, 8..=200_001).unwrap_err();
        assert_eq!(points.to_string(), "points = 4: must be 8 to 200001");
        let boundary = OutOfRange::check("boundary", 0.5, Range::new(3e-4, 0.3, "m")).unwrap_err();
        assert_eq!(boundary.to_string(), "boundary = 0.5 m: must be 0.0003 to 0.3 m");
        let level = OutOfRange::check("level", f64::NAN, Range::new(0.0, 1.0, "")).unwrap_err();
        assert_eq!(level.to_string(), "level = NaN: must be 0 to 1");
        assert_eq!(OutOfRange::check("level", 1.0, Range::new(0.0, 1.0, "")), Ok(()));
    }
}
