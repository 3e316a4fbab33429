//! A figure's file on the command line: its extension selects the format.

use super::destination::{Destination, ForceArgument};
use super::failure::Failure;
use slipline_model::atomic_file::{STANDARD_STREAM, is_stream};
use slipline_model::export::figures::{Drawing, Format};
use std::path::{Path, PathBuf};

/// The destination and format of a figure.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FigureFile {
    path: PathBuf,
    format: Format,
}

/// A file whose extension names its format. A pipe, a device or standard output, which has no extension, gets a PNG file.
pub(super) fn figure_file(text: &str) -> Result<FigureFile, String> {
    let path = PathBuf::from(text);
    let format = match Format::of(&path) {
        Some(format) => format,
        None if is_stream(&path) || path == Path::new(STANDARD_STREAM) => Format::Png,
        None => return Err("must end in .svg or .png".to_owned()),
    };
    Ok(FigureFile { path, format })
}

impl FigureFile {
    /// The file, checked before the computation begins.
    pub(super) fn destination(&self, may_replace: ForceArgument) -> Result<Destination, Failure> {
        Destination::new(&self.path, may_replace)
    }

    /// Writes the figure to its destination.
    pub(super) fn write(&self, destination: &Destination, drawing: &Drawing) -> Result<(), Failure> {
        let file = drawing.file(self.format).map_err(Failure::failed)?;
        destination.write(|out| Ok(std::io::Write::write_all(out, &file)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ending_names_the_format_and_others_are_refused() {
        let format = |text| figure_file(text).map(|file| file.format);
        assert_eq!(format("a.svg"), Ok(Format::Svg));
        assert_eq!(format("b/A.SVG"), Ok(Format::Svg));
        assert_eq!(format("a.b.png"), Ok(Format::Png));
        for text in ["a.pdf", "svg", ".png", "a.svg.gz", "a.", ""] {
            assert_eq!(format(text), Err("must end in .svg or .png".to_owned()), "{text}");
        }
        #[cfg(unix)]
        assert_eq!(format("/dev/null"), Ok(Format::Png));
    }
}
