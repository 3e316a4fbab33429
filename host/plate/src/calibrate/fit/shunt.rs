//! The calibration by the drive's current alone, plate unloaded.

use super::gain::Carried;
use super::joint_fit::Joint;
use super::response::plate_response::{PlateResponse, Units, takes_a_source};
use super::result::{AcceptedFit, Calibrated};
use super::source::data::{entering, normalised};
use super::source::drive_current::{ACTUATOR, DriveCurrent, Transducer};
use super::source::source_file::FittedSource;
use super::unknowns::Priors;
use crate::calibrate::error::CalibrateError;
use crate::calibrate::measurement::sensor::{Measurement, SensorKind};
use crate::calibrate::measurement::signal;
use crate::definition::Plate;
use num_complex::Complex64;

/// Calibrates `plate`, the nominal one, from the current through its drive: the returning wave moves the coil or the
/// piezo, which changes the current. `current` is the current over the code, in any unit, with the device's own delay
/// removed; its place and its sensor kind are ignored. The amplifier must be a voltage source, and nothing may lie on
/// the plate.
///
/// The levels are those of the model, because the current does not measure them. The file must state a membrane's
/// tension or a sheet's thickness; for a plate in bending also the lead-in behind the driven end.
///
/// # Errors
/// [`CalibrateError`]: a mistake in the measurement, or a quantity that it does not determine.
pub fn from_shunt(
    plate: &Plate,
    current: &Measurement,
    transducer: Transducer,
    priors: &Priors,
) -> Result<Calibrated, CalibrateError> {
    priors.check()?;
    // Unit, place and sensor kind have no effect here.
    let current = &Measurement {
        place_m: 0.0,
        sensor: SensorKind::Displacement,
        unit_per_response: None,
        sensor_mass_kg: 0.0,
        ..current.clone()
    };
    signal::check_sensor(plate, current)?;
    takes_a_source(plate.spec())?;
    let points = entering(plate, current)?;
    let units = Units::of(plate, &points).ok_or(CalibrateError::NoFit)?;
    let data = normalised(&points, |hz| Complex64::from(current.hold_droop(hz)));
    let mut joint = Joint::new(plate, DriveCurrent { transducer }, units, None, priors, (&points, data));
    let (fit, chi2_per_n) = joint.accepted()?;

    let first = joint.of_source();
    let of_source = &fit.parameters[first..];
    // Impedance of the electrical side in the middle of the band, added to the source because the file states their
    // sum.
    let damping = joint.source.damping(of_source, Complex64::new(0.0, -1.0));
    let mut impedance = joint.impedance_of(&fit.parameters);
    impedance[0] += damping.re.max(0.0);
    impedance[if damping.im > 0.0 { 2 } else { 1 }] += damping.im.abs();
    let source = FittedSource {
        units,
        first,
        impedance,
        actuator: [of_source[ACTUATOR], of_source[ACTUATOR + 1]],
        actuator_at: ACTUATOR,
        delay: None,
    };
    let carried = |at: &[f64]| {
        let each = |answer: &PlateResponse| {
            let peak = joint.source.peak(answer, &at[first..]) * current.hold_droop(answer.frequency_hz);
            Carried { frequency_hz: answer.frequency_hz, peak, error: 0.0 }
        };
        Some(joint.answers_with_peak(at)?.iter().map(each).collect())
    };
    let accepted = AcceptedFit {
        nominal: plate,
        fit: &fit,
        chi2_per_n,
        misfit: joint.misfit(&fit.parameters).ok_or(CalibrateError::NoFit)?,
        deviations: &joint.deviations,
        sensors: &[],
        levels: current,
        source: Some(source),
        frequencies_hz: &joint.frequencies_hz,
        carried: &carried,
    };
    accepted.finish()
}
