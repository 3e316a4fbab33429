//! The lights of a plate.

use serde::Serialize;
use slipline_plate::check::{CheckError, Checker, Colour, Conditions, Report};
use slipline_plate::{Plate, Progress};

/// Checks a plate at one turning point, or the worst over its span.
///
/// # Errors
/// [`CheckError`]: the unsuitable value and its range, or that the caller has cancelled it.
pub fn check(
    plate: &Plate,
    turning_point_m: Option<f64>,
    conditions: Conditions,
    progress: &mut Progress<'_>,
) -> Result<Report, CheckError> {
    let checker = Checker::watched(plate, conditions, &mut progress.part(0.0, 0.2))?;
    match turning_point_m {
        Some(turning_point_m) => checker.at(turning_point_m),
        None => checker.over_span(&mut progress.part(0.2, 1.0)),
    }
}

/// The fields of `slipline check --json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CheckAnswer<'a> {
    /// The lights and what they are about.
    #[serde(flatten)]
    pub report: &'a Report,
    /// The worst colour.
    // JSON, text: The worst colour
    pub worst: Colour,
}

impl<'a> CheckAnswer<'a> {
    /// The fields of a report.
    #[must_use]
    pub fn of(report: &'a Report) -> Self {
        Self { report, worst: report.worst() }
    }
}
