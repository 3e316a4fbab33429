//! What stands on the command line: quantities, tones, plates.

use super::failure::Failure;
use crate::quantity::{self, PlaceOrFrequency, QuantityError};
use slipline_plate::{PLATE_FILE_BYTES_MAX, Plate, preset, presets};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// A boundary, by its place or by its frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Boundary(PlaceOrFrequency);

/// A tone on the command line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ToneArgument {
    boundary: Boundary,
    level: f64,
}

pub(super) fn boundary(text: &str) -> Result<Boundary, QuantityError> {
    quantity::place_or_frequency(text).map(Boundary)
}

pub(super) fn frequency(text: &str) -> Result<f64, QuantityError> {
    quantity::frequency_hz(text)
}

pub(super) fn time(text: &str) -> Result<f64, QuantityError> {
    quantity::time_s(text)
}

pub(super) fn level(text: &str) -> Result<f64, String> {
    let level = quantity::plain(text, "").map_err(|error| error.to_string())?;
    if (0.0..=1.0).contains(&level) { Ok(level) } else { Err("a level must be 0 to 1".to_owned()) }
}

/// `90mm:0.5`, a place (or a frequency) and a level.
pub(super) fn tone(text: &str) -> Result<ToneArgument, String> {
    let (place, loudness) = text.rsplit_once(':').ok_or("write PLACE:LEVEL, such as 90mm:0.5")?;
    let boundary = boundary(place).map_err(|error| error.to_string())?;
    Ok(ToneArgument { boundary, level: level(loudness)? })
}

/// A span of seconds that is allowed.
pub(super) fn seconds(name: &str, seconds: f64, (low, high): (f64, f64)) -> Result<f64, Failure> {
    if (low..=high).contains(&seconds) {
        Ok(seconds)
    } else {
        Err(Failure::Usage(format!("{name} is {seconds} s: must be {low} to {high} s")))
    }
}

impl Boundary {
    /// Its place in metres, within the plate's span.
    pub(super) fn on(self, plate: &Plate) -> Result<f64, Failure> {
        let (start_m, end_m) = plate.span_m();
        let (low_hz, high_hz) = plate.band_hz();
        match self.0 {
            PlaceOrFrequency::Place(x_m) if (start_m..=end_m).contains(&x_m) => Ok(x_m),
            PlaceOrFrequency::Place(x_m) => Err(Failure::Usage(format!(
                "the boundary at {} does not lie on the span of the plate {:?}: must be {} to {}",
                quantity::show_place(x_m),
                plate.name(),
                quantity::show_place(start_m),
                quantity::show_place(end_m),
            ))),
            PlaceOrFrequency::Frequency(hz) => plate
                .turning_point_m(hz)
                .filter(|_| (low_hz..=high_hz).contains(&hz))
                .map(|x_m| x_m.clamp(start_m, end_m))
                .ok_or_else(|| {
                    Failure::Usage(format!(
                        "a tone of {} has no boundary on the span of the plate {:?}: must be {} to {}",
                        quantity::show_frequency(hz),
                        plate.name(),
                        quantity::show_frequency(low_hz),
                        quantity::show_frequency(high_hz),
                    ))
                }),
        }
    }
}

/// The tones of a command: the boundary first, then the others, each as (place in metres, level).
pub(super) fn tones(
    plate: &Plate,
    boundary: Option<Boundary>,
    level: f64,
    tones: &[ToneArgument],
) -> Result<Vec<(f64, f64)>, Failure> {
    let most = slipline_protocol::limits::MAX_TONES;
    let first = boundary.map(|boundary| ToneArgument { boundary, level });
    let all = first
        .iter()
        .chain(tones)
        .map(|tone| Ok((tone.boundary.on(plate)?, tone.level)))
        .collect::<Result<Vec<_>, Failure>>()?;
    match all.len() {
        0 => Err(Failure::Usage("name a --boundary or at least one --tone".to_owned())),
        count if count > most => Err(Failure::Usage(format!("{count} tones: must be 1 to {most}"))),
        _ => Ok(all),
    }
}

/// A plate by the name of a preset, or from a TOML file.
pub(super) fn plate(name: &str) -> Result<Plate, Failure> {
    if let Some(plate) = preset(name) {
        return Ok(plate);
    }
    let path = Path::new(name);
    let in_file = |message: String| Failure::Usage(format!("{name}: {message}"));
    let text = read_limited(path).map_err(|error| match error.kind() {
        std::io::ErrorKind::NotFound => {
            let names: Vec<&str> = presets().iter().map(|preset| preset.name).collect();
            in_file(format!("neither a preset nor a file; the presets are {}", names.join(", ")))
        }
        std::io::ErrorKind::FileTooLarge => in_file(format!(
            "the file is too big to be a plate: must be at most {PLATE_FILE_BYTES_MAX} bytes"
        )),
        std::io::ErrorKind::InvalidData => in_file("the file is not UTF-8 text".to_owned()),
        _ => in_file(error.to_string()),
    })?;
    Plate::from_toml(&text).map_err(|error| in_file(error.to_string()))
}

/// Reads a text file, but never more than a plate file may have.
fn read_limited(path: &Path) -> std::io::Result<String> {
    let file = File::open(path)?;
    if file.metadata()?.is_dir() {
        return Err(std::io::ErrorKind::IsADirectory.into());
    }
    let mut bytes = Vec::new();
    // A pipe has no length to be asked for, so the limit holds while reading.
    file.take(PLATE_FILE_BYTES_MAX as u64 + 1).read_to_end(&mut bytes)?;
    if bytes.len() > PLATE_FILE_BYTES_MAX {
        return Err(std::io::ErrorKind::FileTooLarge.into());
    }
    String::from_utf8(bytes).map_err(|_| std::io::ErrorKind::InvalidData.into())
}
