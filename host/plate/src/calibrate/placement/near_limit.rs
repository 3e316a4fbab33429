//! How near to the driven end a sensor may stand: beyond the near field of bending and beyond the next width mode.

use crate::definition::{Model, Plate};
use crate::special::airy;

/// Decay lengths of bending's near field at the lowest frequency: e^-4.2 = 1.5 % of it are left.
const NEAR_FIELD: f64 = 4.2;

/// What keeps a sensor from the driven end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NearLimit {
    /// The near field of a plate in bending or of a film.
    NearField,
    /// A width mode beyond the first.
    WidthMode(u32),
}

impl NearLimit {
    /// The nearest place where the first width mode's wave is nearly alone at all frequencies of a band, metres, and what
    /// sets it.
    pub(crate) fn of(plate: &Plate, (low_hz, high_hz): (f64, f64), off_centre: bool) -> (f64, Self) {
        let mode = if off_centre { 2 } else { 3 };
        let by_mode = (beyond_mode_m(plate, mode, high_hz), Self::WidthMode(mode));
        let model = &plate.spec().model;
        match model {
            Model::Membrane { .. } | Model::ShearHorizontal { .. } => match model.film_square() {
                Some(square) if NEAR_FIELD * square.sqrt() > by_mode.0 => {
                    (NEAR_FIELD * square.sqrt(), Self::NearField)
                }
                _ => by_mode,
            },
            Model::BendingSupported(_) | Model::BendingClamped(_) => {
                let width_term = model.width_number(1) / plate.half_width_m(0.0);
                let decay = (plate.wavenumber_squared(low_hz) + width_term.powi(2)).sqrt();
                let by_near_field = (NEAR_FIELD / decay, Self::NearField);
                if by_near_field.0 > by_mode.0 { by_near_field } else { by_mode }
            }
        }
    }
}

/// Where a tenth of a width mode's peak is left beyond its turning point, metres; 0 where that is before the driven end.
fn beyond_mode_m(plate: &Plate, mode: u32, frequency_hz: f64) -> f64 {
    let mode = plate.width_mode(mode);
    let turning_m = mode.turning_point_m(frequency_hz);
    let place_m = turning_m + (airy::EDGE_WIDTH - airy::PEAK_OFFSET) / mode.fall(turning_m).cbrt();
    if place_m.is_finite() { place_m.max(0.0) } else { 0.0 }
}
