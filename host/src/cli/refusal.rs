//! The field, the value and the allowed range of a refusal, by the type of its error.

use clap::error::{ContextKind, ContextValue};
use serde_json::{Value, json};
use slipline_instrument::profile_file::ProfileFileError;
use slipline_model::refused_value::{Given, RefusedValue};
use slipline_plate::quantity::{Measure, NotAllowed, TypedRange};
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

    /// The refusal of an error, or of the first of its sources that has a refused value.
    pub(super) fn of(error: &(dyn Error + 'static)) -> Option<Self> {
        if let Some(ProfileFileError::OutOfRange { field, got, min, max }) = error.downcast_ref() {
            let refusal = Self::new(error.to_string(), field, json!(got));
            return Some(Self { range: Self::range(*min, *max, ""), ..refusal });
        }
        let (RefusedValue { field, value, range }, message) = RefusedValue::of(error)?;
        let value = value.map_or(Value::Null, |value| match value {
            Given::Number(number) => json!(number),
            Given::Count(count) => json!(count),
            Given::Text(text) => json!(text),
        });
        let range = range.map_or(Value::Null, |(low, high, unit)| Self::range(low, high, &unit));
        Some(Self { message, field, value, range })
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
