//! A finger on the plate: `(place_m, "light")`, `(place_m, "firm")`, or the numbers of its contact.

use crate::error::Failure;
use pyo3::prelude::*;
use slipline_plate::Finger;

/// The finger of an argument; its numbers are checked on the plate.
pub(crate) fn of(given: &Bound<'_, PyAny>) -> PyResult<Finger> {
    if let Ok((place_m, kind)) = given.extract::<(f64, String)>() {
        match kind.as_str() {
            "light" => return Ok(Finger::light(place_m)),
            "firm" => return Ok(Finger::firm(place_m)),
            _ => {}
        }
    }
    if let Ok((place_m, resistance_n_s_per_m, mass_kg, contact_m)) = given.extract() {
        return Ok(Finger { place_m, resistance_n_s_per_m, mass_kg, contact_m });
    }
    let allowed =
        "(place_m, \"light\"), (place_m, \"firm\") or (place_m, resistance_n_s_per_m, mass_kg, contact_m)";
    Err(Failure::wrong_arguments(format_args!("finger = {given}"), allowed).into())
}
