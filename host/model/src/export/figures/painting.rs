//! Figures as pixels.

use super::font::FONTS;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::fontdb::Database;
use resvg::usvg::{self, Options, Tree};
use std::sync::{Arc, OnceLock};
use thiserror::Error;

/// Points per inch: the unit of a page.
const POINTS_PER_INCH: f64 = 72.0;

/// Why a figure could not be painted.
#[derive(Debug, Error)]
pub enum PaintError {
    /// The renderer cannot read it.
    #[error("{0}")]
    Svg(#[from] usvg::Error),
    /// It has more pixels than fit into memory, or none.
    #[error("{0} x {1} pixels are not possible")]
    Size(u32, u32),
}

/// A picture: width and height, and the pixels' red, green, blue and straight opacity.
pub(super) struct Pixels {
    pub(super) size: (u32, u32),
    pub(super) rgba: Vec<[u8; 4]>,
}

/// Renders an SVG file at this many dots per inch.
pub(super) fn pixels(svg: &str, dots_per_inch: f64) -> Result<Pixels, PaintError> {
    let tree = parsed(svg)?;
    let scale = dots_per_inch / POINTS_PER_INCH;
    let dots = |points: f32| (f64::from(points) * scale).round() as u32;
    let (width, height) = (dots(tree.size().width()), dots(tree.size().height()));
    let mut pixels = Pixmap::new(width, height).ok_or(PaintError::Size(width, height))?;
    let scale = scale as f32;
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut pixels.as_mut());
    let rgba = pixels
        .pixels()
        .iter()
        .map(|pixel| pixel.demultiply())
        .map(|colour| [colour.red(), colour.green(), colour.blue(), colour.alpha()])
        .collect();
    Ok(Pixels { size: (width, height), rgba })
}

/// The SVG file as the renderer parses it, with its size in points.
pub(super) fn parsed(svg: &str) -> Result<Tree, usvg::Error> {
    let options = Options { dpi: POINTS_PER_INCH as f32, fontdb: database(), ..Options::default() };
    Tree::from_str(svg, &options)
}

/// The fonts, for the renderer.
fn database() -> Arc<Database> {
    static DATABASE: OnceLock<Arc<Database>> = OnceLock::new();
    let made = || {
        let mut database = Database::new();
        for font in FONTS {
            database.load_font_data(font.to_vec());
        }
        // The fallback for every family name, so that each text finds a font.
        database.set_sans_serif_family("Ubuntu");
        database.set_serif_family("Ubuntu");
        Arc::new(database)
    };
    Arc::clone(DATABASE.get_or_init(made))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_font_of_the_figures_exists() {
        assert_eq!(database().faces().count(), FONTS.len());
    }
}
