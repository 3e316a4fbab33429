//! `Plate.respond`: the field at one frequency, or at several in flat arrays.

use crate::arguments::{in_range, reserved};
use crate::error::Failure;
use crate::plate::Plate as PyPlate;
use crate::result::kind::Field;
use crate::result::{Answer, columns, dictionary, fields};
use crate::waiting::compute;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use serde_json::{Map, Value};
use slipline_model::answer::respond::{FieldRequest, RespondAnswer, plate_of, solve};
use slipline_plate::quantity::Range;
use slipline_plate::{
    Complex64, Finger, POINTS_MAX, POINTS_MIN, Plate, Progress, Responder, Response, respond_range,
};
use std::mem::take;
use std::sync::Arc;

/// Most frequencies of one call: each has some kilobytes beside its amplitudes.
pub(crate) const FREQUENCIES_MAX: usize = 100_000;

/// Numbers of places of a field.
pub(crate) const POINTS: Range = Range::new(POINTS_MIN as f64, POINTS_MAX as f64, "");

/// The request at each frequency.
#[derive(Clone, Copy)]
pub(crate) struct Asked {
    pub(crate) points: usize,
    pub(crate) finger: Option<Finger>,
    pub(crate) paper_mode: bool,
    pub(crate) two_dimensions: bool,
}

impl Asked {
    fn at(self, frequency_hz: f64) -> FieldRequest {
        let Self { points, finger, paper_mode, two_dimensions } = self;
        FieldRequest { frequency_hz, points, finger, paper_mode, two_dimensions }
    }

    /// Refuses a frequency that the plate does not respond to.
    fn check(self, plate: &Plate, frequencies_hz: &[f64]) -> Result<(), Failure> {
        let range = respond_range(&plate_of(plate, self.paper_mode));
        frequencies_hz.iter().try_for_each(|&hz| in_range("frequency_hz", hz, range))
    }
}

/// The field at one frequency.
pub(crate) fn at_one(py: Python<'_>, plate: &Arc<Plate>, hz: f64, asked: Asked) -> PyResult<Answer<Field>> {
    let plate = Arc::clone(plate);
    let found = compute(py, move |_| {
        asked.check(&plate, &[hz])?;
        let solved = solve(&plate, &asked.at(hz)).map_err(|error| Failure::of(&error))?;
        Ok(fields(&solved.answer()))
    })?;
    Answer::of(py, found)
}

/// The fields at several frequencies: what is one number of one field is a column here.
struct Fields {
    position_m: Vec<f64>,
    amplitude: Vec<Complex64>,
    frequencies: usize,
    rest: Map<String, Value>,
    two_dimensions: Vec<Value>,
}

/// The names of one value for all frequencies.
const OF_ALL: [&str; 3] = ["plate", "paper_mode", "turning_width"];

/// The field at each of these frequencies.
pub(crate) fn at_each(
    py: Python<'_>,
    plate: &PyPlate,
    frequencies_hz: Vec<f64>,
    asked: Asked,
) -> PyResult<Answer<Field>> {
    let (plate, responders) = (Arc::clone(&plate.plate), Arc::clone(&plate.responders));
    let found = compute(py, move |progress| {
        asked.check(&plate, &frequencies_hz)?;
        responders.with(&plate, asked.points, |responder| each(responder, &frequencies_hz, asked, progress))
    })?;
    let Fields { position_m, amplitude, frequencies, rest, two_dimensions } = found;
    let points = position_m.len();
    let mut answer = Answer::of(py, rest)?;
    answer = answer.with(py, "position_m", PyArray1::from_vec(py, position_m))?;
    let amplitude = PyArray1::from_vec(py, amplitude).reshape([frequencies, points])?;
    answer = answer.with(py, "amplitude", amplitude)?;
    if two_dimensions.is_empty() {
        return Ok(answer);
    }
    let differences = dictionary(py, columns(two_dimensions))?;
    answer.with(py, "two_dimensions", differences)
}

fn each(
    responder: &mut Responder,
    frequencies_hz: &[f64],
    asked: Asked,
    progress: &mut Progress<'_>,
) -> Result<Fields, Failure> {
    let plate = &responder.plate().clone();
    let mut amplitude = reserved(frequencies_hz.len().saturating_mul(asked.points))?;
    let (mut position_m, mut rows, mut two_dimensions) = (Vec::new(), Vec::new(), Vec::new());
    for (i, &hz) in frequencies_hz.iter().enumerate() {
        progress.at(i as f64 / frequencies_hz.len() as f64).map_err(|error| Failure::of(&error))?;
        let mut response = if asked.paper_mode || asked.two_dimensions {
            let solved = solve(plate, &asked.at(hz)).map_err(|error| Failure::of(&error))?;
            two_dimensions.extend(solved.differences().map(|it| Value::Object(fields(&it))));
            solved.response
        } else {
            responder.respond(asked.finger.as_ref(), hz).map_err(|error| Failure::of(&error))?
        };
        // As the command line prints them: a zero has no sign.
        let row = take(&mut response.amplitude);
        amplitude.extend(row.iter().map(|f| Complex64::new(f.re + 0.0, f.im + 0.0)));
        position_m = take(&mut response.position_m);
        rows.push(numbers(plate, asked, &response));
    }
    let mut rest = columns(rows);
    for name in OF_ALL {
        if let Some(Value::Array(column)) = rest.get(name) {
            let value = column.first().cloned().unwrap_or_default();
            rest.insert(name.to_owned(), value);
        }
    }
    Ok(Fields { position_m, amplitude, frequencies: frequencies_hz.len(), rest, two_dimensions })
}

/// The fields of one frequency whose series were taken.
fn numbers(plate: &Plate, asked: Asked, response: &Response) -> Value {
    let plate = plate_of(plate, asked.paper_mode);
    let mut found = fields(&RespondAnswer::of(&plate, asked.paper_mode, response));
    found.retain(|name, _| !["position_m", "amplitude"].contains(&name.as_str()));
    Value::Object(found)
}
