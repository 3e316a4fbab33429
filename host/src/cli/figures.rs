//! `slipline figures`.

use super::destination::{Destination, ForceArgument};
use super::{Failure, output};
use clap::Args;
use serde_json::json;
use slipline_model::disk;
use slipline_model::export::figures::{PaperFigureError, paper};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// `figures`.
#[derive(Debug, Args)]
pub struct FiguresArguments {
    /// The folder to write into; it is made if it is not there.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    force: ForceArgument,
}

pub(super) fn run(arguments: &FiguresArguments, as_json: bool) -> Result<(), Failure> {
    // Every name a figure of the paper may have.
    let names: Vec<String> =
        (1..=99).flat_map(|n| [format!("fig{n:02}.png"), format!("fig{n:02}.csv")]).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    Destination::folder(&arguments.out, &names, arguments.force)?;
    let written = write_all(&arguments.out).map_err(Failure::failed)?;
    output::print(as_json, &json!({ "figures": &written }), |out| {
        for figure in &written {
            writeln!(out, "Fig. {}: {}", figure.number, figure.title)?;
            writeln!(out, "  {}", figure.png.display())?;
            writeln!(out, "  {}", figure.csv.display())?;
        }
        Ok(())
    })
}

/// A figure that was written.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
struct Written {
    /// The figure's number in the paper.
    number: u32,
    /// What it shows.
    title: &'static str,
    /// The picture.
    png: PathBuf,
    /// Its numbers.
    csv: PathBuf,
}

/// Why the figures could not be written.
#[derive(Debug, Error)]
enum WriteError {
    /// The figures could not be made.
    #[error(transparent)]
    Figure(#[from] PaperFigureError),
    /// A file could not be written.
    #[error("{} could not be written: {error}", .path.display())]
    File {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        error: std::io::Error,
    },
}

/// Draws every figure and writes it as PNG and CSV into `folder`, which is made if it is not there.
///
/// # Errors
/// [`WriteError`] names the file that could not be written; each file is whole or as it was before.
fn write_all(folder: &Path) -> Result<Vec<Written>, WriteError> {
    let file = |path: &Path, error| WriteError::File { path: path.to_owned(), error };
    std::fs::create_dir_all(folder).map_err(|error| file(folder, error))?;
    let mut written = Vec::new();
    for figure in paper()? {
        let png = folder.join(format!("{}.png", figure.stem));
        let csv = folder.join(format!("{}.csv", figure.stem));
        for (path, bytes) in [(&png, &figure.png[..]), (&csv, figure.csv.as_bytes())] {
            disk::write(path, |out| out.write_all(bytes)).map_err(|error| file(path, error))?;
        }
        written.push(Written { number: figure.number, title: figure.title, png, csv });
    }
    Ok(written)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_figure_is_written_as_a_picture_and_as_numbers() {
        let folder = std::env::temp_dir().join(format!("slipline-figures-{}", std::process::id()));
        let written = write_all(&folder).expect("writable");
        assert_eq!(written.len(), 6);
        for one in &written {
            let csv = std::fs::read_to_string(&one.csv).expect("there");
            assert!(csv.starts_with(&format!("# Fig. {}", one.number)), "{csv:.40}");
            assert!(std::fs::read(&one.png).expect("there").starts_with(b"\x89PNG"));
        }
        // The file that is there stays what it was until the new one is whole: another name of it keeps the old one.
        let (csv, kept) = (&written[0].csv, folder.join("kept.csv"));
        std::fs::write(csv, b"mine").expect("writable");
        std::fs::hard_link(csv, &kept).expect("linked");
        write_all(&folder).expect("writable");
        assert!(std::fs::read(&kept).expect("there") == b"mine");
        assert!(std::fs::read(csv).expect("there") != b"mine");
        std::fs::remove_dir_all(&folder).expect("removable");
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_named() {
        let file = std::env::temp_dir().join(format!("slipline-no-folder-{}", std::process::id()));
        std::fs::write(&file, b"in the way").expect("writable");
        let error = write_all(&file.join("figures")).expect_err("a file is in the way").to_string();
        std::fs::remove_file(&file).expect("removable");
        assert!(error.contains("slipline-no-folder") && error.contains("could not be written"), "{error}");
    }
}
