//! Numbers with units, as people type and read them.
//!
//! A number may carry a decimal comma or a decimal point, a space before its unit, and an SI prefix of the units
//! named here. Nothing else is guessed.

use slipline_plate::number_format::{at_least, at_most, typed};

/// What a person typed where both a place and a frequency make sense.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlaceOrFrequency {
    /// A place on the plate, in metres from the driven end.
    Place(f64),
    /// A frequency, in Hz.
    Frequency(f64),
}

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

/// The most characters a typed value may have; longer input is no number.
const LONGEST: usize = 64;

/// The number in front and the unit behind it; a comma counts as a decimal point.
fn split(text: &str) -> Result<(f64, &str), QuantityError> {
    let text = text.trim();
    let refuse = || QuantityError::NoNumber(text.chars().take(LONGEST).collect());
    if text.len() > LONGEST {
        return Err(refuse());
    }
    // Not only what overflows: no unit's factor may make it infinite.
    const LARGEST: f64 = 1e300;
    let is_numeric = |(index, c): (usize, char)| {
        let exponent = matches!(c, 'e' | 'E')
            && text[index + 1..].starts_with(|next: char| next.is_ascii_digit() || "+-".contains(next));
        let after_exponent = "+-".contains(c) && (index == 0 || text[..index].ends_with(['e', 'E']));
        c.is_ascii_digit() || matches!(c, '.' | ',') || exponent || after_exponent
    };
    let end = text.char_indices().find(|&at| !is_numeric(at)).map_or(text.len(), |(index, _)| index);
    let number: f64 = text[..end].replace(',', ".").parse().map_err(|_| refuse())?;
    // A zero has no sign here: nothing is shown or sent as -0.
    match number.abs() {
        size if size <= LARGEST => Ok((number + 0.0, text[end..].trim())),
        _ => Err(QuantityError::TooLarge(text.to_owned())),
    }
}

fn length_unit(unit: &str) -> Option<f64> {
    match unit {
        "m" => Some(1.0),
        "cm" => Some(1e-2),
        "mm" => Some(1e-3),
        "um" | "µm" | "μm" => Some(1e-6),
        "nm" => Some(1e-9),
        _ => None,
    }
}

fn frequency_unit(unit: &str) -> Option<f64> {
    match unit.to_ascii_lowercase().as_str() {
        "hz" => Some(1.0),
        "khz" => Some(1e3),
        // A small m could as well be milli.
        _ if unit == "MHz" => Some(1e6),
        _ => None,
    }
}

/// A length in metres; a bare number is in millimetres.
///
/// # Errors
/// [`QuantityError`] for what is no number or not m, cm, mm, um or nm.
pub fn length_m(text: &str) -> Result<f64, QuantityError> {
    let (number, unit) = split(text)?;
    let scale = if unit.is_empty() { Some(1e-3) } else { length_unit(unit) };
    scale.map(|scale| number * scale).ok_or_else(|| refused(unit, "m, cm, mm, um or nm"))
}

/// A frequency in Hz; a bare number is in Hz.
///
/// # Errors
/// [`QuantityError`] for what is no number or not Hz, kHz or MHz.
pub fn frequency_hz(text: &str) -> Result<f64, QuantityError> {
    let (number, unit) = split(text)?;
    let scale = if unit.is_empty() { Some(1.0) } else { frequency_unit(unit) };
    scale.map(|scale| number * scale).ok_or_else(|| refused(unit, "Hz, kHz or MHz"))
}

/// A time in seconds; a bare number is in seconds.
///
/// # Errors
/// [`QuantityError`] for what is no number or not s, ms or min.
pub fn time_s(text: &str) -> Result<f64, QuantityError> {
    let (number, unit) = split(text)?;
    let scale = match unit {
        "" | "s" => 1.0,
        "ms" => 1e-3,
        "min" => 60.0,
        _ => return Err(refused(unit, "s, ms or min")),
    };
    Ok(number * scale)
}

/// A place or a frequency; a bare number is a place in millimetres.
///
/// # Errors
/// [`QuantityError`] for what is no number or not mm, cm, m, Hz or kHz.
pub fn place_or_frequency(text: &str) -> Result<PlaceOrFrequency, QuantityError> {
    let (number, unit) = split(text)?;
    if unit.is_empty() {
        return Ok(PlaceOrFrequency::Place(number * 1e-3));
    }
    length_unit(unit)
        .map(|scale| PlaceOrFrequency::Place(number * scale))
        .or_else(|| frequency_unit(unit).map(|scale| PlaceOrFrequency::Frequency(number * scale)))
        .ok_or_else(|| refused(unit, "mm, cm, m, Hz, kHz or MHz"))
}

