//! The class `Plate`.

mod methods;
mod numbers;

use crate::error::{Exception, Failure};
use crate::responders::Responders;
use pyo3::prelude::*;
use slipline_model::atomic_file::read_text;
use slipline_model::named_plate::{NamedPlateError, named_plate};
use slipline_plate::PLATE_FILE_BYTES_MAX;
use std::path::Path;
use std::sync::Arc;

/// A plate: a preset by its name, or a TOML file of this format.
///
/// Plates of the same content are equal; a plate can be pickled and used as a key.
///
/// Raises ``BadFile`` if it is neither, ``OutOfRange`` for a number of the file that is not allowed.
#[pyclass(frozen, module = "slipline")]
#[derive(Debug)]
pub(crate) struct Plate {
    pub(crate) plate: Arc<slipline_plate::Plate>,
    pub(crate) responders: Arc<Responders>,
}

impl From<slipline_plate::Plate> for Plate {
    fn from(plate: slipline_plate::Plate) -> Self {
        Self { plate: Arc::new(plate), responders: Arc::default() }
    }
}

/// Why a file is refused: that of a plate, or of a study.
pub(crate) fn file_failure(error: &(dyn std::error::Error + 'static)) -> Failure {
    match Failure::of(error) {
        Failure::Because(_, message) => Failure::Because(Exception::BadFile, message),
        other @ (Failure::OutOfRange { .. } | Failure::Fault { .. }) => other,
    }
}

/// Refuses a text that is longer than a file of its kind may be.
pub(crate) fn check_length(name: &str, text: &str, most: usize) -> Result<(), Failure> {
    if text.len() <= most {
        Ok(())
    } else {
        Err(Failure::bad_file(name, format_args!("its text is longer than {most} bytes")))
    }
}

/// The plate of a preset's name or a path.
pub(crate) fn named(name: &str) -> Result<slipline_plate::Plate, Failure> {
    let read = || read_text(Path::new(name), PLATE_FILE_BYTES_MAX);
    named_plate(name, read).map_err(|error: NamedPlateError| file_failure(&error))
}

/// The names of the presets.
#[pyfunction]
pub(crate) fn presets() -> Vec<&'static str> {
    slipline_plate::presets().iter().map(|preset| preset.name).collect()
}
