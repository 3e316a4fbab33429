//! The two amplitude equations: the one that follows from the wave equation, and the paper's.

use crate::definition::plate::Plate;
use crate::definition::turning_width::TurningWidth;
use std::borrow::Cow;

/// Which amplitude equation is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Equation {
    /// f'' + (W'/W) f' + k^2 f = 0, which follows from the wave equation, with the plate's own turning width.
    Corrected,
    /// f'' + k^2 f = 0, the paper's equation (13), which lacks the term (W'/W) f', with [`TurningWidth::Plain`].
    Paper,
}

impl Equation {
    /// The plate as this equation sees it.
    pub(crate) fn plate(self, plate: &Plate) -> Cow<'_, Plate> {
        match (self, plate.spec().turning_width) {
            (Self::Paper, TurningWidth::Arc) => Cow::Owned(plate.with_turning_width(TurningWidth::Plain)),
            (Self::Paper, TurningWidth::Plain) | (Self::Corrected, _) => Cow::Borrowed(plate),
        }
    }
}
