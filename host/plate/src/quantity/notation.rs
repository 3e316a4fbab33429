//! Notation of fields and numbers in a sentence about a plate: that of a plate file, or that of a form.

use super::number_format::{significant, typed};
use super::range::Range;
use super::unit::Unit;

/// Notation of fields and numbers in a sentence. Numbers are passed in SI units, fields by their names in a plate
/// file.
pub trait Notation {
    /// A field: `length_m`.
    fn field(&self, field: &str) -> String;
    /// A field with its value: `length_m = 0.3`.
    fn given(&self, field: &str, value: f64) -> String;
    /// The allowed range of a field, with its unit: `0.005 to 10 m`.
    fn range(&self, field: &str, range: Range) -> String;
    /// A length, with its unit.
    fn length(&self, metres: f64) -> String;
    /// A frequency, with its unit.
    fn frequency(&self, hertz: f64) -> String;
}

/// The notation of plate files: their field names and units.
pub(crate) struct PlateFile;

impl Notation for PlateFile {
    fn field(&self, field: &str) -> String {
        field.to_owned()
    }

    fn given(&self, field: &str, value: f64) -> String {
        format!("{field} = {}", typed(value))
    }

    fn range(&self, _field: &str, range: Range) -> String {
        range.to_string()
    }

    fn length(&self, metres: f64) -> String {
        format!("{} m", typed(metres))
    }

    fn frequency(&self, hertz: f64) -> String {
        format!("{} Hz", typed(hertz))
    }
}

/// One field of a form: its caption and the unit of its number.
#[derive(Debug, Clone, Copy)]
pub struct Caption {
    /// Its caption.
    pub name: &'static str,
    /// The unit of its number.
    pub unit: Unit,
}

/// The list of which a field is an element.
fn list_of(field: &str) -> Option<&str> {
    field.split_once('[').map(|(list, _)| list)
}

/// A form: it displays the library's fields by captions, with its own units. It is a [`Notation`]: fields by their
/// captions, numbers in the form's units and format.
pub trait Form {
    /// The caption of one of the library's fields; `None` if the form does not have it.
    fn caption(&self, field: &str) -> Option<Caption>;
}

/// Significant digits of a form's numbers in a sentence, as in the library's ranges.
const DIGITS: usize = 5;

/// A number of the library with a form's unit.
fn written(value: f64, unit: Unit) -> String {
    if value.is_finite() { unit.written(value, DIGITS) } else { "no number".to_owned() }
}

fn unit_of(form: &impl Form, field: &str) -> Unit {
    form.caption(field).map_or(Unit::Pure, |caption| caption.unit)
}

impl<F: Form> Notation for F {
    fn field(&self, field: &str) -> String {
        self.caption(field).map_or(field, |caption| caption.name).to_owned()
    }

    fn given(&self, field: &str, value: f64) -> String {
        let name = self.field(field);
        // A form does not display single numbers of a list.
        if list_of(field).is_some() {
            name
        } else {
            format!("{name} {}", written(value, unit_of(self, field)))
        }
    }

    fn range(&self, field: &str, range: Range) -> String {
        let range = range.rounded();
        // Both ends of a range get the same unit.
        let largest = if range.high.is_finite() { range.high } else { range.low };
        let (unit, size) = unit_of(self, field).shown(largest);
        format!("{} {unit}", range.in_words(|end| significant(end / size, DIGITS))).trim_end().to_owned()
    }

    fn length(&self, metres: f64) -> String {
        written(metres, Unit::Millimetre)
    }

    fn frequency(&self, hertz: f64) -> String {
        written(hertz, Unit::Hertz)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Sheet;

    impl Form for Sheet {
        fn caption(&self, field: &str) -> Option<Caption> {
            let (name, unit) = match field {
                "thickness_m" | "model.thickness_m" => ("Thickness", Unit::Millimetre),
                "band high" => ("Band to", Unit::Hertz),
                "taper.points[3][1]" => ("Half-widths", Unit::Millimetre),
                _ => return None,
            };
            Some(Caption { name, unit })
        }
    }

    #[test]
    fn a_form_writes_a_field_by_its_caption_and_numbers_in_its_units() {
        assert_eq!(Sheet.given("model.thickness_m", 0.0021), "Thickness 2.1 mm");
        assert_eq!(Sheet.given("thickness_m", f64::NAN), "Thickness no number");
        assert_eq!(Sheet.given("loss_factor", 0.7), "loss_factor 0.7");
        assert_eq!(Sheet.given("taper.points[3][1]", 0.2), "Half-widths");
        assert_eq!(Sheet.range("thickness_m", Range::new(1e-6, 0.1, "m")), "0.001 to 100 mm");
        assert_eq!(Sheet.range("taper.points[3][1]", Range::at_least(0.32, "m")), "at least 320 mm");
        assert_eq!(Sheet.range("band high", Range::new(420.0, 1e7, "Hz")), "0.42 to 10000 kHz");
        assert_eq!((Sheet.length(0.0131), Sheet.frequency(2e4)), ("13.1 mm".to_owned(), "20 kHz".to_owned()));
    }
}
