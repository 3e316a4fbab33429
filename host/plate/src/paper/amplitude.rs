//! Fig. 4: the amplitude in the aluminium plate at 40 kHz.

use super::figure::{Figure, FigureError, Mark, Panel, Series, Stroke, magnitude, preset, solve};
use super::printed;
use crate::frequency::equation::Equation;
use crate::special::airy;

const FREQUENCY_HZ: f64 = 40e3;

pub(super) fn figure() -> Result<Figure, FigureError> {
    let printed = printed::in_aluminium(-60.0, 340.0, FREQUENCY_HZ);
    let printed_x0_mm = printed::x0_in_aluminium_mm(FREQUENCY_HZ);

    let plate = preset("al-bending")?;
    let response = solve(&plate, FREQUENCY_HZ, Equation::Corrected)?;
    let without_term = solve(&plate, FREQUENCY_HZ, Equation::Paper)?;
    let x0 = response.turning_point_m;
    let kappa = airy::EDGE_WIDTH / response.edge_width_m;
    let peak = response.peak.map_or((0.0, 0.0), |peak| (peak.position_m, peak.amplitude));
    // The Airy form holds only near the turning point, so it is drawn from its third node on.
    let airy = response
        .position_m
        .iter()
        .filter(|&&x| kappa * (x - x0) > airy::NODES[2])
        .map(|&x| (x * 1e3, (airy::ai(kappa * (x - x0)) / airy::PEAK_VALUE).abs() * peak.1))
        .collect();
    let top = 1.15 * peak.1;
    Ok(Figure {
        number: Some(4),
        stem: "fig04",
        title: "amplitude in the aluminium plate, 40 kHz, W0 = 2 cm, wave put in at x = 0",
        x_label: "x / mm",
        panels: [
            Panel {
                heading: "as printed",
                convention: &[
                    "(24), (26), (35), (36): SH wave, Vs = 3103 m/s, W0 = 2 cm, d = 4.62 /m.",
                    "x0 = -6.7 mm: the turning point lies BEFORE the drive, the wave never turns.",
                ],
                x_range: (-60.0, 340.0),
                y_range: (-1.0, 1.15),
                y_label: "f / largest f",
                series: vec![Series::new("(35), (36)", Stroke::Solid, 0, printed)],
                marks: vec![Mark::new("x0 of (24)", 1, printed_x0_mm), Mark::new("drive", 5, 0.0)],
            },
            Panel {
                heading: "corrected",
                convention: &[
                    "2 mm plate in bending, supported edges, half-width 2 cm, d = 4.62 /m, loss 0.002, matched drive.",
                    "The peak stands 1.019/κ before x0; a standing wave before it, a tail behind it.",
                ],
                x_range: (-60.0, 340.0),
                y_range: (0.0, top),
                y_label: "|f| over the drive",
                series: vec![
                    Series::new("f'' + (W'/W) f' + k² f = 0", Stroke::Solid, 0, magnitude(&response)),
                    Series::new("without the (W'/W) term", Stroke::Dashed, 2, magnitude(&without_term)),
                    Series::new("|Ai|, scaled to the peak", Stroke::Dashed, 3, airy),
                ],
                marks: vec![Mark::new("x0", 1, x0 * 1e3), Mark::new("peak", 4, peak.0 * 1e3)],
            },
        ],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::figure::highest_point;
    use crate::paper::printed::ALUMINIUM_SPEED;

    #[test]
    fn the_printed_turning_point_lies_before_the_drive_and_its_peak_just_behind() {
        let figure = figure().expect("the preset shows it");
        let panel = &figure.panels[0];
        // d x0 = -0.031.
        assert!((panel.marks[0].x * 4.62e-3 + 0.031).abs() < 5e-4, "{:?}", panel.marks);
        let (x, height) = highest_point(&panel.series[0].points);
        // Edge width of the SH wave at 40 kHz: 69 mm in the Airy form (68 mm exactly), so 1.0188/kappa = 25.9 mm.
        let kappa = printed::kappa_per_m(FREQUENCY_HZ, ALUMINIUM_SPEED);
        assert!((2.7286 / kappa * 1e3 - 69.4).abs() < 0.1, "{}", 2.7286 / kappa);
        assert!((x - (panel.marks[0].x + 1018.793 / kappa)).abs() < 0.8 && height > 0.999, "{x} {height}");
    }

    #[test]
    fn the_corrected_peak_stands_before_278_mm_and_the_lost_term_changes_its_height() {
        let figure = figure().expect("the preset shows it");
        let panel = &figure.panels[1];
        let x0 = panel.marks[0].x;
        assert!((x0 * 4.62e-3 - 1.286).abs() < 1e-3, "{x0}");
        let (x, height) = highest_point(&panel.series[0].points);
        // x0 - 1.0188/kappa, kappa = 90.7/m: 267 mm.
        assert!((x - 267.1).abs() < 0.8 && (panel.marks[1].x - x).abs() < 0.6, "{x}");
        // W0/W = e^1.286 lifts the wave by e^0.64 = 1.9.
        let bare = highest_point(&panel.series[1].points).1;
        assert!((height / bare - 1.9).abs() < 0.15, "{height} {bare}");
        // One tenth of the peak 1.710/kappa behind x0.
        let tail = panel.series[0].points.iter().find(|p| p.0 > x && p.1 < 0.1 * height).expect("decays");
        assert!((tail.0 - (x0 + 18.85)).abs() < 1.2, "{tail:?}");
    }
}
