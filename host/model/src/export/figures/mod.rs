//! Figures: the paper's, as printed beside corrected, and the plate on the screen.
//!
//! The numbers are [`slipline_plate::paper`]'s and the fields'; this module only draws them.

mod draw;
mod layout;
pub mod plate;
mod png_file;

use slipline_plate::paper::{FigureError, figures};
use thiserror::Error;

pub use draw::DrawError;

/// A figure of the paper, drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct PaperFigure {
    /// The figure's number in the paper.
    pub number: u32,
    /// What it shows.
    pub title: &'static str,
    /// The name of its files, without an extension: `fig04`.
    pub stem: String,
    /// The picture, as a PNG file.
    pub png: Vec<u8>,
    /// Its numbers, as CSV.
    pub csv: String,
}

/// Why the figures could not be made.
#[derive(Debug, Error)]
pub enum PaperFigureError {
    /// The numbers could not be computed.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// The picture could not be drawn.
    #[error(transparent)]
    Draw(#[from] DrawError),
}

/// Draws every figure of the paper.
///
/// # Errors
/// [`PaperFigureError`] when the numbers cannot be computed, or the canvas refuses.
pub fn paper() -> Result<Vec<PaperFigure>, PaperFigureError> {
    let drawn = figures()?.into_iter().map(|figure| {
        Ok(PaperFigure {
            number: figure.number,
            title: figure.title,
            stem: figure.file_stem(),
            png: draw::picture(&figure)?,
            csv: figure.to_csv(),
        })
    });
    drawn.collect()
}
