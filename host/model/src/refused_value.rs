//! The field, the value and the allowed range of a refusal, by the type of its error: the shells show them, or act on them.

use slipline_plate::quantity::{Count, OutOfRange, Range, WrongCount};
use slipline_plate::{PlateError, PlateFileError};
use std::error::Error;

/// A value that is not allowed.
#[derive(Clone, Debug, PartialEq)]
pub struct RefusedValue {
    /// The field, as it is written in a plate file, or as the function names it.
    pub field: String,
    /// The value; `None` where there is none.
    pub value: Option<Given>,
    /// The allowed range and its unit; `None` where the allowed values are no range.
    pub range: Option<(f64, f64, String)>,
}

/// A value that was given.
#[derive(Clone, Debug, PartialEq)]
pub enum Given {
    /// A number, in the unit of the range.
    Number(f64),
    /// The length of a text or list.
    Count(usize),
    /// A text.
    Text(String),
}

impl RefusedValue {
    /// The refused value of an error, or of the first of its sources that has one; and the sentence of that error.
    #[must_use]
    pub fn of(error: &(dyn Error + 'static)) -> Option<(Self, String)> {
        let mut next = Some(error);
        while let Some(error) = next {
            if let Some(refused) = Self::of_one(error) {
                return Some((refused, error.to_string()));
            }
            next = error.source();
        }
        None
    }

    fn of_one(error: &(dyn Error + 'static)) -> Option<Self> {
        if let Some(&OutOfRange { field, value, range }) = error.downcast_ref() {
            return Some(Self::number(field, value, range));
        }
        if let Some(&WrongCount { field, count, allowed }) = error.downcast_ref() {
            return Some(Self::count(field, count, allowed));
        }
        if let Some(PlateFileError::Plate { error, .. }) = error.downcast_ref() {
            return Some(Self::of_plate(error));
        }
        error.downcast_ref().map(Self::of_plate)
    }

    fn of_plate(error: &PlateError) -> Self {
        let field = error.field().to_owned();
        let value = match error {
            &PlateError::OutOfRange { value, range, .. } => return Self::number(&field, value, range),
            &PlateError::WrongCount { count, allowed, .. } => return Self::count(&field, count, allowed),
            &PlateError::Unfit { value, .. } => Some(Given::Number(value)),
            PlateError::UnknownKind { value, .. } => Some(Given::Text(value.clone())),
            PlateError::Missing { .. }
            | PlateError::Unexpected { .. }
            | PlateError::ControlCharacter { .. }
            | PlateError::NotNarrowing { .. } => None,
            _ => None,
        };
        Self { field, value, range: None }
    }

    fn count(field: &str, count: usize, allowed: Count) -> Self {
        let range = (allowed.least as f64, allowed.most as f64, allowed.of.to_string());
        Self { field: field.to_owned(), value: Some(Given::Count(count)), range: Some(range) }
    }

    fn number(field: &str, value: f64, range: Range) -> Self {
        let range = (range.low, range.high, range.unit.to_owned());
        Self { field: field.to_owned(), value: Some(Given::Number(value)), range: Some(range) }
    }
}
