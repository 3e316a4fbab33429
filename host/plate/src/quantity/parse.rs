//! Numbers with units, parsed from the text of a user.
//!
//! A number may have a decimal comma or a decimal point, a space before its unit, and an SI prefix of the units
//! listed here. Nothing else is accepted; a comma before exactly three digits could divide thousands, and is refused unless the
//! number begins with 0.

use super::level::{decibels, from_decibels};
use super::refusal::QuantityError;

/// A typed value where both a place and a frequency are valid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlaceOrFrequency {
    /// A place on the plate, in metres from the driven end.
    Place(f64),
    /// A frequency, in Hz.
    Frequency(f64),
}

/// Largest number of characters of a typed value.
const LONGEST: usize = 64;

/// The minus sign of typesetters, as in text copied from a page.
const MINUS: char = '\u{2212}';

/// The leading number and the unit after it; a comma counts as a decimal point.
fn split(text: &str) -> Result<(f64, &str), QuantityError> {
    let text = text.trim();
    let refuse = || QuantityError::NoNumber(text.chars().take(LONGEST).collect());
    if text.len() > LONGEST {
        return Err(refuse());
    }
    // Below the largest f64, so that no unit's factor overflows.
    const LARGEST: f64 = 1e300;
    let is_numeric = |(index, c): (usize, char)| {
        let exponent = matches!(c, 'e' | 'E')
            && text[index + 1..].starts_with(|next: char| next.is_ascii_digit() || "+-".contains(next));
        let after_exponent =
            ['+', '-', MINUS].contains(&c) && (index == 0 || text[..index].ends_with(['e', 'E']));
        c.is_ascii_digit() || matches!(c, '.' | ',') || exponent || after_exponent
    };
    let end = text.char_indices().find(|&at| !is_numeric(at)).map_or(text.len(), |(index, _)| index);
    if let Some((before, after)) = text[..end].split_once(',')
        && !before.trim_start_matches(['+', '-']).starts_with('0')
        && after.chars().take_while(char::is_ascii_digit).count() == 3
    {
        return Err(QuantityError::Comma(text.to_owned()));
    }
    let number: f64 = text[..end].replace(',', ".").replace(MINUS, "-").parse().map_err(|_| refuse())?;
    // Zero has no sign: -0 is never displayed or sent.
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
        // A small m could also mean milli.
        _ if unit == "MHz" => Some(1e6),
        _ => None,
    }
}

/// The number of a text without a unit; `None` for a text with one, and for zero, which needs none.
///
/// # Errors
/// [`QuantityError`] for a text without a number.
pub fn bare(text: &str) -> Result<Option<f64>, QuantityError> {
    Ok(Some(split(text)?)
        .filter(|(number, unit)| unit.is_empty() && *number != 0.0)
        .map(|(number, _)| number))
}

/// A length in metres; a bare number is in millimetres.
///
/// # Errors
/// [`QuantityError`] for a text without a number, or with a unit other than m, cm, mm, um and nm.
pub fn length_m(text: &str) -> Result<f64, QuantityError> {
    let (number, unit) = split(text)?;
    let scale = if unit.is_empty() { Some(1e-3) } else { length_unit(unit) };
    scale.map(|scale| number * scale).ok_or_else(|| refused(unit, "m, cm, mm, um or nm"))
}

/// A frequency in Hz; a bare number is in Hz.
///
/// # Errors
/// [`QuantityError`] for a text without a number, or with a unit other than Hz, kHz and MHz.
pub fn frequency_hz(text: &str) -> Result<f64, QuantityError> {
    let (number, unit) = split(text)?;
    let scale = if unit.is_empty() { Some(1.0) } else { frequency_unit(unit) };
    scale.map(|scale| number * scale).ok_or_else(|| refused(unit, "Hz, kHz or MHz"))
}

/// A time in seconds; a bare number is in seconds.
///
/// # Errors
/// [`QuantityError`] for a text without a number, or with a unit other than s, ms and min.
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

/// A short time in seconds; a bare number is in milliseconds.
///
/// # Errors
/// [`QuantityError`] for a text without a number, or with a unit other than s, ms and min.
pub fn short_time_s(text: &str) -> Result<f64, QuantityError> {
    match split(text)? {
        (number, "") => Ok(number * 1e-3),
        _ => time_s(text),
    }
}

