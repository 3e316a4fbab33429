//! The result of a call: the fields of an answer as attributes.
//!
//! ```text
//! answer (serde) --value, off the interpreter--> JSON value --result--> numbers, numpy arrays, dictionaries
//!                                                   --slipline.results--> an instance of its class, results in it
//! ```
//! A number goes from float to float: no text is between. The classes are Python's: `host/python/slipline/results.py`.

use numpy::{Complex64, PyArray1};
use pyo3::exceptions::PyTypeError;
use pyo3::inspect::PyStaticExpr;
use pyo3::prelude::*;
use pyo3::types::{PyComplex, PyDict, PyList};
use pyo3::{Borrowed, type_hint_identifier, type_hint_subscript};
use serde::Serialize;
use serde_json::{Map, Value};
use slipline_plate::quantity::must_be;
use std::marker::PhantomData;

/// The class of a result.
pub(crate) trait Kind {
    /// Its name in `slipline.results`.
    const NAME: &'static str;
    /// The same for the stubs.
    const TYPE: PyStaticExpr;
}

/// The classes of results.
pub(crate) mod kind {
    use super::{Kind, PyStaticExpr, type_hint_identifier};

    macro_rules! kinds {
        ($($name:ident)*) => { $(
            #[derive(Clone, Copy, Debug)]
            pub(crate) struct $name;
            impl Kind for $name {
                const NAME: &'static str = stringify!($name);
                const TYPE: PyStaticExpr = type_hint_identifier!("slipline.results", stringify!($name));
            }
        )* };
    }
    kinds!(BrownOut Calibration Check Design Drive Field Harmonics Merit PortInfo Profile Selftest Simulation Status Sweep Table Texture Trim Verification);
}

/// The fields of a result of this kind, which becomes an instance of its class.
#[derive(Debug)]
pub(crate) struct Answer<K> {
    fields: Py<PyDict>,
    kind: PhantomData<K>,
}

impl<'py, K: Kind> IntoPyObject<'py> for Answer<K> {
    type Target = PyAny;
    type Output = Bound<'py, PyAny>;
    type Error = PyErr;
    const OUTPUT_TYPE: PyStaticExpr = K::TYPE;

    fn into_pyobject(self, py: Python<'py>) -> PyResult<Self::Output> {
        py.import("slipline.results")?.call_method1(K::NAME, (self.fields,))
    }
}

impl<K> Answer<K> {
    /// The fields of an answer.
    pub(crate) fn of(py: Python<'_>, fields: Map<String, Value>) -> PyResult<Self> {
        Ok(Self { fields: dictionary(py, fields)?.unbind(), kind: PhantomData })
    }

    /// It with one more attribute.
    pub(crate) fn with<'py>(
        self,
        py: Python<'py>,
        name: &str,
        value: impl IntoPyObject<'py>,
    ) -> PyResult<Self> {
        self.fields.bind(py).set_item(name, value)?;
        Ok(self)
    }
}

/// Results of this kind: a list that a notebook shows as a table.
#[derive(Debug)]
pub(crate) struct Answers<K>(pub(crate) Vec<Answer<K>>);

impl<'py, K: Kind> IntoPyObject<'py> for Answers<K> {
    type Target = PyAny;
    type Output = Bound<'py, PyAny>;
    type Error = PyErr;
    const OUTPUT_TYPE: PyStaticExpr =
        type_hint_subscript!(type_hint_identifier!("slipline.results", "Results"), K::TYPE);

    fn into_pyobject(self, py: Python<'py>) -> PyResult<Self::Output> {
        let results =
            self.0.into_iter().map(|answer| answer.into_pyobject(py)).collect::<PyResult<Vec<_>>>()?;
        py.import("slipline.results")?.call_method1("Results", (results,))
    }
}

/// A result as an argument.
#[derive(Clone, Debug)]
pub(crate) struct ResultArgument<'py>(pub(crate) Bound<'py, PyAny>);

impl<'py> ResultArgument<'py> {
    /// The class of all results, for the stubs.
    pub(crate) const TYPE: PyStaticExpr = type_hint_identifier!("slipline.results", "Result");

