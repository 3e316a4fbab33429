//! The legend of a figure: line samples with their names, in rows.

use super::font;
use super::page::{Anchor, BLACK, Ink, Page, Pen, Place};

/// Length of a curve's sample, as a multiple of the text size.
const PIECE: f64 = 2.0;
/// Width of any other sample, as a multiple of the text size.
const NARROW: f64 = 0.8;

/// How a sample is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Sample {
    /// A piece of a curve.
    Line(Pen),
    /// A piece of a vertical line.
    Upright(Pen),
    /// A ring of this radius.
    Ring(Pen, f64),
    /// A dot of this radius.
    Dot(Ink, f64),
}

impl Sample {
    /// Its width beside text of this size.
    fn length(self, text: f64) -> f64 {
        match self {
            Self::Line(_) => PIECE * text,
            Self::Upright(_) | Self::Ring(..) | Self::Dot(..) => NARROW * text,
        }
    }

    fn draw(self, page: &mut Page, (x, y): Place, text: f64) {
        let length = self.length(text);
        let middle = x + 0.5 * length;
        match self {
            Self::Line(pen) => page.line([(x, y), (x + length, y)], pen),
            Self::Upright(pen) => page.line([(middle, y - 0.5 * text), (middle, y + 0.5 * text)], pen),
            Self::Ring(pen, radius) => page.ring((middle, y), radius, pen),
            Self::Dot(ink, radius) => page.dot((middle, y), radius, ink),
        }
    }
}

/// Height of a row of text of this size.
pub(super) const fn row_height(text: f64) -> f64 {
    1.35 * text
}

/// Draws the entries in rows no wider than `room`, the middle of the first row at `start`; returns the number of
/// rows.
pub(super) fn legend(
    page: &mut Page,
    entries: &[(String, Sample)],
    (left, first): Place,
    room: f64,
    text: f64,
) -> usize {
    let name_at = |sample: Sample| sample.length(text) + 0.5 * text;
    let wide = |(name, sample): &(String, Sample)| name_at(*sample) + font::width(name, text);
    let widths: Vec<f64> = entries.iter().map(wide).collect();
    let places = rows(&widths, room, 1.5 * text);
    for ((name, sample), &(along, row)) in entries.iter().zip(&places) {
        let (x, y) = (left + along, first + row as f64 * row_height(text));
        sample.draw(page, (x, y), text);
        page.text(name, (x + name_at(*sample), y), Anchor::Left, text, BLACK);
    }
    places.last().map_or(0, |&(_, row)| row + 1)
}

/// Places of items of the given widths in rows no wider than `room`: (left edge, row) each.
fn rows(widths: &[f64], room: f64, gap: f64) -> Vec<(f64, usize)> {
    let (mut left, mut row) = (0.0, 0);
    widths
        .iter()
        .map(|&wide| {
            if left > 0.0 && left + wide > room {
                (left, row) = (0.0, row + 1);
            }
            let place = (left, row);
            left += wide + gap;
            place
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_go_on_to_the_next_row_when_one_is_full() {
        assert_eq!(rows(&[40.0, 40.0, 40.0], 100.0, 10.0), [(0.0, 0), (50.0, 0), (0.0, 1)]);
        assert_eq!(rows(&[200.0, 20.0], 100.0, 10.0), [(0.0, 0), (0.0, 1)]);
    }
}
