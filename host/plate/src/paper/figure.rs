//! The data of a figure: panels, curves and marks; and helpers that compute the curves.

use crate::definition::plate::Plate;
use crate::definition::turning_width::TurningWidth;
use crate::frequency::equation::Equation;
use crate::frequency::error::RespondError;
use crate::frequency::respond::{Response, respond};
pub(crate) use crate::special::ramp::ramp;
use thiserror::Error;

/// Rate of the taper in every figure, 1/m.
pub const RATE_PER_M: f64 = 4.62;
/// Points of a curve.
pub(crate) const POINTS: usize = 601;

/// Line style of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stroke {
    /// A main curve of the panel.
    Solid,
    /// A curve for comparison.
    Dashed,
    /// Single points.
    Dots,
}

/// A curve of a panel.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name of the curve in the legend.
    pub name: String,
    /// Line style of the curve.
    pub stroke: Stroke,
    /// Index of its colour; curves of the same frequency have the same.
    pub hue: usize,
    /// Points in the panel's units, in drawing order.
    pub points: Vec<(f64, f64)>,
}

impl Series {
    pub(crate) fn new(name: impl Into<String>, stroke: Stroke, hue: usize, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.into(), stroke, hue, points }
    }
}

/// A position marked by a vertical line.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Name of the mark.
    pub name: String,
    /// Index of its colour, as [`Series::hue`].
    pub hue: usize,
    /// Position in the unit of the x axis.
    pub x: f64,
}

impl Mark {
    pub(crate) fn new(name: impl Into<String>, hue: usize, x: f64) -> Self {
        Self { name: name.into(), hue, x }
    }
}

/// One of the two versions, or halves, of a figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// `as printed` or `corrected`, or the plate.
    pub heading: &'static str,
    /// The formulas and values that the curves assume, one line each.
    pub convention: &'static [&'static str],
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

/// One figure of the paper, or of the physics page.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Its number in the paper; `None` for a figure of the physics page.
    pub number: Option<u32>,
    /// Name of its files without the extension.
    pub stem: &'static str,
    /// The title.
    pub title: &'static str,
    /// The x axis's label with its unit.
    pub x_label: &'static str,
    /// In the paper the version as printed, then the corrected one.
    pub panels: [Panel; 2],
}

/// Reasons why a figure could not be computed.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum FigureError {
    /// The plate of a figure is not among the presets.
    #[error("the preset plate \"{0}\" does not exist")]
    Preset(&'static str),
    /// The plate of a figure was refused.
    #[error(transparent)]
    Plate(#[from] crate::definition::error::PlateError),
    /// The amplitude could not be computed.
    #[error(transparent)]
    Respond(#[from] RespondError),
    /// The plate in two dimensions could not be computed.
    #[error(transparent)]
    Plane(#[from] crate::plane::PlaneError),
}

/// A preset with the paper's turning width, straight across: the figures do not correct the width.
pub(crate) fn preset(name: &'static str) -> Result<Plate, FigureError> {
    let plate = crate::definition::presets::preset(name).ok_or(FigureError::Preset(name))?;
    Ok(plate.with_turning_width(TurningWidth::Plain))
}

pub(super) fn solve(plate: &Plate, frequency_hz: f64, equation: Equation) -> Result<Response, FigureError> {
    Ok(respond(plate, frequency_hz, POINTS, equation)?)
}

/// |f| of a response as points (x in mm, |f|).
pub(crate) fn magnitude(response: &Response) -> Vec<(f64, f64)> {
    let pairs = response.position_m.iter().zip(&response.amplitude);
    pairs.map(|(x, amplitude)| (x * 1e3, amplitude.norm())).collect()
}

/// The point of a curve with the largest y.
#[cfg(test)]
pub(super) fn highest_point(points: &[(f64, f64)]) -> (f64, f64) {
    points.iter().copied().fold((0.0, f64::NEG_INFINITY), |best, p| if p.1 > best.1 { p } else { best })
}

impl Figure {
    /// The title with its number in the paper.
    pub fn heading(&self) -> String {
        self.number.map_or_else(|| self.title.to_owned(), |number| format!("Fig. {number}: {}", self.title))
    }
}

impl Panel {
    /// The curve called `name`; `None` if there is none.
    pub fn curve(&self, name: &str) -> Option<&Series> {
        self.series.iter().find(|series| series.name == name)
    }
}
