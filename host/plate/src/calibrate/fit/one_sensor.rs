//! The calibration by one sensor, with the full model of the source.

use super::gain::Carried;
use super::joint_fit::Joint;
use super::least_squares::Fit;
use super::pairs::{MODEL_ERROR, unbiased_magnitude};
use super::response::plate_response::{PlateResponse, Units, takes_a_source};
use super::response::sensor_body::{check_fitted_mass, check_mass};
use super::result::{AcceptedFit, Calibrated};
use super::source::data::{Datum, entering, of_deflection};
use super::source::sensor_signal::{CURVE, DELAY, RISE, SensorSignal};
use super::source::source_file::FittedSource;
use super::source::third_mode::widen;
use super::unknowns::Priors;
use crate::calibrate::error::CalibrateError;
use crate::calibrate::measurement::band::band_hz;
use crate::calibrate::measurement::sensor::{MeasuredPoint, Measurement};
use crate::calibrate::measurement::signal;
use crate::calibrate::placement::near_limit::NearLimit;
use crate::definition::Plate;

/// Calibrates `plate`, the nominal one, from one sensor at one place. The model includes everything before the plate: a
/// source with resistance, mass and stiffness, an actuator of second order, a gain and a delay. The file must state a
/// membrane's tension or a sheet's thickness. The calibrated plate has the fitted source.
///
/// ```no_run
/// # use slipline_plate::calibrate::{Measurement, Priors, from_one_sensor};
/// # fn example(sensor: Measurement) -> Result<(), Box<dyn std::error::Error>> {
/// let nominal = slipline_plate::preset("membrane").unwrap();
/// let found = from_one_sensor(&nominal, &sensor, &Priors::default())?;
/// for parameter in &found.parameters {
///     println!("{} = {} ({} to {})", parameter.name, parameter.value, parameter.low, parameter.high);
/// }
/// # Ok(()) }
/// ```
///
/// # Errors
/// [`CalibrateError`]: a mistake in the measurement, or a quantity that it does not determine.
pub fn from_one_sensor(
    plate: &Plate,
    sensor: &Measurement,
    priors: &Priors,
) -> Result<Calibrated, CalibrateError> {
    let found = fitted(plate, sensor, priors, true).map(|(calibrated, _)| calibrated);
    found.map_err(|error| near_end(plate, sensor, error))
}

/// The refusal of a sensor that stands nearer to the driven end than a plan proposes: that it sees other waves, too.
fn near_end(plate: &Plate, sensor: &Measurement, error: CalibrateError) -> CalibrateError {
    let (place_m, (nearest_m, _)) = (sensor.place_m, NearLimit::of(plate, band_hz(plate), false));
    match error {
        CalibrateError::Unlike { chi2_per_n, most } if place_m < nearest_m => {
            CalibrateError::UnlikeNearEnd { place_m, nearest_m, chi2_per_n, most }
        }
        error => error,
    }
}

/// Refuses a plate that no measurement by one sensor, or of the drive's current, can calibrate: its file must state a
/// membrane's tension or a sheet's thickness, and no law of the thickness.
///
/// # Errors
/// [`CalibrateError::Plate`].
pub fn check_source(plate: &Plate) -> Result<(), CalibrateError> {
    Ok(takes_a_source(plate.spec())?)
}

/// As [`from_one_sensor`]; also returns the fitted coordinates of the plate, the place and the source. `of_any_end` counts what an end
/// that moves in another shape than the first width mode adds near it, and where its wave begins.
pub(crate) fn fitted(
    plate: &Plate,
    sensor: &Measurement,
    priors: &Priors,
    of_any_end: bool,
) -> Result<(Calibrated, Fit), CalibrateError> {
    priors.check()?;
    signal::check_sensor(plate, sensor)?;
    check_source(plate)?;
    let points = entering(plate, sensor)?;
    let units = Units::of(plate, &points).ok_or(CalibrateError::NoFit)?;
    let mut data = of_deflection(&points, sensor, units);
    let mut source = SensorSignal::new(units, points[points.len() - 1].frequency_hz);
    let frequencies_hz: Vec<f64> = points.iter().map(|point| point.frequency_hz).collect();
    if of_any_end {
        widen(&mut data, plate, sensor.place_m, &frequencies_hz);
        source = source.of_any_end(plate);
    }
    check_mass(plate, sensor, &frequencies_hz)?;
    let mut joint = Joint::new(plate, source, units, Some(sensor), priors, (&points, data));
    let (fit, chi2_per_n) = joint.accepted()?;
    check_fitted_mass(sensor, joint.of_mass(&fit.parameters))?;

    let first = joint.of_source();
    let of_source = &fit.parameters[first..];
    let source = FittedSource {
        units,
        first,
        impedance: joint.impedance_of(&fit.parameters),
        actuator: [of_source[RISE], of_source[CURVE]],
        actuator_at: RISE,
        delay: Some((of_source[DELAY], DELAY)),
    };
    let carried = |at: &[f64]| {
        let impedance = joint.impedance_of(at);
        let each = |((answer, point), datum): ((&PlateResponse, &MeasuredPoint), &Datum)| {
            let seen = SensorSignal::seen(answer, 0, &at[joint.of_source()..]);
            let to_peak = answer.rise(impedance) * answer.peak / seen.norm();
            let error = datum.relative(MODEL_ERROR) * point.response.norm() * to_peak;
            Carried { frequency_hz: answer.frequency_hz, peak: unbiased_magnitude(point) * to_peak, error }
        };
        Some(joint.answers_with_peak(at)?.iter().zip(&points).zip(&joint.data).map(each).collect())
    };
    let accepted = AcceptedFit {
        nominal: plate,
        fit: &fit,
        chi2_per_n,
        misfit: joint.misfit(&fit.parameters).ok_or(CalibrateError::NoFit)?,
        deviations: &joint.deviations,
        sensors: &[sensor],
        levels: sensor,
        source: Some(source),
        frequencies_hz: &joint.frequencies_hz,
        carried: &carried,
    };
    Ok((accepted.finish()?, fit))
}
