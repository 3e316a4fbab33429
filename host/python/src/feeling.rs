//! The feeling of a finger, from a file or that of a usual finger.

use crate::error::Failure;
use slipline_instrument::requests::NamedFeeling;
use slipline_model::atomic_file::{read_text, said};
use slipline_model::setup::file::FILE_BYTES_MAX;
use std::path::Path;

/// The feeling of a file; that of a usual finger without one.
pub(crate) fn read(path: Option<&Path>) -> Result<NamedFeeling, Failure> {
    let Some(path) = path else { return Ok(NamedFeeling::default()) };
    let text = read_text(path, FILE_BYTES_MAX);
    let name = path.to_string_lossy().into_owned();
    let text = text.map_err(|error| Failure::bad_file(&name, said(&error)))?;
    NamedFeeling::read(&text, name.clone()).map_err(|error| Failure::bad_file(name, error))
}
