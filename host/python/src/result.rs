//! The result of a call: the fields of an answer as attributes.
//!
//! ```text
//! answer (serde) --value, off the interpreter--> JSON value --result--> attributes: numbers, numpy arrays, results
//! ```
//! A number goes from float to float: no text is between.

use numpy::{Complex64, PyArray1};
use pyo3::exceptions::PyAttributeError;
use pyo3::prelude::*;
use pyo3::types::{PyComplex, PyDict, PyList, PyTuple};
use serde::Serialize;
use serde_json::{Map, Value};

/// The result of a call. Its attributes are the fields of the same command's ``--json``.
///
/// Numbers are SI floats, series of numbers are numpy arrays, complex numbers are complex, and lists of objects are lists of
/// results. What is unknown or does not apply is ``None``, and NaN in an array.
#[pyclass(frozen, name = "Result", module = "slipline")]
#[derive(Debug)]
pub(crate) struct Answer {
    fields: Py<PyDict>,
}

#[pymethods]
impl Answer {
    /// A result of these fields.
    #[new]
    fn new(fields: Py<PyDict>) -> Self {
        Self { fields }
    }

    /// A field by its name.
    fn __getattr__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let found = self.fields.bind(py).get_item(name)?;
        found.ok_or_else(|| PyAttributeError::new_err(format!("the result has no field {name:?}")))
    }

    fn __dir__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let names = self.fields.bind(py).keys();
        for call in ["plot", "to_dict", "to_pandas", "to_xarray"] {
            names.append(call)?;
        }
        Ok(names)
    }

    /// The fields with their values; of a long array its shape and first values.
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        self.shown(py, "text")?.extract()
    }

    /// The same for a notebook: the lights of a check with their colours, the rows of a list, or the fields.
    fn _repr_html_(&self, py: Python<'_>) -> PyResult<String> {
        self.shown(py, "table")?.extract()
    }

    /// The fields as they are.
    fn _fields(&self, py: Python<'_>) -> Py<PyDict> {
        self.fields.clone_ref(py)
    }

    /// As for ``pickle``.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let class = py.get_type::<Self>();
        (class, (self.fields.clone_ref(py),)).into_pyobject(py)
    }

    /// The fields as plain data that ``json`` writes: arrays are lists, complex numbers ``{"re", "im"}``, and what is not a
    /// number is ``None``.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        Ok(self.shown(py, "plain")?.cast_into()?)
    }

    /// A list of results in it as a ``pandas.DataFrame``, a row for each: that of the field ``name``, or its lights, tones or
    /// parameters; without any list its arrays, a column for each. Needs pandas.
    #[pyo3(signature = (name=None))]
    fn to_pandas<'py>(&self, py: Python<'py>, name: Option<&str>) -> PyResult<Bound<'py, PyAny>> {
        py.import("slipline._shown")?.call_method1("pandas", (self.fields.bind(py), name))
    }

    /// Draws a field, a simulated envelope, a drive table or the lights of a check with matplotlib, into ``axes`` or new ones,
    /// which it returns.
    #[pyo3(signature = (axes=None))]
    fn plot<'py>(&self, py: Python<'py>, axes: Option<Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyAny>> {
        py.import("slipline._shown")?.call_method1("plot", (self.fields.bind(py), axes))
    }

    /// The arrays as an ``xarray.Dataset`` over ``position_m`` and, of several frequencies, ``frequency_hz``, each with
    /// ``units`` and ``long_name``; the numbers and texts are its attributes. Needs xarray: ``pip install slipline[xarray]``.
    fn to_xarray<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("slipline.dataset")?.call_method1("dataset", (self.fields.bind(py),))
    }
}

impl Answer {
    /// A form of it by the package's Python code.
    fn shown<'py>(&self, py: Python<'py>, form: &str) -> PyResult<Bound<'py, PyAny>> {
        py.import("slipline._shown")?.call_method1(form, (self.fields.bind(py),))
    }

    /// The fields of an answer.
    pub(crate) fn of(py: Python<'_>, fields: Map<String, Value>) -> PyResult<Self> {
        let found = PyDict::new(py);
        for (name, value) in fields {
            found.set_item(name, attribute(py, value)?)?;
        }
        Ok(Self { fields: found.unbind() })
    }

    /// Changes an attribute.
    pub(crate) fn set<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        value: impl IntoPyObject<'py>,
    ) -> PyResult<()> {
        self.fields.bind(py).set_item(name, value)
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
            None => Bound::new(py, Answer::of(py, fields)?)?.into_any(),
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
