//! Numbers with units as displayed to users, each in the unit that suits its size.

use super::number_format::{at_least, at_most, fixed, typed};
use std::fmt;

/// The quantity of a range, which determines the units of its ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Metres.
    Length,
    /// Hertz.
    Frequency,
    /// Seconds.
    Time,
    /// A quantity with one unit only; empty for a pure number.
    Plain(&'static str),
}

impl Measure {
    /// The quantity of numbers in this SI unit.
    #[must_use]
    pub fn of(unit: &'static str) -> Self {
        match unit {
            "m" => Self::Length,
            "Hz" => Self::Frequency,
            "s" => Self::Time,
            unit => Self::Plain(unit),
        }
    }

    /// A finite number rounded to four digits by `round`, in the unit that suits it.
    fn written(self, value: f64, round: fn(f64, usize) -> f64) -> String {
        let units: &[(f64, &str)] = match self {
            Self::Length => &[(1.0, "m"), (1e-3, "mm"), (1e-6, "µm"), (1e-9, "nm")],
            Self::Frequency => &[(1e6, "MHz"), (1e3, "kHz"), (1.0, "Hz")],
            Self::Time => &[(1.0, "s"), (1e-3, "ms")],
            Self::Plain(unit) => &[(1.0, unit)],
        };
        let suits = units.iter().find(|(factor, _)| value.abs() >= factor * (1.0 - 1e-9));
        // Zero has the first unit; a value below the smallest unit has the last.
        let otherwise = if value == 0.0 { units.first() } else { units.last() };
        let (factor, unit) = *suits.or(otherwise).unwrap_or(&(1.0, ""));
        // The rounding error of the division must not count as a digit.
        let scaled: f64 = format!("{:.11e}", value / factor).parse().unwrap_or(value / factor);
        format!("{} {unit}", typed(round(scaled, 4))).trim_end().to_owned()
    }
}

/// A range as a user would type it: `5 mm to 10 m`, each end rounded inwards to four digits, so that it is allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TypedRange {
    /// Lower end, in SI units.
    pub low: f64,
    /// Upper end, in SI units.
    pub high: f64,
    /// The quantity.
    pub measure: Measure,
}

impl fmt::Display for TypedRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (low, high) =
            (self.measure.written(self.low, at_least), self.measure.written(self.high, at_most));
        match (low.split_once(' '), high.split_once(' ')) {
            (Some((number, unit)), Some((_, same))) if unit == same => write!(f, "{number} to {high}"),
            _ => write!(f, "{low} to {high}"),
        }
    }
}

/// The text of a [`TypedRange`].
#[must_use]
pub fn show_range(low: f64, high: f64, measure: Measure) -> String {
    TypedRange { low, high, measure }.to_string()
}

/// A value as a user would type it, to the last digit, in the unit that suits it: `1.0001`, `3 dB`, `1 ms`.
pub(super) fn show_value(value: f64, measure: Measure) -> String {
    if value.is_finite() { measure.written(value, |value, _| value) } else { "no number".to_owned() }
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
    format!("{} mm", fixed(metres * 1e3, 1))
}

/// How far a place may be off, in the place's own unit: `± 0.92 mm`.
#[must_use]
pub fn show_half_width(metres: f64) -> String {
    format!("± {} mm", fixed(metres * 1e3, if metres.abs() < 1e-3 { 2 } else { 1 }))
}

/// A frequency in the unit that suits it: `126.4 Hz`, `40.00 kHz`.
#[must_use]
pub fn show_frequency(hertz: f64) -> String {
    match hertz.abs() {
        f if !f.is_finite() => "–".to_owned(),
        f if f >= 10_000.0 => format!("{:.2} kHz", hertz / 1e3),
        f if f >= 1000.0 => format!("{:.3} kHz", hertz / 1e3),
        _ => format!("{} Hz", fixed(hertz, 1)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_is_stated_in_its_own_units_and_its_ends_are_allowed() {
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
    fn a_place_and_how_far_it_may_be_off_share_a_unit() {
        for (metres, wanted) in
            [(0.00092, "± 0.92 mm"), (0.0031, "± 3.1 mm"), (2e-5, "± 0.02 mm"), (0.0, "± 0.00 mm")]
        {
            assert_eq!(show_half_width(metres), wanted);
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
        assert_eq!((show_place(-1e-5), show_frequency(-0.01)), ("0.0 mm".to_owned(), "0.0 Hz".to_owned()));
        assert_eq!(show_length(4.2e-6), "4.20 µm");
        assert_eq!(show_length(1.2e-4), "120 µm");
        assert_eq!(show_frequency(126.44), "126.4 Hz");
        assert_eq!(show_frequency(40_000.0), "40.00 kHz");
        assert_eq!(show_frequency(f64::NAN), "–");
    }
}
