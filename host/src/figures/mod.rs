//! Figures as files: the paper's (`fig04.png` and `fig04.csv`, as printed beside corrected), and the plate on the
//! screen.
//!
//! The numbers are [`slipline_plate::paper`]'s and the picture's; this module only draws and writes them.

mod draw;
mod layout;
#[cfg(feature = "gui")]
pub mod plate;
mod png_file;

use crate::disk;
use slipline_plate::paper::{FigureError, figures};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use thiserror::Error;

pub use draw::DrawError;

/// A figure that was written.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Written {
    /// The figure's number in the paper.
    pub number: u32,
    /// What it shows.
    pub title: &'static str,
    /// The picture.
    pub png: PathBuf,
    /// Its numbers.
    pub csv: PathBuf,
}

/// Why the figures could not be written.
#[derive(Debug, Error)]
pub enum WriteError {
    /// The numbers could not be computed.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// The picture could not be drawn.
    #[error(transparent)]
    Draw(#[from] DrawError),
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
pub fn write_all(folder: &Path) -> Result<Vec<Written>, WriteError> {
    let file = |path: &Path, error| WriteError::File { path: path.to_owned(), error };
    std::fs::create_dir_all(folder).map_err(|error| file(folder, error))?;
    let mut written = Vec::new();
    for figure in figures()? {
        let png = folder.join(format!("{}.png", figure.file_stem()));
        let csv = folder.join(format!("{}.csv", figure.file_stem()));
        let picture = draw::picture(&figure)?;
        for (path, bytes) in [(&png, &picture[..]), (&csv, figure.to_csv().as_bytes())] {
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
