//! The failures of a command and their exit codes.

use super::likely_unit::no_unit;
use super::refusal::Refusal;
use super::schema::SCHEMA;
use serde_json::{Value, json};
use slipline_model::field::simulation::SimulationError;
use slipline_plate::quantity::{Measure, NotAllowed, Range, must_be, show_range};
use std::error::Error;
use std::fmt;
use std::path::Path;

/// Why a command failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Failure {
    /// Bad usage or a bad file: exit code 2. The message names the value and its allowed range.
    Usage(String),
    /// A value that is not allowed: exit code 2. The message names it; field, value and range are known.
    Refused(Box<Refusal>),
    /// The command could not be carried out: exit code 1.
    Failed(String),
    /// The command was carried out, and the plate has red lights: exit code 3. The message gives their number.
    Red(String),
}

impl Failure {
    /// The process's exit code.
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) | Self::Refused(_) => 2,
            Self::Failed(_) => 1,
            Self::Red(_) => 3,
        }
    }

    /// This failure as one line of JSON: its message, and the field, the value and the range where a value is refused.
    #[must_use]
    pub fn json(&self) -> Value {
        let mut value = json!({
            "schema": SCHEMA,
            "error": self.to_string(),
            "exit_code": self.exit_code(),
            "field": null,
            "value": null,
            "range": null,
        });
        if let Self::Refused(refusal) = self {
            value["field"] = json!(refusal.field);
            value["value"] = refusal.value.clone();
            value["range"] = refusal.range.clone();
        }
        value
    }

    /// An option's value that is not allowed, with the wording of the command line's parser.
    pub(super) fn value(option: &str, text: &str, allowed: impl fmt::Display) -> Self {
        let message = must_be(format_args!("invalid value '{text}' for '{option}'"), allowed);
        Self::Refused(Box::new(Refusal::new(message, option, text.into())))
    }

    /// An option's value outside its range; `more` follows the range in the message.
    pub(super) fn outside(option: &str, text: &str, range: Range, measure: Measure, more: &str) -> Self {
        let allowed = format!("{}{more}", show_range(range.low, range.high, measure));
        let refused = match no_unit(text, measure, (range.low, range.high)) {
            Some(mistake) => Self::asked(option, text, &NotAllowed { mistake: Some(mistake), allowed }),
            None => Self::value(option, text, allowed),
        };
        refused.with_range(Refusal::range(range.low, range.high, range.unit))
    }

    /// An option's value that may be meant in another way: the mistake asks.
    pub(super) fn asked(option: &str, text: &str, mistake: &dyn fmt::Display) -> Self {
        let message = format!("invalid value '{text}' for '{option}': {mistake}");
        Self::Refused(Box::new(Refusal::new(message, option, text.into())))
    }

    /// The same, with the allowed range.
    pub(super) fn with_range(mut self, range: Value) -> Self {
        if let Self::Refused(refusal) = &mut self {
            refusal.range = range;
        }
        self
    }

    pub(super) fn usage(error: impl fmt::Display) -> Self {
        Self::Usage(error.to_string())
    }

    /// Bad usage; field, value and range are those of the error, or of its source.
    pub(super) fn refused(error: impl Error + 'static) -> Self {
        Self::because(error.to_string(), &error)
    }

    /// Bad usage: what is wrong with a file, after its name.
    pub(super) fn of_file(path: &Path, why: impl fmt::Display) -> Self {
        Self::Usage(format!("{}: {why}", path.display()))
    }

    /// A bad file, with its name.
    pub(super) fn in_file(path: &Path, error: impl Error + 'static) -> Self {
        Self::because(format!("{}: {error}", path.display()), &error)
    }

    /// Bad usage with this message, because of this error.
    pub(super) fn because(message: String, error: &(dyn Error + 'static)) -> Self {
        match Refusal::of(error) {
            Some(refusal) => Self::Refused(Box::new(Refusal { message, ..refusal })),
            None => Self::Usage(message),
        }
    }

    pub(super) fn failed(error: impl fmt::Display) -> Self {
        Self::Failed(error.to_string())
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Usage(message) | Self::Failed(message) | Self::Red(message) => f.write_str(message),
            Self::Refused(refusal) => f.write_str(&refusal.message),
        }
    }
}

impl From<SimulationError> for Failure {
    fn from(error: SimulationError) -> Self {
        match error {
            // A plate that cannot be used as requested.
            SimulationError::Table(_)
            | SimulationError::DeviceTable(_)
            | SimulationError::Respond(_)
            | SimulationError::Sum(_)
            | SimulationError::Line(_)
            | SimulationError::Sheet(_) => Self::refused(error),
            SimulationError::Stopped(_) | SimulationError::Loopback(_) => Self::failed(error),
        }
    }
}