    /// This object, if it is a result.
    pub(crate) fn of(given: &Bound<'py, PyAny>) -> PyResult<Option<Self>> {
        let class = given.py().import("slipline.results")?.getattr("Result")?;
        Ok(given.is_instance(&class)?.then(|| Self(given.clone())))
    }
}

impl<'a, 'py> FromPyObject<'a, 'py> for ResultArgument<'py> {
    type Error = PyErr;
    const INPUT_TYPE: PyStaticExpr = Self::TYPE;

    fn extract(given: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let found = Self::of(&given)?;
        found.ok_or_else(|| PyTypeError::new_err(must_be(&*given, "a result of a call")))
    }
}

/// Fields as a dictionary of Python.
pub(crate) fn dictionary(py: Python<'_>, fields: Map<String, Value>) -> PyResult<Bound<'_, PyDict>> {
    let found = PyDict::new(py);
    for (name, value) in fields {
        found.set_item(name, attribute(py, value)?)?;
    }
    Ok(found)
}

/// The fields of an answer as JSON; the interpreter is not needed for it. An answer is an object.
pub(crate) fn fields(answer: &impl Serialize) -> Map<String, Value> {
    match serde_json::to_value(answer) {
        Ok(Value::Object(fields)) => fields,
        _ => Map::new(),
    }
}

/// The fields of a list's objects as columns.
pub(crate) fn columns(list: Vec<Value>) -> Map<String, Value> {
    let mut columns: Map<String, Value> = Map::new();
    for object in list {
        if let Value::Object(fields) = object {
            for (name, value) in fields {
                if let Value::Array(column) = columns.entry(name).or_insert_with(|| Value::Array(Vec::new()))
                {
                    column.push(value);
                }
            }
        }
    }
    columns
}

fn attribute(py: Python<'_>, value: Value) -> PyResult<Bound<'_, PyAny>> {
    Ok(match value {
        Value::Null => py.None().into_bound(py),
        Value::Bool(is) => is.into_pyobject(py)?.to_owned().into_any(),
        Value::Number(number) => match number.as_i64().filter(|_| !number.is_f64()) {
            Some(count) => count.into_pyobject(py)?.into_any(),
            None => float(&Value::Number(number)).into_pyobject(py)?.into_any(),
        },
        Value::String(text) => text.into_pyobject(py)?.into_any(),
        Value::Array(values) => array(py, values)?,
        Value::Object(fields) => match complex(&fields) {
            Some(value) => PyComplex::from_doubles(py, value.re, value.im).into_any(),
            None => dictionary(py, fields)?.into_any(),
        },
    })
}

/// A series of numbers, complex numbers or truths as an array; anything else as a list.
fn array(py: Python<'_>, values: Vec<Value>) -> PyResult<Bound<'_, PyAny>> {
    if values.is_empty() {
        return Ok(PyList::empty(py).into_any());
    }
    if values.iter().all(|value| value.as_i64().is_some()) {
        let counts: Vec<i64> = values.iter().filter_map(Value::as_i64).collect();
        return Ok(PyArray1::from_vec(py, counts).into_any());
    }
    if values.iter().all(|value| value.is_number() || value.is_null()) {
        return Ok(PyArray1::from_vec(py, values.iter().map(float).collect()).into_any());
    }
    if values.iter().all(Value::is_boolean) {
        let truths: Vec<bool> = values.iter().filter_map(Value::as_bool).collect();
        return Ok(PyArray1::from_vec(py, truths).into_any());
    }
    let numbers: Option<Vec<Complex64>> = values.iter().map(|it| complex(it.as_object()?)).collect();
    if let Some(numbers) = numbers {
        return Ok(PyArray1::from_vec(py, numbers).into_any());
    }
    let items = values.into_iter().map(|value| attribute(py, value)).collect::<PyResult<Vec<_>>>()?;
    Ok(PyList::new(py, items)?.into_any())
}

/// A number without the sign of a zero, as the command line prints it; NaN for what is absent.
fn float(value: &Value) -> f64 {
    value.as_f64().map_or(f64::NAN, |number| number + 0.0)
}

fn complex(fields: &Map<String, Value>) -> Option<Complex64> {
    match (fields.len(), fields.get("re"), fields.get("im")) {
        (2, Some(re), Some(im)) => Some(Complex64::new(float(re), float(im))),
        _ => None,
    }
}
