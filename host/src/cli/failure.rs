//! How a command fails, and with which exit code.

use slipline_model::field::simulation::SimulationError;
use std::fmt;

/// Why a command was not done.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Failure {
    /// Bad usage or a bad file: exit code 2. The message names what, and the allowed range.
    Usage(String),
    /// It could not be done: exit code 1.
    Failed(String),
    /// It was done, and the plate has red lights: exit code 3. The message says how many.
    Red(String),
}

impl Failure {
    /// The process's exit code.
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) => 2,
            Self::Failed(_) => 1,
            Self::Red(_) => 3,
        }
    }

    /// An option's value that does not fit, in the words of the parser of the command line.
    pub(super) fn value(option: &str, text: &str, must: impl fmt::Display) -> Self {
        Self::Usage(format!("invalid value '{text}' for '{option}': must be {must}"))
    }

    pub(super) fn usage(error: impl fmt::Display) -> Self {
        Self::Usage(error.to_string())
    }

    pub(super) fn failed(error: impl fmt::Display) -> Self {
        Self::Failed(error.to_string())
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Usage(message) | Self::Failed(message) | Self::Red(message) => f.write_str(message),
        }
    }
}

impl From<SimulationError> for Failure {
    fn from(error: SimulationError) -> Self {
        match error {
            // What was asked for does not fit the plate.
            SimulationError::Table(_)
            | SimulationError::DeviceTable(_)
            | SimulationError::Respond(_)
            | SimulationError::Sum(_)
            | SimulationError::Line(_) => Self::usage(error),
            SimulationError::Loopback(_) => Self::failed(error),
        }
    }
}
