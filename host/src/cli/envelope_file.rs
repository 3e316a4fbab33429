//! Files of `slipline simulate`: the envelope over x as CSV or as a figure, by the ending of the name.

use super::destination::{Destination, ForceArgument};
use super::failure::Failure;
use super::figure_file::{FigureFile, figure_file};
use clap::Args;
use slipline_model::atomic_file::{STANDARD_STREAM, is_stream};
use std::path::{Path, PathBuf};

/// The files.
#[derive(Debug, Args)]
pub(super) struct EnvelopeArgument {
    /// Write the envelope over x: as CSV (.csv; -), or drawn (.svg, .png). Repeated for more files.
    #[arg(long, value_name = "FILE", value_parser = envelope_file, help_heading = "Output")]
    out: Vec<EnvelopeFile>,
    #[arg(long, hide = true, value_name = "F")]
    csv: Option<PathBuf>,
    #[arg(long, hide = true, alias = "png", value_name = "F", value_parser = figure_file)]
    figure: Option<FigureFile>,
}

/// A file and its form.
#[derive(Clone, Debug)]
enum EnvelopeFile {
    Csv(PathBuf),
    Figure(FigureFile),
}

/// A file that may be written: the figure, or CSV where there is none.
#[derive(Debug)]
pub(super) struct EnvelopeDestination {
    pub(super) destination: Destination,
    pub(super) figure: Option<FigureFile>,
}

fn envelope_file(text: &str) -> Result<EnvelopeFile, String> {
    let path = PathBuf::from(text);
    let is_csv = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv"));
    // A stream without an ending gets CSV.
    if is_csv || is_stream(&path) || path == Path::new(STANDARD_STREAM) {
        return Ok(EnvelopeFile::Csv(path));
    }
    figure_file(text).map(EnvelopeFile::Figure).map_err(|_| "must end in .csv, .svg or .png".to_owned())
}

impl EnvelopeArgument {
    /// The files, which are different ones.
    pub(super) fn destinations(
        &self,
        may_replace: ForceArgument,
    ) -> Result<Vec<EnvelopeDestination>, Failure> {
        let mut files = Vec::new();
        let csv = self.csv.iter().map(|path| EnvelopeFile::Csv(path.clone()));
        let figure = self.figure.iter().map(|figure| EnvelopeFile::Figure(figure.clone()));
        for file in csv.chain(figure).chain(self.out.iter().cloned()) {
            let (destination, figure) = match file {
                EnvelopeFile::Csv(path) => (Destination::new(&path, may_replace)?, None),
                EnvelopeFile::Figure(figure) => (figure.destination(may_replace)?, Some(figure)),
            };
            files.push(EnvelopeDestination { destination, figure });
        }
        let is_twice = |(number, file): (usize, &EnvelopeDestination)| {
            files.iter().take(number).any(|before| before.destination.is(&file.destination))
        };
        match files.iter().enumerate().any(is_twice) {
            false => Ok(files),
            true if self.out.is_empty() => Err(Failure::usage("--csv and --figure name the same file")),
            true => Err(Failure::usage("two outputs name the same file")),
        }
    }
}
