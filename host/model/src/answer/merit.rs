//! Figures of merit of a plate's boundaries.

use serde::Serialize;
use slipline_plate::merit::Merit;
use slipline_plate::texture::{Palette, TextureError};
use slipline_plate::{Plate, Progress};

/// Number of turning points, each in the middle of an equal share of the span.
const TURNING_POINTS: usize = 5;

/// Rates one boundary, or those of five over the span before which there is room for an even area; if there are none, the
/// error is that of the last one.
///
/// # Errors
/// [`TextureError`]: why a boundary cannot be rated, or that the caller has cancelled it.
pub fn rate(
    palette: &Palette<'_>,
    turning_point_m: Option<f64>,
    progress: &mut Progress<'_>,
) -> Result<Vec<Merit>, TextureError> {
    if let Some(turning_point_m) = turning_point_m {
        return Ok(vec![Merit::of(palette, turning_point_m)?]);
    }
    let (start_m, end_m) = palette.plate().span_m();
    let share = |i: usize| (i as f64 + 0.5) / TURNING_POINTS as f64;
    let mut found = Vec::new();
    let mut refused = None;
    for i in 0..TURNING_POINTS {
        progress.at(i as f64 / TURNING_POINTS as f64)?;
        match Merit::of(palette, start_m + (end_m - start_m) * share(i)) {
            Ok(merit) => found.push(merit),
            Err(error @ TextureError::TooShort { .. }) => refused = Some(error),
            Err(error) => return Err(error),
        }
    }
    match refused {
        Some(error) if found.is_empty() => Err(error),
        _ => Ok(found),
    }
}

/// The fields of `slipline merit --json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MeritAnswer<'a> {
    /// Name of the plate.
    pub plate: &'a str,
    /// The figures at each turning point.
    pub turning_points: &'a [Merit],
}

impl<'a> MeritAnswer<'a> {
    /// The fields of these ratings.
    #[must_use]
    pub fn of(plate: &'a Plate, merits: &'a [Merit]) -> Self {
        Self { plate: plate.name(), turning_points: merits }
    }
}
