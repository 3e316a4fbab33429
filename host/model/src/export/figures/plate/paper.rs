//! A sheet of paper measured in points (1/72 inch), on which lines, text and colours are put.

use super::super::draw::{DrawError, embedded_font, refused};
use super::super::png_file::{self, Shades};
use plotters::coord::Shift;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Dots per inch of the finished picture: what journals ask of figures at print size.
pub(super) const DPI: f64 = 300.0;
/// The picture is drawn this many times larger and averaged down: the canvas draws lines without smoothing.
const OVERSAMPLING: u32 = 2;

/// Text size of the title, in points.
pub(super) const TITLE: f64 = 11.0;
/// Text size of everything else, in points.
pub(super) const TEXT: f64 = 8.0;
/// Height of a line of text, in points.
pub(super) const LINE: f64 = 11.0;

/// Points as dots of the canvas.
fn dots(points: f64) -> i32 {
    (points / 72.0 * DPI * f64::from(OVERSAMPLING)).round() as i32
}

/// Dots of the finished picture as dots of the canvas, in points: pictures are painted no finer.
pub(super) const CELL: f64 = 72.0 / DPI;

/// A point on the paper: from its left, from its top.
pub(super) type Place = (f64, f64);

fn at((x, y): Place) -> (i32, i32) {
    (dots(x), dots(y))
}

/// How wide a text is, in points.
pub(super) fn text_width(text: &str, size: f64) -> Result<f64, DrawError> {
    let (wide, _) = embedded_font(dots(size))?.box_size(text).map_err(refused)?;
    Ok(f64::from(wide) / f64::from(dots(72.0)) * 72.0)
}

type Area<'a> = DrawingArea<BitMapBackend<'a>, Shift>;

/// The sheet.
pub(super) struct Paper<'a>(Area<'a>);

/// Draws on a white sheet of this size in points and returns it as a PNG file of 300 dots per inch.
pub(super) fn print(
    (width, height): Place,
    draw: impl FnOnce(&Paper<'_>) -> Result<(), DrawError>,
) -> Result<Vec<u8>, DrawError> {
    let whole = |points: f64| (dots(points).unsigned_abs() / OVERSAMPLING).max(1) * OVERSAMPLING;
    let (width, height) = (whole(width), whole(height));
    let mut rgb = vec![255; (width * height * 3) as usize];
    {
        let area = BitMapBackend::with_buffer(&mut rgb, (width, height)).into_drawing_area();
        let paper = Paper(area);
        draw(&paper)?;
        paper.0.present().map_err(refused)?;
    }
    let shades = Shades::All { dots_per_m: (DPI / 0.0254).round() as u32 };
    Ok(png_file::encode(&rgb, (width, height), OVERSAMPLING, shades)?)
}

/// Which point of a text stands at its place.
#[derive(Clone, Copy)]
pub(super) enum Anchor {
    /// The middle of its left end.
    Left,
    /// The middle of its right end.
    Right,
    /// Its middle.
    Centre,
}

impl Paper<'_> {
    /// Puts a text of one line.
    pub(super) fn text(
        &self,
        text: &str,
        place: Place,
        anchor: Anchor,
        size: f64,
        ink: RGBColor,
    ) -> Result<(), DrawError> {
        let side = match anchor {
            Anchor::Left => HPos::Left,
            Anchor::Right => HPos::Right,
            Anchor::Centre => HPos::Center,
        };
        let style = embedded_font(dots(size))?.color(&ink).pos(Pos::new(side, VPos::Center));
        self.0.draw_text(text, &style, at(place)).map_err(refused)
    }

    /// Puts a text that reads upwards, its middle at the place.
    pub(super) fn upward(&self, text: &str, place: Place) -> Result<(), DrawError> {
        let font = embedded_font(dots(TEXT))?.transform(FontTransform::Rotate270);
        let style = font.color(&BLACK).pos(Pos::new(HPos::Center, VPos::Center));
        self.0.draw_text(text, &style, at(place)).map_err(refused)
    }

    /// Draws a line through these places, this many points wide.
    pub(super) fn line(
        &self,
        places: impl IntoIterator<Item = Place>,
        width: f64,
        ink: RGBColor,
    ) -> Result<(), DrawError> {
        let places: Vec<(i32, i32)> = places.into_iter().map(at).collect();
        let style = ink.stroke_width(dots(width).unsigned_abs().max(1));
        self.0.draw(&PathElement::new(places, style)).map_err(refused)
    }

    /// Draws a dashed line through these places: dashes and gaps in points.
    pub(super) fn dashed(
        &self,
        places: impl IntoIterator<Item = Place>,
        (dash, gap): Place,
        width: f64,
        ink: RGBColor,
    ) -> Result<(), DrawError> {
        let places: Vec<(i32, i32)> = places.into_iter().map(at).collect();
        let style = ink.stroke_width(dots(width).unsigned_abs().max(1));
        let line = DashedPathElement::new(places, dots(dash), dots(gap), style);
        self.0.draw(&line).map_err(refused)
    }

    /// Draws a small ring.
    pub(super) fn ring(&self, place: Place, radius: f64, ink: RGBColor) -> Result<(), DrawError> {
        let style = ink.stroke_width(dots(0.6).unsigned_abs().max(1));
        self.0.draw(&Circle::new(at(place), dots(radius), style)).map_err(refused)
    }

    /// Fills a rectangle.
    pub(super) fn fill(&self, from: Place, to: Place, ink: RGBColor) -> Result<(), DrawError> {
        self.0.draw(&Rectangle::new([at(from), at(to)], ink.filled())).map_err(refused)
    }
}
