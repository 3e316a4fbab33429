//! The values of `slipline design`'s options.

use super::argument::{self, Typed};
use slipline_plate::PlateError;
use slipline_plate::design::{Material, band_high_range};
use slipline_plate::limits;
use slipline_plate::limits::BAND_WIDTH_MIN_PERCENT;
use slipline_plate::quantity::{self, Measure, NotAllowed, QuantityError, TypedRange, must_be, only};
use std::borrow::Cow;

pub(super) fn band(text: &str) -> Result<(f64, f64), String> {
    let (low, high) = text.split_once("..").ok_or("write LOW..HIGH, such as 20kHz..40kHz")?;
    let low = with_unit_of(low, high);
    let allowed = (limits::FREQUENCY.low, limits::FREQUENCY.high);
    let frequency = argument::within(quantity::frequency_hz, Measure::Frequency, allowed);
    let end =
        |which: &str, text: &str| frequency(text).map_err(|error| format!("its {which} frequency: {error}"));
    let (low_hz, high_hz) = (end("lowest", &low)?, end("highest", high)?);
    // Both have been checked against their range.
    if !band_high_range(low_hz).contains(high_hz) {
        let allowed = format!("at least {BAND_WIDTH_MIN_PERCENT} % above the lowest");
        return Err(must_be("its highest frequency", allowed));
    }
    Ok((low_hz, high_hz))
}

/// `low` with the unit of `high` if it has no unit: `20..40kHz` means 20 to 40 kHz.
fn with_unit_of<'t>(low: &'t str, high: &str) -> Cow<'t, str> {
    let is_number = |text: &str| text.trim().parse::<f64>().is_ok();
    let places = high.char_indices().map(|(place, _)| place).rev();
    // The longest prefix that is a number: in 40e3Hz it includes the e.
    let unit = places.map(|place| high.split_at(place)).find(|(number, _)| is_number(number));
    match unit {
        Some((_, unit)) if is_number(low) && !is_number(high) => format!("{}{unit}", low.trim()).into(),
        _ => low.into(),
    }
}

pub(super) fn speed() -> impl Fn(&str) -> Result<f64, NotAllowed<TypedRange>> + Clone + Send + Sync + 'static
{
    let allowed = (limits::WAVE_SPEED.low, limits::WAVE_SPEED.high);
    argument::within(|text| quantity::plain(text, "m/s"), Measure::Plain("m/s"), allowed)
}

pub(super) fn loss() -> impl Fn(&str) -> Result<f64, NotAllowed<TypedRange>> + Clone + Send + Sync + 'static {
    let allowed = (limits::LOSS_FACTOR.low, limits::LOSS_FACTOR.high);
    argument::within(|text| quantity::plain(text, ""), Measure::Plain(""), allowed)
}

pub(super) fn tension(text: &str) -> Result<Typed<f64>, QuantityError> {
    argument::typed(text, |text| quantity::plain(text, "N/m"), f64::NAN)
}

pub(super) fn margin(text: &str) -> Result<Typed<f64>, QuantityError> {
    argument::typed(text, quantity::length_m, f64::NAN)
}

pub(super) fn material(text: &str) -> Result<Material, String> {
    // The command line's parser adds the option and the value.
    Material::named(text).map_err(|error| {
        if let PlateError::UnknownKind { allowed, .. } = error { only(allowed) } else { error.to_string() }
    })
}

pub(super) fn name(text: &str) -> Result<String, String> {
    if limits::NAME.allows(text) {
        return Ok(text.to_owned());
    }
    Err(only(format_args!("{} on one line", limits::NAME.with_unit())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_at_the_end_of_a_band_counts_for_both_of_its_ends() {
        for text in ["20..40kHz", "20kHz..40kHz", " 20 .. 40 kHz", "20e3..40e3Hz", "20000Hz..40kHz"] {
            let (low_hz, high_hz) = band(text).unwrap_or_else(|error| panic!("{text}: {error}"));
            assert!(
                (low_hz - 20e3).abs() < 1e-6 && (high_hz - 40e3).abs() < 1e-6,
                "{text}: {low_hz} {high_hz}"
            );
        }
        for text in ["20..", "20000..40000", "..40kHz", "20", "20..40mm", "x..40kHz"] {
            assert!(band(text).is_err(), "{text}");
        }
    }
}
