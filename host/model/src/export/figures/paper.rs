//! A figure of the paper or of the physics page on a page: title, then two panels, each with its heading, convention, legend and plot.

use super::drawing::Drawing;
use super::font;
use super::legend::{Sample, row_height};
use super::page::{Anchor, BLACK, HUES, Ink, Page, Pen, Place};
use super::plot::{Curve, Plot, Upright};
use slipline_plate::paper::{Figure, Panel, Stroke};

/// Width and height of the page, in points.
const SIZE: Place = (620.0, 250.0);
/// Dots per inch of the PNG: 1240 x 500 pixels.
const DOTS_PER_INCH: f64 = 144.0;
/// Size of the title's text, of a heading's, and of all other text, in points.
const TITLE: f64 = 8.6;
const HEADING: f64 = 7.4;
const TEXT: f64 = 6.5;
/// Margin around the title and left and right of a panel, in points.
const MARGIN: f64 = 7.0;
/// Top of the panels, in points.
const TOP: f64 = 20.0;
/// The convention under the heading.
const REMARK: Ink = [40, 40, 40];

/// Draws a figure of the paper or of the physics page.
#[must_use]
pub fn paper_figure(figure: &Figure) -> Drawing {
    let title = figure.heading();
    let mut page = Page::new(SIZE, &title);
    page.text(&title, (MARGIN, 0.5 * TOP - 1.0), Anchor::Left, TITLE, BLACK);
    let width = SIZE.0 / figure.panels.len() as f64;
    for (number, panel) in figure.panels.iter().enumerate() {
        let left = number as f64 * width;
        draw_panel(&mut page, (left + MARGIN, left + width - MARGIN), figure, panel);
    }
    page.finish(DOTS_PER_INCH)
}

fn draw_panel(page: &mut Page, (left, right): (f64, f64), figure: &Figure, panel: &Panel) {
    page.text(panel.heading, (left, TOP + 0.5 * HEADING), Anchor::Left, HEADING, BLACK);
    let mut y = TOP + HEADING + 4.0;
    for sentence in panel.convention {
        for line in font::wrapped(sentence, TEXT, right - left) {
            page.text(&line, (left, y + 0.5 * TEXT), Anchor::Left, TEXT, REMARK);
            y += row_height(TEXT);
        }
    }
    plot(figure, panel).draw(page, (left, y + 2.0), (right, SIZE.1 - 4.0));
}

fn plot<'a>(figure: &'a Figure, panel: &'a Panel) -> Plot<'a> {
    let curves = panel.series.iter().map(|series| Curve {
        // The second branch of a curve, and its dots by two dimensions, have the colour of the first and no legend entry.
        name: (![", Im", ", 2-D"].iter().any(|ending| series.name.ends_with(ending)))
            .then(|| series.name.clone()),
        sample: match series.stroke {
            Stroke::Solid => Sample::Line(Pen::solid(hue(series.hue), 1.3)),
            // Long dashes: on a solid curve of similar brightness both colours stay visible.
            Stroke::Dashed => Sample::Line(Pen::dashed(hue(series.hue), 1.0, (5.0, 4.0))),
            Stroke::Dots => Sample::Dot(hue(series.hue), 2.0),
        },
        points: series.points.clone(),
    });
    let uprights = panel.marks.iter().map(|mark| Upright {
        name: Some(format!("{} = {:.1} mm", mark.name, mark.x)),
        x: mark.x,
        pen: Pen::solid(hue(mark.hue), 0.6),
    });
    Plot {
        x: panel.x_range,
        y: panel.y_range,
        x_name: figure.x_label,
        y_name: panel.y_label,
        curves: curves.collect(),
        uprights: uprights.collect(),
        text: TEXT,
    }
}

fn hue(number: usize) -> Ink {
    HUES[number % HUES.len()]
}
