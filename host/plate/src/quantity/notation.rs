//! How fields and numbers are written in the sentence of a refusal.

use super::number_format::typed;
use super::range::Range;

/// How fields and numbers are written in a sentence. Numbers come in SI units, fields as the plate file has them.
pub trait Notation {
    /// A field: `length_m`.
    fn field(&self, field: &str) -> String;
    /// A field with the number that it has: `length_m = 0.3`.
    fn given(&self, field: &str, value: f64) -> String;
    /// The numbers that a field may have, with their unit: `0.005 to 10 m`.
    fn range(&self, field: &str, range: Range) -> String;
    /// A length, with its unit.
    fn length(&self, metres: f64) -> String;
    /// A frequency, with its unit.
    fn frequency(&self, hertz: f64) -> String;
}

/// The notation of plate files: their own names, and their units.
pub struct PlateFile;

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
