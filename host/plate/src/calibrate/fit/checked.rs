//! The calibration by the ratio of two places with a third place as a check: it widens the stated interval, or refuses.
//!
//! The third place and the one of the two that is farther from it calibrate the same plate again. What two places do not see, edges
//! that give or a plate that is not the file's, moves the second result away from the first.

use super::result::Calibrated;
use super::two_places::from_ratio;
use super::unknowns::Priors;
use crate::calibrate::error::CalibrateError;
use crate::calibrate::measurement::sensor::Measurement;
use crate::definition::{Plate, PlateSpec, limits};
use crate::special::ramp::ramp;

/// Boundaries over the span at which the two results are compared.
const BOUNDARIES: usize = 33;
/// Both results are of one plate where their boundaries differ by at most this many times the root of the sum of their squared
/// intervals. One in 300 is refused that should not be.
pub(crate) const SAME: f64 = 1.5;

/// As [`from_ratio`], with a third measurement by the same sensor, `check`, at another place.
///
/// The stated interval of the boundary is at least as wide as the check is off. Where the two places hardly show how far clamped edges
/// give, the result is that of the check and the place that is farther from it.
///
/// # Errors
/// [`CalibrateError::CheckDiffers`] where the check is farther off than both intervals explain; and those of [`from_ratio`], of either
/// pair of places.
pub fn from_checked_ratio(
    plate: &Plate,
    sensors: [&Measurement; 2],
    check: &Measurement,
    priors: &Priors,
) -> Result<Calibrated, CalibrateError> {
    let [first, second] = sensors;
    let apart = |sensor: &Measurement| (sensor.place_m - check.place_m).abs();
    let with = if apart(first) >= apart(second) { first } else { second };
    let again = from_ratio(plate, [with, check], priors);
    let mut found = match from_ratio(plate, sensors, priors) {
        Err(CalibrateError::EdgesUnseen { .. }) => return again,
        found => found?,
    };
    let again = again?;
    let off_m = off_m(&found.plate, &again.plate);
    let known_m = found.boundary_tolerance_m.hypot(again.boundary_tolerance_m);
    if off_m > SAME * known_m {
        return Err(CalibrateError::CheckDiffers {
            place_m: check.place_m,
            with_m: with.place_m,
            off_m,
            known_m,
            give_m: give_m(plate, &again),
        });
    }
    if off_m > found.boundary_tolerance_m {
        let tolerance = found.plate.spec().wave_speed_tolerance * off_m / found.boundary_tolerance_m;
        let wave_speed_tolerance = tolerance.min(limits::WAVE_SPEED_TOLERANCE.high);
        found.plate = Plate::new(PlateSpec { wave_speed_tolerance, ..found.plate.spec().clone() })?;
        found.boundary_tolerance_m = off_m;
    }
    Ok(found)
}

/// The largest distance of the boundaries of both plates at one frequency over the span, metres. One that does not enter the other
/// plate counts as lying at its driven end.
fn off_m(plate: &Plate, other: &Plate) -> f64 {
    let (start_m, end_m) = plate.span_m();
    let off = |place_m: f64| {
        let frequency_hz = plate.frequency_for_boundary_hz(place_m);
        (other.turning_point_m(frequency_hz).unwrap_or(0.0) - place_m).abs()
    };
    ramp(start_m, end_m, BOUNDARIES).map(off).fold(0.0, f64::max)
}

/// How far the edges give by this calibration, metres, where it shows that they do not give as the file says.
fn give_m(nominal: &Plate, found: &Calibrated) -> Option<f64> {
    let give = found.parameters.iter().find(|parameter| parameter.name == "edge_give_m")?;
    let stated_m = nominal.spec().edge_give_m.unwrap_or(0.0);
    (!(give.low..=give.high).contains(&stated_m)).then_some(give.value)
}
