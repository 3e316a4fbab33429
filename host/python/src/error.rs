//! Errors of Rust as the exceptions of `slipline.errors`, where each is described.

use pyo3::exceptions::{PyMemoryError, PyTimeoutError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyType;
use slipline_model::refused_value::{Given, RefusedValue};
use slipline_plate::quantity::must_be;
use std::error::Error;
use std::fmt::Display;

/// Why a call failed. It is made without the interpreter, and becomes an exception where the call returns.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Failure {
    /// `slipline.OutOfRange`.
    OutOfRange {
        /// The sentence.
        message: String,
        /// The argument, or the field of a file.
        field: String,
        /// The number that was given; NaN where it was none.
        value: f64,
        /// The ends of the allowed range.
        range: (f64, f64),
    },
    /// `slipline.Fault`.
    Fault {
        /// The sentence.
        message: String,
        /// The names of the latched faults.
        faults: Vec<String>,
        /// What to do about them.
        remedy: String,
    },
    /// An exception of a message alone.
    Because(Exception, String),
}

/// An exception of a message alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Exception {
    /// It cannot be done with this plate, these values or this device.
    Refused,
    /// No connection to the device.
    LinkLost,
    /// No call came for too long.
    Unattended,
    /// A file that cannot be read.
    BadFile,
    /// Arguments that do not belong together: Python's own `TypeError`.
    Type,
    /// An argument of the right type with an impossible value: Python's own `ValueError`.
    Value,
    /// A wait that took too long: Python's own `TimeoutError`.
    Timeout,
    /// No memory for a result: Python's own `MemoryError`.
    Memory,
}

impl Failure {
    /// Why a computation was refused: `OutOfRange` where its error, or a source of it, names a number and a range.
    pub(crate) fn of(error: &(dyn Error + 'static)) -> Self {
        let message = error.to_string();
        match RefusedValue::of(error) {
            Some((RefusedValue { field, value: Some(value), range: Some((low, high, _)) }, _)) => {
                let value = match value {
                    Given::Number(number) => number,
                    Given::Count(count) => count as f64,
                    Given::Text(_) => f64::NAN,
                };
                Self::number(message, &field, value, (low, high))
            }
            _ => Self::Because(Exception::Refused, message),
        }
    }

    /// The same by the name of the argument, where a computation names the option of the command line.
    pub(crate) fn named(self, option: &str, argument: &str) -> Self {
        match self {
            Self::OutOfRange { message, field, value, range } if field == option => {
                let rest = message.strip_prefix(option).unwrap_or_default();
                Self::number(format!("{argument}{rest}"), argument, value, range)
            }
            other @ (Self::OutOfRange { .. } | Self::Fault { .. } | Self::Because(..)) => other,
        }
    }

    /// A number out of its range; of a length that may have been meant in millimetres, the sentence says so.
    pub(crate) fn number(message: String, field: &str, value: f64, range: (f64, f64)) -> Self {
        let meant = value / 1e3;
        let is_length = field.ends_with("_m") && !field.ends_with("_per_m");
        let is_in_mm = is_length && (range.0..=range.1).contains(&meant);
        let message = if is_in_mm { format!("{message}; did you mean {meant} m?") } else { message };
        Self::OutOfRange { message, field: field.to_owned(), value, range }
    }

    /// `slipline.Refused`.
    pub(crate) fn refused(message: impl Display) -> Self {
        Self::Because(Exception::Refused, message.to_string())
    }

    /// `ValueError`: an argument of the right type with an impossible value.
    pub(crate) fn value(message: impl Display) -> Self {
        Self::Because(Exception::Value, message.to_string())
    }

    /// `MemoryError`: there is no room for `count` values of this size in bytes.
    pub(crate) fn memory(count: usize, bytes: usize) -> Self {
        let gigabytes = count as f64 * bytes as f64 / 1e9;
        Self::Because(
            Exception::Memory,
            format!("the result would take {gigabytes:.1} GB: ask for it in parts"),
        )
    }

    /// `slipline.BadFile`: the file's name and the reason.
    pub(crate) fn bad_file(name: impl Display, why: impl Display) -> Self {
        Self::Because(Exception::BadFile, format!("{name}: {why}"))
    }

    /// `TypeError`: what was given and what is allowed.
    pub(crate) fn wrong_arguments(given: impl Display, allowed: impl Display) -> Self {
        Self::Because(Exception::Type, must_be(given, allowed))
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::OutOfRange { message, field, value, range: (low, high) } => {
                raised("OutOfRange", (message, field, value, low, high))
            }
            Failure::Fault { message, faults, remedy } => raised("Fault", (message, faults, remedy)),
            Failure::Because(Exception::Type, message) => PyTypeError::new_err(message),
            Failure::Because(Exception::Value, message) => PyValueError::new_err(message),
            Failure::Because(Exception::Timeout, message) => PyTimeoutError::new_err(message),
            Failure::Because(Exception::Memory, message) => PyMemoryError::new_err(message),
            Failure::Because(Exception::Refused, message) => raised("Refused", (message,)),
            Failure::Because(Exception::LinkLost, message) => raised("LinkLost", (message,)),
            Failure::Because(Exception::Unattended, message) => raised("Unattended", (message,)),
            Failure::Because(Exception::BadFile, message) => raised("BadFile", (message,)),
        }
    }
}

/// The exception of this name; the interpreter's own error where the package is not whole.
fn raised<A>(name: &str, arguments: A) -> PyErr
where
    A: pyo3::PyErrArguments + Send + Sync + 'static,
{
    Python::attach(|py| {
        let exceptions = py.import("slipline.errors");
        let found = exceptions.and_then(|it| it.getattr(name)).and_then(|it| Ok(it.cast_into::<PyType>()?));
        found.map_or_else(|error| error, |exception| PyErr::from_type(exception, arguments))
    })
}
