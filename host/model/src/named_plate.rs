//! A plate by the name of a preset, or from a file.

use crate::atomic_file::said;
use slipline_plate::quantity::nearest;
use slipline_plate::{Plate, PlateFileError, preset, presets};
use std::io;

/// Why no plate has this name.
#[derive(Debug, thiserror::Error)]
pub enum NamedPlateError {
    /// It is neither a preset nor a file.
    #[error("{}", unknown(.0))]
    Unknown(String),
    /// The file cannot be read.
    #[error("{}: {}", shown(.0), said(.1))]
    Unread(String, #[source] io::Error),
    /// The file is no plate's.
    #[error("{}: {}", shown(.0), .1)]
    File(String, #[source] PlateFileError),
}

fn unknown(name: &str) -> String {
    let names: Vec<&str> = presets().iter().map(|preset| preset.name).collect();
    let meant = nearest(name, names.iter().copied())
        .map_or_else(|| "; the".to_owned(), |meant| format!("; did you mean {meant}? The"));
    format!("{name:?} is neither a preset nor a file{meant} presets are {}", names.join(", "))
}

fn shown(name: &str) -> String {
    name.replace(char::is_control, "\u{fffd}")
}

/// The preset of this name, or the plate of the file that `read` reads.
///
/// # Errors
/// [`NamedPlateError`]: which of the two it is not, and why.
pub fn named_plate(name: &str, read: impl FnOnce() -> io::Result<String>) -> Result<Plate, NamedPlateError> {
    if let Some(plate) = preset(name) {
        return Ok(plate);
    }
    let text = read().map_err(|error| {
        if error.kind() == io::ErrorKind::NotFound {
            NamedPlateError::Unknown(name.to_owned())
        } else {
            NamedPlateError::Unread(name.to_owned(), error)
        }
    })?;
    Plate::from_toml(&text).map_err(|error| NamedPlateError::File(name.to_owned(), error))
}
