//! Arguments that hold several values: numbers, series of numbers, and lists.
//!
//! Any sequence and any array will do: a list, a tuple, a range, numpy's array, a column of pandas, a DataArray of xarray.
//! Every length is limited before memory is reserved for it, so that no argument ends the interpreter. Errors name the argument.

use crate::error::Failure;
use numpy::{Complex64, PyArray1, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::PyTypeError;
use pyo3::inspect::PyStaticExpr;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use pyo3::{Borrowed, type_hint_identifier};
use slipline_plate::quantity::{OutOfRange, Range, must_be};
use std::convert::Infallible;

/// Most numbers of a series.
pub(crate) const SERIES_MAX: usize = 1_000_000;

/// Refuses a number out of its range.
pub(crate) fn in_range(field: &'static str, value: f64, range: Range) -> Result<(), Failure> {
    OutOfRange::check(field, value, range).map_err(|refused| Failure::of(&refused))
}

/// Refuses a number out of its range, if there is one.
pub(crate) fn optional(field: &'static str, value: Option<f64>, range: Range) -> Result<(), Failure> {
    value.map_or(Ok(()), |value| in_range(field, value, range))
}

/// A whole number in its range. An argument is an `i64`, so that one below zero is refused by its name, too.
pub(crate) fn count_in(field: &'static str, value: i64, range: Range) -> Result<usize, Failure> {
    in_range(field, value as f64, range)?;
    usize::try_from(value).map_err(|error| Failure::value(must_be(format_args!("{field} = {value}"), error)))
}

/// One of these words.
pub(crate) fn one_of<T: Copy>(name: &str, given: &str, words: &[(&str, T)]) -> Result<T, Failure> {
    let found = words.iter().find(|(word, _)| *word == given).map(|(_, value)| *value);
    let allowed = || words.iter().map(|(word, _)| *word).collect::<Vec<_>>().join(", ");
    let text = format_args!("{name} = {given:?}");
    found.ok_or_else(|| Failure::refused(must_be(text, format_args!("one of {}", allowed()))))
}

/// An argument that is a number, or a series of numbers.
#[derive(Clone, Debug)]
pub(crate) struct ArrayLike<'py>(Bound<'py, PyAny>);

impl<'a, 'py> FromPyObject<'a, 'py> for ArrayLike<'py> {
    type Error = Infallible;
    const INPUT_TYPE: PyStaticExpr = type_hint_identifier!("numpy.typing", "ArrayLike");

    fn extract(given: Borrowed<'a, 'py, PyAny>) -> Result<Self, Infallible> {
        Ok(Self(given.to_owned()))
    }
}

/// A number, or a series of numbers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum OneOrMore {
    One(f64),
    More(Vec<f64>),
}

impl OneOrMore {
    /// Each number by this function.
    pub(crate) fn map(self, each: impl Fn(f64) -> Result<f64, Failure>) -> Result<Self, Failure> {
        Ok(match self {
            Self::One(number) => Self::One(each(number)?),
            Self::More(numbers) => Self::More(numbers.into_iter().map(each).collect::<Result<_, _>>()?),
        })
    }

    /// Its numbers; one number as often as this.
    pub(crate) fn repeated(self, count: usize) -> Vec<f64> {
        match self {
            Self::One(number) => vec![number; count],
            Self::More(numbers) => numbers,
        }
    }

    /// A float, or an array.
    pub(crate) fn into_python(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        Ok(match self {
            Self::One(number) => number.into_pyobject(py)?.into_any(),
            Self::More(numbers) => PyArray1::from_vec(py, numbers).into_any(),
        })
    }

    /// Its numbers.
    pub(crate) fn numbers(self) -> Vec<f64> {
        self.repeated(1)
    }
}

