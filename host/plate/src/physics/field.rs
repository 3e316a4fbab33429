//! The field along the centre line in one and in two dimensions: a membrane, and a plate in bending with its lead-in.

use super::{PLANE_POINTS, one_dimension, preset, two_dimensions};
use crate::definition::plate::Plate;
use crate::paper::figure::{Figure, FigureError, Mark, Panel, Series, Stroke, magnitude, ramp};
use crate::plane::{Field, Setup};

const MEMBRANE_HZ: f64 = 150.0;
const BENDING_HZ: f64 = 28e3;

pub(super) fn figure() -> Result<Figure, FigureError> {
    let (membrane, bending) = (preset("membrane")?, preset("al-bending")?);
    let both = |plate: &Plate, hz: f64| -> Result<Vec<Series>, FigureError> {
        Ok(vec![
            Series::new("one dimension", Stroke::Solid, 0, one_dimension(plate, None, hz)?),
            Series::new("two dimensions", Stroke::Dashed, 1, magnitude(&two_dimensions(plate, None, hz)?)),
        ])
    };
    let turning = |plate: &Plate, hz: f64| {
        Mark::new("turning point", 5, plate.turning_point_m(hz).unwrap_or(f64::NAN) * 1e3)
    };
    let mut with_lead_in = both(&bending, BENDING_HZ)?;
    let setup = Setup::of(&bending);
    let length_mm = setup.lead_in.map_or(0.0, |lead_in| lead_in.length_m * 1e3);
    let field = Field::solve(&bending, BENDING_HZ, &setup)?;
    let behind = ramp(-length_mm, 0.0, PLANE_POINTS).map(|x| (x, field.at(x * 1e-3, 0.0).norm()));
    with_lead_in.push(Series::new("lead-in, two dimensions", Stroke::Dashed, 2, behind.collect()));
    Ok(Figure {
        number: None,
        stem: "field",
        title: "the field along the centre line, by one dimension and by two",
        x_label: "x / mm",
        panels: [
            Panel {
                heading: "preset membrane at 150 Hz",
                convention: &["Matched damper at x = 0; |W'| = 0.23 there and 0.09 at the boundary."],
                x_range: (0.0, 320.0),
                y_range: (0.0, 3.0),
                y_label: "|w| over the drive",
                series: both(&membrane, MEMBRANE_HZ)?,
                marks: vec![turning(&membrane, MEMBRANE_HZ)],
            },
            Panel {
                heading: "preset al-bending at 28 kHz",
                convention: &[
                    "A force at x = 0; behind it the lead-in, whose loss takes the returning wave in.",
                ],
                x_range: (-80.0, 320.0),
                y_range: (0.0, 5.0),
                y_label: "|w| over the drive",
                series: with_lead_in,
                marks: vec![turning(&bending, BENDING_HZ)],
            },
        ],
    })
}
