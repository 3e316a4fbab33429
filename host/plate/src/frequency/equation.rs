//! The two amplitude equations: the one derived from the wave equation, and the paper's.

use crate::definition::plate::Plate;
use crate::definition::spec::PlateSpec;
use crate::definition::turning_width::TurningWidth;
use std::borrow::Cow;

/// The amplitude equation to solve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Equation {
    /// f'' + (W'/W) f' + k^2 f = 0, which follows from the wave equation, with the plate's own turning width.
    Corrected,
    /// f'' + k^2 f = 0, the paper's equation (13), which lacks the term (W'/W) f'. It uses [`TurningWidth::Plain`], no
    /// air, no film stiffness, and the thickness of the driven end everywhere.
    Paper,
}

impl Equation {
    /// The plate with the properties that this equation uses.
    pub(crate) fn plate(self, plate: &Plate) -> Cow<'_, Plate> {
        match (self, plate.spec()) {
            (Self::Corrected, _) => Cow::Borrowed(plate),
            (
                Self::Paper,
                PlateSpec { turning_width: TurningWidth::Plain, air: None, thickness: None, model, .. },
            ) if model.film().is_none() => Cow::Borrowed(plate),
            (Self::Paper, _) => {
                let plain = plate.in_vacuum().without_film().with_uniform_thickness();
                Cow::Owned(plain.with_turning_width(TurningWidth::Plain))
            }
        }
    }
}
