//! The calibration by the ratio of two places.

use super::acceptance::{self, CHI2_PER_N_MAX};
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
    let fit = ratio.fit().ok_or(CalibrateError::NoFit)?;
    let residuals = (ratio.pairs.len() + ratio.deviations.len() - fit.parameters.len()) as f64;
    let chi2_per_n = fit.chi2 / residuals;
    if chi2_per_n > CHI2_PER_N_MAX {
        let swapped = ratio.swapped().fit().map_or(f64::INFINITY, |fit| fit.chi2 / residuals);
        return Err(if swapped <= CHI2_PER_N_MAX {
            let [first_m, second_m] = ratio.places_m;
            CalibrateError::Swapped { first_m, second_m }
        } else {
            CalibrateError::Unlike { chi2_per_n, most: CHI2_PER_N_MAX }
        });
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
    accepted.finish()
}
