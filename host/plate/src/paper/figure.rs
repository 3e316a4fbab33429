//! What a figure is made of: panels, curves and marks; and the solutions that its curves show.

use crate::frequency::equation::Equation;
use crate::frequency::error::RespondError;
use crate::frequency::respond::{Response, respond};
use crate::spec::plate::Plate;
use thiserror::Error;

/// Rate of the taper in every figure, 1/m.
pub const RATE_PER_M: f64 = 4.62;
/// Points of a curve.
pub(super) const POINTS: usize = 601;

/// How a curve is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stroke {
    /// The curve the panel is about.
    Solid,
    /// Something to compare it with.
    Dashed,
}

/// A curve of a panel.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// What it is.
    pub name: String,
    /// How it is drawn.
    pub stroke: Stroke,
    /// Number of its colour: curves of one frequency share one.
    pub hue: usize,
    /// Points in the panel's units, in drawing order.
    pub points: Vec<(f64, f64)>,
}

/// A place worth a vertical line.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// What is there.
    pub name: String,
    /// Number of its colour, as [`Series::hue`].
    pub hue: usize,
    /// Where, in the unit of the x axis.
    pub x: f64,
}

/// One version of a figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// `as printed` or `corrected`.
    pub heading: &'static str,
    /// The convention the curves suppose, one sentence a line.
    pub convention: Vec<String>,
    /// Range of the x axis, in its unit.
    pub x_range: (f64, f64),
    /// Range of the y axis, in its unit.
    pub y_range: (f64, f64),
    /// The y axis's label with its unit.
    pub y_label: &'static str,
    /// The curves.
    pub series: Vec<Series>,
    /// Marked places.
    pub marks: Vec<Mark>,
}

/// One figure of the paper.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Its number in the paper.
    pub number: u32,
    /// What it shows.
    pub title: &'static str,
    /// The x axis's label with its unit.
    pub x_label: &'static str,
    /// As printed, then corrected.
    pub panels: [Panel; 2],
}

/// Why a figure could not be computed.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FigureError {
    /// The figures' own plate is not among the presets.
    #[error("the preset plate \"{0}\" is not there")]
    Preset(&'static str),
    /// The figures' own plate was refused.
    #[error(transparent)]
    Plate(#[from] crate::spec::error::PlateError),
    /// The plate did not answer.
    #[error(transparent)]
    Respond(#[from] RespondError),
}

/// `count` numbers from `low` to `high`, both included.
pub(super) fn ramp(low: f64, high: f64, count: usize) -> impl Iterator<Item = f64> + Clone {
    (0..count).map(move |i| low + (high - low) * i as f64 / (count - 1) as f64)
}

pub(super) fn preset(name: &'static str) -> Result<Plate, FigureError> {
    crate::spec::presets::preset(name).ok_or(FigureError::Preset(name))
}

pub(super) fn solve(plate: &Plate, frequency_hz: f64, equation: Equation) -> Result<Response, FigureError> {
    Ok(respond(plate, frequency_hz, POINTS, equation)?)
}

/// |f| over x in mm.
pub(super) fn magnitude(response: &Response) -> Vec<(f64, f64)> {
    let pairs = response.position_m.iter().zip(&response.amplitude);
    pairs.map(|(x, amplitude)| (x * 1e3, amplitude.norm())).collect()
}

/// Points of the largest y in a curve.
#[cfg(test)]
pub(super) fn summit(points: &[(f64, f64)]) -> (f64, f64) {
    points.iter().copied().fold((0.0, f64::NEG_INFINITY), |best, p| if p.1 > best.1 { p } else { best })
}

impl Figure {
    /// Base of the names of its files: `fig04`.
    pub fn file_stem(&self) -> String {
        format!("fig{:02}", self.number)
    }
}

impl Panel {
    /// The curve of that name.
    pub fn curve(&self, name: &str) -> Option<&Series> {
        self.series.iter().find(|series| series.name == name)
    }
}
