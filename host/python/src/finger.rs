//! A finger on the plate: `(place_m, "light")`, `(place_m, "firm")`, or the numbers of its contact.

use crate::error::Failure;
use pyo3::prelude::*;
use slipline_plate::Finger;
use slipline_plate::quantity::must_be;

/// A finger as an argument.
#[derive(Clone, Debug, FromPyObject)]
pub(crate) enum FingerArgument {
    /// Its place in metres and its kind.
    Kind(f64, String),
    /// Its place in metres, its resistance in N s/m, its mass in kg and the width of its contact in metres.
    Contact(f64, f64, f64, f64),
}

impl FingerArgument {
    /// The finger; its numbers are checked on the plate.
    pub(crate) fn finger(self) -> Result<Finger, Failure> {
        match self {
            Self::Kind(place_m, kind) => match kind.as_str() {
                "light" => Ok(Finger::light(place_m)),
                "firm" => Ok(Finger::firm(place_m)),
                _ => {
                    let given = format_args!("finger = ({place_m}, {kind:?})");
                    Err(Failure::refused(must_be(given, "light, firm, or the numbers of its contact")))
                }
            },
            Self::Contact(place_m, resistance_n_s_per_m, mass_kg, contact_m) => {
                Ok(Finger { place_m, resistance_n_s_per_m, mass_kg, contact_m })
            }
        }
    }
}
