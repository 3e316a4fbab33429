//! A calibration.

use serde::Serialize;
use slipline_plate::calibrate::{
    CalibrateError, Calibrated, Departure, ForeignRead, Measurement, Parameter, Priors, Touch, TouchedDrive,
    Transducer, from_checked_ratio, from_one_sensor, from_ratio, from_shunt, from_touches,
};
use slipline_plate::feeling::Feeling;
use slipline_plate::quantity::Range;
use slipline_plate::{DriveTable, Plate};

/// The default level of touched tones, equal to that of a drive.
pub const TOUCH_LEVEL: f64 = 0.8;
/// Default standard deviation of a felt edge's position, metres.
pub const TOUCH_TOLERANCE_M: f64 = 2e-3;
/// Allowed standard deviation of a felt edge's position, metres.
pub const TOUCH_TOLERANCE: Range = Range::new(1e-5, 0.05, "m");
/// Allowed standard deviation of calipers, metres.
pub const CALIPERS_TOLERANCE: Range = Range::new(1e-7, 0.01, "m");

/// The measurements of a plate.
#[derive(Clone, Copy, Debug)]
pub enum Measured<'a> {
    /// One sensor at two places.
    TwoPlaces([&'a Measurement; 2]),
    /// The same, and at a third place as a check.
    Checked([&'a Measurement; 2], &'a Measurement),
    /// One sensor at one place.
    OneSensor(&'a Measurement),
    /// The current of this drive.
    Current(&'a Measurement, Transducer),
}

/// The calibration by what was measured.
///
/// # Errors
/// [`CalibrateError`]: why it is refused.
pub fn by_measurements(
    nominal: &Plate,
    measured: Measured<'_>,
    priors: &Priors,
) -> Result<CalibrationReport, CalibrateError> {
    let (way, found) = match measured {
        Measured::TwoPlaces(sensors) => (Way::TwoPlaces, from_ratio(nominal, sensors, priors)?),
        Measured::Checked(sensors, check) => {
            (Way::CheckedPlaces, from_checked_ratio(nominal, sensors, check, priors)?)
        }
        Measured::OneSensor(sensor) => (Way::OneSensor, from_one_sensor(nominal, sensor, priors)?),
        Measured::Current(current, drive) => (Way::Current, from_shunt(nominal, current, drive, priors)?),
    };
    Ok(CalibrationReport::by(way, found))
}

/// A felt edge: a tone of this turning point and level was felt to end at `mark_m`; `table` is that of the plate.
#[must_use]
pub fn touch(
    table: &DriveTable,
    turning_point_m: f64,
    level: f64,
    (mark_m, tolerance_m): (f64, f64),
) -> Touch {
    Touch {
        mark_m,
        tolerance_m,
        frequency_hz: table.frequency_hz(turning_point_m),
        peak_m: level * table.peak_m(turning_point_m),
    }
}

/// The calibration by felt edges; `drive` is the knowledge of the drive, by default that of the plate's file.
///
/// # Errors
/// [`CalibrateError`]: why it is refused.
pub fn by_touches(
    nominal: &Plate,
    touches: &[Touch],
    feeling: &Feeling,
    drive: Option<TouchedDrive>,
    priors: &Priors,
) -> Result<CalibrationReport, CalibrateError> {
    let drive = drive.unwrap_or_else(|| TouchedDrive::of(nominal));
    let found = from_touches(nominal, touches, feeling, drive, priors)?;
    Ok(CalibrationReport {
        way: match drive {
            TouchedDrive::AsStated => Way::Touches,
            TouchedDrive::Unknown => Way::TouchesOfUnknownDrive,
        },
        edge_tolerance_m: Some(found.edge_tolerance_m),
        plate: found.plate,
        parameters: found.parameters,
        chi2_per_n: found.chi2_per_n,
        feeling: Some(found.feeling),
        misfit: None,
        turning_point: None,
        caution: None,
        level_tolerance_db: None,
    })
}

/// The method of a calibration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    /// One sensor at two places.
    TwoPlaces,
    /// The same, with a third place as a check.
    CheckedPlaces,
    /// One sensor at one place, and a model of the source.
    OneSensor,
    /// The drive's current.
    Current,
    /// Felt edges, of a drive as the plate file states it.
    Touches,
    /// Felt edges, of an unknown drive.
    TouchesOfUnknownDrive,
}

impl Way {
    const fn word(self) -> &'static str {
        match self {
            Self::TwoPlaces => "two places",
            Self::CheckedPlaces => "two places and a check",
            Self::OneSensor => "one sensor",
            Self::Current => "current",
            Self::Touches | Self::TouchesOfUnknownDrive => "touches",
        }
    }
}

/// A calibrated plate, and the reported values.
#[derive(Clone, Debug)]
pub struct CalibrationReport {
    /// The method.
    pub way: Way,
    /// The plate.
    pub plate: Plate,
    /// The fitted numbers of its file, and their intervals.
    pub parameters: Vec<Parameter>,
    /// Squared departure over variance and number of points.
    pub chi2_per_n: f64,
    /// The finger's feeling; only of a calibration by felt edges.
    pub feeling: Option<Feeling>,
    /// The model error with which `chi2_per_n` would be 1, and the remedy; `None` for felt edges.
    pub misfit: Option<(f64, String)>,
    /// Half of the 95 % interval of the turning point, metres, and its shift per metre of misplacement of each sensor.
    pub turning_point: Option<(f64, Vec<f64>)>,
    /// Half of the 95 % interval of the felt edge, metres; only of a calibration by felt edges.
    pub edge_tolerance_m: Option<f64>,
    /// A property that no measurement determines and the user must check.
    pub caution: Option<String>,
    /// Half of the 95 % interval of the level, dB; `None` where no levels were measured.
    pub level_tolerance_db: Option<f64>,
}

impl CalibrationReport {
    fn by(way: Way, found: Calibrated) -> Self {
        Self {
            caution: found.caution(),
            misfit: Some((found.misfit, found.misfit_note())),
            way,
            plate: found.plate,
            parameters: found.parameters,
            chi2_per_n: found.chi2_per_n,
            feeling: None,
            edge_tolerance_m: None,
            turning_point: Some((found.boundary_tolerance_m, found.boundary_per_place)),
            level_tolerance_db: Some(found.level_tolerance_db).filter(|db| db.is_finite()),
        }
    }
}

/// The fields of `slipline calibrate --json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct CalibrateAnswer<'a> {
    /// Name of the plate.
    pub plate: &'a str,
    /// JSON, true or false: Whether the calibration is accepted; if not, `reason` says why
    pub accepted: bool,
    /// JSON, text: Why the calibration is refused; null if it is accepted
    pub reason: Option<String>,
    /// JSON, text: The way: two places, two places and a check, one sensor, current or touches
    pub by: Option<&'static str>,
    /// The fitted parameters, each with its interval.
    pub parameters: &'a [Parameter],
    /// JSON, 1: Square of the deviation per answer, in units of its noise
    pub chi2_per_n: Option<f64>,
    /// JSON, 1: Error of the model that explains the deviation; null by touches
    pub misfit: Option<f64>,
    /// JSON: Half of the 95 % interval of turning points; null where unknown
    pub turning_point_tolerance_m: Option<f64>,
    /// JSON, m/m: Shift of turning points per metre that a sensor is off its mark
    pub turning_point_per_place: Option<&'a [f64]>,
    /// JSON: Half of the 95 % interval of the felt edge; null except by touches
    pub felt_edge_tolerance_m: Option<f64>,
    /// JSON: Half of the 95 % interval of the level; null where no levels were measured
    pub level_tolerance_db: Option<f64>,
    /// A caution that no measurement reveals and the user must check.
    pub caution: Option<&'a str>,
    /// How far off the file was before.
    pub before: Option<BeforeAnswer>,
    /// `None` where the caller gives measurements instead of files.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub read: Option<&'a [FileReadAnswer]>,
}

/// The fields of a file by another program.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FileReadAnswer {
    /// The file that was read.
    pub file: String,
    /// How the file was read.
    #[serde(flatten)]
    pub read: ForeignRead,
}