/// A plain number with an optional unit that must be `unit`.
///
/// # Errors
/// [`QuantityError`] for what is no number, or carries another unit.
pub fn plain(text: &str, unit: &'static str) -> Result<f64, QuantityError> {
    let (number, got) = split(text)?;
    if got.is_empty() || got == unit { Ok(number) } else { Err(refused(got, unit)) }
}

fn refused(unit: &str, allowed: &'static str) -> QuantityError {
    QuantityError::Unit { got: unit.to_owned(), allowed }
}

/// What a range is of, and so the units that its ends are told in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Metres.
    Length,
    /// Hertz.
    Frequency,
    /// Seconds.
    Time,
    /// Of one unit only; empty for a pure number.
    Plain(&'static str),
}

/// A range as it would be typed: `5 mm to 10 m`, each end rounded inwards to four digits, so that it is allowed.
#[must_use]
pub fn show_range(low: f64, high: f64, measure: Measure) -> String {
    let units: &[(f64, &str)] = match measure {
        Measure::Length => &[(1.0, "m"), (1e-3, "mm"), (1e-6, "µm"), (1e-9, "nm")],
        Measure::Frequency => &[(1e6, "MHz"), (1e3, "kHz"), (1.0, "Hz")],
        Measure::Time => &[(1.0, "s"), (1e-3, "ms")],
        Measure::Plain(unit) => &[(1.0, unit)],
    };
    let end = |value: f64, round: fn(f64, usize) -> f64| {
        let suits = units.iter().find(|(factor, _)| value.abs() >= factor * (1.0 - 1e-9));
        // Nothing is nothing of the first unit; what is smaller than all units is told in the last.
        let otherwise = if value == 0.0 { units.first() } else { units.last() };
        let (factor, unit) = *suits.or(otherwise).unwrap_or(&(1.0, ""));
        // The division's own error must not count as a digit to be rounded away.
        let scaled: f64 = format!("{:.11e}", value / factor).parse().unwrap_or(value / factor);
        format!("{} {unit}", typed(round(scaled, 4))).trim_end().to_owned()
    };
    let (low, high) = (end(low, at_least), end(high, at_most));
    match (low.split_once(' '), high.split_once(' ')) {
        (Some((number, unit)), Some((_, same))) if unit == same => format!("{number} to {high}"),
        _ => format!("{low} to {high}"),
    }
}

/// A value with four digits and the prefix that suits it: `26.67 N s/m`, `6.213 mN s/m`.
#[must_use]
pub fn show_si(value: f64, unit: &str) -> String {
    const PREFIXES: [(i32, &str); 8] =
        [(9, "G"), (6, "M"), (3, "k"), (0, ""), (-3, "m"), (-6, "µ"), (-9, "n"), (-12, "p")];
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 { format!("0 {unit}") } else { "–".to_owned() };
    }
    // Rounded first: 999.96 is 1.000 k.
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    let exponent = rounded.abs().log10().floor() as i32;
    let (power, prefix) = PREFIXES.into_iter().find(|(power, _)| exponent >= *power).unwrap_or((-12, "p"));
    let decimals = usize::try_from(3 - (exponent - power)).unwrap_or(0);
    format!("{:.decimals$} {prefix}{unit}", rounded / 10f64.powi(power))
}

/// A length in the unit that suits it: `120.0 mm`, `4.2 µm`.
#[must_use]
pub fn show_length(metres: f64) -> String {
    match metres.abs() {
        m if !m.is_finite() => "–".to_owned(),
        m if m >= 1e-3 => format!("{:.1} mm", metres * 1e3),
        m if m >= 1e-4 => format!("{:.0} µm", metres * 1e6),
        m if m >= 1e-5 => format!("{:.1} µm", metres * 1e6),
        m if m >= 1e-6 => format!("{:.2} µm", metres * 1e6),
        0.0 => "0 µm".to_owned(),
        _ => format!("{:.1} nm", metres * 1e9),
    }
}

/// A place on the plate: always millimetres with one decimal.
#[must_use]
pub fn show_place(metres: f64) -> String {
    format!("{:.1} mm", metres * 1e3)
}

