//! A number outside the range of a protocol field, and its message, which equals that of the device's own
//! refusals.

use std::fmt;

/// A number that is outside its range or not a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutOfRange {
    /// The name of the value, with its unit: `boundary (mm)`.
    pub field: &'static str,
    /// The number.
    pub got: f64,
    /// The lowest allowed value.
    pub min: f64,
    /// The highest allowed value; infinite if there is none.
    pub max: f64,
}

impl OutOfRange {
    /// Refuses a number that is not in the range, and NaN.
    ///
    /// # Errors
    /// The field, the number and the range.
    pub(crate) fn check(field: &'static str, got: f64, min: f64, max: f64) -> Result<(), Self> {
        if got.is_finite() && (min..=max).contains(&got) {
            Ok(())
        } else {
            Err(Self { field, got, min, max })
        }
    }
}

impl fmt::Display for OutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { field, got, min, max } = self;
        write!(f, "{field} is {got}; allowed are {min} ")?;
        if max.is_finite() { write!(f, "to {max}") } else { f.write_str("or more") }
    }
}

impl std::error::Error for OutOfRange {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_that_does_not_fit_is_refused_with_its_field_and_range() {
        let said =
            |got, max| OutOfRange::check("glide time (s)", got, 0.0, max).map_err(|error| error.to_string());
        assert_eq!(said(0.0, f64::INFINITY), Ok(()));
        assert_eq!(said(-1.0, f64::INFINITY), Err("glide time (s) is -1; allowed are 0 or more".to_owned()));
        assert_eq!(said(11.0, 10.0), Err("glide time (s) is 11; allowed are 0 to 10".to_owned()));
        for got in [f64::NAN, f64::INFINITY] {
            assert!(said(got, f64::INFINITY).is_err(), "{got}");
        }
    }
}
