//! Fig. 3: the plate's potential and the turning point, with the paper's sign and the right one.

use super::figure::{Figure, Mark, POINTS, Panel, RATE_PER_M, Series, Stroke, ramp};
use super::printed;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Wave speed of the rubber sheet, m/s.
const SPEED: f64 = 5.0;
/// Half-width at x = 0, metres.
const HALF_WIDTH_M: f64 = 0.05;
/// Frequency of the drive, Hz.
const FREQUENCY_HZ: f64 = 40.0;
/// x axis, mm.
const RANGE_MM: (f64, f64) = (-200.0, 200.0);

/// The potential V = (pi/2W)^2 with W = W0 e^(-sign d x), 1/m^2.
fn potential(x_m: f64, sign: f64) -> f64 {
    (FRAC_PI_2 / HALF_WIDTH_M).powi(2) * (2.0 * sign * RATE_PER_M * x_m).exp()
}

/// The "energy" E = (omega/Vs)^2, 1/m^2: the wave turns where V = E.
fn energy() -> f64 {
    (TAU * FREQUENCY_HZ / SPEED).powi(2)
}

/// The turning point (1/d) ln(f/fc0), metres: minus the printed one.
fn turning_point_m() -> f64 {
    -printed::turning_point_m(FREQUENCY_HZ, SPEED, HALF_WIDTH_M)
}

pub(super) fn figure() -> Figure {
    let over = |from: f64, value: &dyn Fn(f64) -> f64| -> Vec<(f64, f64)> {
        ramp(from, RANGE_MM.1, POINTS).map(|x| (x, value(x * 1e-3) * 1e-3)).collect()
    };
    let at_mm = turning_point_m() * 1e3;
    let printed = vec![
        Series::new(
            "V = (π/2W0)² exp(-2dx), as in (23)",
            Stroke::Solid,
            0,
            over(RANGE_MM.0, &|x| potential(x, -1.0)),
        ),
        Series::new(
            "\"in inverse proportion to the width\" (2.6)",
            Stroke::Dashed,
            2,
            over(RANGE_MM.0, &|x| potential(x, 1.0).sqrt() * potential(0.0, 1.0).sqrt()),
        ),
        Series::new("E = (ω/Vs)² at 40 Hz", Stroke::Solid, 1, over(RANGE_MM.0, &|_| energy())),
    ];
    // (sqrt W)''/sqrt W = d^2/4: the part of the potential by the lost (W'/W) term.
    let added = 0.25 * RATE_PER_M * RATE_PER_M;
    let corrected = vec![
        Series::new("V = (π/2W)², W = W0 exp(-dx)", Stroke::Solid, 0, over(0.0, &|x| potential(x, 1.0))),
        Series::new(
            "V + d²/4 (with the (W'/W) term)",
            Stroke::Dashed,
            2,
            over(0.0, &|x| potential(x, 1.0) + added),
        ),
        Series::new("E = (ω/Vs)² at 40 Hz", Stroke::Solid, 1, over(0.0, &|_| energy())),
    ];
    let panel = |heading, convention: &'static [&'static str], series, x: f64| Panel {
        heading,
        convention,
        x_range: RANGE_MM,
        y_range: (0.0, 6.0),
        y_label: "V, E / (1000/m²)",
        series,
        marks: vec![Mark::new("turning point", 1, x)],
    };
    Figure {
        number: Some(3),
        stem: "fig03",
        title: "the plate's potential and the turning point",
        x_label: "x / mm",
        panels: [
            panel(
                "as printed",
                &[
                    "(23) and (24): the potential FALLS along x although (22) narrows; x0 has the wrong sign.",
                    "Rubber, Vs = 5 m/s, W0 = 50 mm, d = 4.62 /m, 40 Hz.",
                ],
                printed,
                -at_mm,
            ),
            panel(
                "corrected",
                &[
                    "(22): V goes with the inverse square of W and rises; the wave comes from x = 0 and turns at x0.",
                    "The same sheet. The lost term lifts V by d²/4, here by 0.2 % of E.",
                ],
                corrected,
                at_mm,
            ),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_turning_point_of_40_hz_lies_at_101_7_mm_and_is_printed_with_a_minus() {
        let figure = figure();
        assert!((figure.panels[0].marks[0].x + 101.7).abs() < 0.05, "{:?}", figure.panels[0].marks);
        assert!((figure.panels[1].marks[0].x - 101.7).abs() < 0.05, "{:?}", figure.panels[1].marks);
        // E = 2526.6/m^2 meets each potential there.
        assert!((energy() - 2526.6).abs() < 0.1);
        assert!((potential(0.1017338, 1.0) / energy() - 1.0).abs() < 1e-4);
        assert!((potential(-0.1017338, -1.0) / energy() - 1.0).abs() < 1e-4);
    }

    #[test]
    fn the_printed_potential_falls_and_the_corrected_one_rises_with_the_square_of_the_width() {
        let figure = figure();
        let printed = &figure.panels[0].series[0].points;
        let corrected = &figure.panels[1].series[0].points;
        assert!(printed.windows(2).all(|pair| pair[1].1 < pair[0].1));
        assert!(corrected.windows(2).all(|pair| pair[1].1 > pair[0].1));
        // W falls by e^(-d 0.2) over 200 mm and V rises as its inverse square; V is 987/m^2 at x = 0.
        assert!((corrected[0].1 - 0.98696).abs() < 1e-4);
        let ratio = corrected[POINTS - 1].1 / corrected[0].1;
        assert!((ratio - (2.0 * 4.62 * 0.2_f64).exp()).abs() < 1e-9);
        let lifted = figure.panels[1].series[1].points[0].1 - corrected[0].1;
        assert!((lifted * 1e3 - 4.62 * 4.62 / 4.0).abs() < 1e-9);
    }
}