impl ArrayLike<'_> {
    /// A number, or up to `most` numbers of a series. `name` is that of the argument.
    pub(crate) fn one_or_more(&self, name: &str, most: usize) -> PyResult<OneOrMore> {
        let array = self.array(name)?;
        if array.ndim() == 0 {
            return Ok(OneOrMore::One(self.float(name, array.call_method0("item")?)?));
        }
        self.numbers(name, &array, most).map(OneOrMore::More)
    }

    /// Up to `most` numbers of a series.
    pub(crate) fn series(&self, name: &str, most: usize) -> PyResult<Vec<f64>> {
        let array = self.array(name)?;
        if array.ndim() == 0 {
            let text = format_args!("{name} of one number");
            return Err(Failure::wrong_arguments(text, "a series of numbers").into());
        }
        self.numbers(name, &array, most)
    }

    fn numbers(&self, name: &str, array: &Bound<'_, PyUntypedArray>, most: usize) -> PyResult<Vec<f64>> {
        if array.ndim() > 1 {
            let text = format!("{name} of the shape {}", array.getattr("shape")?);
            return Err(
                Failure::value(must_be(text, "a number, or a series of numbers in one dimension")).into()
            );
        }
        match array.len() {
            0 => {
                return Err(
                    Failure::value(must_be(format_args!("{name} of no number"), "one or more")).into()
                );
            }
            count if count > most => {
                let (message, range) = (
                    must_be(format_args!("{name} of {count} numbers"), format_args!("1 to {most} of them")),
                    (1.0, most as f64),
                );
                return Err(Failure::OutOfRange {
                    message,
                    field: name.to_owned(),
                    value: count as f64,
                    range,
                }
                .into());
            }
            _ => {}
        }
        let floats =
            array.call_method1("astype", ("float64",)).map_err(|error| self.no_numbers(name, &error))?;
        let floats = floats.cast_into::<PyArray1<f64>>()?;
        let mut numbers = reserved(floats.len())?;
        numbers.extend(floats.readonly().as_array().iter().copied());
        Ok(numbers)
    }

    /// Up to `most` complex numbers of a series.
    pub(crate) fn complex_series(&self, name: &str, most: usize) -> PyResult<Vec<Complex64>> {
        let numpy = self.0.py().import("numpy")?;
        let parts = |part: &str| -> PyResult<Vec<f64>> {
            let part = numpy.call_method1(part, (&self.0,)).map_err(|error| self.no_numbers(name, &error))?;
            Self(part).series(name, most)
        };
        let (re, im) = (parts("real")?, parts("imag")?);
        Ok(re.into_iter().zip(im).map(|(re, im)| Complex64::new(re, im)).collect())
    }

    /// As an array of numpy; refused if its values are no numbers, or some are masked.
    fn array(&self, name: &str) -> PyResult<Bound<'_, PyUntypedArray>> {
        let py = self.0.py();
        let numpy = py.import("numpy")?;
        let masked = numpy.getattr("ma")?;
        if self.0.is_instance(&masked.getattr("MaskedArray")?)?
            && masked.call_method1("is_masked", (&self.0,))?.is_truthy()?
        {
            let text = format_args!("{name} with masked values");
            return Err(Failure::value(must_be(text, "numbers: leave the masked ones out")).into());
        }
        let array = numpy.call_method1("asarray", (&self.0,)).map_err(|error| {
            // Lists of different lengths are no array.
            if error.is_instance_of::<pyo3::exceptions::PyValueError>(py) {
                let text = format_args!("{name} of series of different lengths");
                return Failure::value(must_be(text, "a number, or a series of numbers")).into();
            }
            error
        })?;
        let array = array.cast_into::<PyUntypedArray>()?;
        match array.getattr("dtype")?.getattr("kind")?.extract::<String>()?.as_str() {
            "f" | "i" | "u" => Ok(array),
            // Fractions, decimal numbers and whole numbers beyond 64 bits.
            "O" => {
                // numpy alone would take None for NaN, and read texts.
                for item in array.getattr("flat")?.try_iter()? {
                    self.float(name, item?)?;
                }
                Ok(array.call_method1("astype", ("float64",))?.cast_into()?)
            }
            "c" => {
                let text = format_args!("{name} of complex numbers");
                Err(Failure::wrong_arguments(text, "real numbers").into())
            }
            _ => Err(self.no_numbers(name, &PyTypeError::new_err(()))),
        }
    }

    fn float(&self, name: &str, item: Bound<'_, PyAny>) -> PyResult<f64> {
        item.extract().map_err(|error| self.no_numbers(name, &error))
    }

    /// The refusal of what is no number; lack of memory stays what it is.
    fn no_numbers(&self, name: &str, error: &PyErr) -> PyErr {
        let py = self.0.py();
        if error.is_instance_of::<pyo3::exceptions::PyMemoryError>(py) {
            return error.clone_ref(py);
        }
        let text = format!("{name} = {}", shown(&self.0));
        Failure::wrong_arguments(text, "a number, or a series of numbers").into()
    }
}

