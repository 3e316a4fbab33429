//! Profiles from files: breakpoints as CSV, or a row of grey pixels.

use crate::content::Content;
use serde::Serialize;
use slipline_plate::quantity::{Count, Counted, WrongCount, from_decibels, must_be};
use slipline_plate::text_table::{
    BadLine, ColumnRead, Quantity, Table, UnclearColumns, Unit, text_of, understood,
};
use std::fmt;
use thiserror::Error;

/// The largest profile file that is read, in bytes.
pub const PROFILE_FILE_BYTES_MAX: usize = 1 << 20;
/// Largest number of pixels of an image; only one row is used.
const PIXELS_MAX: u64 = 1 << 22;

/// Why a profile file was refused.
#[derive(Debug, Error)]
pub enum ProfileFileError {
    /// The file is too large.
    #[error(transparent)]
    TooBig(WrongCount),
    /// A line of the CSV cannot be read.
    #[error("{0}. Write PLACE,AMPLITUDE, the place in metres from the driven end, such as 0.12,0.5")]
    Line(#[from] BadLine),
    /// Columns of the CSV whose meaning is not clear.
    #[error("{0}. Write PLACE,AMPLITUDE, the place in metres from the driven end, such as 0.12,0.5")]
    Columns(#[from] UnclearColumns),
    /// It is no text: what it is, and what to do.
    #[error("{0}")]
    Foreign(&'static str),
    /// No line of the CSV is a breakpoint.
    #[error(
        "no line is a breakpoint: write PLACE,AMPLITUDE, the place in metres from the driven end, such as 0.12,0.5"
    )]
    Empty,
    /// Not a readable PNG image.
    #[error("not a PNG image that can be read: {0}")]
    Png(#[from] png::DecodingError),
    /// The image has too few or too many pixels.
    #[error("{}", must_be(
        format_args!("the image's size = {width} x {height} pixels"),
        "at least 2 wide, with at most 4194304 pixels",
    ))]
    Size {
        /// Width, pixels.
        width: u32,
        /// Height, pixels.
        height: u32,
    },
}

fn check_size(bytes: usize) -> Result<(), ProfileFileError> {
    let allowed = Count::at_most(PROFILE_FILE_BYTES_MAX, Counted::Bytes);
    WrongCount::check("the file", bytes, allowed).map_err(ProfileFileError::TooBig)
}

/// A profile of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct ProfileTable {
    /// Places in metres from the driven end, each with its amplitude.
    pub breakpoints: Vec<(f64, f64)>,
    /// What was read.
    pub read: ProfileRead,
}

/// What was read of a table.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ProfileRead {
    /// Number of its rows.
    pub rows: usize,
    /// Its columns.
    pub columns: Vec<ColumnRead>,
}

impl fmt::Display for ProfileRead {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rows = if self.rows == 1 { "1 row".to_owned() } else { format!("{} rows", self.rows) };
        write!(f, "{rows}; {}", understood(&self.columns))
    }
}

