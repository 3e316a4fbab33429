//! The field, the value and the allowed range of a refusal, by the type of its error.

use clap::error::{ContextKind, ContextValue};
use serde_json::{Value, json};
use slipline_instrument::profile_file::ProfileFileError;
use slipline_plate::quantity::{Measure, NotAllowed, OutOfRange, TypedRange, WrongCount};
use slipline_plate::{PlateError, PlateFileError};
use std::error::Error;
use std::fmt;

/// A value that is not allowed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// The sentence.
    pub(super) message: String,
    /// The option as it is written, or the field of a file.
    pub(super) field: String,
    /// The number in the unit of the range, or the text that was typed.
    pub(super) value: Value,
    /// `low`, `high` and `unit`; an end without a limit is null. Null where the allowed values are no range.
    pub(super) range: Value,
}

/// The allowed values of a count on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct WholeNumber {
    pub(super) low: usize,
    pub(super) high: usize,
}

impl fmt::Display for WholeNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a whole number, {} to {}", self.low, self.high)
    }
}

impl Refusal {
    pub(super) fn new(message: String, field: &str, value: Value) -> Self {
        Self { message, field: field.to_owned(), value, range: Value::Null }
    }

    /// A range; an infinite end becomes null.
    pub(super) fn range(low: f64, high: f64, unit: &str) -> Value {
        json!({ "low": low, "high": high, "unit": unit })
    }

    /// What an error, or the first of its sources that does, knows of a refused value.
    pub(super) fn of(error: &(dyn Error + 'static)) -> Option<Self> {
        let mut next = Some(error);
        while let Some(error) = next {
            if let Some(refusal) = Self::of_one(error) {
                return Some(refusal);
            }
            next = error.source();
        }
        None
    }

    fn of_one(error: &(dyn Error + 'static)) -> Option<Self> {
        let message = error.to_string();
        if let Some(OutOfRange { field, value, range }) = error.downcast_ref() {
            let range = Self::range(range.low, range.high, range.unit);
            return Some(Self { range, ..Self::new(message, field, json!(value)) });
        }
        if let Some(WrongCount { field, count, allowed }) = error.downcast_ref() {
            let range = Self::range(allowed.least as f64, allowed.most as f64, &allowed.of.to_string());
            return Some(Self { range, ..Self::new(message, field, json!(count)) });
        }
        if let Some(ProfileFileError::OutOfRange { field, got, min, max }) = error.downcast_ref() {
            return Some(Self {
                range: Self::range(*min, *max, ""),
                ..Self::new(message, field, json!(got))
            });
        }
        if let Some(PlateFileError::Plate { error, .. }) = error.downcast_ref() {
            return Self::of_one(error);
        }
        let error: &PlateError = error.downcast_ref()?;
        let (value, range) = match error {
            PlateError::OutOfRange { value, range, .. } => {
                (json!(value), Self::range(range.low, range.high, range.unit))
            }
            PlateError::WrongCount { count, allowed, .. } => {
                let (least, most) = (allowed.least as f64, allowed.most as f64);
                (json!(count), Self::range(least, most, &allowed.of.to_string()))
            }
            PlateError::Unfit { value, .. } => (json!(value), Value::Null),
            PlateError::UnknownKind { value, .. } => (json!(value), Value::Null),
            PlateError::Missing { .. }
            | PlateError::Unexpected { .. }
            | PlateError::ControlCharacter { .. }
            | PlateError::NotNarrowing { .. } => (Value::Null, Value::Null),
        };
        Some(Self { range, ..Self::new(message, error.field(), value) })
    }

    /// The refusal of an argument by the command line's parser; `message` is its sentence.
    pub(super) fn of_argument(error: &clap::Error, message: String) -> Option<Self> {
        let text = |kind| match error.get(kind) {
            Some(ContextValue::String(text)) => Some(text.clone()),
            Some(ContextValue::Strings(texts)) => texts.first().cloned(),
            _ => None,
        };
        // It is written with the name of its value: `--for <TIME>`.
        let field = text(ContextKind::InvalidArg)?.split(' ').next()?.to_owned();
        let value = text(ContextKind::InvalidValue).map_or(Value::Null, Value::from);
        let source = error.source();
        let count = source.and_then(|source| source.downcast_ref::<NotAllowed<WholeNumber>>());
        let count = count.map(|it| Self::range(it.allowed.low as f64, it.allowed.high as f64, ""));
        let range = source.and_then(|source| source.downcast_ref::<NotAllowed<TypedRange>>());
        let range = range.map_or(count.unwrap_or_default(), |NotAllowed { allowed, .. }| {
            let unit = match allowed.measure {
                Measure::Length => "m",
                Measure::Frequency => "Hz",
                Measure::Time => "s",
                Measure::Plain(unit) => unit,
            };
            Self::range(allowed.low, allowed.high, unit)
        });
        Some(Self { message, field, value, range })
    }
}
