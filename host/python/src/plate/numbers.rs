//! A plate's numbers: places and frequencies of each other, and the plate with other numbers.

use super::Plate as PyPlate;
use crate::arguments::{ArrayLike, OneOrMore};
use crate::error::Failure;
use crate::field::FREQUENCIES_MAX;
use crate::place::turning_point_of;
use crate::waiting::compute;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use slipline_model::field::asked_place::{AskedPlace, turning_point_on};
use slipline_model::field::simulation::{SAMPLE_RATE_HZ, table_for_watched};
use slipline_model::setup::Setup;
use slipline_plate::quantity::{PlaceOrFrequency, nearest};
use slipline_plate::{Plate, PlateFile};
use std::sync::Arc;

/// The frequency whose wave turns at a place of the plate's span, Hz.
pub(super) fn frequency_of(plate: &Plate, place_m: f64) -> Result<f64, Failure> {
    let place_m = turning_point_on(PlaceOrFrequency::Place(place_m), plate);
    let place_m = place_m.map_err(|refused| Failure::of(&refused))?;
    Ok(plate.frequency_for_boundary_hz(place_m))
}

/// The frequencies of the arguments of `respond`: frequencies, turning points, or felt edges of tones of this level.
pub(super) fn frequencies_of(
    py: Python<'_>,
    plate: &Arc<Plate>,
    asked: [Option<ArrayLike<'_>>; 3],
    level: f64,
) -> PyResult<OneOrMore> {
    let names = ["frequency_hz", "turning_point_m", "felt_edge_m"];
    let given: Vec<_> = names.into_iter().zip(asked).filter_map(|(name, it)| Some((name, it?))).collect();
    let [(name, numbers)] = &given[..] else {
        let given = if given.is_empty() { "no place" } else { "more than one place" };
        return Err(Failure::wrong_arguments(given, format_args!("one of {}", names.join(", "))).into());
    };
    let numbers = numbers.one_or_more(name, FREQUENCIES_MAX)?;
    Ok(match *name {
        "frequency_hz" => numbers,
        "turning_point_m" => numbers.map(|place_m| frequency_of(plate, place_m))?,
        _ => {
            crate::arguments::in_range("level", level, crate::place::LEVEL)?;
            let plate = Arc::clone(plate);
            compute(py, move |progress| {
                let (table, _) =
                    table_for_watched(&plate, SAMPLE_RATE_HZ, progress).map_err(|it| Failure::of(&it))?;
                let setup = Setup::new(Arc::clone(&plate));
                numbers.map(|edge_m| {
                    let place_m = turning_point_of(AskedPlace::FeltEdge(edge_m), &setup, level, &table)?;
                    Ok(plate.frequency_for_boundary_hz(place_m))
                })
            })?
        }
    })
}

/// Most nested sections: more than any plate file has. It ends the walk through a dictionary that contains itself.
const DEPTH_MAX: usize = 8;

/// The numbers of a dictionary, each with the path of its field; those of a dictionary in it are of its section.
pub(super) fn flatten(
    section: &str,
    numbers: &Bound<'_, PyDict>,
    changes: &mut Vec<(String, f64)>,
) -> PyResult<()> {
    for (name, value) in numbers {
        let path = format!("{section}{name}");
        match value.cast::<PyDict>() {
            Ok(inner) if section.matches('.').count() < DEPTH_MAX => {
                flatten(&format!("{path}."), inner, changes)?;
            }
            Ok(_) => {
                let given = format_args!("{path} of a dictionary");
                return Err(
                    Failure::wrong_arguments(given, "a number: no plate file has so many sections").into()
                );
            }
            Err(_) => {
                let wrong = || Failure::wrong_arguments(format_args!("{path} = {value}"), "a number");
                changes.push((path.clone(), value.extract::<f64>().map_err(|_| wrong())?));
            }
        }
    }
    Ok(())
}

/// The plate with these numbers at the paths of its file.
pub(super) fn replaced(plate: &Arc<Plate>, changes: &[(String, f64)]) -> PyResult<PyPlate> {
    let text = plate.to_toml();
    let (file, nominal) = PlateFile::parse(&text).map_err(|error| Failure::of(&error))?;
    let known = file.numbers();
    for (path, _) in changes {
        if known.iter().any(|(other, _)| other == path) {
            continue;
        }
        let meant = nearest(path, known.iter().map(|(other, _)| other.as_str()));
        let meant = meant.map_or_else(String::new, |meant| format!(" (did you mean {meant}?)"));
        let paths: Vec<_> = known.iter().map(|(other, _)| other.as_str()).collect();
        let given = format_args!("{path}{meant}");
        return Err(Failure::wrong_arguments(given, format_args!("one of {}", paths.join(", "))).into());
    }
    let changes: Vec<(&str, f64)> = changes.iter().map(|(path, number)| (path.as_str(), *number)).collect();
    Ok(file.plate_with(&changes, &nominal).map_err(|error| Failure::of(&error))?.into())
}
