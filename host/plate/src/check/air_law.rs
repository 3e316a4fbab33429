//! How far the law of the air along a light membrane in a baffle puts the peak from that of the field in two dimensions.
//!
//! The law describes the air by a mass that depends on the place. Where the air outweighs the membrane the field itself shapes
//! the air's motion, and the law is up to 22 mm off, most of all in the middle of the span. One solution in two dimensions takes 0.1
//! to 0.3 s, so it is computed at a few boundaries, each when it is first needed; what is between two of them may be as far off as
//! the worse one.

use crate::definition::air::{Air, AirMounting};
use crate::definition::plate::Plate;
use crate::frequency::{Equation, respond};
use crate::plane::{self, Comparison, Setup};
use std::sync::OnceLock;

/// Least mass of the air over that of the membrane at the nearest boundary, where the law is checked. Of the preset `membrane`
/// it is 0.4, and its peaks are within 0.6 mm.
const HEAVY: f64 = 0.6;
/// Boundaries over the span that are solved in two dimensions.
const PLACES: usize = 9;
/// A boundary within this of one that is solved is that one, metres.
const AT_M: f64 = 1e-6;
/// Points of a field: ten per wavelength, for its peak.
const POINTS: usize = 513;

/// The law's error at some boundaries of a plate.
#[derive(Debug)]
pub(super) struct AirLaw {
    /// Each boundary, metres, and the peak in two dimensions beyond the law's, metres, once it is known: 0 where one of them has
    /// no peak.
    places: Vec<(f64, OnceLock<f64>)>,
}

impl AirLaw {
    /// Of a light membrane in a baffle; `None` of another plate, on which the law serves or no field in two dimensions is known.
    pub(super) fn of(plate: &Plate) -> Option<Self> {
        let Some(Air::Around { mounting: AirMounting::Baffle { .. }, .. }) = plate.spec().air else {
            return None;
        };
        let air = plate.width_mode(1).air(plate.band_hz().0)?;
        let at_turning = air.share * (1.0 + air.growth) * (air.wide / air.turning).sqrt();
        (at_turning >= HEAVY)
            .then(|| Self { places: plate.over_span_m(PLACES).map(|x| (x, OnceLock::new())).collect() })
    }

    /// The peak in two dimensions beyond the law's at this boundary, metres; between two that are solved that of the worse one, beyond
    /// the span that of its end.
    pub(super) fn off_m(&self, plate: &Plate, boundary_m: f64) -> f64 {
        let solved =
            |(place_m, off_m): &(f64, OnceLock<f64>)| *off_m.get_or_init(|| off_m_at(plate, *place_m));
        let last = self.places.len() - 1;
        let after = self.places.iter().position(|(place_m, _)| *place_m >= boundary_m - AT_M).unwrap_or(last);
        let there = solved(&self.places[after]);
        if after == 0
            || (self.places[after].0 - boundary_m).abs() <= AT_M
            || self.places[after].0 < boundary_m
        {
            return there;
        }
        let before = solved(&self.places[after - 1]);
        if before.abs() > there.abs() { before } else { there }
    }
}

fn off_m_at(plate: &Plate, boundary_m: f64) -> f64 {
    let frequency_hz = plate.frequency_for_boundary_hz(boundary_m);
    let by_law = respond(plate, frequency_hz, POINTS, Equation::Corrected).ok();
    let in_two = plane::respond(plate, frequency_hz, POINTS, &Setup::of(plate)).ok();
    let shift_m = |(one, two)| Comparison::of(&one, &two).peak_shift_m;
    by_law.zip(in_two).and_then(shift_m).unwrap_or(0.0)
}
