//! Reflection of the returning wave at the ends of a plate in bending, over frequency.

use super::preset;
use crate::definition::drive::DriveEnd;
use crate::definition::impedance::Impedance;
use crate::definition::plate::Plate;
use crate::definition::source::{EndSlope, LeadIn, Source};
use crate::frequency::driven_end::reflection;
use crate::paper::figure::{Figure, FigureError, Panel, Series, Stroke, ramp};
use crate::plane;

/// Frequency at which the resistances are stated in wave impedances, Hz.
const AT_HZ: f64 = 28e3;
const BAND_KHZ: (f64, f64) = (12.0, 44.0);
const LINE_POINTS: usize = 129;
const DOTS: usize = 6;

pub(super) fn figure() -> Result<Figure, FigureError> {
    let strip = preset("al-bending-displacement")?;
    let impedance = strip.wave_impedance_n_s_per_m(AT_HZ).unwrap_or(f64::NAN);
    let soft = Source::soft(&strip.spec().model, AT_HZ);
    let damped = |ratio: f64, slope: EndSlope| Source {
        impedance: Impedance::damper(ratio * impedance),
        slope: Some(slope),
        ..soft
    };
    let led = |length_m: f64, ratio: f64| Source {
        lead_in: Some(LeadIn { length_m, loss_factor: 0.2, end_resistance_n_s_per_m: ratio * impedance }),
        ..soft
    };
    let curves = |ends: [(&str, Source); 3]| -> Result<Vec<Series>, FigureError> {
        let mut curves = Vec::new();
        for (hue, (name, source)) in ends.into_iter().enumerate() {
            curves.extend(both(&strip.with_drive_end(DriveEnd::Source(source)), name, hue)?);
        }
        Ok(curves)
    };
    let panel = |heading, convention: &'static [&'static str], series| Panel {
        heading,
        convention,
        x_range: BAND_KHZ,
        y_range: (0.0, 1.0),
        y_label: "|r|",
        series,
        marks: Vec::new(),
    };
    Ok(Figure {
        number: None,
        stem: "reflection",
        title: "the share |r| of a returning wave that a driven end sends back (lines: one dimension, dots: two)",
        x_label: "frequency / kHz",
        panels: [
            panel(
                "dampers",
                &["Aluminium strip, 2 mm thick, half-width 20 mm, supported; Z = 151 N s/m at 28 kHz."],
                curves([
                    ("free, R = Z", damped(1.0, EndSlope::Free)),
                    ("free, R = 0.37 Z", damped(0.37, EndSlope::Free)),
                    ("slope held, R = 0.74 Z", damped(0.74, EndSlope::Held)),
                ])?,
            ),
            panel(
                "lead-ins, loss factor 0.2",
                &["The same strip behind a soft force; damper R at the far end of the lead-in."],
                curves([
                    ("60 mm, R = 0", led(0.06, 0.0)),
                    ("60 mm, R = 0.37 Z", led(0.06, 0.37)),
                    ("150 mm, R = 0.37 Z", led(0.15, 0.37)),
                ])?,
            ),
        ],
    })
}

/// |r| in one dimension as a line, in two dimensions as dots.
fn both(plate: &Plate, name: &str, hue: usize) -> Result<[Series; 2], FigureError> {
    let line = ramp(BAND_KHZ.0, BAND_KHZ.1, LINE_POINTS)
        .filter_map(|khz| reflection(plate, khz * 1e3).map(|r| (khz, r.norm())))
        .collect();
    let setup = plane::Setup::of(plate);
    let dots: Result<Vec<(f64, f64)>, FigureError> = ramp(BAND_KHZ.0 + 2.0, BAND_KHZ.1 - 2.0, DOTS)
        .map(|khz| Ok((khz, plane::reflection(plate, khz * 1e3, &setup)?.norm())))
        .collect();
    Ok([
        Series::new(name, Stroke::Solid, hue, line),
        Series::new(format!("{name}, 2-D"), Stroke::Dots, hue, dots?),
    ])
}
