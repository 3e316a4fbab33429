//! A pair of axes on a page: frame, round numbers and names, and the clipped drawing inside.

use super::font;
use super::page::{Anchor, BLACK, GRID, Page, Pen, Place};
use slipline_plate::quantity::ticks::Ticks;

/// Smallest distance of two numbers on an axis, in multiples of the text size: along x and along y.
const SPACING: Place = (4.5, 3.2);
/// Length of a tick mark, in points.
const TICK: f64 = 3.0;

const FRAME: Pen = Pen::solid(BLACK, 0.6);
const LINE: Pen = Pen::solid(GRID, 0.4);

/// Axes with linear scales.
#[derive(Clone, Copy)]
pub(super) struct Axes {
    /// Left and right end on the page, in points.
    pub(super) across: (f64, f64),
    /// Top and bottom on the page, in points.
    pub(super) down: (f64, f64),
    /// Values at the left and the right end.
    pub(super) x: (f64, f64),
    /// Values at the bottom and the top.
    pub(super) y: (f64, f64),
    /// Size of the text, in points.
    pub(super) text: f64,
}

impl Axes {
    /// Position of a value of x on the page.
    pub(super) fn at_x(&self, value: f64) -> f64 {
        let (left, right) = self.across;
        left + (value - self.x.0) / (self.x.1 - self.x.0) * (right - left)
    }

    /// Position of a value of y on the page.
    pub(super) fn at_y(&self, value: f64) -> f64 {
        let (top, bottom) = self.down;
        bottom - (value - self.y.0) / (self.y.1 - self.y.0) * (bottom - top)
    }

    /// Position of a point on the page.
    pub(super) fn at(&self, (x, y): Place) -> Place {
        (self.at_x(x), self.at_y(y))
    }

    /// The frame's corners.
    fn corners(&self) -> [Place; 4] {
        let ((left, right), (top, bottom)) = (self.across, self.down);
        [(left, top), (right, top), (right, bottom), (left, bottom)]
    }

    fn x_ticks(&self) -> Ticks {
        let per_point = (self.x.1 - self.x.0) / (self.across.1 - self.across.0);
        Ticks::between(self.x.0, self.x.1, SPACING.0 * self.text * per_point)
    }

    fn y_ticks(&self) -> Ticks {
        let per_point = (self.y.1 - self.y.0) / (self.down.1 - self.down.0);
        Ticks::between(self.y.0, self.y.1, SPACING.1 * self.text * per_point)
    }

    /// Width needed left of the frame by the numbers and the name of the y axis.
    pub(super) fn left_room(&self) -> f64 {
        let ticks = self.y_ticks();
        let widths = ticks.places.iter().map(|&place| font::width(&ticks.label(place), self.text));
        widths.fold(0.0, f64::max) + TICK + 2.0 + 1.8 * self.text
    }

    /// Height needed below the frame by the numbers and the name of the x axis, for text of this size.
    pub(super) const fn bottom_room(text: f64) -> f64 {
        TICK + 3.1 * text
    }

    /// Draws grid lines at the round numbers. Call it first, so that the curves lie on top.
    pub(super) fn grid(&self, page: &mut Page) {
        let ((left, right), (top, bottom)) = (self.across, self.down);
        for place in self.x_ticks().places {
            page.line([(self.at_x(place), top), (self.at_x(place), bottom)], LINE);
        }
        for place in self.y_ticks().places {
            page.line([(left, self.at_y(place)), (right, self.at_y(place))], LINE);
        }
    }

    /// Draws the frame, the numbers and the names.
    pub(super) fn frame(&self, page: &mut Page, x_name: &str, y_name: &str) {
        let ((left, right), (top, bottom)) = (self.across, self.down);
        let ticks = self.x_ticks();
        for &place in &ticks.places {
            let x = self.at_x(place);
            page.line([(x, bottom), (x, bottom + TICK)], FRAME);
            let below = bottom + TICK + 0.7 * self.text;
            page.text(&ticks.label(place), (x, below), Anchor::Centre, self.text, BLACK);
        }
        let below = bottom + TICK + 2.0 * self.text;
        page.text(x_name, (0.5 * (left + right), below), Anchor::Centre, self.text, BLACK);
        let ticks = self.y_ticks();
        for &place in &ticks.places {
            let y = self.at_y(place);
            page.line([(left - TICK, y), (left, y)], FRAME);
            page.text(&ticks.label(place), (left - TICK - 2.0, y), Anchor::Right, self.text, BLACK);
        }
        page.upward(y_name, (left - self.left_room() + 0.7 * self.text, 0.5 * (top + bottom)), self.text);
        let corners = self.corners();
        page.line(corners.into_iter().chain([corners[0]]), FRAME);
    }

    /// Draws inside the frame, clipped to it.
    pub(super) fn inside(&self, page: &mut Page, draw: impl FnOnce(&mut Page)) {
        page.clipped(self.corners(), draw);
    }
}
