//! A number outside the range of a protocol field, and its message, which equals that of the device's own
//! refusals.

use std::borrow::Cow;
use std::fmt;

/// A number that is outside its range or not a number.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct OutOfRange {
    /// The name of the value, with its unit: `boundary (mm)`.
    pub field: Cow<'static, str>,
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
            Err(Self { field: field.into(), got, min, max })
        }
    }
}

impl fmt::Display for OutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { ref field, got, min, max } = *self;
        let decimals = decimals(if got > max { got - max } else { min - got });
        // A bound is rounded into the range, so that what is shown as allowed is accepted.
        let shown = |bound: f64, round: fn(f64) -> f64| {
            let unit = 0.1_f64.powi(decimals);
            let count = bound / unit;
            let whole = if (count - count.round()).abs() < 1e-6 + 1e-12 * count.abs() {
                count.round()
            } else {
                round(count)
            };
            text(whole * unit, decimals)
        };
        write!(f, "{field} is {}; allowed are {} ", text(got, decimals), shown(min, f64::ceil))?;
        if max.is_finite() { write!(f, "to {}", shown(max, f64::floor)) } else { f.write_str("or more") }
    }
}

/// Decimals by which a number is seen to lie `beyond` another: 1 to 9, and 9 where nothing can be compared.
fn decimals(beyond: f64) -> i32 {
    if beyond.is_finite() { (1 - beyond.log10().floor().min(0.0) as i32).min(9) } else { 9 }
}

fn text(value: f64, decimals: i32) -> String {
    let text = format!("{value:.*}", decimals as usize);
    let text = if value.is_finite() { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    text.to_owned()
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
        assert_eq!(said(10.1234567, 10.0), Err("glide time (s) is 10.12; allowed are 0 to 10".to_owned()));
        let close = OutOfRange::check("boundary (mm)", 264.977_133_470_569, 80.0, 264.971_2);
        let close = close.map_err(|error| error.to_string());
        assert_eq!(close, Err("boundary (mm) is 264.9771; allowed are 80 to 264.9712".to_owned()));
        let least =
            OutOfRange::check("amplitude (codes)", 0.01, 0.0625, 2047.0).map_err(|error| error.to_string());
        assert_eq!(least, Err("amplitude (codes) is 0.01; allowed are 0.063 to 2047".to_owned()));
        for got in [f64::NAN, f64::INFINITY] {
            assert!(said(got, f64::INFINITY).is_err(), "{got}");
        }
    }
}
