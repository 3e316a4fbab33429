//! Distance of the peak from that of the plate in two dimensions, with the turning width along the arc and straight
//! across.

use super::{preset, two_dimensions};
use crate::definition::plate::Plate;
use crate::definition::turning_width::TurningWidth;
use crate::frequency::equation::Equation;
use crate::frequency::respond::respond;
use crate::paper::figure::{Figure, FigureError, POINTS, Panel, Series, Stroke, ramp};

const BOUNDARIES: usize = 9;

pub(super) fn figure() -> Result<Figure, FigureError> {
    Ok(Figure {
        number: None,
        stem: "turning",
        title: "how far the peak of one dimension is from that of two",
        x_label: "boundary / mm",
        panels: [
            panel("al-sh", "preset al-sh", &["|W'| = 0.46 at 150 mm, 0.09 at 505 mm."], (-2.0, 16.0))?,
            panel("membrane", "preset membrane", &["|W'| = 0.16 at 80 mm, 0.06 at 280 mm."], (-0.5, 2.0))?,
        ],
    })
}

fn panel(
    name: &'static str,
    heading: &'static str,
    convention: &'static [&'static str],
    y_range: (f64, f64),
) -> Result<Panel, FigureError> {
    let preset = preset(name)?;
    let arc = preset.with_turning_width(TurningWidth::Arc);
    let plain = preset.with_turning_width(TurningWidth::Plain);
    let (start, end) = arc.span_m();
    // The peak is farther from the drive than a quarter of a wavelength.
    let places = ramp(start + 0.1 * (end - start), end, BOUNDARIES);
    let shifts = |plate: &Plate| -> Result<Vec<(f64, f64)>, FigureError> {
        let mut shifts = Vec::new();
        for boundary_m in places.clone() {
            let frequency_hz = arc.frequency_for_boundary_hz(boundary_m);
            let one_mode = respond(plate, frequency_hz, POINTS, Equation::Corrected)?.peak;
            let truth = two_dimensions(&arc, None, frequency_hz)?.peak;
            if let Some((one_mode, truth)) = one_mode.zip(truth) {
                shifts.push((1e3 * boundary_m, 1e3 * (one_mode.position_m - truth.position_m)));
            }
        }
        Ok(shifts)
    };
    let curves: Result<Vec<Series>, FigureError> = [("along the arc", &arc), ("straight across", &plain)]
        .into_iter()
        .enumerate()
        .map(|(hue, (name, plate))| Ok(Series::new(name, Stroke::Solid, hue, shifts(plate)?)))
        .collect();
    let (first, last) = (1e3 * start, 1e3 * end);
    Ok(Panel {
        heading,
        convention,
        x_range: (first, last),
        y_range,
        y_label: "peak, one dimension less two / mm",
        series: curves?,
        marks: Vec::new(),
    })
}
