//! A plate in air whose file states none, or another: its calibration is refused, and the refusal says so where the plate fits in
//! the air that it is in.

use super::result::Calibrated;
use super::unknowns::Priors;
use crate::calibrate::error::CalibrateError;
use crate::definition::{Air, AirMounting, Gas, Plate, PlateSpec};

/// Places over the span at which the air's shift of the peak is computed.
const PLACES: usize = 5;
/// Air that moves the peaks by less is not why a plate does not fit, metres.
const SHIFT_MIN_M: f64 = 1e-3;
/// More chi^2 per answer no air explains: light membranes in a baffle have up to 60.
const CHI2_MAX: f64 = 100.0;
/// Standard deviation of ln alpha where nobody knows the mounting.
const AS_UNKNOWN: f64 = 0.22;
/// Misfit and chi^2 per answer beyond which the stated air is in doubt: plates in two dimensions in the air of their files have up
/// to 0.03. Air on one face where the file says two leaves 0.11 and 1.8.
const DOUBTFUL: (f64, f64) = (0.05, 1.5);
/// The air is another one where chi^2 falls below this share.
const FITS_BETTER: f64 = 0.5;

/// `calibrate` of a plate; where that is refused because no such plate fits, of the same plate in air by the law of
/// its coefficient alone, which takes no longer. What fits badly in the stated air is tried in other air.
pub(crate) fn or_missing_air(
    plate: &Plate,
    priors: &Priors,
    calibrate: impl Fn(&Plate, &Priors) -> Result<Calibrated, CalibrateError>,
) -> Result<Calibrated, CalibrateError> {
    let error = match calibrate(plate, priors) {
        Ok(found) if found.misfit > DOUBTFUL.0 && found.chi2_per_n > DOUBTFUL.1 => {
            return other_air(plate, priors, found.chi2_per_n, &calibrate).map_or(Ok(found), Err);
        }
        Err(error @ CalibrateError::Unlike { chi2_per_n, .. }) if plate.spec().air.is_some() => {
            return Err(other_air(plate, priors, chi2_per_n, &calibrate).unwrap_or(error));
        }
        Err(error @ CalibrateError::Unlike { chi2_per_n, .. })
            if plate.spec().air.is_none() && chi2_per_n < CHI2_MAX =>
        {
            error
        }
        Err(error @ CalibrateError::AnotherPlate { what: "wave speed", .. })
            if plate.spec().air.is_none() =>
        {
            error
        }
        other => return other,
    };
    let unknown = Air::Around { gas: Gas::ROOM, mounting: AirMounting::Unknown, gap_m: None };
    if shift_m(plate, &unknown) < SHIFT_MIN_M {
        return Err(error);
    }
    let air = unknown.near_alone();
    let Ok(in_air) = Plate::new(PlateSpec { air: Some(air), ..plate.spec().clone() }) else {
        return Err(error);
    };
    let found = calibrate(&in_air, &Priors { air: Some(AS_UNKNOWN), ..*priors });
    match found.ok().and_then(|found| found.plate.spec().air) {
        Some(air) => Err(CalibrateError::NoAir { shift_m: shift_m(plate, &air) }),
        None => Err(error),
    }
}

/// The refusal of a plate that fits with air on the other number of faces, or mounted otherwise than its file says, much better than
/// with `chi2_per_n`.
fn other_air(
    plate: &Plate,
    priors: &Priors,
    chi2_per_n: f64,
    calibrate: impl Fn(&Plate, &Priors) -> Result<Calibrated, CalibrateError>,
) -> Option<CalibrateError> {
    let Some(Air::Around { gas, mounting, gap_m }) = plate.spec().air else { return None };
    let mut others = [mounting.on_other_faces(), mounting.as_unknown()].into_iter().flatten();
    let fits_better = |mounting: &AirMounting| {
        let air = Some(Air::Around { gas, mounting: *mounting, gap_m });
        let other = Plate::new(PlateSpec { air, ..plate.spec().clone() }).ok();
        let found = other.and_then(|other| calibrate(&other, priors).ok());
        found.is_some_and(|found| found.chi2_per_n < FITS_BETTER * chi2_per_n)
    };
    let mounting = others.find(fits_better)?;
    Some(CalibrateError::OtherAir { chi2_per_n, faces: mounting.stated_faces() })
}

/// How far this air moves the peaks of the plate's span, the most.
fn shift_m(plate: &Plate, air: &Air) -> f64 {
    let (start, end) = plate.span_m();
    let place = |i: usize| start + (end - start) * i as f64 / (PLACES - 1) as f64;
    (0..PLACES).map(|i| plate.air_shift_m(Some(air), place(i)).abs()).fold(0.0, f64::max)
}
