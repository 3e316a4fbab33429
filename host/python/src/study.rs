//! The class `_Study`: a specification, and any range of its plates. `slipline/study.py` spreads the ranges and keeps the store.

use crate::arguments::{in_range, reserved};
use crate::error::Failure;
use crate::plate::{Plate, check_length, file_failure, named};
use crate::waiting::compute;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use slipline_model::study::{Draft, Kind, SPEC_BYTES_MAX, Spec, Status, Varied};
use slipline_plate::quantity::Range;

/// A range's results: `status` as `int8`, the fields that vary, and each result.
type Results<'py> = (Bound<'py, PyArray1<i8>>, Bound<'py, PyArray2<f64>>, Vec<Bound<'py, PyArray2<f64>>>);

/// A study: the plates of a specification, each driven by the nominal plate's table.
///
/// Raises ``OutOfRange`` and ``BadFile`` for the text; ``Refused`` if the nominal plate has no table, or no boundary at a place.
#[pyclass(frozen, name = "_Study", module = "slipline._slipline")]
#[derive(Debug)]
pub(crate) struct Study {
    inner: slipline_model::study::Study,
}

impl Study {
    fn spec(&self) -> &Spec {
        self.inner.spec()
    }
}

#[pymethods]
impl Study {
    #[new]
    fn new(py: Python<'_>, text: String) -> PyResult<Self> {
        check_length("the study", &text, SPEC_BYTES_MAX)?;
        let inner = compute(py, move |progress| {
            let draft = Draft::parse(&text).map_err(|error| file_failure(&error))?;
            let plate = draft.plate_name().map(named).transpose()?;
            let spec = draft.finish(plate).map_err(|error| file_failure(&error))?;
            slipline_model::study::Study::new(spec, progress).map_err(|error| Failure::of(&error))
        })?;
        Ok(Self { inner })
    }

    /// Its specification, the same text for equal ones: with its whole plate.
    fn to_toml(&self) -> String {
        self.spec().to_toml()
    }

    /// Number of plates.
    #[getter]
    fn count(&self) -> u64 {
        self.spec().count()
    }

    /// Its places, metres: turning points on the nominal plate.
    #[getter]
    fn place_m(&self) -> Vec<f64> {
        self.spec().turning_point_m().to_vec()
    }

    /// The variables of the fields that vary, each with the field's path in the plate file.
    #[getter]
    fn varied(&self) -> Vec<(String, String)> {
        let of = |varied: &Varied| (varied.column(), varied.path.clone());
        self.spec().varied().iter().map(of).collect()
    }

    /// Its results, each with its unit and its meaning.
    #[getter]
    fn results(&self) -> Vec<(&'static str, &'static str, &'static str)> {
        self.spec().results().iter().map(|it| (it.name(), it.unit(), it.meaning())).collect()
    }

    /// Whether each plate is solved in two dimensions.
    #[getter]
    fn is_2d(&self) -> bool {
        self.spec().kind() == Kind::Plane
    }

    /// The meaning of each number of a status, from 0.
    #[classattr]
    fn meanings() -> Vec<&'static str> {
        Status::ALL.iter().map(|status| status.meaning()).collect()
    }

    /// The plates ``first`` to ``end`` (excluded): ``status`` (plates,), the fields that vary (plates, fields), and of each result
    /// its numbers (plates, places). Other threads run meanwhile.
    fn run<'py>(&self, py: Python<'py>, first: u64, end: u64) -> PyResult<Results<'py>> {
        let end = end.min(self.count());
        // The results are refused before they are computed where they have no room.
        let (fields, places) = (self.spec().varied().len(), self.spec().turning_point_m().len());
        let numbers = fields + self.spec().results().len() * places;
        drop(reserved::<f64>(numbers.saturating_mul(end.saturating_sub(first) as usize))?);
        let chunk = py.detach(|| self.inner.run_range(first..end));
        let plates = chunk.status.len();
        let status = chunk.status.iter().map(|&status| status as i8).collect();
        let result = |numbers| PyArray1::from_vec(py, numbers).reshape([plates, places]);
        Ok((
            PyArray1::from_vec(py, status),
            PyArray1::from_vec(py, chunk.varied).reshape([plates, fields])?,
            chunk.results.into_iter().map(result).collect::<PyResult<_>>()?,
        ))
    }

    /// Plate ``i``, from 0.
    ///
    /// Raises ``OutOfRange`` if the study has no such plate; ``BadFile`` if the plate file refuses its numbers.
    fn plate(&self, i: i64) -> PyResult<Plate> {
        let plates = Range::new(0.0, self.count().saturating_sub(1) as f64, "");
        in_range("i", i as f64, plates)?;
        let plate = self.inner.plate(i.unsigned_abs());
        Ok(plate.map_err(|error| file_failure(&error))?.into())
    }
}
