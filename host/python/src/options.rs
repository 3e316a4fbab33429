//! The entries of a dictionary that is an argument, such as a tone: their quantities are SI floats.

use crate::arguments::optional;
use crate::error::Failure;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use slipline_plate::quantity::{Range, nearest};

/// Entries that are taken one by one; what is left at the end is refused.
pub(crate) struct Options<'py> {
    call: &'static str,
    left: Bound<'py, PyDict>,
    known: Vec<&'static str>,
}

impl<'py> Options<'py> {
    pub(crate) fn new(call: &'static str, given: &Bound<'py, PyDict>) -> PyResult<Self> {
        Ok(Self { call, left: given.copy()?, known: Vec::new() })
    }

    /// An option; `None` if it is absent or `None`.
    pub(crate) fn take(&mut self, name: &'static str) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.known.push(name);
        let found = self.left.get_item(name)?;
        if found.is_some() {
            self.left.del_item(name)?;
        }
        Ok(found.filter(|value| !value.is_none()))
    }

    /// A number, whose range is known later.
    pub(crate) fn number(&mut self, name: &'static str) -> PyResult<Option<f64>> {
        let Some(value) = self.take(name)? else { return Ok(None) };
        let given = format_args!("{name} of {}()", self.call);
        Ok(Some(value.extract::<f64>().map_err(|_| Failure::wrong_arguments(given, "a number"))?))
    }

    /// A number in its range.
    pub(crate) fn number_in(&mut self, name: &'static str, range: Range) -> PyResult<Option<f64>> {
        let number = self.number(name)?;
        optional(name, number, range)?;
        Ok(number)
    }

    /// Raises `TypeError` for an unknown option, listing the accepted ones.
    pub(crate) fn end(self) -> Result<(), Failure> {
        let names = self.left.keys().extract::<Vec<String>>().unwrap_or_default();
        let Some(name) = names.first() else { return Ok(()) };
        let meant = nearest(name, self.known.iter().copied())
            .map_or_else(String::new, |meant| format!(" (did you mean {meant}?)"));
        let given = format_args!("option {name:?} of {}(){meant}", self.call);
        Err(Failure::wrong_arguments(given, format_args!("one of {}", self.known.join(", "))))
    }
}
