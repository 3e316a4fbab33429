//! A plot: legend, axes, curves and vertical lines.

use super::axes::Axes;
use super::drawing::Drawing;
use super::legend::{Sample, legend, row_height};
use super::page::{Anchor, BLACK, Page, Pen, Place};
use super::{PRINT_DOTS_PER_INCH, PRINT_WIDTH};

/// Text size of the title, of all other text, and the margin around a plot that is alone on its page, in points.
pub(super) const TITLE: f64 = 11.0;
pub(super) const TEXT: f64 = 8.0;
const MARGIN: f64 = 8.0;

/// A curve over x.
pub(super) struct Curve {
    /// Its name in the legend; `None` leaves it out.
    pub(super) name: Option<String>,
    /// How it is drawn: as a line, or as rings or dots at its points.
    pub(super) sample: Sample,
    /// Points in the units of the axes, in drawing order.
    pub(super) points: Vec<Place>,
}

/// A vertical line.
pub(super) struct Upright {
    /// Its name in the legend; `None` leaves it out.
    pub(super) name: Option<String>,
    /// Where, in the unit of the x axis.
    pub(super) x: f64,
    /// The pen of the line.
    pub(super) pen: Pen,
}

/// The contents of a plot.
pub(super) struct Plot<'a> {
    /// Range of the x axis, in its unit.
    pub(super) x: (f64, f64),
    /// Range of the y axis, in its unit.
    pub(super) y: (f64, f64),
    /// Name of the x axis, with its unit.
    pub(super) x_name: &'a str,
    /// Name of the y axis, with its unit.
    pub(super) y_name: &'a str,
    /// The curves, in the order of the legend. A dashed curve lies above a solid one; of two solid ones the first
    /// lies on top.
    pub(super) curves: Vec<Curve>,
    /// Vertical lines, below the curves and behind them in the legend.
    pub(super) uprights: Vec<Upright>,
    /// Size of the text, in points.
    pub(super) text: f64,
}

impl Plot<'_> {
    /// Draws the plot alone on a page for print, under its title.
    pub(super) fn printed(&self, title: &str) -> Drawing {
        let (width, height) = (PRINT_WIDTH, 0.5 * PRINT_WIDTH);
        let mut page = Page::new((width, height), title);
        page.text(title, (MARGIN, MARGIN + 0.5 * TITLE), Anchor::Left, TITLE, BLACK);
        self.draw(&mut page, (MARGIN, 2.0 * MARGIN + TITLE), (width - MARGIN, height - MARGIN));
        page.finish(PRINT_DOTS_PER_INCH)
    }

    /// Draws the plot into the rectangle with these corners, in points.
    pub(super) fn draw(&self, page: &mut Page, (left, top): Place, (right, bottom): Place) {
        let text = self.text;
        let rows = legend(page, &self.entries(), (left, top + 0.5 * text), right - left, text);
        let mut axes = Axes {
            across: (left, right - text),
            down: (top + rows as f64 * row_height(text) + 0.5 * text, bottom - Axes::bottom_room(text)),
            x: self.x,
            y: self.y,
            text,
        };
        axes.across.0 += axes.left_room();
        axes.grid(page);
        axes.inside(page, |page| self.draw_inside(page, &axes));
        axes.frame(page, self.x_name, self.y_name);
    }

    fn entries(&self) -> Vec<(String, Sample)> {
        let curves = self.curves.iter().filter_map(|curve| Some((curve.name.clone()?, curve.sample)));
        let uprights = self.uprights.iter();
        let uprights = uprights.filter_map(|line| Some((line.name.clone()?, Sample::Upright(line.pen))));
        curves.chain(uprights).collect()
    }

    fn draw_inside(&self, page: &mut Page, axes: &Axes) {
        for upright in &self.uprights {
            let x = axes.at_x(upright.x);
            page.line([(x, axes.down.0), (x, axes.down.1)], upright.pen);
        }
        // Dashed curves come last, so that a prediction stays visible on top of the measurement it is compared
        // with.
        let (dashed, solid): (Vec<&Curve>, Vec<&Curve>) = self
            .curves
            .iter()
            .partition(|curve| matches!(curve.sample, Sample::Line(pen) if pen.is_dashed()));
        for curve in solid.into_iter().rev().chain(dashed) {
            let places = curve.points.iter().map(|&point| axes.at(point));
            match curve.sample {
                Sample::Line(pen) | Sample::Upright(pen) => page.line(places, pen),
                Sample::Ring(pen, radius) => places.for_each(|place| page.ring(place, radius, pen)),
                Sample::Dot(ink, radius) => places.for_each(|place| page.dot(place, radius, ink)),
            }
        }
    }
}
