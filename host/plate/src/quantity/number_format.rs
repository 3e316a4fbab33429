//! Format of numbers in messages: as a user would type them, with enough digits for a non-zero value.

/// A number as a user would type it, without trailing zeros or a row of leading zeros.
pub fn typed(value: f64) -> String {
    match value.abs() {
        size if size.is_nan() => "nan".to_owned(),
        0.0 => "0".to_owned(),
        size if (1e-4..1e7).contains(&size) || size.is_infinite() => value.to_string(),
        _ => format!("{value:e}"),
    }
}

/// A number with `decimals` decimals, or with enough of them for two significant digits where all would be zero:
/// `0.23`, `12.50`, `0.0034`.
pub fn with_decimals(value: f64, decimals: usize) -> String {
    let size = value.abs();
    let plain = fixed(value, decimals);
    if size == 0.0
        || !size.is_finite()
        || plain.contains(|digit: char| digit.is_ascii_digit() && digit != '0')
    {
        return plain;
    }
    if size < 1e-6 {
        return format!("{value:.1e}");
    }
    format!("{value:.*}", usize::try_from(1 - size.log10().floor() as i32).unwrap_or(decimals))
}

/// A number with `decimals` decimals, never a negative zero: `-0.0` is written `0.0`.
pub fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(size) if size.bytes().all(|byte| matches!(byte, b'0' | b'.')) => size.to_owned(),
        _ => text,
    }
}

/// A number with its sign and `decimals` decimals: `+0.5`, `-1.2`; what rounds to zero is `+0.0`.
pub fn signed(value: f64, decimals: usize) -> String {
    let text = fixed(value, decimals);
    if text.starts_with('-') { text } else { format!("+{text}") }
}

/// A number rounded to `decimals` decimals, without trailing zeros and never `-0`: `0.5`, `20`.
pub fn rounded(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// A number with `digits` significant digits (1 to 15), without trailing zeros; below 1e-9 and from 1e9 on with an
/// exponent and four digits: `7`, `0.000001`, `28.312`, `9.000e12`.
pub fn significant(value: f64, digits: usize) -> String {
    let decade = value.abs().log10().floor();
    if value == 0.0 || !value.is_finite() {
        return rounded(value, 0);
    }
    if !(-9.0..9.0).contains(&decade) {
        return format!("{value:.3e}");
    }
    rounded(value, (digits as f64 - 1.0 - decade).clamp(0.0, 12.0) as usize)
}

/// The smallest number of `digits` digits (1 to 15) that is not below `value`.
pub fn at_least(value: f64, digits: usize) -> f64 {
    -at_most(-value, digits)
}

/// The largest number of `digits` digits (1 to 15) that is not above `value`.
pub fn at_most(value: f64, digits: usize) -> f64 {
    let decimals = digits.clamp(1, 15) - 1;
    let rounded = |value: f64| format!("{value:.decimals$e}").parse().unwrap_or(value);
    let nearest: f64 = rounded(value);
    if nearest <= value || !value.is_finite() {
        return nearest;
    }
    // One step of the last digit towards the allowed side.
    rounded(nearest - 10f64.powi(nearest.abs().log10().floor() as i32 - decimals as i32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_written_without_rows_of_zeros() {
        for (value, wanted) in [
            (1e300, "1e300"),
            (-0.0, "0"),
            (0.0005, "0.0005"),
            (1e-7, "1e-7"),
            (20_000.0, "20000"),
            (f64::NAN, "nan"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(typed(value), wanted);
        }
    }

    #[test]
    fn a_small_number_keeps_two_of_its_digits() {
        for (value, wanted) in [
            (0.234, "0.23"),
            (12.5, "12.50"),
            (0.0344, "0.03"),
            (-0.00344, "-0.0034"),
            (2e-9, "2.0e-9"),
            (0.0, "0.00"),
            (-0.0, "0.00"),
        ] {
            assert_eq!(with_decimals(value, 2), wanted);
        }
    }

    #[test]
    fn what_rounds_to_zero_has_no_minus() {
        assert_eq!([fixed(-0.04, 1), fixed(-0.06, 1), fixed(0.0, 0)], ["0.0", "-0.1", "0"]);
        assert_eq!([signed(-0.04, 1), signed(-0.06, 1), signed(2.0, 1)], ["+0.0", "-0.1", "+2.0"]);
    }

    #[test]
    fn a_rounded_number_has_no_tail_of_zeros() {
        for (value, decimals, wanted) in [
            (1.0, 2, "1"),
            (0.5, 2, "0.5"),
            (-0.001, 2, "0"),
            (-0.0, 0, "0"),
            (120.0, 0, "120"),
            (20.0, 4, "20"),
            (1e-6, 12, "0.000001"),
            (f64::NAN, 2, "NaN"),
        ] {
            assert_eq!(rounded(value, decimals), wanted);
        }
    }

    #[test]
    fn a_number_keeps_the_requested_count_of_digits() {
        for (value, wanted) in [
            (7.0, "7"),
            (28.31234567, "28.312"),
            (-0.5, "-0.5"),
            (1e-6, "0.000001"),
            (123_456.7, "123457"),
            (9e12, "9.000e12"),
            (-0.0, "0"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(significant(value, 5), wanted);
        }
    }

    #[test]
    fn rounding_inwards_stays_inside() {
        assert_eq!((at_most(1052.69, 4), at_least(1052.61, 4)), (1052.0, 1053.0));
        assert_eq!((at_most(0.1, 5), at_least(1e-6, 5), at_least(0.0, 5)), (0.1, 1e-6, 0.0));
        for value in [0.299_699_999_999_999_97, 59.999_999_999_999_986, 1e-300, 1e300, 7.0 / 3.0] {
            assert!(at_most(value, 4) <= value && at_least(value, 4) >= value, "{value}");
        }
    }
}
