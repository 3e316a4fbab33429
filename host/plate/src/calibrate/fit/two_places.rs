//! The calibration by the ratio of two places.

use super::acceptance::{self, CHI2_PER_N_MAX};
use super::least_squares::Fit;
use super::missing_air::or_missing_air;
use super::ratio::Ratio;
use super::response::sensor_body::{check_fitted_mass, check_mass};
use super::result::{AcceptedFit, Calibrated};
use super::unknowns::Priors;
use crate::calibrate::error::CalibrateError;
use crate::calibrate::measurement::sensor::Measurement;
use crate::calibrate::measurement::signal;
use crate::definition::Plate;

/// Calibrates `plate`, the nominal one, from the same sensor at two places.
///
/// ```no_run
/// # use slipline_plate::calibrate::{Measurement, Priors, from_ratio};
/// # fn example(near: Measurement, far: Measurement) -> Result<(), Box<dyn std::error::Error>> {
/// let nominal = slipline_plate::preset("membrane").unwrap();
/// let found = from_ratio(&nominal, [&near, &far], &Priors::default())?;
/// println!("{} +- {} m", found.plate.name(), found.boundary_tolerance_m);
/// let file = found.plate.to_toml();
/// # Ok(()) }
/// ```
///
/// # Errors
/// [`CalibrateError`]: what is wrong with the measurements, or what they do not carry.
pub fn from_ratio(
    plate: &Plate,
    sensors: [&Measurement; 2],
    priors: &Priors,
) -> Result<Calibrated, CalibrateError> {
    or_missing_air(plate, priors, |plate, priors| fitted(plate, sensors, priors))
}

fn fitted(plate: &Plate, sensors: [&Measurement; 2], priors: &Priors) -> Result<Calibrated, CalibrateError> {
    priors.check()?;
    for sensor in sensors {
        signal::check_sensor(plate, sensor)?;
    }
    let ratio = Ratio::new(plate, sensors, priors);
    acceptance::check_pair(sensors, &ratio.pairs)?;
    for sensor in sensors {
        check_mass(plate, sensor, &ratio.frequencies_hz)?;
    }
    let residuals = (ratio.pairs.len() + ratio.deviations.len()) as f64;
    let per_residual = |fit: &Fit| fit.chi2 / (residuals - fit.parameters.len() as f64);
    // Widths and edges far from the file's may make up for exchanged places, or nothing fits them at all.
    let or_swapped = |error: CalibrateError, chi2_per_n: f64| {
        let swapped = ratio.swapped().fit().as_ref().map_or(f64::INFINITY, per_residual);
        let [first_m, second_m] = ratio.places_m;
        let is_swapped = swapped <= CHI2_PER_N_MAX.min(chi2_per_n);
        if is_swapped { CalibrateError::Swapped { first_m, second_m } } else { error }
    };
    let Some(fit) = ratio.fit() else { return Err(or_swapped(CalibrateError::NoFit, f64::INFINITY)) };
    let chi2_per_n = per_residual(&fit);
    if chi2_per_n > CHI2_PER_N_MAX {
        return Err(or_swapped(CalibrateError::Unlike { chi2_per_n, most: CHI2_PER_N_MAX }, chi2_per_n));
    }

    check_fitted_mass(sensors[0], ratio.of_mass(&fit.parameters))?;
    let carried = |coordinates: &[f64]| Some(ratio.carried(&ratio.with_peak(coordinates)?).collect());
    let accepted = AcceptedFit {
        nominal: plate,
        fit: &fit,
        chi2_per_n,
        misfit: ratio.misfit(&fit.parameters).ok_or(CalibrateError::NoFit)?,
        deviations: &ratio.deviations,
        sensors: &sensors,
        levels: sensors[0],
        source: None,
        frequencies_hz: &ratio.frequencies_hz,
        carried: &carried,
    };
    accepted.finish().map_err(|error| match error {
        CalibrateError::AnotherPlate { .. }
        | CalibrateError::EdgesGive { .. }
        | CalibrateError::Misplaced { .. } => or_swapped(error, chi2_per_n),
        other => other,
    })
}
