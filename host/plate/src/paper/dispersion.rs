//! Fig. 2: the local wavenumber as the plate narrows.

use super::figure::{Figure, Mark, POINTS, Panel, Series, Stroke, ramp};
use num_complex::Complex64;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Wave speed of the rubber sheet, m/s. The paper does not give it; 30 Hz must enter a plate 100 mm wide, which
/// requires less than 6 m/s.
const SPEED: f64 = 5.0;
/// Loss factor of the rubber sheet.
const LOSS: f64 = 0.1;
/// Frequency of the drive, Hz.
const FREQUENCY_HZ: f64 = 40.0;
/// Highest frequency shown, Hz.
const HIGHEST_HZ: f64 = 80.0;
/// Half-widths of the three curves, mm.
const HALF_WIDTHS_MM: [f64; 3] = [50.0, 31.25, 22.0];

/// k of width mode m at half-width W, 1/m: k^2 = K^2 (1 + j eta) - (m pi/2W)^2.
fn wavenumber(frequency_hz: f64, half_width_m: f64, mode: f64, loss: f64) -> Complex64 {
    let free = (TAU * frequency_hz / SPEED).powi(2);
    (free * Complex64::new(1.0, loss) - (mode * FRAC_PI_2 / half_width_m).powi(2)).sqrt()
}

/// The curve without loss, drawn as in the paper: Re k to the right of zero, -Im k to the left.
fn lossless(half_width_mm: f64, mode: f64) -> Vec<(f64, f64)> {
    ramp(0.0, HIGHEST_HZ, POINTS)
        .map(|frequency_hz| {
            let k = wavenumber(frequency_hz, half_width_mm * 1e-3, mode, 0.0);
            (if k.re > 0.0 { k.re } else { -k.im }, frequency_hz)
        })
        .collect()
}

pub(super) fn figure() -> Figure {
    let wave = |width: f64| format!("W = {width} mm");
    let curves = |stroke: Stroke| {
        let widths = HALF_WIDTHS_MM.iter().enumerate();
        widths.map(move |(hue, &width)| Series::new(wave(width), stroke, hue, lossless(width, 1.0)))
    };
    let input = || {
        let points = vec![(-90.0, FREQUENCY_HZ), (90.0, FREQUENCY_HZ)];
        Series::new(format!("{FREQUENCY_HZ} Hz"), Stroke::Dashed, 5, points)
    };
    let mut printed: Vec<Series> = curves(Stroke::Solid).collect();
    printed.push(input());
    let mut corrected = Vec::new();
    for (hue, width) in HALF_WIDTHS_MM.into_iter().enumerate() {
        let lossy = |take: fn(Complex64) -> f64| {
            ramp(1.0, HIGHEST_HZ, POINTS)
                .map(|f| (take(wavenumber(f, width * 1e-3, 1.0, LOSS)), f))
                .collect::<Vec<_>>()
        };
        corrected.push(Series::new(wave(width), Stroke::Solid, hue, lossy(|k| k.re)));
        let imaginary = format!("{}, Im", wave(width));
        corrected.push(Series::new(imaginary, Stroke::Solid, hue, lossy(|k| -k.im)));
    }
    let third = lossless(HALF_WIDTHS_MM[0], 3.0);
    corrected.push(Series::new("W = 50 mm, mode 3", Stroke::Dashed, 0, third));
    corrected.push(input());
    let panel = |heading, convention: &'static [&'static str], series| Panel {
        heading,
        convention,
        x_range: (-90.0, 90.0),
        y_range: (0.0, HIGHEST_HZ),
        y_label: "frequency / Hz",
        series,
        marks: Vec::<Mark>::new(),
    };
    Figure {
        number: Some(2),
        stem: "fig02",
        title: "the local wavenumber as the plate narrows",
        x_label: "left: -Im k, right: Re k / (1/m)",
        panels: [
            panel(
                "as printed",
                &[
                    "Rubber, Vs = 5 m/s, first width mode only, no loss.",
                    "W0 = 50 mm read as the half-width.",
                ],
                printed,
            ),
            panel(
                "corrected",
                &[
                    "The same sheet with loss 0.1: k is complex, never zero, and the wave leaks past the cut-off.",
                    "The third width mode has a cut-off of its own, three times as high.",
                ],
                corrected,
            ),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_printed_curves_start_at_their_cut_offs_and_40_hz_turns_between_the_widths() {
        let figure = figure();
        for (width, cut_off) in [(50.0_f64, 25.0_f64), (31.25, 40.0), (22.0, 56.818)] {
            // (7): Vs/(4 W).
            assert!((5.0 / (4.0 * width * 1e-3) - cut_off).abs() < 1e-3);
            let curve = figure.panels[0].curve(&format!("W = {width} mm")).expect("drawn");
            let entered = curve.points.iter().find(|p| p.0 > 0.0).expect("enters").1;
            assert!(entered >= cut_off && entered - cut_off < 0.14, "{width}: {entered}");
            // (5) at the top of the panel.
            let k = ((TAU * 80.0 / 5.0).powi(2) - (FRAC_PI_2 / (width * 1e-3)).powi(2)).sqrt();
            assert!((curve.points[POINTS - 1].0 - k).abs() < 1e-9);
        }
        // At 40 Hz: real at 50 mm (39.3 1/m), imaginary at 22 mm (-50.7 1/m).
        assert!((wavenumber(40.0, 0.05, 1.0, 0.0).re - 39.24).abs() < 0.02);
        assert!((wavenumber(40.0, 0.022, 1.0, 0.0).im - 50.69).abs() < 0.02);
    }

    #[test]
    fn with_loss_the_wavenumber_never_vanishes_and_the_third_mode_enters_at_75_hz() {
        let figure = figure();
        let at_cut_off = wavenumber(40.0, 0.031_25, 1.0, LOSS);
        // |k| = K sqrt(eta) at the cut-off.
        let expected = TAU * 40.0 / 5.0 * LOSS.sqrt();
        assert!((at_cut_off.norm() / expected - 1.0).abs() < 1e-9, "{at_cut_off}");
        assert!((at_cut_off.re - at_cut_off.im).abs() < 1e-9);
        let third = figure.panels[1].curve("W = 50 mm, mode 3").expect("drawn");
        let entered = third.points.iter().find(|p| p.0 > 0.0).expect("enters").1;
        assert!((entered - 75.0).abs() < 0.14, "{entered}");
    }
}
