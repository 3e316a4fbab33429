//! Fig. 5: the turning point follows the frequency.

use super::figure::{Figure, FigureError, Mark, Panel, Series, Stroke, magnitude, preset, solve};
use super::printed;
use crate::frequency::equation::Equation;

const FREQUENCIES_HZ: [f64; 2] = [40e3, 20e3];

pub(super) fn figure() -> Result<Figure, FigureError> {
    let plate = preset("al-bending")?;
    let name = |frequency_hz: f64| format!("{:.0} kHz", frequency_hz * 1e-3);
    let mut printed = (Vec::new(), Vec::new());
    let mut corrected = (Vec::new(), Vec::new());
    let mut top: f64 = 0.0;
    for (hue, frequency_hz) in FREQUENCIES_HZ.into_iter().enumerate() {
        let points = printed::in_aluminium(-60.0, 340.0, frequency_hz);
        printed.0.push(Series::new(name(frequency_hz), Stroke::Solid, hue, points));
        let x = printed::x0_in_aluminium_mm(frequency_hz);
        printed.1.push(Mark::new(format!("x0, {}", name(frequency_hz)), hue, x));

        let response = solve(&plate, frequency_hz, Equation::Corrected)?;
        let points = magnitude(&response);
        top = points.iter().map(|p| p.1).fold(top, f64::max);
        corrected.0.push(Series::new(name(frequency_hz), Stroke::Solid, hue, points));
        let x = response.turning_point_m * 1e3;
        corrected.1.push(Mark::new(format!("x0, {}", name(frequency_hz)), hue, x));
    }
    Ok(Figure {
        number: Some(5),
        stem: "fig05",
        title: "the turning point at 40 kHz and at 20 kHz",
        x_label: "x / mm",
        panels: [
            Panel {
                heading: "as printed",
                convention: &[
                    "(24), (35), (36): SH wave in aluminium, W0 = 2 cm, d = 4.62 /m: -6.7 and +143 mm.",
                    "This is a WIDENING plate driven from large x: a higher frequency moves the boundary to smaller x.",
                ],
                x_range: (-60.0, 340.0),
                y_range: (-1.0, 1.15),
                y_label: "f / largest f",
                series: printed.0,
                marks: printed.1,
            },
            Panel {
                heading: "corrected",
                convention: &[
                    "2 mm plate in bending, supported edges, half-width 2 cm, d = 4.62 /m, loss 0.002, matched drive.",
                    "x0 = (1/2d) ln(f/fc0): an octave moves the boundary by ln 2/(2d) = 75 mm, away from the drive.",
                ],
                x_range: (-60.0, 340.0),
                y_range: (0.0, 1.15 * top),
                y_label: "|f| over the drive",
                series: corrected.0,
                marks: corrected.1,
            },
        ],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::figure::highest_point;

    #[test]
    fn the_printed_boundaries_move_the_wrong_way() {
        let marks = &figure().expect("the preset shows it").panels[0].marks;
        let (forty, twenty) = (marks[0].x * 4.62e-3, marks[1].x * 4.62e-3);
        assert!((forty + 0.031).abs() < 5e-4 && (twenty - 0.662).abs() < 5e-4, "{forty} {twenty}");
    }

    #[test]
    fn the_corrected_boundaries_are_75_mm_apart_with_edges_of_30_and_38_mm() {
        let figure = figure().expect("the preset shows it");
        let panel = &figure.panels[1];
        let (forty, twenty) = (panel.marks[0].x * 4.62e-3, panel.marks[1].x * 4.62e-3);
        assert!((forty - 1.286).abs() < 1e-3 && (twenty - 0.939).abs() < 1e-3, "{forty} {twenty}");
        assert!((panel.marks[0].x - panel.marks[1].x - 75.0).abs() < 0.1);
        for (series, edge_mm) in panel.series.iter().zip([29.8, 37.4]) {
            let (x, height) = highest_point(&series.points);
            let tail = series.points.iter().find(|p| p.0 > x && p.1 < 0.1 * height).expect("decays").0;
            assert!((tail - x - edge_mm).abs() < 1.5, "{}: {}", series.name, tail - x);
        }
    }
}
