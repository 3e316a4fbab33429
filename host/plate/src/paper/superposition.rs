//! Fig. 7: two tones, two peaks.

use super::figure::{Figure, FigureError, Mark, Panel, Series, Stroke, magnitude, preset, solve};
use super::printed;
use crate::frequency::equation::Equation;

const FREQUENCIES_HZ: [f64; 2] = [5e3, 40e3];

pub(super) fn figure() -> Result<Figure, FigureError> {
    let name = |frequency_hz: f64| format!("{:.0} kHz", frequency_hz * 1e-3);
    let x0 = |i: usize, x: f64| Mark::new(format!("x0, {}", name(FREQUENCIES_HZ[i])), i + 1, x);
    let [low, high] = FREQUENCIES_HZ.map(|f| printed::in_aluminium(-100.0, 700.0, f));
    let printed_sum = low.iter().zip(high).map(|(a, b)| (a.0, a.1 + b.1)).collect();
    let printed_marks = [0, 1].map(|i| x0(i, printed::x0_in_aluminium_mm(FREQUENCIES_HZ[i])));

    let plate = preset("al-bending")?;
    let mut tones: Vec<Series> = Vec::new();
    let mut marks = Vec::new();
    for (i, frequency_hz) in FREQUENCIES_HZ.into_iter().enumerate() {
        let response = solve(&plate, frequency_hz, Equation::Corrected)?;
        let mut points = magnitude(&response);
        // A drive table makes the peaks equal, so the curves are scaled to a peak of 1.
        points.iter_mut().for_each(|point| point.1 /= response.height());
        tones.push(Series::new(name(frequency_hz), Stroke::Dashed, i + 1, points));
        marks.push(x0(i, response.turning_point_m * 1e3));
    }
    let rms = tones[0].points.iter().zip(&tones[1].points).map(|(a, b)| (a.0, a.1.hypot(b.1))).collect();
    let mut corrected = vec![Series::new("both: root of the sum of squares", Stroke::Solid, 0, rms)];
    corrected.extend(tones);
    Ok(Figure {
        number: Some(7),
        stem: "fig07",
        title: "a wave of 5 kHz and 40 kHz together",
        x_label: "x / mm",
        panels: [
            Panel {
                heading: "as printed",
                convention: &[
                    "(24), (35), (36) for both frequencies, added; SH wave in aluminium, W0 = 2 cm, d = 4.62 /m.",
                    "x0 = -6.7 mm and +443 mm, each oscillating toward LARGER x.",
                ],
                x_range: (-100.0, 700.0),
                y_range: (-1.6, 2.0),
                y_label: "f, each tone's largest = 1",
                series: vec![Series::new("5 kHz + 40 kHz", Stroke::Solid, 0, printed_sum)],
                marks: printed_marks.into(),
            },
            Panel {
                heading: "corrected",
                convention: &[
                    "2 mm plate in bending, supported edges, half-width 2 cm, d = 4.62 /m, loss 0.002, matched drive.",
                    "Each tone scaled to a peak of 1; tones of different frequency add in power.",
                ],
                x_range: (0.0, 340.0),
                y_range: (0.0, 1.6),
                y_label: "|f| / peak of one tone",
                series: corrected,
                marks,
            },
        ],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::figure::highest_point;

    #[test]
    fn the_printed_peaks_are_450_mm_apart_in_the_wrong_order() {
        let marks = &figure().expect("the preset shows it").panels[0].marks;
        assert!((marks[0].x * 4.62e-3 - 2.049).abs() < 1e-3, "{marks:?}");
        assert!((marks[1].x * 4.62e-3 + 0.031).abs() < 1e-3, "{marks:?}");
    }

    #[test]
    fn the_corrected_plate_has_one_peak_near_the_drive_and_one_near_its_end() {
        let figure = figure().expect("the preset shows it");
        let panel = &figure.panels[1];
        assert!((panel.marks[0].x * 4.62e-3 - 0.246).abs() < 1e-3, "{:?}", panel.marks);
        assert!((panel.marks[1].x * 4.62e-3 - 1.286).abs() < 1e-3, "{:?}", panel.marks);
        for (tone, mark) in panel.series[1..].iter().zip(&panel.marks) {
            let (x, height) = highest_point(&tone.points);
            assert!(
                (height - 1.0).abs() < 2e-3 && x < mark.x && mark.x - x < 30.0,
                "{}: {x} {height}",
                tone.name
            );
        }
        // Powers add: the sum is nowhere below either tone, and at the far peak the near tone has decayed.
        for ((sum, a), b) in
            panel.series[0].points.iter().zip(&panel.series[1].points).zip(&panel.series[2].points)
        {
            assert!(sum.1 >= a.1.max(b.1) && sum.1 <= a.1 + b.1 + 1e-12);
        }
        let far = panel.series[0].points.iter().copied().filter(|p| p.0 > 200.0).collect::<Vec<_>>();
        assert!((highest_point(&far).1 - 1.0).abs() < 5e-3);
    }
}
