//! The calibration by one sensor, with the full model of the source.

use super::acceptance;
use super::gain::{self, Carried};
use super::joint_fit::{Joint, Place};
use super::least_squares::Fit;
use super::response::plate_response::{PlateResponse, Units, takes_a_source};
use super::result::{AcceptedFit, Calibrated, INTERVAL, Parameter};
use super::source::data::{Datum, entering, of_deflection};
use super::source::sensor_signal::{CURVE, DELAY, RISE, SensorSignal};
use super::source::source_file::{
    parameters_of_actuator, parameters_of_impedance, source_tolerance, with_actuator, with_source,
};
use super::source::source_model::SourceModel;
use super::spread::Spread;
use super::unknowns::{Priors, spec_at};
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
    let measured_hz = (points[0].frequency_hz, points[points.len() - 1].frequency_hz);
    let units = Units::of(plate, measured_hz).ok_or(CalibrateError::NoFit)?;
    let data = of_deflection(&points, sensor, units);
    let (place_m, tolerance_m) = (sensor.place_m, sensor.place_tolerance_m);
    let place = Place { place_m, tolerance_m, sensor: sensor.sensor };
    let frequencies_hz = points.iter().map(|point| point.frequency_hz).collect();
    let source = SensorSignal::new(units, measured_hz.1);
    let mut joint = Joint::new(plate, source, units, Some(place), priors, (frequencies_hz, data));
    let (fit, chi2_per_n) = joint.accepted()?;
    acceptance::check_coordinates(&fit.parameters, &joint.deviations, &[place_m])?;

    let first = joint.of_source();
    let impedance = joint.impedance_of(&fit.parameters);
    let actuator = [fit.parameters[first + RISE], fit.parameters[first + CURVE]];
    let spec = with_source(spec_at(plate.spec(), &fit.parameters), units, units.impedance(impedance));
    let fitted = Plate::new(with_actuator(spec, units, actuator))?;
    let carried = |answers: &[PlateResponse]| -> Vec<Carried> {
        let each = |((answer, point), datum): ((&PlateResponse, &MeasuredPoint), &Datum)| {
            let peak = point.response.norm() / answer.seen[0].norm() * answer.peak;
            // Beside a node of the wave the model's answer is small, whatever the noise is.
            let model = joint.source.response(answer, 0, &fit.parameters[first..]).norm();
            Carried { frequency_hz: answer.frequency_hz, peak, error: datum.variance.sqrt() / model }
        };
        answers.iter().zip(&points).zip(&joint.data).map(each).collect()
    };
    let peaks = |at: &[f64]| {
        let carried = carried(&joint.answers_with_peak(at)?);
        Some(carried.iter().map(|carried| carried.peak.ln()).collect())
    };
    let spread = Spread::of(&fitted, &fit, &joint.deviations, 1, &peaks).ok_or(CalibrateError::NoFit)?;
    let answers = joint.answers_with_peak(&fit.parameters).ok_or(CalibrateError::NoFit)?;
    let measured: Vec<Carried> = carried(&answers).into_iter().filter(|it| it.peak > 0.0).collect();
    let (correction, noise_db) = gain::correction(&fitted, Some(plate), sensor, &measured)?;
    let places_m = [place_m];
    let found = AcceptedFit {
        nominal: plate,
        fitted,
        fit: &fit,
        chi2_per_n,
        spread,
        places_m: &places_m,
        correction,
        noise_db,
        source_tolerance: None,
        measured_hz,
    };
    acceptance::check_carried(plate, &[sensor], found.open())?;
    let half = |i: usize| INTERVAL * found.deviation(first + i);
    let mut of_source = parameters_of_impedance(units, impedance, [0, 1, 2].map(half));
    of_source.extend(parameters_of_actuator(units, actuator, [RISE, CURVE].map(half)));
    let delay = fit.parameters[first + DELAY] / units.omega;
    of_source.push(Parameter::about("delay_s", delay, half(DELAY) / units.omega));
    let source_tolerance = Some(source_tolerance(units, [0, 1, 2].map(half)));
    let mut calibrated = AcceptedFit { source_tolerance, ..found }.into_calibrated()?;
    calibrated.parameters.extend(of_source);
    Ok((calibrated, fit))
}
