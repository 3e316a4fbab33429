//! A plate's dimensions by calipers and a rule.

use slipline_plate::calibrate::{Calipers, Priors};
use slipline_plate::{Plate, PlateError};
use thiserror::Error;

/// Standard deviation of a half-width measured with calipers, metres: a tenth of a millimetre in the whole
/// width.
pub const CALIPERS_TOLERANCE_M: f64 = 5e-5;

/// Calipers of which some lengths are missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("the calipers are incomplete: they give both half-widths and the length")]
pub struct IncompleteCalipers;

/// The plate's half-widths and length by calipers and a rule, in metres: all three or none. An absent tolerance is
/// [`CALIPERS_TOLERANCE_M`].
///
/// # Errors
/// [`IncompleteCalipers`].
pub fn complete_calipers(
    half_width_m: Option<f64>,
    end_half_width_m: Option<f64>,
    length_m: Option<f64>,
    tolerance_m: Option<f64>,
) -> Result<Option<Calipers>, IncompleteCalipers> {
    let tolerance_m = tolerance_m.unwrap_or(CALIPERS_TOLERANCE_M);
    match (half_width_m, end_half_width_m, length_m) {
        (None, None, None) => Ok(None),
        (Some(half_width_m), Some(end_half_width_m), Some(length_m)) => {
            Ok(Some(Calipers { half_width_m, end_half_width_m, length_m, tolerance_m }))
        }
        _ => Err(IncompleteCalipers),
    }
}

/// The plate with the lengths of calipers, if there are any, and the uncertainties of its dimensions.
///
/// # Errors
/// Which length is out of range or gives an invalid plate.
pub fn with_calipers(plate: &Plate, calipers: Option<Calipers>) -> Result<(Plate, Priors), PlateError> {
    calipers.map_or_else(|| Ok((plate.clone(), Priors::default())), |calipers| calipers.applied_to(plate))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn calipers_give_three_lengths_or_none() {
        assert_eq!(complete_calipers(None, None, None, Some(1e-4)), Ok(None));
        let found = complete_calipers(Some(0.06), Some(0.01), Some(0.32), None).unwrap().unwrap();
        assert_eq!((found.length_m, found.tolerance_m), (0.32, CALIPERS_TOLERANCE_M));
        assert_eq!(complete_calipers(Some(0.06), None, Some(0.32), None), Err(IncompleteCalipers));
        let plate = slipline_plate::preset("membrane").unwrap();
        assert_eq!(with_calipers(&plate, None).unwrap().0, plate);
        assert_eq!(with_calipers(&plate, Some(found)).unwrap().0.length_m(), 0.32);
    }
}
