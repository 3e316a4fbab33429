//! The calibration by one sensor, with the full model of the source.

use super::gain::Carried;
use super::joint_fit::Joint;
use super::least_squares::Fit;
use super::response::plate_response::{PlateResponse, Units, takes_a_source};
use super::result::{AcceptedFit, Calibrated};
use super::source::data::{Datum, entering, of_deflection};
use super::source::sensor_signal::{CURVE, DELAY, RISE, SensorSignal};
use super::source::source_file::FittedSource;
use super::source::source_model::SourceModel;
use super::unknowns::Priors;
use crate::calibrate::error::CalibrateError;
use crate::calibrate::measurement::sensor::{MeasuredPoint, Measurement};
use crate::calibrate::measurement::signal;
use crate::definition::Plate;

/// Calibrates `plate`, the nominal one, from one sensor at one place, by a model of everything before the plate: a source
/// with resistance, mass and spring, an actuator of the second order, a gain and a delay. The file must state a membrane's
/// tension or a sheet's thickness. The calibrated plate has the fitted source.
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
/// [`CalibrateError`]: what is wrong with the measurement, or what it does not carry.
pub fn from_one_sensor(
    plate: &Plate,
    sensor: &Measurement,
    priors: &Priors,
) -> Result<Calibrated, CalibrateError> {
    fitted(plate, sensor, priors).map(|(calibrated, _)| calibrated)
}

/// As [`from_one_sensor`], with the coordinates of the plate, the place and the source.
pub(crate) fn fitted(
    plate: &Plate,
    sensor: &Measurement,
    priors: &Priors,
) -> Result<(Calibrated, Fit), CalibrateError> {
    priors.check()?;
    signal::check_sensor(plate, sensor)?;
    takes_a_source(&plate.spec().model)?;
    let points = entering(plate, sensor)?;
    let units = Units::of(plate, &points).ok_or(CalibrateError::NoFit)?;
    let data = of_deflection(&points, sensor, units);
    let source = SensorSignal::new(units, points[points.len() - 1].frequency_hz);
    let mut joint = Joint::new(plate, source, units, Some(sensor), priors, (&points, data));
    let (fit, chi2_per_n) = joint.accepted()?;

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
        let each = |((answer, point), datum): ((&PlateResponse, &MeasuredPoint), &Datum)| {
            let peak = point.response.norm() / answer.seen[0].norm() * answer.peak;
            // Beside a node of the wave the model's answer is small, whatever the noise is.
            let model = joint.source.response(answer, 0, &at[first..]).norm();
            Carried { frequency_hz: answer.frequency_hz, peak, error: datum.variance.sqrt() / model }
        };
        Some(joint.answers_with_peak(at)?.iter().zip(&points).zip(&joint.data).map(each).collect())
    };
    let accepted = AcceptedFit {
        nominal: plate,
        fit: &fit,
        chi2_per_n,
        deviations: &joint.deviations,
        sensors: &[sensor],
        levels: sensor,
        source: Some(source),
        frequencies_hz: &joint.frequencies_hz,
        carried: &carried,
    };
    Ok((accepted.finish()?, fit))
}