/// The fields of what the plate's file missed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BeforeAnswer {
    /// JSON: Largest error of turning points by the file before
    pub turning_point_error_m: f64,
    /// JSON: Largest error of the level by the file before; null where no levels were measured
    pub level_error_db: Option<f64>,
}

impl<'a> CalibrateAnswer<'a> {
    /// The fields of a calibration of this plate; `before` is the error of its file.
    #[must_use]
    pub fn of(file: &'a Plate, found: &'a CalibrationReport, before: &Departure) -> Self {
        Self {
            plate: file.name(),
            accepted: true,
            reason: None,
            by: Some(found.way.word()),
            parameters: &found.parameters,
            chi2_per_n: Some(found.chi2_per_n),
            misfit: found.misfit.as_ref().map(|it| it.0),
            turning_point_tolerance_m: found.turning_point.as_ref().map(|it| it.0),
            turning_point_per_place: found.turning_point.as_ref().map(|it| &it.1[..]),
            felt_edge_tolerance_m: found.edge_tolerance_m,
            level_tolerance_db: found.level_tolerance_db,
            caution: found.caution.as_deref(),
            before: Some(BeforeAnswer {
                turning_point_error_m: before.boundary_m,
                level_error_db: found.level_tolerance_db.map(|_| before.level_db),
            }),
            read: None,
        }
    }

    /// The fields of a refused calibration.
    #[must_use]
    pub fn refused(file: &'a Plate, error: &CalibrateError) -> Self {
        let chi2_per_n = if let CalibrateError::Unlike { chi2_per_n, .. }
        | CalibrateError::EdgesUnlike { chi2_per_n, .. } = error
        {
            Some(*chi2_per_n)
        } else {
            None
        };
        Self { plate: file.name(), reason: Some(error.to_string()), chi2_per_n, ..Self::default() }
    }
}
