//! `Plate.calibrate`.

use crate::error::Failure;
use crate::feeling::{self, NamedFeeling};
use crate::options::Options;
use crate::place::{LEVEL, turning_point_of};
use crate::plate::Plate as PyPlate;
use crate::result::{Answer, fields};
use crate::waiting::compute;
use pyo3::prelude::*;
use slipline_instrument::calibration::{CALIPERS_TOLERANCE_M, named_calibrated};
use slipline_model::answer::calibrate::{
    CALIPERS_TOLERANCE, CalibrateAnswer, CalibrationReport, Measured, TOUCH_LEVEL, TOUCH_TOLERANCE,
    TOUCH_TOLERANCE_M, by_measurements, by_touches, touch,
};
use slipline_model::field::asked_place::AskedPlace;
use slipline_model::field::simulation::{SAMPLE_RATE_HZ, table_for_watched};
use slipline_model::setup::Setup;
use slipline_plate::calibrate::{
    CalibrateError, Calipers, Measurement, Priors, Touch, TouchedDrive, Transducer, departure,
};
use slipline_plate::quantity::{OutOfRange, Range};
use slipline_plate::{Plate, Progress, limits};
use std::sync::Arc;

/// Felt edges, and what is known of them.
struct Touches {
    /// Each as (felt edge asked for, place where it was felt), metres.
    asked_and_felt_m: Vec<(f64, f64)>,
    level: f64,
    tolerance_m: f64,
    drive: Option<TouchedDrive>,
    feeling: NamedFeeling,
}

/// Fits the plate's numbers.
pub(crate) fn run(
    py: Python<'_>,
    plate: &Arc<Plate>,
    measurements: Vec<Arc<Measurement>>,
    mut options: Options<'_>,
) -> PyResult<Answer> {
    let current = options.word("current", &[("coil", Transducer::Coil), ("piezo", Transducer::Piezo)])?;
    let calipers = calipers(&mut options)?;
    let touches = touches(&mut options)?;
    options.end()?;
    let file = Arc::clone(plate);
    let (found, calibrated) = compute(py, move |progress| {
        let applied = calipers.map(|calipers| calipers.applied_to(&file)).transpose();
        let applied = applied.map_err(|error| Failure::of(&error))?;
        let (nominal, priors) = applied.unwrap_or_else(|| ((*file).clone(), Priors::default()));
        let found = match (&measurements[..], current, &touches) {
            ([one], Some(drive), None) => by_measurements(&nominal, Measured::Current(one, drive), &priors),
            ([one], None, None) => by_measurements(&nominal, Measured::OneSensor(one), &priors),
            ([near, far], None, None) => by_measurements(&nominal, Measured::TwoPlaces([near, far]), &priors),
            ([], None, Some(touches)) => touches.calibrate(&nominal, &priors, progress)?,
            (more, ..) => {
                let given = format_args!("{} measurements", more.len());
                let allowed = "1 or 2 of one sensor, 1 of the current, or none with touch";
                return Err(Failure::wrong_arguments(given, allowed));
            }
        };
        answer(&file, found)
    })?;
    let calibrated = calibrated.map(|plate| Py::new(py, PyPlate::from(plate))).transpose()?;
    Answer::of(py, found)?.with(py, "plate", calibrated)
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
fn calipers(options: &mut Options<'_>) -> PyResult<Option<Calipers>> {
    let half_width_m = options.number("half_width", limits::HALF_WIDTH)?;
    let end_half_width_m = options.number("end_half_width", limits::HALF_WIDTH)?;
    let length_m = options.number("length", limits::LENGTH)?;
    let tolerance_m = options.number("calipers_tolerance", CALIPERS_TOLERANCE)?;
    match (half_width_m, end_half_width_m, length_m) {
        (None, None, None) => Ok(None),
        (Some(half_width_m), Some(end_half_width_m), Some(length_m)) => {
            let tolerance_m = tolerance_m.unwrap_or(CALIPERS_TOLERANCE_M);
            Ok(Some(Calipers { half_width_m, end_half_width_m, length_m, tolerance_m }))
        }
        _ => {
            let given = "one of half_width, end_half_width and length alone";
            Err(Failure::wrong_arguments(given, "all three of them").into())
        }
    }
}

/// The felt edges of the options.
fn touches(options: &mut Options<'_>) -> PyResult<Option<Touches>> {
    let asked_and_felt_m = options.take("touch")?.map(|given| given.extract()).transpose()?;
    let level = options.number("level", LEVEL)?;
    let tolerance_m = options.number("touch_tolerance", TOUCH_TOLERANCE)?;
    let known = [("as-told", TouchedDrive::AsStated), ("unknown", TouchedDrive::Unknown)];
    let drive = options.word("touched_drive", &known)?;
    let feeling = options.text("feeling")?;
    let Some(asked_and_felt_m) = asked_and_felt_m else {
        if level.is_some() || tolerance_m.is_some() || drive.is_some() || feeling.is_some() {
            let given = "level, touch_tolerance, touched_drive or feeling without touch";
            return Err(Failure::wrong_arguments(given, "beside it").into());
        }
        return Ok(None);
    };
    Ok(Some(Touches {
        asked_and_felt_m,
        level: level.unwrap_or(TOUCH_LEVEL),
        tolerance_m: tolerance_m.unwrap_or(TOUCH_TOLERANCE_M),
        drive,
        feeling: feeling::read(feeling.as_deref())?,
    }))
}

impl Touches {
    fn calibrate(
        &self,
        nominal: &Plate,
        priors: &Priors,
        progress: &mut Progress<'_>,
    ) -> Result<Result<CalibrationReport, CalibrateError>, Failure> {
        let feeling = self.feeling.feeling;
        let (table, _) =
            table_for_watched(nominal, SAMPLE_RATE_HZ, progress).map_err(|it| Failure::of(&it))?;
        let setup = Setup { feeling, ..Setup::new(Arc::new(nominal.clone())) };
        let on_plate = Range::new(0.0, nominal.length_m(), "m");
        let touched = |&(asked_m, felt_m): &(f64, f64)| -> Result<Touch, Failure> {
            OutOfRange::check("touch", felt_m, on_plate)
                .map_err(|refused| Failure::out_of_range(&refused))?;
            let turning_point_m =
                turning_point_of(AskedPlace::FeltEdge(asked_m), &setup, self.level, &table)?;
            Ok(touch(&table, turning_point_m, self.level, (felt_m, self.tolerance_m)))
        };
        let touches = self.asked_and_felt_m.iter().map(touched).collect::<Result<Vec<_>, _>>()?;
        Ok(by_touches(nominal, &touches, &feeling, self.drive, priors))
    }
}