/// A level as a factor; a bare number is the factor itself, percent and dB are converted.
///
/// # Errors
/// [`QuantityError`] for a text without a number, or with a unit other than % and dB.
pub fn level(text: &str) -> Result<f64, QuantityError> {
    match split(text)? {
        (number, "") => Ok(number),
        (percent, "%") => Ok(percent * 1e-2),
        (decibel, unit) if unit.eq_ignore_ascii_case("dB") => Ok(from_decibels(decibel)),
        (_, unit) => Err(refused(unit, "% or dB")),
    }
}

/// A level in dB; a bare number is in dB, a percentage is an amplitude ratio, and 0 % is minus infinity.
///
/// # Errors
/// [`QuantityError`] for a text without a number, or with a unit other than dB and %.
pub fn decibel(text: &str) -> Result<f64, QuantityError> {
    match split(text)? {
        (number, "") => Ok(number),
        (percent, "%") => Ok(decibels(percent * 1e-2)),
        (number, unit) if unit.eq_ignore_ascii_case("dB") => Ok(number),
        (_, unit) => Err(refused(unit, "dB or %")),
    }
}

/// A place or a frequency; a bare number is a place in millimetres.
///
/// # Errors
/// [`QuantityError`] for a text without a number, or with a unit other than mm, cm, m, Hz and kHz.
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

/// A mass in kg; a bare number is in grams.
///
/// # Errors
/// [`QuantityError`] for a text without a number, or with a unit other than g, mg and kg.
pub fn mass_kg(text: &str) -> Result<f64, QuantityError> {
    match split(text)? {
        (grams, "" | "g") => Ok(1e-3 * grams),
        (milligrams, "mg") => Ok(1e-6 * milligrams),
        (kilograms, "kg") => Ok(kilograms),
        (_, unit) => Err(refused(unit, "g, mg or kg")),
    }
}

/// A plain number with an optional unit that must be `unit`.
///
/// # Errors
/// [`QuantityError`] for a text without a number, or with another unit.
pub fn plain(text: &str, unit: &'static str) -> Result<f64, QuantityError> {
    let (number, got) = split(text)?;
    if got.is_empty() || got == unit { Ok(number) } else { Err(refused(got, unit)) }
}

fn refused(unit: &str, allowed: &'static str) -> QuantityError {
    QuantityError::Unit { got: unit.to_owned(), allowed }
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
    fn a_text_that_is_no_number_or_has_a_foreign_unit_is_refused_in_words() {
        for text in ["", "mm", "nan", "inf Hz", "1.2.3", "--1", &"9".repeat(400)] {
            assert!(matches!(place_or_frequency(text), Err(QuantityError::NoNumber(_))), "{text}");
        }
        for (text, thousands, decimals) in [
            ("1,000ms", "1000ms", "1.000ms"),
            ("1,000", "1000", "1.000"),
            ("-12,125 m", "-12125 m", "-12.125 m"),
        ] {
            let refused = place_or_frequency(text).unwrap_err();
            assert_eq!(refused, QuantityError::Comma(text.to_owned()));
            assert_eq!(refused.to_string(), format!("did you mean {thousands} or {decimals}?"));
        }
        assert!((length_m("0,125 m").unwrap() - 0.125).abs() < 1e-12, "no thousands begin with 0");
        assert!((length_m("1,0005 m").unwrap() - 1.0005).abs() < 1e-12, "four digits are no thousands");
        assert_eq!((bare("160"), bare("0"), bare("160 mm")), (Ok(Some(160.0)), Ok(None), Ok(None)));
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
        assert_eq!(plain("\u{2212}6,5 dB", "dB"), Ok(-6.5));
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
    fn levels_and_short_times_are_typed_in_the_units_people_use() {
        for (text, wanted) in [("0,8", 0.8), ("80%", 0.8), ("80 %", 0.8), ("-20 dB", 0.1), ("0 db", 1.0)] {
            assert!((level(text).unwrap() - wanted).abs() < 1e-12, "{text}");
        }
        for (text, wanted) in [("-6,5", -6.5), ("-6.5 dB", -6.5), ("10 %", -20.0), ("0 %", f64::NEG_INFINITY)]
        {
            assert_eq!(decibel(text), Ok(wanted), "{text}");
        }
        assert!(decibel("-10 %").is_ok_and(f64::is_nan), "no level, and in no range");
        for (text, wanted) in [("20", 0.02), ("3 s", 3.0), ("0,5s", 0.5), ("7 ms", 0.007)] {
            assert!((short_time_s(text).unwrap() - wanted).abs() < 1e-12, "{text}");
        }
        for text in ["7 Hz", "x", "", "5 %%"] {
            assert!(level(text).is_err() && decibel(text).is_err() && short_time_s(text).is_err(), "{text}");
        }
    }
}
