//! The failures of a command and their exit codes.

use slipline_model::field::simulation::SimulationError;
use slipline_plate::quantity::must_be;
use std::fmt;

/// Why a command failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Failure {
    /// Bad usage or a bad file: exit code 2. The message names the value and its allowed range.
    Usage(String),
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
            Self::Usage(_) => 2,
            Self::Failed(_) => 1,
            Self::Red(_) => 3,
        }
    }

    /// An option's value outside its range, with the wording of the command line's parser.
    pub(super) fn value(option: &str, text: &str, allowed: impl fmt::Display) -> Self {
        Self::Usage(must_be(format_args!("invalid value '{text}' for '{option}'"), allowed))
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
            // A plate that cannot be used as requested.
            SimulationError::Table(_)
            | SimulationError::DeviceTable(_)
            | SimulationError::Respond(_)
            | SimulationError::Sum(_)
            | SimulationError::Line(_)
            | SimulationError::Sheet(_) => Self::usage(error),
            SimulationError::Stopped(_) | SimulationError::Loopback(_) => Self::failed(error),
        }
    }
}
