//! The clamped strip: its exact law against the law near the cut-off.

use super::{preset, two_dimensions};
use crate::definition::drive::DriveEnd;
use crate::definition::model::Model;
use crate::definition::plate::Plate;
use crate::definition::source::EndSlope;
use crate::frequency::numerov::{self, Grid};
use crate::paper::figure::{Figure, FigureError, POINTS, Panel, Series, Stroke, magnitude, ramp};
use crate::plane::strip::wavenumber_squared;

/// The turning point, metres.
const BOUNDARY_M: f64 = 0.24;
const DOTS: usize = 12;

pub(super) fn figure() -> Result<Figure, FigureError> {
    let mut spec = preset("al-bending-displacement")?.spec().clone();
    if let Some(bending) = spec.model.bending().cloned() {
        spec.model = Model::BendingClamped(bending);
    }
    (spec.span_start_m, spec.span_end_m) = (0.1, 0.25);
    spec.loss_factor = 0.01;
    spec.drive_end = DriveEnd::DisplacementAndSlope { slope: EndSlope::Held };
    let plate = Plate::new(spec)?;
    let mode = plate.width_mode(1);
    let frequency_hz = plate.frequency_for_boundary_hz(BOUNDARY_M);
    let exact = |x: f64| mode.wavenumber_squared(x, frequency_hz);
    let tangent = |x: f64| mode.axial_squared(frequency_hz) - mode.width_term(x);
    let line = |square: &dyn Fn(f64) -> f64| -> Vec<(f64, f64)> {
        let places = ramp(0.0, 1e3 * BOUNDARY_M, POINTS);
        places.map(|x| (x, square(1e-3 * x).max(0.0).sqrt())).collect()
    };
    let dots = ramp(5.0, 1e3 * BOUNDARY_M - 5.0, DOTS).filter_map(|x| {
        let square = wavenumber_squared(&plate, 1e-3 * x, frequency_hz)?;
        Some((x, square.max(0.0).sqrt()))
    });

    let step_m = plate.length_m() / (POINTS - 1) as f64;
    let field = |grid: &Grid| -> Vec<(f64, f64)> {
        let f = numerov::solve(grid, &plate, frequency_hz);
        f.iter().enumerate().map(|(i, f)| (1e3 * i as f64 * step_m, f.norm())).collect()
    };
    let exact_field = Grid::new(&plate, crate::frequency::equation::Equation::Corrected, POINTS, 1);
    let tangent_field = Grid::tangent(&plate, POINTS, 1);
    let truth = magnitude(&two_dimensions(&plate, None, frequency_hz)?);
    Ok(Figure {
        number: None,
        stem: "clamped",
        title: "clamped edges: the exact law of the strip against the tangent at its cut-off",
        x_label: "x / mm",
        panels: [
            Panel {
                heading: "local wavenumber of a clamped plate",
                convention: &[
                    "Aluminium, 2 mm, turning at 240 mm; p tan p + r tanh r = 0 with p^2, r^2 = W^2 (K^2 -+ k^2).",
                ],
                x_range: (0.0, 300.0),
                y_range: (0.0, 500.0),
                y_label: "k / (1/m)",
                series: vec![
                    Series::new("exact law", Stroke::Solid, 0, line(&exact)),
                    Series::new("tangent at the cut-off", Stroke::Solid, 1, line(&tangent)),
                    Series::new("two dimensions", Stroke::Dots, 2, dots.collect()),
                ],
                marks: Vec::new(),
            },
            Panel {
                heading: "its field",
                convention: &["Loss factor 0.01; the end is clamped and moved."],
                x_range: (0.0, 300.0),
                y_range: (0.0, 3.0),
                y_label: "|w| over the drive",
                series: vec![
                    Series::new("exact law", Stroke::Solid, 0, field(&exact_field)),
                    Series::new("tangent at the cut-off", Stroke::Solid, 1, field(&tangent_field)),
                    Series::new("two dimensions", Stroke::Dashed, 2, truth),
                ],
                marks: Vec::new(),
            },
        ],
    })
}
