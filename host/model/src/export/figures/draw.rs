//! One figure on a canvas: title, then two panels, each with its heading, convention, legend and plot.

use super::layout::{OVERSAMPLING, SIZE, pixels, rows, wrapped};
use super::png_file::{self, Shades};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};
use slipline_plate::number_format::rounded;
use slipline_plate::paper::{Figure, Panel, Stroke};
use std::sync::OnceLock;
use thiserror::Error;

/// The name the embedded font is registered under.
const FONT: &str = "slipline-figures";

/// Colours that stay apart for colour-blind readers (Okabe and Ito), by a curve's hue.
pub(super) const HUES: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 60, 160),
    RGBColor(90, 90, 90),
];

/// Why a picture could not be drawn.
#[derive(Debug, Error)]
pub enum DrawError {
    /// The canvas refused.
    #[error("the figure could not be drawn: {0}")]
    Canvas(String),
    /// The PNG writer refused.
    #[error("the picture could not be encoded: {0}")]
    Png(#[from] png::EncodingError),
}

pub(super) fn refused(error: impl std::fmt::Display) -> DrawError {
    DrawError::Canvas(error.to_string())
}

type Area<'a> = DrawingArea<BitMapBackend<'a>, Shift>;

/// The figure as a PNG file.
pub(super) fn picture(figure: &Figure) -> Result<Vec<u8>, DrawError> {
    embed_font()?;
    let (width, height) = (SIZE.0 * OVERSAMPLING, SIZE.1 * OVERSAMPLING);
    let mut rgb = vec![255; (width * height * 3) as usize];
    {
        let canvas = BitMapBackend::with_buffer(&mut rgb, (width, height)).into_drawing_area();
        canvas.fill(&WHITE).map_err(refused)?;
        let (title, panels) = canvas.split_vertically(px(pixels::TITLE_STRIP));
        let text = format!("Fig. {}: {}", figure.number, figure.title);
        put(&title, &text, pixels::TITLE, (px(pixels::MARGIN), px(8)), BLACK)?;
        for (area, panel) in panels.split_evenly((1, 2)).iter().zip(&figure.panels) {
            draw_panel(area, figure, panel)?;
        }
        canvas.present().map_err(refused)?;
    }
    Ok(png_file::encode(&rgb, (width, height), OVERSAMPLING, Shades::Few)?)
}

/// Makes the embedded font known to the canvas: pictures look alike on every machine, with no font installed.
fn embed_font() -> Result<(), DrawError> {
    static READY: OnceLock<bool> = OnceLock::new();
    let ready = *READY
        .get_or_init(|| register_font(FONT, FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT).is_ok());
    if ready { Ok(()) } else { Err(DrawError::Canvas("the embedded font cannot be read".to_owned())) }
}

/// The embedded font, this many dots of the canvas high. There is no other way to it, so nothing can be measured or
/// put before the canvas knows it.
pub(super) fn embedded_font(dots: i32) -> Result<FontDesc<'static>, DrawError> {
    embed_font()?;
    Ok((FONT, dots).into_font())
}

/// Pixels of the finished picture on the canvas.
fn px(finished: u32) -> i32 {
    (finished * OVERSAMPLING) as i32
}

fn font(size: u32, colour: RGBColor) -> TextStyle<'static> {
    (FONT, px(size)).into_font().color(&colour)
}

fn put(area: &Area<'_>, text: &str, size: u32, at: (i32, i32), colour: RGBColor) -> Result<(), DrawError> {
    area.draw_text(text, &font(size, colour), at).map_err(refused)
}

fn text_width(area: &Area<'_>, text: &str) -> u32 {
    area.estimate_text_size(text, &font(pixels::TEXT, BLACK)).map_or(0, |size| size.0)
}

fn hue(number: usize) -> RGBColor {
    HUES[number % HUES.len()]
}

fn draw_panel(area: &Area<'_>, figure: &Figure, panel: &Panel) -> Result<(), DrawError> {
    let margin = px(pixels::MARGIN);
    let width = area.dim_in_pixel().0.saturating_sub(2 * margin.unsigned_abs());
    put(area, panel.heading, pixels::HEADING, (margin, 0), BLACK)?;
    let mut y = px(pixels::LINE + 4);
    for sentence in &panel.convention {
        for line in wrapped(sentence, width, |text| text_width(area, text)) {
            put(area, &line, pixels::TEXT, (margin, y), RGBColor(40, 40, 40))?;
            y += px(pixels::LINE);
        }
    }
    y = draw_legend(area, panel, (margin, y + px(4)), width)?;
    let (_, plot) = area.split_vertically(y);
    draw_plot(&plot, figure, panel)
}