/// A frequency in the unit that suits it: `126.4 Hz`, `40.00 kHz`.
#[must_use]
pub fn show_frequency(hertz: f64) -> String {
    match hertz.abs() {
        f if !f.is_finite() => "–".to_owned(),
        f if f >= 10_000.0 => format!("{:.2} kHz", hertz / 1e3),
        f if f >= 1000.0 => format!("{:.3} kHz", hertz / 1e3),
        _ => format!("{hertz:.1} Hz"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_boundary_is_typed_in_millimetres_hertz_or_kilohertz_with_point_or_comma() {
        for (text, want) in [
            ("120", PlaceOrFrequency::Place(0.12)),
            ("120 mm", PlaceOrFrequency::Place(0.12)),
            (" 12,5cm", PlaceOrFrequency::Place(0.125)),
            ("0.12 m", PlaceOrFrequency::Place(0.12)),
            ("40kHz", PlaceOrFrequency::Frequency(40_000.0)),
            ("40,5 khz", PlaceOrFrequency::Frequency(40_500.0)),
            ("1.2e2 Hz", PlaceOrFrequency::Frequency(120.0)),
        ] {
            match (place_or_frequency(text), want) {
                (Ok(PlaceOrFrequency::Place(a)), PlaceOrFrequency::Place(b))
                | (Ok(PlaceOrFrequency::Frequency(a)), PlaceOrFrequency::Frequency(b)) => {
                    assert!((a - b).abs() < 1e-9 * b.max(1.0), "{text}: {a}");
                }
                (got, _) => panic!("{text}: {got:?}"),
            }
        }
    }

    #[test]
    fn what_is_no_number_or_has_a_foreign_unit_is_refused_in_words() {
        for text in ["", "mm", "nan", "inf Hz", "1.2.3", "--1", &"9".repeat(400)] {
            assert!(matches!(place_or_frequency(text), Err(QuantityError::NoNumber(_))), "{text}");
        }
        for text in ["1e999", "-1e999 Hz", "1e305 kHz"] {
            assert_eq!(place_or_frequency(text), Err(QuantityError::TooLarge(text.to_owned())));
        }
        assert_eq!(
            plain("50 %", "").unwrap_err().to_string(),
            "\"%\" is no unit that fits here: write the number alone"
        );
        assert!(place_or_frequency("120 kg").unwrap_err().to_string().contains("mm, cm, m, Hz, kHz or MHz"));
        assert!(length_m("40 kHz").is_err());
        assert_eq!(plain("-6,5 dB", "dB"), Ok(-6.5));
        assert!(plain("3 mm", "dB").is_err());
    }

    #[test]
    fn frequencies_and_times_carry_their_units() {
        assert_eq!(frequency_hz("400kHz"), Ok(400_000.0));
        assert_eq!(frequency_hz("39997"), Ok(39_997.0));
        assert_eq!(frequency_hz("0.4 MHz"), Ok(400_000.0));
        assert!(frequency_hz("400 mHz").is_err());
        assert!(frequency_hz("2 s").unwrap_err().to_string().contains("Hz, kHz or MHz"));
        assert_eq!(time_s("2s"), Ok(2.0));
        assert_eq!(time_s("0,5 min"), Ok(30.0));
        assert!((time_s("250ms").unwrap() - 0.25).abs() < 1e-12);
        assert!(time_s("2 m").is_err());
    }

    #[test]
    fn a_range_is_told_in_its_own_units_and_its_ends_are_allowed() {
        for (low, high, measure, wanted) in [
            (0.005, 10.0, Measure::Length, "5 mm to 10 m"),
            (0.07, 0.28, Measure::Length, "70 to 280 mm"),
            (1e-9, 0.1, Measure::Length, "1 nm to 100 mm"),
            (59.999_999_999_999_986, 1_052.621, Measure::Frequency, "60 Hz to 1.052 kHz"),
            (86.8213, 218.77, Measure::Frequency, "86.83 to 218.7 Hz"),
            (0.0, 600.0, Measure::Time, "0 to 600 s"),
            (0.01, 2.62144, Measure::Time, "10 ms to 2.621 s"),
            (0.0, 1.0, Measure::Plain(""), "0 to 1"),
            (0.1, 2e4, Measure::Plain("m/s"), "0.1 to 20000 m/s"),
        ] {
            assert_eq!(show_range(low, high, measure), wanted);
        }
    }

    #[test]
    fn a_small_value_keeps_its_four_digits() {
        for (value, wanted) in [
            (26.67034, "26.67 N"),
            (0.006_213_4, "6.213 mN"),
            (1.2e-7, "120.0 nN"),
            (0.999_96, "1.000 N"),
            (-4.5e4, "-45.00 kN"),
            (3e-16, "0.0003000 pN"),
            (0.0, "0 N"),
        ] {
            assert_eq!(show_si(value, "N"), wanted);
        }
    }

    #[test]
    fn lengths_and_frequencies_are_shown_in_the_unit_that_suits_them() {
        assert_eq!(show_place(0.12), "120.0 mm");
        assert_eq!(show_length(4.2e-6), "4.20 µm");
        assert_eq!(show_length(1.2e-4), "120 µm");
        assert_eq!(show_frequency(126.44), "126.4 Hz");
        assert_eq!(show_frequency(40_000.0), "40.00 kHz");
        assert_eq!(show_frequency(f64::NAN), "–");
    }
}