/// The value of an argument, shortened.
fn shown(given: &Bound<'_, PyAny>) -> String {
    let text = given.repr().map_or_else(|_| "?".to_owned(), |text| text.to_string());
    if text.chars().count() <= 60 { text } else { text.chars().take(57).collect::<String>() + "..." }
}

/// Room for this number of values; a `MemoryError` where there is none.
pub(crate) fn reserved<T>(count: usize) -> Result<Vec<T>, Failure> {
    let mut room = Vec::new();
    room.try_reserve_exact(count).map_err(|_| Failure::memory(count, size_of::<T>()))?;
    Ok(room)
}

/// The items of a sequence, at most `most`.
pub(crate) fn items<'py, T>(name: &str, given: &Bound<'py, PyAny>, most: usize) -> PyResult<Vec<T>>
where
    T: Item<'py>,
{
    let wrong = |given: &Bound<'py, PyAny>| {
        let text = format!("{name} = {}", shown(given));
        Failure::wrong_arguments(text, format_args!("a sequence of {}", T::WORDS))
    };
    if given.is_instance_of::<PyString>() || given.is_instance_of::<PyDict>() {
        return Err(wrong(given).into());
    }
    let mut items = Vec::new();
    for item in given.try_iter().map_err(|_| wrong(given))? {
        if items.len() == most {
            let (message, range) = (
                must_be(format_args!("more than {most} {name}"), format_args!("at most {most}")),
                (0.0, most as f64),
            );
            let value = most as f64 + 1.0;
            return Err(Failure::OutOfRange { message, field: name.to_owned(), value, range }.into());
        }
        let item = item?;
        items.push(T::of(&item).ok_or_else(|| wrong(given))?);
    }
    Ok(items)
}

/// An item of a sequence.
pub(crate) trait Item<'py>: Sized {
    /// What it is, in the plural.
    const WORDS: &'static str;
    /// This value as an item; `None` if it is none.
    fn of(given: &Bound<'py, PyAny>) -> Option<Self>;
}

impl<'py> Item<'py> for Bound<'py, PyDict> {
    const WORDS: &'static str = "dictionaries";

    fn of(given: &Bound<'py, PyAny>) -> Option<Self> {
        given.cast::<PyDict>().ok().cloned()
    }
}

/// Two numbers.
impl<'py> Item<'py> for (f64, f64) {
    const WORDS: &'static str = "pairs of numbers";

    fn of(given: &Bound<'py, PyAny>) -> Option<Self> {
        let mut numbers = given.try_iter().ok()?;
        let mut next = || numbers.next()?.ok()?.extract::<f64>().ok();
        let pair = (next()?, next()?);
        numbers.next().is_none().then_some(pair)
    }
}

/// Two numbers as an argument: a tuple, a list, an array.
pub(crate) fn pair(name: &str, given: &Bound<'_, PyAny>, allowed: &str) -> PyResult<(f64, f64)> {
    let wrong = || Failure::wrong_arguments(format_args!("{name} = {}", shown(given)), allowed);
    if given.is_instance_of::<PyString>() {
        return Err(wrong().into());
    }
    Ok(<(f64, f64)>::of(given).ok_or_else(wrong)?)
}
