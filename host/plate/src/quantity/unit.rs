//! The unit of an input field: formatting and parsing of its number.

use super::number_format::significant;
use super::parse;
use super::refusal::QuantityError;

/// Significant digits of a number in a field: more than any measurement has, but few enough to hide the rounding of a
/// change of units.
pub const FIELD_DIGITS: usize = 7;

/// The unit of a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unit {
    /// Millimetres.
    Millimetre,
    /// Hertz, or kilohertz from 1 kHz on.
    Hertz,
    /// A unit of this name, with its size in the library's unit.
    Times(&'static str, f64),
    /// No unit.
    Pure,
}

impl Unit {
    /// The unit's name for a number of this size, and its size in the library's unit.
    #[must_use]
    pub fn shown(self, value: f64) -> (&'static str, f64) {
        match self {
            Self::Millimetre => ("mm", 1e-3),
            Self::Hertz if value.abs() >= 1e3 => ("kHz", 1e3),
            Self::Hertz => ("Hz", 1.0),
            Self::Times(name, size) => (name, size),
            Self::Pure => ("", 1.0),
        }
    }

    /// A number in the library's unit as text for the field, with this many significant digits.
    #[must_use]
    pub fn written(self, value: f64, digits: usize) -> String {
        let (name, size) = self.shown(value);
        format!("{} {name}", significant(value / size, digits)).trim_end().to_owned()
    }

    /// Parses a number that was typed into the field; the result is in the library's unit.
    ///
    /// # Errors
    /// [`QuantityError`] for a text that is not a number, or has a unit that does not fit.
    pub fn read(self, text: &str) -> Result<f64, QuantityError> {
        match self {
            Self::Millimetre => parse::length_m(text),
            Self::Hertz => parse::frequency_hz(text),
            Self::Times(name, size) => parse::plain(text, name).map(|number| number * size),
            Self::Pure => parse::plain(text, ""),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_of_any_size_reads_back_from_its_field() {
        for (unit, value, text) in [
            (Unit::Millimetre, 1e-9, "0.000001 mm"),
            (Unit::Millimetre, 0.34, "340 mm"),
            (Unit::Times("1/m", 1.0), 4.62, "4.62 1/m"),
            (Unit::Times("GPa", 1e9), 70e9, "70 GPa"),
            (Unit::Hertz, 28_500.0, "28.5 kHz"),
            (Unit::Pure, 0.0, "0"),
        ] {
            assert_eq!(unit.written(value, FIELD_DIGITS), text, "{unit:?}");
            let read = unit.read(text).unwrap();
            assert!((read - value).abs() <= 1e-12 * value, "{unit:?}: {read}");
        }
    }
}
