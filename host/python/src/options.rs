//! The options of a call that are those of the command line: their names with `_` for `-`, their quantities SI floats.

use crate::error::Failure;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use slipline_plate::quantity::nearest;
use slipline_plate::quantity::{OutOfRange, Range};

/// Options that are taken one by one; what is left at the end is refused.
pub(crate) struct Options<'py> {
    call: &'static str,
    left: Option<Bound<'py, PyDict>>,
    known: Vec<&'static str>,
}

impl<'py> Options<'py> {
    pub(crate) fn new(call: &'static str, given: Option<&Bound<'py, PyDict>>) -> PyResult<Self> {
        let left = given.map(|given| given.copy()).transpose()?;
        Ok(Self { call, left, known: Vec::new() })
    }

    /// An option; `None` if it is absent or `None`.
    pub(crate) fn take(&mut self, name: &'static str) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.known.push(name);
        let Some(left) = &self.left else { return Ok(None) };
        let found = left.get_item(name)?;
        if found.is_some() {
            left.del_item(name)?;
        }
        Ok(found.filter(|value| !value.is_none()))
    }

    /// A number in its range.
    pub(crate) fn number(&mut self, name: &'static str, range: Range) -> PyResult<Option<f64>> {
        let Some(value) = self.take(name)? else { return Ok(None) };
        let number = value.extract::<f64>().map_err(|_| self.wrong(name, "a number"))?;
        OutOfRange::check(name, number, range).map_err(|refused| Failure::out_of_range(&refused))?;
        Ok(Some(number))
    }

    /// A switch; off by default.
    pub(crate) fn switch(&mut self, name: &'static str) -> PyResult<bool> {
        let Some(value) = self.take(name)? else { return Ok(false) };
        Ok(value.extract().map_err(|_| self.wrong(name, "True or False"))?)
    }

    /// A text, or a path.
    pub(crate) fn text(&mut self, name: &'static str) -> PyResult<Option<String>> {
        let Some(value) = self.take(name)? else { return Ok(None) };
        let path = value.extract::<std::path::PathBuf>().map_err(|_| self.wrong(name, "a text"))?;
        Ok(Some(path.to_string_lossy().into_owned()))
    }

    /// One of these words.
    pub(crate) fn word<T: Copy>(&mut self, name: &'static str, words: &[(&str, T)]) -> PyResult<Option<T>> {
        let Some(text) = self.text(name)? else { return Ok(None) };
        let found = words.iter().find(|(word, _)| *word == text).map(|(_, value)| *value);
        let allowed = || words.iter().map(|(word, _)| *word).collect::<Vec<_>>().join(", ");
        let refused = || {
            Failure::refused(slipline_plate::quantity::must_be(
                format_args!("{name} = {text:?}"),
                format_args!("one of {}", allowed()),
            ))
        };
        Ok(Some(found.ok_or_else(refused)?))
    }

    /// The refusal of an option's type.
    pub(crate) fn wrong(&self, name: &str, allowed: &str) -> Failure {
        Failure::wrong_arguments(format_args!("{name} of {}()", self.call), allowed)
    }

    /// Raises `TypeError` for an unknown option, listing the accepted ones.
    pub(crate) fn end(self) -> Result<(), Failure> {
        let names =
            self.left.map_or_else(Vec::new, |left| left.keys().extract::<Vec<String>>().unwrap_or_default());
        let Some(name) = names.first() else { return Ok(()) };
        let meant = nearest(name, self.known.iter().copied())
            .map_or_else(String::new, |meant| format!(" (did you mean {meant}?)"));
        let given = format_args!("option {name:?} of {}(){meant}", self.call);
        Err(Failure::wrong_arguments(given, format_args!("one of {}", self.known.join(", "))))
    }
}
