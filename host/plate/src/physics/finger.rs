//! Effect of a finger on the peak of a light membrane and of a heavy one.

use super::{one_dimension, preset, two_dimensions};
use crate::frequency::finger::Finger;
use crate::paper::figure::{Figure, FigureError, Mark, Panel, Series, Stroke, magnitude};

const FREQUENCY_HZ: f64 = 130.0;

pub(super) fn figure() -> Result<Figure, FigureError> {
    Ok(Figure {
        number: None,
        stem: "finger",
        title: "a finger on the peak (lines: one dimension, dashes: two)",
        x_label: "x / mm",
        panels: [
            panel("membrane", "preset membrane (40 N/m) at 130 Hz")?,
            panel("membrane-heavy", "preset membrane-heavy (400 N/m) at 130 Hz")?,
        ],
    })
}

fn panel(name: &'static str, heading: &'static str) -> Result<Panel, FigureError> {
    let plate = preset(name)?;
    let free = two_dimensions(&plate, None, FREQUENCY_HZ)?;
    let place_m = free.peak.map_or(free.turning_point_m, |peak| peak.position_m);
    let mut curves = Vec::new();
    for (hue, (name, finger)) in [
        ("no finger", None),
        ("light touch", Some(Finger::light(place_m))),
        ("firm press", Some(Finger::firm(place_m))),
    ]
    .into_iter()
    .enumerate()
    {
        let computed = one_dimension(&plate, finger.as_ref(), FREQUENCY_HZ)?;
        curves.push(Series::new(name, Stroke::Solid, hue, computed));
        let truth = magnitude(&two_dimensions(&plate, finger, FREQUENCY_HZ)?);
        curves.push(Series::new(format!("{name}, 2-D"), Stroke::Dashed, hue, truth));
    }
    Ok(Panel {
        heading,
        convention: &[
            "Light: 0.1 N s/m and 0.01 g; firm: 1 N s/m and 0.1 g; contact 10 mm wide (illustrative).",
        ],
        x_range: (0.0, 320.0),
        y_range: (0.0, 3.0),
        y_label: "|w| over the drive",
        series: curves,
        marks: vec![Mark::new("finger", 5, place_m * 1e3)],
    })
}
