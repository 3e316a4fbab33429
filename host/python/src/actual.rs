//! The plate on which the waves of a simulation run.

use crate::error::Failure;
use crate::plate::{self, Plate};
use pyo3::inspect::PyStaticExpr;
use pyo3::prelude::*;
use pyo3::{Borrowed, PyTypeInfo, type_hint_union};
use slipline_instrument::rig::{secret, secret_seed};
use slipline_plate::quantity::must_be;
use std::convert::Infallible;
use std::path::PathBuf;

/// A plate as an argument: a `Plate`, the name of one, a path, or `secret:SEED`.
#[derive(Clone, Debug)]
pub(crate) struct PlateArgument<'py>(Bound<'py, PyAny>);

impl<'a, 'py> FromPyObject<'a, 'py> for PlateArgument<'py> {
    type Error = Infallible;
    const INPUT_TYPE: PyStaticExpr =
        type_hint_union!(<Plate as PyTypeInfo>::TYPE_HINT, <PathBuf as FromPyObject<'a, 'py>>::INPUT_TYPE);

    fn extract(given: Borrowed<'a, 'py, PyAny>) -> Result<Self, Infallible> {
        Ok(Self(given.to_owned()))
    }
}

/// The plate of an argument; `secret:SEED` is one near the nominal plate.
pub(crate) fn plate(
    PlateArgument(given): &PlateArgument<'_>,
    nominal: Option<&slipline_plate::Plate>,
) -> PyResult<slipline_plate::Plate> {
    if let Ok(plate) = given.cast::<Plate>() {
        return Ok((*plate.get().plate).clone());
    }
    let name: PathBuf = given.extract().map_err(|_| {
        Failure::wrong_arguments(
            format_args!("actual_plate = {given}"),
            "a Plate, a name, a path or \"secret:SEED\"",
        )
    })?;
    let name = name.to_string_lossy();
    let Some(seed) = secret_seed(&name) else { return Ok(plate::named(&name)?) };
    let whole = "secret:SEED with a whole number from 0 to 18446744073709551615";
    let given = format_args!("actual_plate = {name:?}");
    let seed = seed.map_err(|_| Failure::refused(must_be(given, whole)))?;
    let nominal =
        nominal.ok_or_else(|| Failure::wrong_arguments(given, "the name of a plate: it is near no other"))?;
    Ok(secret(nominal, seed).map_err(|error| Failure::of(&error))?)
}
