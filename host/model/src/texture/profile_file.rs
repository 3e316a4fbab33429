//! Profiles from files: breakpoints as CSV, or a row of grey pixels.

use slipline_plate::quantity::{Count, Counted, WrongCount, must_be};
use slipline_plate::text_table::{cells, rows};
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
    /// A line of the CSV is not two numbers.
    #[error("line {line}: write PLACE,AMPLITUDE, the place in metres from the driven end, such as 0.12,0.5")]
    Line {
        /// The line, from 1.
        line: usize,
    },
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
        "2 wide or more, 4194304 in all or less",
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

/// Breakpoints, one per line: the place in metres from the driven end and the amplitude in any unit,
/// separated by a comma, a semicolon, a tab or blanks. Lines that are empty or begin with `#`, and a first
/// line of names, are skipped.
///
/// # Errors
/// [`ProfileFileError`]: too big, the first line that is not two numbers, or no line at all.
pub fn from_csv(text: &str) -> Result<Vec<(f64, f64)>, ProfileFileError> {
    check_size(text.len())?;
    let mut breakpoints = Vec::new();
    let mut may_be_names = true;
    for (number, line) in rows(text) {
        let breakpoint = match cells(line).as_slice() {
            [place, amplitude] => place.parse().ok().zip(amplitude.parse().ok()),
            _ => None,
        };
        match breakpoint {
            Some(breakpoint) => breakpoints.push(breakpoint),
            None if may_be_names && !line.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c)) => {}
            None => return Err(ProfileFileError::Line { line: number }),
        }
        may_be_names = false;
    }
    if breakpoints.is_empty() { Err(ProfileFileError::Empty) } else { Ok(breakpoints) }
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
    fn csv_is_read_with_names_comments_and_either_separator() {
        let text = "\u{feff}place_m, amplitude\n# drawn by hand\n0.01, 1\n\n0.1; 0.25\n";
        assert_eq!(from_csv(text).unwrap(), [(0.01, 1.0), (0.1, 0.25)]);
        assert_eq!(from_csv("0,01; 1\n0,1; 0,25\n").unwrap(), [(0.01, 1.0), (0.1, 0.25)], "a decimal comma");
    }

    #[test]
    fn a_file_without_a_breakpoint_is_refused() {
        for text in ["", "place_m,rms\n", "# nothing\n", "not a profile at all"] {
            let error = from_csv(text).unwrap_err().to_string();
            assert!(error.starts_with("no line is a breakpoint"), "{text:?}: {error}");
        }
    }

    #[test]
    fn a_line_that_is_not_two_numbers_is_named() {
        for (text, line) in [("0.1,1\n0.2\n", 2), ("0.1,1\nname,x\n", 2), ("0.1,\n", 1), ("a,b\nc,d\n", 2)] {
            let error = from_csv(text).unwrap_err().to_string();
            assert!(error.starts_with(&format!("line {line}: ")), "{text:?}: {error}");
        }
        let error = from_csv(&"#".repeat(PROFILE_FILE_BYTES_MAX + 1)).unwrap_err().to_string();
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
