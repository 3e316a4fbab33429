//! A finger on the plate: `(place_m, "light")`, `(place_m, "firm")`, or the numbers of its contact.

use crate::error::Failure;
use pyo3::inspect::PyStaticExpr;
use pyo3::prelude::*;
use pyo3::{Borrowed, type_hint_identifier, type_hint_subscript, type_hint_union};
use slipline_plate::Finger;

/// A finger as an argument: any sequence of these values. Its numbers are checked on the plate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FingerArgument(pub(crate) Finger);

/// What is allowed for it.
const FINGERS: &str =
    "(place_m, \"light\"), (place_m, \"firm\"), or (place_m, resistance_n_s_per_m, mass_kg, contact_m)";

impl<'a, 'py> FromPyObject<'a, 'py> for FingerArgument {
    type Error = PyErr;
    const INPUT_TYPE: PyStaticExpr = type_hint_subscript!(
        type_hint_identifier!("collections.abc", "Sequence"),
        type_hint_union!(
            type_hint_identifier!("builtins", "float"),
            type_hint_identifier!("builtins", "str")
        )
    );

    fn extract(given: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let wrong = || Failure::wrong_arguments(format_args!("finger = {}", *given), FINGERS);
        // Of five values one is too many.
        let values = given.try_iter().map_err(|_| wrong())?.take(5).collect::<PyResult<Vec<_>>>()?;
        let number = |value: &Bound<'py, PyAny>| value.extract::<f64>().map_err(|_| wrong());
        let finger = match &values[..] {
            [place_m, kind] => {
                let place_m = number(place_m)?;
                match kind.extract::<String>().map_err(|_| wrong())?.as_str() {
                    "light" => Finger::light(place_m),
                    "firm" => Finger::firm(place_m),
                    _ => return Err(wrong().into()),
                }
            }
            [place_m, resistance_n_s_per_m, mass_kg, contact_m] => Finger {
                place_m: number(place_m)?,
                resistance_n_s_per_m: number(resistance_n_s_per_m)?,
                mass_kg: number(mass_kg)?,
                contact_m: number(contact_m)?,
            },
            _ => return Err(wrong().into()),
        };
        Ok(Self(finger))
    }
}
