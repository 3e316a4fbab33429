//! The plate's displacement as pixels, and the scale of its colours.

use super::super::drawing::{DrawError, encode};
use super::super::page::{Ink, Page, Place};
use super::super::{PRINT_DOTS_PER_INCH, PRINT_WIDTH};
use super::Subject;
use super::layout::Layout;
use crate::colour_map;
use crate::field::displacement_map::{DisplacementMap, Wave};

/// Points per pixel: the resolution of the finished PNG, because print shows no finer pixels.
const PIXEL: f64 = 72.0 / PRINT_DOTS_PER_INCH;
/// Number of colours in the scale.
const SHADES: u32 = 256;

impl Subject {
    /// The colour of a displacement, given as a share of full colour.
    fn colour(&self, value: f64) -> Ink {
        if self.is_largest {
            colour_map::sequential(value.abs() as f32, false)
        } else {
            colour_map::diverging(value as f32, false)
        }
    }
}

/// Draws the colour scale into a rectangle: from zero (amplitude) or from the lowest value (signed) to full
/// colour.
pub(super) fn draw_scale(
    page: &mut Page,
    subject: &Subject,
    from: Place,
    to: Place,
) -> Result<(), DrawError> {
    let shade = |number: u32| {
        let share = (f64::from(number) + 0.5) / f64::from(SHADES);
        opaque(subject.colour(if subject.is_largest { share } else { 2.0 * share - 1.0 }))
    };
    let pixels: Vec<[u8; 4]> = (0..SHADES).map(shade).collect();
    page.picture(&encode((SHADES, 1), &pixels, None)?, from, to);
    Ok(())
}

/// Draws the displacement within the plate's outline.
pub(super) fn draw_field(page: &mut Page, subject: &Subject, layout: &Layout) -> Result<(), DrawError> {
    let plate = &subject.setup.plate;
    let map = DisplacementMap::new(Wave {
        plate,
        sounding: subject.sounding.as_ref(),
        sheet: subject.sheet.as_ref(),
        is_largest: subject.is_largest,
        time_s: subject.wave_time_s,
    });
    let full_m = subject.full_colour_m();
    let high = layout.half_width(plate.half_width_m(0.0));
    let count = |points: f64| (points / PIXEL).ceil().clamp(1.0, PRINT_WIDTH / PIXEL) as u32;
    let (columns, rows) = (count(layout.right - layout.left), count(2.0 * high));
    let across: Vec<_> = (0..columns)
        .map(|column| map.column(plate.length_m() * (f64::from(column) + 0.5) / f64::from(columns)))
        .collect();
    let mut pixels = Vec::with_capacity((columns * rows) as usize);
    for row in 0..rows {
        let down = high * (2.0 * (f64::from(row) + 0.5) / f64::from(rows) - 1.0);
        for column in &across {
            // Pixels on or outside the outline get the colour of the edge, so that clipping leaves no gap.
            let beta = (down / layout.half_width(column.half_width_m)).clamp(-1.0, 1.0);
            pixels.push(opaque(subject.colour(map.at(column, &map.row(beta)) / full_m)));
        }
    }
    let file = encode((columns, rows), &pixels, None)?;
    let (from, to) = ((layout.left, layout.centre - high), (layout.right, layout.centre + high));
    let outline = layout.edge(plate, -1.0).chain(layout.edge(plate, 1.0).rev());
    page.clipped(outline, |page| page.picture(&file, from, to));
    Ok(())
}

const fn opaque([red, green, blue]: Ink) -> [u8; 4] {
    [red, green, blue, u8::MAX]
}
