//! Targets of a texture: a wanted RMS amplitude and a weight at each place.

use super::error::TextureError;
use super::palette::Palette;
use crate::quantity::{OutOfRange, Range};
use crate::special::airy;
use std::ops::RangeInclusive;

/// Start of a solid area, metres from the driven end: nearer to it the field of the drive itself is felt.
const SOLID_FROM_M: f64 = 0.01;
/// Distance from the end of the even part of a solid area to its turning point, in edge widths: the last peak rises
/// there.
const SOLID_TO_EDGE_WIDTHS: f64 = 1.3;
/// Distance past the turning point from which the plate should be still, in edge widths.
pub(super) const STILL_FROM_EDGE_WIDTHS: f64 = 1.4;
/// Weight of a place that should be still, over that of a place that should vibrate.
const STILL_WEIGHT: f64 = 10.0;
/// Weight of the last peak of a solid area: it should not stand out, but its height matters less than evenness.
const PEAK_WEIGHT: f64 = 0.3;

/// A wanted RMS amplitude along the plate.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Target {
    /// Wanted RMS amplitude at each of the palette's places, in units of the largest, 0 to 1.
    pub(super) wanted: Vec<f64>,
    /// Weight of the error at each place, 0 or more.
    pub(super) weight: Vec<f64>,
    /// First and last turning point that the tones may have, metres.
    pub(super) allowed_m: (f64, f64),
    pub(super) wanted_kind: Wanted,
}

/// The kind of a target.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Wanted {
    /// An even area from the driven end to an edge.
    Solid {
        /// Turning point of the edge, metres.
        turning_point_m: f64,
        /// Edge width there, metres.
        edge_width_m: f64,
    },
    /// Any profile.
    Profile,
}

impl Target {
    /// An even area from the driven end to `turning_point_m`, metres.
    ///
    /// # Errors
    /// [`TextureError::OutOfRange`] if the turning point is outside the table's span, [`TextureError::Silent`] if the
    /// wave cannot enter, [`TextureError::TooShort`] if the area has fewer than two places.
    pub fn solid(palette: &Palette<'_>, turning_point_m: f64) -> Result<Self, TextureError> {
        let table = palette.table();
        let span = table.span_m();
        OutOfRange::check("turning point", turning_point_m, Range::new(span.0, span.1, "m"))?;
        let plate = palette.plate();
        let frequency_hz = table.frequency_hz(turning_point_m);
        let edge_width_m = plate.edge_width_m(frequency_hz).ok_or(TextureError::Silent)?;
        let even_to_m = turning_point_m - SOLID_TO_EDGE_WIDTHS * edge_width_m;
        let still_from_m = turning_point_m + STILL_FROM_EDGE_WIDTHS * edge_width_m;
        let peak_m = turning_point_m - airy::PEAK_OFFSET / airy::EDGE_WIDTH * edge_width_m;
        let places = palette.places_m();
        let parts = places.iter().map(|&x| match x {
            x if x < SOLID_FROM_M => (1.0, 0.0),
            x if x <= even_to_m => (1.0, 1.0),
            x if x <= peak_m => (1.0, PEAK_WEIGHT),
            x if x < still_from_m => (1.0, 0.0),
            _ => (0.0, STILL_WEIGHT),
        });
        let (wanted, weight): (Vec<f64>, Vec<f64>) = parts.unzip();
        if places.iter().filter(|&&x| (SOLID_FROM_M..=even_to_m).contains(&x)).count() < 2 {
            return Err(TextureError::TooShort { turning_point_m, edge_width_m });
        }
        Ok(Self {
            wanted,
            weight,
            allowed_m: (span.0, turning_point_m),
            wanted_kind: Wanted::Solid { turning_point_m, edge_width_m },
        })
    }

    /// The RMS amplitude over breakpoints `(place in metres, amplitude)` joined by straight lines. Places before the
    /// first and beyond the last breakpoint have no weight. The unit of the amplitudes is arbitrary: the texture is as
    /// loud as the DAC allows.
    ///
    /// # Errors
    /// [`TextureError::Profile`] if there are fewer than two breakpoints; if a place is not finite or not beyond the
    /// one before; if an amplitude is not finite or below zero, or all are zero; or if fewer than two of the palette's
    /// places lie within the profile.
    pub fn profile(palette: &Palette<'_>, breakpoints: &[(f64, f64)]) -> Result<Self, TextureError> {
        check_breakpoints(breakpoints)?;
        let largest = breakpoints.iter().map(|&(_, amplitude)| amplitude).fold(0.0, f64::max);
        let table = palette.table();
        let places = palette.places_m();
        let drawn = breakpoints[0].0..=breakpoints[breakpoints.len() - 1].0;
        if places.iter().filter(|x| drawn.contains(x)).count() < 2 {
            return Err(TextureError::Profile {
                number: 1,
                reason: "the profile covers fewer than 2 of the places at which a texture is fitted",
            });
        }
        Ok(Self {
            wanted: places.iter().map(|&x| value_at(breakpoints, x) / largest).collect(),
            weight: places.iter().map(|x| if drawn.contains(x) { 1.0 } else { 0.0 }).collect(),
            allowed_m: table.span_m(),
            wanted_kind: Wanted::Profile,
        })
    }

    /// Wanted RMS amplitude at each place, in units of the largest.
    pub fn wanted(&self) -> &[f64] {
        &self.wanted
    }

    /// Weight of the error at each place.
    pub fn weight(&self) -> &[f64] {
        &self.weight
    }

    /// The kind of this target.
    pub fn kind(&self) -> Wanted {
        self.wanted_kind
    }

    /// Even part of a solid area, metres from the driven end; `None` for other targets.
    pub(super) fn even_m(&self) -> Option<RangeInclusive<f64>> {
        match self.wanted_kind {
            Wanted::Solid { turning_point_m, edge_width_m } => {
                Some(SOLID_FROM_M..=turning_point_m - SOLID_TO_EDGE_WIDTHS * edge_width_m)
            }
            Wanted::Profile => None,
        }
    }
}

fn check_breakpoints(breakpoints: &[(f64, f64)]) -> Result<(), TextureError> {
    let refused =
        |number: usize, reason: &'static str| Err(TextureError::Profile { number: number + 1, reason });
    if breakpoints.len() < 2 {
        return refused(breakpoints.len(), "a profile needs at least 2 breakpoints");
    }
    for (number, &(place, amplitude)) in breakpoints.iter().enumerate() {
        if !place.is_finite() {
            return refused(number, "its place is not a finite number");
        }
        if !(amplitude.is_finite() && amplitude >= 0.0) {
            return refused(number, "its amplitude is not a finite number of at least 0");
        }
        if number > 0 && breakpoints[number - 1].0 >= place {
            return refused(number, "its place is not beyond the place of the breakpoint before it");
        }
    }
    if breakpoints.iter().all(|&(_, amplitude)| amplitude == 0.0) {
        return refused(0, "all amplitudes are 0");
    }
    Ok(())
}

fn value_at(breakpoints: &[(f64, f64)], x: f64) -> f64 {
    let after = breakpoints.partition_point(|&(place, _)| place <= x);
    match (after.checked_sub(1).map(|before| breakpoints[before]), breakpoints.get(after)) {
        (Some((x0, y0)), Some(&(x1, y1))) => y0 + (y1 - y0) * (x - x0) / (x1 - x0),
        (Some((_, y)), None) | (None, Some(&(_, y))) => y,
        (None, None) => 0.0,
    }
}
