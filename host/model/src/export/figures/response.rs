//! The amplitude along the plate at one frequency, relative to the drive's.

use super::drawing::Drawing;
use super::legend::Sample;
use super::page::{HUES, Pen};
use super::plot::{Curve, Plot, TEXT, Upright};
use slipline_plate::Response;
use slipline_plate::quantity::{show_frequency, show_place};

/// Largest number of points of the curve: two per pixel of the figure's width.
const MOST: usize = 4001;

/// Draws the response of the plate with this name.
#[must_use]
pub fn response_figure(response: &Response, plate: &str) -> Drawing {
    let places_mm = response.position_m.iter().map(|x_m| x_m * 1e3);
    let amplitudes = response.amplitude.iter().map(|amplitude| amplitude.norm());
    let step = response.position_m.len().div_ceil(MOST).max(1);
    let highest = amplitudes.clone().fold(0.0, f64::max);
    let length_mm = response.position_m.last().map_or(1.0, |x_m| x_m * 1e3);
    let peak_m = response.peak.map(|peak| peak.position_m);
    let marked = [("turning point", Some(response.turning_point_m), 1), ("peak", peak_m, 4)];
    let uprights = marked.into_iter().filter_map(|(name, place_m, hue)| {
        // If the wave reaches the plate's end, its turning point lies beyond the end.
        let place_m = place_m.filter(|place_m| place_m * 1e3 <= length_mm)?;
        let name = Some(format!("{name} {}", show_place(place_m)));
        Some(Upright { name, x: place_m * 1e3, pen: Pen::solid(HUES[hue], 0.8) })
    });
    let plot = Plot {
        x: (0.0, length_mm),
        y: (0.0, if highest > 0.0 { 1.08 * highest } else { 1.0 }),
        x_name: "x from the driven end (mm)",
        y_name: "amplitude / drive",
        curves: vec![Curve {
            name: Some("amplitude".to_owned()),
            sample: Sample::Line(Pen::solid(HUES[0], 1.0)),
            points: places_mm.zip(amplitudes).step_by(step).collect(),
        }],
        uprights: uprights.collect(),
        text: TEXT,
    };
    plot.printed(&format!("{plate} at {}", show_frequency(response.frequency_hz)))
}