/// Breakpoints, one per line: the place from the driven end, in metres or in the unit of its name, and the amplitude in any
/// unit. Lines that begin with `#`, and a line of names, may stand among them; other columns need names.
///
/// # Errors
/// [`ProfileFileError`]: too big, no text, the first line that is not two numbers, columns that are not clear, or no line at
/// all.
pub fn from_csv(bytes: &[u8]) -> Result<ProfileTable, ProfileFileError> {
    check_size(bytes.len())?;
    if let Content::Foreign(what) = Content::of(bytes) {
        return Err(ProfileFileError::Foreign(what));
    }
    let table = Table::read(&text_of(bytes))?.ok_or(ProfileFileError::Empty)?;
    let is_amplitude = |of| matches!(of, Quantity::Level | Quantity::Magnitude);
    let place = table.find("place", &|of| of == Quantity::Place)?;
    let amplitude = table.find("amplitude", &is_amplitude)?;
    // Two columns have an order, unless their names say that they are something else.
    let are_two = table.columns.len() == 2
        && table.quantity(0).is_none_or(|of| of == Quantity::Place)
        && table.quantity(1).is_none_or(is_amplitude);
    let (place, amplitude) = match (place, amplitude) {
        (Some(place), Some(amplitude)) => (place, amplitude),
        (None | Some(0), None | Some(1)) if are_two => (0, 1),
        _ => {
            return Err(table
                .unclear("no column is named as the place, or none as the amplitude".to_owned())
                .into());
        }
    };
    let unit = |at: usize| table.columns[at].unit();
    let metres = match unit(place) {
        None => 1.0,
        Some((Unit::Linear(size, Some(Quantity::Displacement)), _)) => size,
        Some(_) => return Err(table.unclear(format!("*{}* is no length", table.columns[place].name)).into()),
    };
    let of_amplitude = unit(amplitude).map(|it| it.0);
    let rows = table.rows().iter().map(|row| {
        let value = |at: usize| table.finite(row, at);
        let amplitude = match of_amplitude {
            Some(Unit::Decibels) => from_decibels(value(amplitude)?),
            Some(unit) => unit.size() * value(amplitude)?,
            None => value(amplitude)?,
        };
        Ok((metres * value(place)?, amplitude))
    });
    let breakpoints = rows.collect::<Result<Vec<_>, BadLine>>()?;
    let in_words = |at: usize, usual: &str| unit(at).map_or(usual.to_owned(), |it| it.1);
    let units = [in_words(place, "m"), in_words(amplitude, "")];
    let columns = table.columns_read(&[(place, "place", &units[0]), (amplitude, "amplitude", &units[1])]);
    let read = ProfileRead { rows: breakpoints.len(), columns };
    Ok(ProfileTable { breakpoints, read })
}

/// The middle row of an image as a profile from 0 to `length_m` metres: black is still, white vibrates most.
/// Colours count by their brightness; transparent pixels count as black.
///
/// # Errors
/// [`ProfileFileError`]: too big, not a PNG image, fewer than two pixels wide.
pub fn from_png(bytes: &[u8], length_m: f64) -> Result<Vec<(f64, f64)>, ProfileFileError> {
    check_size(bytes.len())?;
    let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::normalize_to_color8() | png::Transformations::ALPHA);
    let mut reader = decoder.read_info()?;
    let (width, height) = (reader.info().width, reader.info().height);
    if width < 2 || u64::from(width) * u64::from(height) > PIXELS_MAX {
        return Err(ProfileFileError::Size { width, height });
    }
    let size = ProfileFileError::Size { width, height };
    let Some(length) = reader.output_buffer_size() else { return Err(size) };
    let mut pixels = vec![0; length];
    let frame = reader.next_frame(&mut pixels)?;
    let samples = frame.color_type.samples();
    let row: Vec<f64> = pixels
        .chunks_exact(frame.line_size)
        .nth(height as usize / 2)
        .into_iter()
        .flat_map(|row| row.chunks_exact(samples))
        .take(width as usize)
        .map(brightness)
        .collect();
    let last = row.len().saturating_sub(1) as f64;
    Ok(row.into_iter().enumerate().map(|(at, value)| (at as f64 / last * length_m, value)).collect())
}

