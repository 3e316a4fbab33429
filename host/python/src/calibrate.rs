//! `Plate.calibrate`.

use crate::arguments::{items, one_of, optional};
use crate::error::Failure;
use crate::feeling;
use crate::measurement::Measurement as PyMeasurement;
use crate::place::{LEVEL, no_such_tone};
use crate::plate::Plate as PyPlate;
use crate::result::kind::Calibration;
use crate::result::{Answer, fields};
use crate::waiting::compute;
use pyo3::prelude::*;
use slipline_instrument::calibration::named_calibrated;
use slipline_instrument::calipers::{IncompleteCalipers, complete_calipers, with_calipers};
use slipline_instrument::requests::{FeltEdgeError, FeltEdgeRequest, FeltEdgesRequest, measured};
use slipline_model::answer::calibrate::{
    CALIPERS_TOLERANCE, CalibrateAnswer, CalibrationReport, TOUCH_TOLERANCE, by_measurements,
};
use slipline_model::field::asked_place::AskedPlace;
use slipline_model::field::simulation::{SAMPLE_RATE_HZ, table_for_watched};
use slipline_plate::calibrate::{
    CalibrateError, Calipers, Measurement, Priors, TouchedDrive, Transducer, departure,
};
use slipline_plate::{Plate, Progress, limits};
use std::path::PathBuf;
use std::sync::Arc;

/// Most felt edges of a calibration.
const TOUCHES_MAX: usize = 1000;

/// Fits the plate's numbers.
pub(crate) fn run(
    py: Python<'_>,
    plate: &Arc<Plate>,
    measurements: Vec<Arc<Measurement>>,
    current: Option<Transducer>,
    calipers: Option<Calipers>,
    touches: Option<FeltEdgesRequest>,
) -> PyResult<Answer<Calibration>> {
    let file = Arc::clone(plate);
    let kept = measurements.iter().map(|it| Py::new(py, PyMeasurement::from(Arc::clone(it))));
    let kept = kept.collect::<PyResult<Vec<_>>>()?;
    let (found, calibrated) = compute(py, move |progress| {
        let (nominal, priors) = with_calipers(&file, calipers).map_err(|error| Failure::of(&error))?;
        let found = match (&touches, measured(&measurements, current)) {
            (None, Some(measured)) => by_measurements(&nominal, measured, &priors),
            (Some(touches), None) if measurements.is_empty() && current.is_none() => {
                by_felt_edges(touches, &nominal, &priors, progress)?
            }
            _ => {
                let given = format_args!("{} measurements", measurements.len());
                let allowed = "1 to 3 of one sensor, 1 of the current, or none with touch";
                return Err(Failure::wrong_arguments(given, allowed));
            }
        };
        answer(&file, found)
    })?;
    let calibrated = calibrated.map(|plate| Py::new(py, PyPlate::from(plate))).transpose()?;
    Answer::of(py, found)?.with(py, "plate", calibrated)?.with(py, "measurements", kept)
}

type Fields = serde_json::Map<String, serde_json::Value>;

/// The fields of a calibration, and the calibrated plate; `None` where it was refused.
fn answer(
    file: &Plate,
    found: Result<CalibrationReport, CalibrateError>,
) -> Result<(Fields, Option<Plate>), Failure> {
    match found {
        Ok(found) => {
            let before = departure(file, &found.plate, f64::from(SAMPLE_RATE_HZ));
            let before = before.map_err(|error| Failure::of(&error))?;
            Ok((fields(&CalibrateAnswer::of(file, &found, &before)), Some(named_calibrated(&found.plate))))
        }
        Err(error) => Ok((fields(&CalibrateAnswer::refused(file, &error)), None)),
    }
}

/// The plate's widths and length by calipers and a rule: all three or none.
pub(crate) fn calipers(
    half_width_m: Option<f64>,
    end_half_width_m: Option<f64>,
    length_m: Option<f64>,
    tolerance_m: Option<f64>,
) -> Result<Option<Calipers>, Failure> {
    optional("half_width_m", half_width_m, limits::HALF_WIDTH)?;
    optional("end_half_width_m", end_half_width_m, limits::HALF_WIDTH)?;
    optional("length_m", length_m, limits::LENGTH)?;
    optional("calipers_tolerance_m", tolerance_m, CALIPERS_TOLERANCE)?;
    let calipers = complete_calipers(half_width_m, end_half_width_m, length_m, tolerance_m);
    calipers.map_err(|IncompleteCalipers| {
        let given = "one of half_width_m, end_half_width_m and length_m alone";
        Failure::wrong_arguments(given, "all three of them")
    })
}

/// What drives the plate, whose current was measured.
pub(crate) fn transducer(word: Option<&str>) -> Result<Option<Transducer>, Failure> {
    let transducers = [("coil", Transducer::Coil), ("piezo", Transducer::Piezo)];
    word.map(|word| one_of("current", word, &transducers)).transpose()
}

/// The felt edges of the arguments.
pub(crate) struct Touches<'a, 'py> {
    pub(crate) touch: Option<Bound<'py, PyAny>>,
    pub(crate) level: Option<f64>,
    pub(crate) touch_tolerance_m: Option<f64>,
    pub(crate) touched_drive: Option<&'a str>,
    pub(crate) feeling: Option<PathBuf>,
}

impl Touches<'_, '_> {
    /// The request; `None` without felt edges.
    pub(crate) fn read(self) -> PyResult<Option<FeltEdgesRequest>> {
        let Self { touch, level, touch_tolerance_m: tolerance_m, touched_drive, feeling } = self;
        optional("level", level, LEVEL)?;
        optional("touch_tolerance_m", tolerance_m, TOUCH_TOLERANCE)?;
        let known = [("as-told", TouchedDrive::AsStated), ("unknown", TouchedDrive::Unknown)];
        let drive = touched_drive.map(|word| one_of("touched_drive", word, &known)).transpose()?;
        let Some(touch) = touch else {
            if level.is_some() || tolerance_m.is_some() || drive.is_some() || feeling.is_some() {
                let given = "level, touch_tolerance_m, touched_drive or feeling without touch";
                return Err(Failure::wrong_arguments(given, "beside it").into());
            }
            return Ok(None);
        };
        let asked_and_felt_m = items::<(f64, f64)>("touch", &touch, TOUCHES_MAX)?;
        let edge = |(asked_m, felt_m)| FeltEdgeRequest { asked: AskedPlace::FeltEdge(asked_m), felt_m };
        let edges = asked_and_felt_m.into_iter().map(edge).collect();
        let feeling = feeling::read(feeling.as_deref())?.feeling;
        Ok(Some(FeltEdgesRequest { edges, level, tolerance_m, drive, feeling }))
    }
}

fn by_felt_edges(
    touches: &FeltEdgesRequest,
    nominal: &Plate,
    priors: &Priors,
    progress: &mut Progress<'_>,
) -> Result<Result<CalibrationReport, CalibrateError>, Failure> {
    let made = table_for_watched(nominal, SAMPLE_RATE_HZ, progress);
    let (table, _) = made.map_err(|error| Failure::of(&error))?;
    touches.calibrate(nominal, priors, &table).map_err(|(_, error)| match error {
        FeltEdgeError::Felt(refused) => Failure::of(&refused),
        FeltEdgeError::Asked(refused) => no_such_tone(refused),
    })
}
