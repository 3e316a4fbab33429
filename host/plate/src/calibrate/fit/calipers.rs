//! The plate's widths and length by calipers and a rule.

use super::unknowns::Priors;
use crate::definition::limits;
use crate::definition::{Plate, PlateError, Taper};
use crate::quantity::Range;

/// Lengths by calipers and a rule with their standard deviation, metres.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Calipers {
    /// Half of the full width at the driven end.
    pub half_width_m: f64,
    /// Half of the full width at the narrow end.
    pub end_half_width_m: f64,
    /// Length from the driven to the narrow end.
    pub length_m: f64,
    /// Standard deviation of both half-widths (1e-7 to 0.01); 5e-5 for calipers.
    pub tolerance_m: f64,
}

impl Calipers {
    /// `plate` with these lengths, and the priors of their errors.
    ///
    /// # Errors
    /// A length or the tolerance is out of its range, or the resulting plate is refused.
    pub fn applied_to(&self, plate: &Plate) -> Result<(Plate, Priors), PlateError> {
        let Self { half_width_m, end_half_width_m, length_m, tolerance_m } = *self;
        Range::new(1e-7, 0.01, "m").check("tolerance_m", tolerance_m)?;
        limits::LENGTH.check("length_m", length_m)?;
        limits::HALF_WIDTH.check("half_width_m", half_width_m)?;
        let narrower = Range { high: 0.999 * half_width_m, ..limits::HALF_WIDTH };
        narrower.check("end_half_width_m", end_half_width_m)?;
        let fall = (half_width_m / end_half_width_m).ln();
        let nominal = (plate.cut_half_width_m(0.0) / plate.cut_half_width_m(plate.length_m())).ln();
        let mut spec = plate.spec().clone();
        spec.length_m = length_m;
        spec.taper = match &spec.taper {
            Taper::Exponential { .. } => Taper::Exponential { half_width_m, rate_per_m: fall / length_m },
            Taper::Linear { .. } => Taper::Linear { half_width_m, end_half_width_m },
            taper @ Taper::Sampled { .. } => {
                taper.stretched(half_width_m / plate.cut_half_width_m(0.0), fall / nominal)
            }
        };
        let ends = tolerance_m / half_width_m;
        let taper = ends.hypot(tolerance_m / end_half_width_m) / fall;
        Ok((Plate::new(spec)?, Priors { half_width: ends, taper, ..Priors::default() }))
    }
}