/// Draws the legend and returns where it ends.
fn draw_legend(
    area: &Area<'_>,
    panel: &Panel,
    (left, top): (i32, i32),
    width: u32,
) -> Result<i32, DrawError> {
    let mut entries: Vec<(String, usize, Sample)> = Vec::new();
    for series in &panel.series {
        // The second branch of a curve has its colour and its name already.
        if !series.name.ends_with(", Im") {
            entries.push((series.name.clone(), series.hue, Sample::Line(series.stroke)));
        }
    }
    for mark in &panel.marks {
        entries.push((format!("{} = {:.1} mm", mark.name, mark.x), mark.hue, Sample::Mark));
    }
    let sample = px(pixels::SAMPLE);
    let gap = px(6);
    let widths: Vec<u32> =
        entries.iter().map(|entry| text_width(area, &entry.0) + (sample + gap).unsigned_abs()).collect();
    let places = rows(&widths, width, px(14).unsigned_abs());
    let mut bottom = top;
    for ((text, number, kind), (x, row)) in entries.iter().zip(places) {
        let (x, y) = (left + x as i32, top + px(pixels::LINE) * row as i32);
        let middle = y + px(pixels::TEXT) / 2;
        let style = hue(*number).stroke_width(px(2).unsigned_abs());
        let refuse = |error| refused(error);
        match kind {
            Sample::Line(Stroke::Solid) => {
                area.draw(&PathElement::new([(x, middle), (x + sample, middle)], style)).map_err(refuse)?;
            }
            Sample::Line(Stroke::Dashed) => {
                for part in 0..3 {
                    let start = x + sample * part / 3;
                    let dash = [(start, middle), (start + sample / 5, middle)];
                    area.draw(&PathElement::new(dash, style)).map_err(refuse)?;
                }
            }
            Sample::Mark => {
                let at = x + sample / 2;
                let line = [(at, y), (at, y + px(pixels::TEXT))];
                area.draw(&PathElement::new(line, hue(*number).stroke_width(px(1).unsigned_abs())))
                    .map_err(refuse)?;
            }
        }
        put(area, text, pixels::TEXT, (x + sample + gap, y), BLACK)?;
        bottom = bottom.max(y + px(pixels::LINE));
    }
    Ok(bottom + px(2))
}

/// How a legend entry is drawn.
enum Sample {
    Line(Stroke),
    Mark,
}

fn draw_plot(area: &Area<'_>, figure: &Figure, panel: &Panel) -> Result<(), DrawError> {
    let (x, y) = (panel.x_range, panel.y_range);
    let mut chart = ChartBuilder::on(area)
        .margin(px(4))
        .margin_left(px(pixels::MARGIN))
        .margin_right(px(pixels::MARGIN))
        .set_label_area_size(LabelAreaPosition::Left, px(56))
        .set_label_area_size(LabelAreaPosition::Bottom, px(42))
        .build_cartesian_2d(x.0..x.1, y.0..y.1)
        .map_err(refused)?;
    let grey = RGBColor(225, 225, 225);
    chart
        .configure_mesh()
        .x_labels(8)
        .y_labels(6)
        .bold_line_style(grey.stroke_width(px(1).unsigned_abs()))
        .light_line_style(WHITE)
        .axis_style(BLACK.stroke_width(px(1).unsigned_abs()))
        .label_style(font(pixels::TEXT, BLACK))
        .axis_desc_style(font(pixels::TEXT, BLACK))
        .x_desc(figure.x_label)
        .y_desc(panel.y_label)
        .x_label_formatter(&|value| format!("{value:.0}"))
        .y_label_formatter(&|value| rounded(*value, 2))
        .draw()
        .map_err(refused)?;
    for mark in &panel.marks {
        let style = hue(mark.hue).stroke_width(px(1).unsigned_abs());
        chart.draw_series([PathElement::new([(mark.x, y.0), (mark.x, y.1)], style)]).map_err(refused)?;
    }
    // Dashed curves last: what is compared lies on top of what it is compared with.
    let (solid, dashed): (Vec<_>, Vec<_>) =
        panel.series.iter().partition(|series| series.stroke == Stroke::Solid);
    for series in solid.into_iter().rev().chain(dashed) {
        let style = hue(series.hue).stroke_width(px(2).unsigned_abs());
        // The canvas would press what lies outside onto its border.
        let inside = |p: &(f64, f64)| p.0 >= x.0 && p.0 <= x.1 && p.1 >= y.0 && p.1 <= y.1;
        let points = series.points.iter().copied().filter(inside);
        match series.stroke {
            Stroke::Solid => chart.draw_series(LineSeries::new(points, style)).map(drop),
            Stroke::Dashed => chart.draw_series(DashedLineSeries::new(points, px(6), px(5), style)).map(drop),
        }
        .map_err(refused)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::png_file::tests::decoded;
    use super::*;
    use slipline_plate::paper::figures;

    /// RGB pixels of a figure's file.
    fn pixels_of(figure: &Figure) -> (u32, u32, Vec<[u8; 3]>) {
        let (width, height, data) = decoded(&picture(figure).expect("drawn"));
        (width, height, data.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect())
    }

    #[test]
    fn both_panels_hold_their_curves_and_the_file_is_small() {
        for figure in figures().expect("computed") {
            assert!(picture(&figure).expect("drawn").len() < 100_000, "Fig. {}", figure.number);
            let (width, height, data) = pixels_of(&figure);
            assert_eq!((width, height), SIZE);
            let blue = |from: u32, to: u32| {
                let near = |p: &[u8; 3]| p[0] < 40 && (85..150).contains(&p[1]) && p[2] > 140;
                (0..data.len() as u32)
                    .filter(|i| (from..to).contains(&(i % width)) && near(&data[*i as usize]))
                    .count()
            };
            assert!(blue(0, width / 2) > 300 && blue(width / 2, width) > 300, "Fig. {}", figure.number);
        }
    }
}
