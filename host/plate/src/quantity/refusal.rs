//! The wording of refusals: of a typed text that is not a number, of a number out of its range, of a text or list
//! that is too long.
//!
//! An error carries the field, the value and the range as data; its sentence is made here. A test of the workspace
//! (`tests/tests/wording.rs`) asserts that nothing else in the host words a refusal of its own.

use super::display::{Measure, show_range, show_value};
use super::number_format::typed;
use super::range::{Count, Range};
use crate::StaticText;
use std::fmt;

/// `length_m = 11: must be 0.005 to 10 m`: the given value and the allowed range.
#[must_use]
pub fn must_be(given: impl fmt::Display, allowed: impl fmt::Display) -> String {
    format!("{given}: {}", only(allowed))
}

/// `must be 0.005 to 10 m`: the allowed range alone, where the caller displays the value.
#[must_use]
pub fn only(allowed: impl fmt::Display) -> String {
    format!("must be {allowed}")
}

/// A number that is outside its range, or not a number.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct OutOfRange {
    /// The name of the field in its function or type.
    #[serde(with = "crate::static_text")]
    pub field: StaticText,
    /// The given value, in the range's unit.
    pub value: f64,
    /// The allowed range.
    pub range: Range,
}

impl OutOfRange {
    /// Refuses a number that is not in the range.
    ///
    /// # Errors
    /// The field, the value and the range.
    pub fn check(field: &'static str, value: f64, range: Range) -> Result<(), Self> {
        if range.contains(value) { Ok(()) } else { Err(Self { field, value, range }) }
    }

    /// As [`OutOfRange::check`], for a count.
    pub(crate) fn check_count(
        field: &'static str,
        count: usize,
        allowed: std::ops::RangeInclusive<usize>,
    ) -> Result<(), Self> {
        // Counts are far below 2^53, so this is exact.
        Self::check(field, count as f64, Range::new(*allowed.start() as f64, *allowed.end() as f64, ""))
    }

    /// The refusal in the units that suit the numbers: `glide = 1 ms: must be 5 ms to 10 s`.
    #[must_use]
    pub fn in_suitable_units(&self) -> String {
        let measure = Measure::of(self.range.unit);
        let given = format!("{} = {}", self.field, show_value(self.value, measure));
        must_be(given, show_range(self.range.low, self.range.high, measure))
    }
}

impl fmt::Display for OutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let space = if self.range.unit.is_empty() { "" } else { " " };
        let value = if self.value.is_nan() { "NaN".to_owned() } else { typed(self.value) };
        let given = format!("{} = {value}{space}{}", self.field, self.range.unit);
        // The range of a count is displayed to the last digit: rounding would exclude allowed counts.
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

/// A text or a list that is too short or too long.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct WrongCount {
    /// The text or list.
    #[serde(with = "crate::static_text")]
    pub field: crate::StaticText,
    /// Its number of characters, points or bytes.
    pub count: usize,
    /// The allowed count, with its items.
    pub allowed: Count,
}

impl WrongCount {
    /// Refuses a count that is not allowed.
    ///
    /// # Errors
    /// The field, the count and the allowed count.
    pub fn check(field: &'static str, count: usize, allowed: Count) -> Result<(), Self> {
        if allowed.contains(count) { Ok(()) } else { Err(Self { field, count, allowed }) }
    }
}

impl fmt::Display for WrongCount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&wrong_count(self.field, self.count, self.allowed))
    }
}

impl std::error::Error for WrongCount {}

/// `name has 0 characters: must be 1 to 80, on one line, without control characters`.
pub(crate) fn wrong_count(field: &str, count: usize, allowed: Count) -> String {
    must_be(
        format_args!("{field} has {count} {}", allowed.of),
        format_args!("{allowed}{}", allowed.of.rule()),
    )
}

/// A typed text that is not allowed: it has no number with a valid unit, or its number is out of range. The sentence
/// does not repeat the text: the caller displays it beside the message.
#[derive(Clone, Debug, PartialEq)]
pub struct NotAllowed<A> {
    /// Reason why no number was read; `None` where the number is out of range.
    pub mistake: Option<QuantityError>,
    /// The allowed values.
    pub allowed: A,
}

