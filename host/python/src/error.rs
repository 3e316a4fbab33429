//! Errors of Rust as the exceptions of `slipline.errors`, where each is described.

use pyo3::prelude::*;
use pyo3::types::PyType;
use std::fmt::Display;

/// An exception of a message alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Exception {
    /// It cannot be done with this plate, these values or this device.
    Refused,
    /// No connection to the device.
    LinkLost,
    /// Nobody called for too long.
    Unattended,
    /// A file that cannot be read.
    BadFile,
}

impl Exception {
    const fn name(self) -> &'static str {
        match self {
            Self::Refused => "Refused",
            Self::LinkLost => "LinkLost",
            Self::Unattended => "Unattended",
            Self::BadFile => "BadFile",
        }
    }

    /// It with this message.
    pub(crate) fn because(self, message: impl Display) -> PyErr {
        raised(self.name(), message.to_string())
    }
}

/// `slipline.OutOfRange`: an argument or a field of a file, the value given, and the ends of the allowed range.
pub(crate) fn out_of_range(message: impl Display, field: &str, value: f64, (low, high): (f64, f64)) -> PyErr {
    raised("OutOfRange", (message.to_string(), field.to_owned(), value, low, high))
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
