//! Fig. 9: the rubber plate at 30 and 40 Hz.

use super::figure::{Figure, FigureError, Mark, Panel, RATE_PER_M, Series, Stroke, magnitude, preset, solve};
use crate::definition::plate::Plate;
use crate::definition::spec::PlateSpec;
use crate::definition::taper::Taper;
use crate::frequency::equation::Equation;

const FREQUENCIES_HZ: [f64; 2] = [30.0, 40.0];

fn curves(plate: &Plate, equation: Equation) -> Result<(Vec<Series>, Vec<Mark>), FigureError> {
    let mut series = Vec::new();
    let mut marks = Vec::new();
    for (hue, frequency_hz) in FREQUENCIES_HZ.into_iter().enumerate() {
        let response = solve(plate, frequency_hz, equation)?;
        let name = format!("{frequency_hz} Hz");
        marks.push(Mark::new(format!("x0, {name}"), hue, response.turning_point_m * 1e3));
        series.push(Series::new(name, Stroke::Solid, hue, magnitude(&response)));
    }
    Ok((series, marks))
}

pub(super) fn figure() -> Result<Figure, FigureError> {
    let rig = preset("paper-rubber")?;
    // By the paper's own definition of W0 as a half-width, the plate is twice as wide as the rig's.
    let half_width_m = 0.1;
    let read_literally = Plate::new(PlateSpec {
        taper: Taper::Exponential { half_width_m, rate_per_m: RATE_PER_M },
        ..rig.spec().clone()
    })?;
    let (printed, printed_marks) = curves(&read_literally, Equation::Paper)?;
    let (corrected, marks) = curves(&rig, Equation::Corrected)?;
    let top = |series: &[Series]| {
        1.15 * series.iter().flat_map(|one| &one.points).map(|point| point.1).fold(0.0, f64::max)
    };
    let panel = |heading, convention: &'static [&'static str], series: Vec<Series>, marks| Panel {
        heading,
        convention,
        x_range: (0.0, 300.0),
        y_range: (0.0, top(&series)),
        y_label: "|f| / drive",
        series,
        marks,
    };
    Ok(Figure {
        number: Some(9),
        stem: "fig09",
        title: "largest amplitude in the rubber plate at 30 Hz and 40 Hz",
        x_label: "x / mm",
        panels: [
            panel(
                "as printed",
                &[
                    "\"W0 = 100 mm\" read as the half-width that section 2.1 defines; (13) without the (W'/W) term.",
                    "Vs = 5 m/s, d = 4.62 /m, loss 0.1, displacement drive: x0 = 189 and 252 mm, and |W'| = 0.46.",
                ],
                printed,
                printed_marks,
            ),
            panel(
                "corrected",
                &[
                    "The rig's 100 mm is the full width: half-width 50 mm, fc0 = 25 Hz; same rubber, with the term.",
                    "x0 = 39 and 102 mm; 30 Hz has no room for a peak. A bending plate would shift only half as far.",
                ],
                corrected,
                marks,
            ),
        ],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::figure::highest_point;

    #[test]
    fn the_corrected_turning_points_are_39_5_and_101_7_mm_a_shift_of_ln_4_thirds_over_d() {
        let marks = &figure().expect("the preset shows it").panels[1].marks;
        assert!((marks[0].x - 39.5).abs() < 0.05 && (marks[1].x - 101.7).abs() < 0.05, "{marks:?}");
        assert!((marks[1].x - marks[0].x - 287.7 / 4.62).abs() < 0.05);
    }

    #[test]
    fn read_literally_the_rig_turns_150_mm_farther_out_on_a_plate_that_is_not_slender() {
        let panel = &figure().expect("the preset shows it").panels[0];
        // (1/d) ln(f/12.5 Hz).
        for (mark, frequency_hz) in panel.marks.iter().zip(FREQUENCIES_HZ) {
            assert!((mark.x - 1e3 * (frequency_hz / 12.5_f64).ln() / 4.62).abs() < 0.01, "{mark:?}");
        }
    }

    #[test]
    fn at_30_hz_the_amplitude_only_falls_and_at_40_hz_it_has_an_edge() {
        let panel = &figure().expect("the preset shows it").panels[1];
        let slow = &panel.series[0].points;
        assert!(slow.windows(2).all(|pair| pair[1].1 < pair[0].1), "no peak at 30 Hz");
        let (x, height) = highest_point(&panel.series[1].points);
        let at_turn = panel.series[1].points.iter().find(|p| p.0 > panel.marks[1].x).expect("on it").1;
        assert!(x < panel.marks[1].x && at_turn < height, "{x} {height} {at_turn}");
    }
}
