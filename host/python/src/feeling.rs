//! The feeling of a finger, from a file or that of a usual finger.

use crate::error::Failure;
use slipline_model::atomic_file::{read_text, said};
use slipline_model::setup::file::{FILE_BYTES_MAX, feeling};
use slipline_plate::feeling::Feeling;
use std::path::Path;

/// A feeling and its file.
#[derive(Clone, Debug, Default)]
pub(crate) struct NamedFeeling {
    pub(crate) feeling: Feeling,
    pub(crate) from: Option<String>,
}

/// The feeling of a file; that of a usual finger without one.
pub(crate) fn read(path: Option<&str>) -> Result<NamedFeeling, Failure> {
    let Some(path) = path else { return Ok(NamedFeeling::default()) };
    let text = read_text(Path::new(path), FILE_BYTES_MAX);
    let text = text.map_err(|error| Failure::bad_file(path, said(&error)))?;
    let feeling = feeling::read(&text).map_err(|error| Failure::bad_file(path, error))?;
    Ok(NamedFeeling { feeling, from: Some(path.to_owned()) })
}
