//! Arguments of the command line: quantities, places, plates.

use super::defaults;
use super::failure::Failure;
use super::likely_unit::no_unit;
use super::refusal::{Refusal, WholeNumber};
use super::source::read_text;
use clap::Args;
use slipline_model::field::asked_place::turning_point_on;
use slipline_model::named_plate::named_plate;
use slipline_plate::quantity::{
    self, Measure, NotAllowed, OutOfRange, PlaceOrFrequency, QuantityError, Range, TypedRange, show_range,
};
use slipline_plate::{Finger, PLATE_FILE_BYTES_MAX, Plate};
use std::path::Path;

/// The plate.
#[derive(Debug, Args)]
#[command(next_help_heading = "Plate")]
pub(super) struct PlateArgument {
    /// A preset's name or a TOML file. Without this option: SLIPLINE_PLATE of the environment, else plate = "..." of the
    /// settings file, else membrane.
    #[arg(long, value_name = "PLATE")]
    plate: Option<String>,
}

impl PlateArgument {
    /// The plate.
    pub(super) fn read(&self) -> Result<Plate, Failure> {
        plate_or_default(self.plate.as_deref())
    }
}

/// A value whose range depends on the plate or the device, with the typed text.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Typed<T> {
    pub(super) text: String,
    pub(super) value: T,
}

/// A tone's place, or its frequency.
pub(super) type PlaceArgument = Typed<PlaceOrFrequency>;

/// Parses a value and keeps the typed text. A text that is not a number, too large, or without its unit becomes NaN, which
/// is outside every range. It is refused later, where the range is known and the message can name it.
pub(super) fn typed<T>(
    text: &str,
    parse: fn(&str) -> Result<T, QuantityError>,
    not_a_number: T,
) -> Result<Typed<T>, QuantityError> {
    let value = match (quantity::bare(text), parse(text)) {
        (Ok(Some(_)), _) | (_, Err(QuantityError::TooLarge(_) | QuantityError::NoNumber(_))) => not_a_number,
        (_, parsed) => parsed?,
    };
    Ok(Typed { text: text.trim().to_owned(), value })
}

/// Refuses a number of a dimension without its unit, which is probably `likely`. In the window the unit stands in the field.
fn has_unit(text: &str, likely: &'static str) -> Result<(), QuantityError> {
    match quantity::bare(text)? {
        Some(_) => Err(QuantityError::NoUnit { given: text.trim().to_owned(), likely }),
        None => Ok(()),
    }
}

pub(super) fn place_or_frequency(text: &str) -> Result<PlaceArgument, QuantityError> {
    typed(text, quantity::place_or_frequency, PlaceOrFrequency::Place(f64::NAN))
}

pub(super) fn place(text: &str) -> Result<Typed<f64>, QuantityError> {
    typed(text, quantity::length_m, f64::NAN)
}

/// The place and frequency of a beat.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Beat {
    pub(super) place: Typed<f64>,
    pub(super) frequency: Typed<f64>,
}

/// Parses `120mm:180Hz`, a place and a frequency.
pub(super) fn beat(text: &str) -> Result<Beat, String> {
    let (at, how_fast) = text.rsplit_once(':').ok_or("write PLACE:FREQUENCY, such as 120mm:180Hz")?;
    if let Some(mistake) = no_unit(at, Measure::Length, LENGTHS_M) {
        return Err(format!("its place: {mistake}"));
    }
    let place = place(at).map_err(|error| format!("its place: {error}"))?;
    let frequency = frequency(how_fast).map_err(|error| format!("its frequency: {error}"))?;
    Ok(Beat { place, frequency })
}

pub(super) fn frequency(text: &str) -> Result<Typed<f64>, QuantityError> {
    // No range of a command has a number that is meant in another unit.
    if let Err(mistake @ QuantityError::NoUnit { .. }) = has_unit(text, "Hz") {
        return Err(mistake);
    }
    typed(text, quantity::frequency_hz, f64::NAN)
}

pub(super) fn time(text: &str) -> Result<Typed<f64>, QuantityError> {
    typed(text, quantity::time_s, f64::NAN)
}

/// A parser of a quantity with a fixed range.
pub(super) fn within(
    parse: fn(&str) -> Result<f64, QuantityError>,
    measure: Measure,
    (low, high): (f64, f64),
) -> impl Fn(&str) -> Result<f64, NotAllowed<TypedRange>> + Clone + Send + Sync + 'static {
    move |text| {
        let allowed = TypedRange { low, high, measure };
        match no_unit(text, measure, (low, high)).map_or_else(|| parse(text), Err) {
            Ok(value) if (low..=high).contains(&value) => Ok(value),
            Ok(_) | Err(QuantityError::TooLarge(_)) => Err(NotAllowed { mistake: None, allowed }),
            Err(mistake) => Err(NotAllowed { mistake: Some(mistake), allowed }),
        }
    }
}

/// A parser of a time, in seconds.
pub(super) fn seconds(
    low: f64,
    high: f64,
) -> impl Fn(&str) -> Result<f64, NotAllowed<TypedRange>> + Clone + Send + Sync + 'static {
    within(quantity::time_s, Measure::Time, (low, high))
}

/// A parser of a ratio, in decibels.
pub(super) fn decibels(
    low: f64,
    high: f64,
) -> impl Fn(&str) -> Result<f64, NotAllowed<TypedRange>> + Clone + Send + Sync + 'static {
    within(|text| quantity::plain(text, "dB"), Measure::Plain("dB"), (low, high))
}

/// A parser of a length, in metres.
pub(super) fn length(
    range: Range,
) -> impl Fn(&str) -> Result<f64, NotAllowed<TypedRange>> + Clone + Send + Sync + 'static {
    within(quantity::length_m, Measure::Length, (range.low, range.high))
}