/// Brightness of a pixel, 0 to 1, with its transparency last (ITU-R BT.709 for colours).
fn brightness(pixel: &[u8]) -> f64 {
    let share = |value: u8| f64::from(value) / 255.0;
    match *pixel {
        [grey, alpha] => share(grey) * share(alpha),
        [red, green, blue, alpha] => {
            (0.2126 * share(red) + 0.7152 * share(green) + 0.0722 * share(blue)) * share(alpha)
        }
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn png_of(width: u32, height: u32, colour: png::ColorType, pixels: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_color(colour);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.write_header().unwrap().write_image_data(pixels).unwrap();
        bytes
    }

    #[test]
    fn csv_is_read_with_names_units_comments_and_either_separator() {
        let text = "\u{feff}place_m, amplitude\n# drawn by hand\n0.01, 1\n\n0.1, 0.25\n";
        assert_eq!(from_csv(text.as_bytes()).unwrap().breakpoints, [(0.01, 1.0), (0.1, 0.25)]);
        for text in [
            "0,01; 1\n0,1; 0,25\n",
            "Place (mm);Amplitude\r\n10,0;1\r\n100,0;0,25\r\n",
            "No.\tAmplitude\tPosition [cm]\n1\t1\t1\n2\t.25\t10\n",
            "x_mm,rms\n10,1\n100,0.25\n",
        ] {
            let wide: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
            for bytes in [text.as_bytes(), &[b"\xff\xfe", &wide[..]].concat()] {
                assert_eq!(from_csv(bytes).unwrap().breakpoints, [(0.01, 1.0), (0.1, 0.25)], "{text}");
            }
        }
    }

    #[test]
    fn what_was_read_is_reported() {
        for (text, read) in [
            ("0.1,1\n0.2,2\n", "2 rows; column 1 as place in m, column 2 as amplitude"),
            (
                "No.;Place (mm);Level (dB)\n1;1;-1\n",
                "1 row; *Place (mm)* as place, *Level (dB)* as amplitude; *No.* left out",
            ),
        ] {
            assert_eq!(from_csv(text.as_bytes()).unwrap().read.to_string(), read);
        }
    }

    #[test]
    fn a_file_without_a_breakpoint_is_refused() {
        for text in ["place_m,rms\n", "# nothing\n", "not a profile at all", "a,b\nc,d\n"] {
            let error = from_csv(text.as_bytes()).unwrap_err().to_string();
            assert!(error.starts_with("no line is a breakpoint"), "{text:?}: {error}");
        }
    }

    #[test]
    fn a_line_that_is_not_two_numbers_is_named() {
        for (text, start) in [
            ("0.1,1\n0.2\n", "line 2: "),
            ("0.1,\n", "line 1: no column is named as the place, or none as the amplitude"),
            ("0.1,1\nname,x\n", "line 2: "),
            ("0.1,1\n0.2,nan\n", "line 2: column 2 = nan: must be a number"),
            ("0.1,1,2\n0.2,2,3\n", "line 1: no column is named as the place"),
            ("place (kg),amplitude\n0.1,1\n", "line 1: *place (kg)* has the unit kg"),
            ("frequency,level\n0.1,1\n", "line 1: no column is named as the place"),
            ("", "the file is empty"),
            ("PK\x03\x04", "it is an archive: unpack it"),
            ("place (m),level (dB),amplitude\n0.1,1,2\n", "line 1: 2 columns may be the amplitude"),
        ] {
            let error = from_csv(text.as_bytes()).unwrap_err().to_string();
            assert!(error.starts_with(start), "{text:?}: {error}");
        }
        let error = from_csv("#".repeat(PROFILE_FILE_BYTES_MAX + 1).as_bytes()).unwrap_err().to_string();
        assert!(error.contains("1048576"), "{error}");
    }

    #[test]
    fn the_middle_row_of_an_image_is_the_profile() {
        let grey = png_of(3, 3, png::ColorType::Grayscale, &[9, 9, 9, 0, 51, 255, 7, 7, 7]);
        let profile = from_png(&grey, 0.3).unwrap();
        for ((place, value), (wanted_place, wanted)) in
            profile.iter().zip([(0.0, 0.0), (0.15, 0.2), (0.3, 1.0)])
        {
            assert!((place - wanted_place).abs() < 1e-12 && (value - wanted).abs() < 1e-12, "{profile:?}");
        }
        let colours = png_of(2, 1, png::ColorType::Rgba, &[255, 255, 255, 255, 255, 255, 255, 0]);
        let profile = from_png(&colours, 1.0).unwrap();
        assert!((profile[0].1 - 1.0).abs() < 1e-12 && profile[1].1 == 0.0);
    }

    #[test]
    fn a_file_that_is_no_image_is_refused() {
        assert!(from_png(b"not an image", 0.3).unwrap_err().to_string().contains("PNG"));
        let narrow = png_of(1, 1, png::ColorType::Grayscale, &[0]);
        assert!(from_png(&narrow, 0.3).unwrap_err().to_string().contains("1 x 1"));
    }
}