impl<A: fmt::Display> fmt::Display for NotAllowed<A> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.mistake {
            Some(question @ (QuantityError::Comma(_) | QuantityError::NoUnit { .. })) => {
                write!(f, "{question} ({})", only(&self.allowed))
            }
            Some(mistake) => write!(f, "{mistake}; {}", only(&self.allowed)),
            None => f.write_str(&only(&self.allowed)),
        }
    }
}

impl<A: fmt::Display + fmt::Debug> std::error::Error for NotAllowed<A> {}

/// Reason why a typed value is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum QuantityError {
    /// The text does not begin with a number.
    #[error("{0:?} does not begin with a number")]
    NoNumber(String),
    /// The number is too large for an f64.
    #[error("{0:?} is too large a number")]
    TooLarge(String),
    /// A comma before exactly three digits: thousands or decimals.
    #[error("did you mean {} or {}?", .0.replace(',', ""), .0.replace(',', "."))]
    Comma(String),
    /// A number without a unit, where several are valid.
    #[error("did you mean {given}{likely}?")]
    NoUnit {
        /// The text.
        given: String,
        /// The unit that was probably meant.
        likely: &'static str,
    },
    /// The unit is not valid here.
    #[error("{got:?} is no unit that fits here: {}", if .allowed.is_empty() { "write the number alone" } else { "use " }.to_owned() + .allowed)]
    Unit {
        /// The given unit.
        got: String,
        /// The valid units; empty where the number has no unit.
        allowed: &'static str,
    },
}

#[cfg(test)]
mod tests {
    use super::super::range::Counted;
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
    #[test]
    fn a_number_out_of_range_is_refused_in_the_units_that_suit_it() {
        let said = |field, value, (low, high), unit| {
            OutOfRange { field, value, range: Range::new(low, high, unit) }.in_suitable_units()
        };
        assert_eq!(said("glide", 0.001, (0.005, 10.0), "s"), "glide = 1 ms: must be 5 ms to 10 s");
        assert_eq!(said("level", 1.00001, (0.0, 1.0), ""), "level = 1.00001: must be 0 to 1");
        assert_eq!(said("master", f64::NAN, (-96.0, 0.0), "dB"), "master = no number: must be -96 to 0 dB");
        assert_eq!(said("place", 0.5, (0.08, 0.28), "m"), "place = 500 mm: must be 80 to 280 mm");
    }

    #[test]
    fn what_is_too_long_is_refused_with_its_length_and_the_longest() {
        let file = WrongCount::check("the file", 11, Count::at_most(10, Counted::Bytes)).unwrap_err();
        assert_eq!(file.to_string(), "the file has 11 bytes: must be at most 10");
        let name = WrongCount::check("name", 0, Count::new(1, 80, Counted::Characters)).unwrap_err();
        let wanted = "name has 0 characters: must be 1 to 80, on one line, without control characters";
        assert_eq!(name.to_string(), wanted);
        assert_eq!(WrongCount::check("tones", 16, Count::new(1, 16, Counted::Tones)), Ok(()));
    }

    #[test]
    fn a_typed_text_is_refused_with_its_mistake_and_what_is_allowed() {
        let allowed = "0 to 1";
        let mistake = QuantityError::NoNumber("x".to_owned());
        let unread = NotAllowed { mistake: Some(mistake), allowed };
        assert_eq!(unread.to_string(), "\"x\" does not begin with a number; must be 0 to 1");
        assert_eq!(NotAllowed { mistake: None, allowed }.to_string(), "must be 0 to 1");
        let mistake = QuantityError::NoUnit { given: "20".to_owned(), likely: "ms" };
        let asked = NotAllowed { mistake: Some(mistake), allowed: "5 ms to 10 s" };
        assert_eq!(asked.to_string(), "did you mean 20ms? (must be 5 ms to 10 s)");
    }
}