/// A parser of a whole number.
pub(super) fn count(
    low: usize,
    high: usize,
) -> impl Fn(&str) -> Result<usize, NotAllowed<WholeNumber>> + Clone + Send + Sync + 'static {
    move |text| {
        let parsed = text.trim().parse().ok().filter(|count| (low..=high).contains(count));
        parsed.ok_or(NotAllowed { mistake: None, allowed: WholeNumber { low, high } })
    }
}

/// A level: a factor (0.8), a share (80%) or decibels (-6dB).
pub(super) fn level(text: &str) -> Result<f64, NotAllowed<TypedRange>> {
    within(quantity::level, Measure::Plain(""), (0.0, 1.0))(text)
}

impl Typed<f64> {
    /// The value if it is in its range. The error names `option`, the typed text and the range, followed by
    /// `more`.
    pub(super) fn within(
        &self,
        option: &str,
        range: Range,
        measure: Measure,
        more: &str,
    ) -> Result<f64, Failure> {
        if range.contains(self.value) {
            return Ok(self.value);
        }
        Err(Failure::outside(option, &self.text, range, measure, more))
    }

    /// The place of a sensor on a plate, metres.
    pub(super) fn of_sensor(&self, plate: &Plate) -> Result<f64, Failure> {
        let on_plate = Range::new(0.0, plate.length_m(), "m");
        self.within("--sensor", on_plate, Measure::Length, ", on the plate")
    }
}

impl PlaceArgument {
    /// The turning point in metres, within the plate's span: this place, or that of this frequency. An error names
    /// `option`.
    pub(super) fn turning_point_on(&self, plate: &Plate, option: &str) -> Result<f64, Failure> {
        turning_point_on(self.value, plate).map_err(|error| self.outside(plate, option, &error))
    }

    /// Refuses a number without its unit; an error names `option` and the unit by which it is a place of an edge.
    pub(super) fn with_unit(&self, plate: &Plate, option: &str) -> Result<(), Failure> {
        let edges = (plate.span_m().0, plate.length_m());
        match no_unit(&self.text, Measure::Length, edges) {
            Some(mistake) => Err(Failure::asked(option, &self.text, &mistake)),
            None => Ok(()),
        }
    }

    /// The refusal of a turning point outside the plate's span, or of a frequency outside its band.
    pub(super) fn outside(&self, plate: &Plate, option: &str, error: &OutOfRange) -> Failure {
        let show = |range: Range| show_range(range.low, range.high, Measure::of(range.unit));
        let (low_hz, high_hz) = plate.band_hz();
        let frequencies = match self.value {
            PlaceOrFrequency::Place(_) => {
                format!(", or {}", show_range(low_hz, high_hz, Measure::Frequency))
            }
            PlaceOrFrequency::Frequency(_) => String::new(),
        };
        let allowed = format_args!("{}{frequencies}, on the plate {:?}", show(error.range), plate.name());
        let range = Refusal::range(error.range.low, error.range.high, error.range.unit);
        Failure::value(option, &self.text, allowed).with_range(range)
    }
}

/// Lengths of contacts, and places on a plate that is not known yet.
const LENGTHS_M: (f64, f64) = (1e-3, 1.0);

/// A finger on the command line; `None` for no finger.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FingerArgument(pub(super) Option<Finger>);

/// Parses `120mm:light`, a place and a finger: none, light, firm, or resistance, mass and width of the
/// contact.
pub(super) fn finger(text: &str) -> Result<FingerArgument, String> {
    let form = "write PLACE:KIND, such as 120mm:light; the kinds are none, light, firm, or R,M,WIDTH such as \
                0.5Ns/m,0.1g,10mm";
    let (place, kind) = text.split_once(':').ok_or(form)?;
    let with_unit = |text: &str, likely, parse: fn(&str) -> Result<f64, QuantityError>| {
        has_unit(text, likely).and_then(|()| parse(text))
    };
    let length_m = |text: &str| match no_unit(text, Measure::Length, LENGTHS_M) {
        Some(mistake) => Err(mistake),
        None => quantity::length_m(text),
    };
    let place_m = length_m(place).map_err(|error| format!("its place: {error}"))?;
    let finger = match kind.trim() {
        "none" => None,
        "light" => Some(Finger::light(place_m)),
        "firm" => Some(Finger::firm(place_m)),
        parts => {
            let parts: Vec<&str> = parts.split(',').map(str::trim).collect();
            let [resistance, mass, width] = parts[..] else { return Err(form.to_owned()) };
            let resistance = resistance.replace(' ', "");
            Some(Finger {
                place_m,
                resistance_n_s_per_m: with_unit(&resistance, "Ns/m", |text| quantity::plain(text, "Ns/m"))
                    .map_err(|error| format!("its resistance: {error}"))?,
                mass_kg: with_unit(mass, "g", quantity::mass_kg)
                    .map_err(|error| format!("its mass: {error}"))?,
                contact_m: length_m(width).map_err(|error| format!("its width: {error}"))?,
            })
        }
    };
    Ok(FingerArgument(finger))
}

/// Parses a mass with its unit.
pub(super) fn mass(text: &str) -> Result<f64, QuantityError> {
    has_unit(text, "g").and_then(|()| quantity::mass_kg(text))
}

/// A plate by the name of a preset, or from a TOML file.
pub(super) fn plate(name: &str) -> Result<Plate, Failure> {
    let read = || read_text(Path::new(name), PLATE_FILE_BYTES_MAX);
    named_plate(name, read).map_err(Failure::refused)
}

/// The plate of an option, or else the default one.
pub(super) fn plate_or_default(name: Option<&str>) -> Result<Plate, Failure> {
    name.map_or_else(|| plate(defaults::plate()?), plate)
}
