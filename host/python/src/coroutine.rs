//! Objects of Python that the package's Python code makes, with their types for the stubs.

use pyo3::inspect::PyStaticExpr;
use pyo3::prelude::*;
use pyo3::{type_hint_identifier, type_hint_subscript};
use std::convert::Infallible;

use crate::result::{Kind, kind::Status};

/// A coroutine that returns a sample index.
pub(crate) struct Coroutine<'py>(pub(crate) Bound<'py, PyAny>);

impl<'py> IntoPyObject<'py> for Coroutine<'py> {
    type Target = PyAny;
    type Output = Bound<'py, PyAny>;
    type Error = Infallible;
    const OUTPUT_TYPE: PyStaticExpr = type_hint_subscript!(
        type_hint_identifier!("collections.abc", "Coroutine"),
        type_hint_identifier!("typing", "Any"),
        type_hint_identifier!("typing", "Any"),
        type_hint_identifier!("builtins", "int")
    );

    fn into_pyobject(self, _py: Python<'py>) -> Result<Self::Output, Infallible> {
        Ok(self.0)
    }
}

/// An iterator over the device's status.
pub(crate) struct StatusIterator<'py>(pub(crate) Bound<'py, PyAny>);

impl<'py> IntoPyObject<'py> for StatusIterator<'py> {
    type Target = PyAny;
    type Output = Bound<'py, PyAny>;
    type Error = Infallible;
    const OUTPUT_TYPE: PyStaticExpr =
        type_hint_subscript!(type_hint_identifier!("collections.abc", "Iterator"), <Status as Kind>::TYPE);

    fn into_pyobject(self, _py: Python<'py>) -> Result<Self::Output, Infallible> {
        Ok(self.0)
    }
}

/// A break of a device.
pub(crate) struct Rest<'py>(pub(crate) Bound<'py, PyAny>);

impl<'py> IntoPyObject<'py> for Rest<'py> {
    type Target = PyAny;
    type Output = Bound<'py, PyAny>;
    type Error = Infallible;
    const OUTPUT_TYPE: PyStaticExpr = type_hint_identifier!("slipline._rest", "Rest");

    fn into_pyobject(self, _py: Python<'py>) -> Result<Self::Output, Infallible> {
        Ok(self.0)
    }
}
