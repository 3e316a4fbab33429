//! The unit that a number without one was probably meant in.

use slipline_plate::quantity::{self, Measure, QuantityError};

/// The question whether a number without a unit was meant in another one; `None` for a text with a unit.
pub(super) fn no_unit(text: &str, measure: Measure, range: (f64, f64)) -> Option<QuantityError> {
    let number = quantity::bare(text).ok().flatten()?;
    let likely = likely_unit(measure, number, range)?;
    Some(QuantityError::NoUnit { given: text.trim().to_owned(), likely })
}

/// The unit that was probably meant: the first by which the number is in its range.
fn likely_unit(measure: Measure, number: f64, (low, high): (f64, f64)) -> Option<&'static str> {
    let units: &[(&str, f64)] = match measure {
        // Metres first: 0.21 is 210 mm on any plate on which 0.21 mm is a place, too.
        Measure::Length => &[("m", 1.0), ("mm", 1e-3), ("cm", 1e-2), ("um", 1e-6)],
        Measure::Frequency => &[("Hz", 1.0), ("kHz", 1e3)],
        Measure::Time => &[("s", 1.0), ("ms", 1e-3)],
        Measure::Plain("F") => &[("nF", 1e-9)],
        // A level needs no unit: it is a factor, or decibels.
        Measure::Plain("" | "dB") => return None,
        Measure::Plain(unit) => return Some(unit),
    };
    let fits = |(_, size): &&(&str, f64)| (low..=high).contains(&(number * size));
    let usual = if measure == Measure::Length { units.get(1) } else { units.first() };
    units.iter().find(fits).or(usual).map(|(unit, _)| *unit)
}
