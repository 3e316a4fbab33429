//! The frame of a design: the first of some usual ones whose still side a finger does not feel move.

use crate::StaticText;
use crate::check::thresholds::FRAME_DB;
use crate::definition::frame::Frame;
use crate::definition::plate::Plate;
use crate::feeling::Feeling;
use crate::frequency::{Equation, respond};
use crate::quantity::number_format::with_decimals;
use crate::quantity::{decibels, from_decibels, show_frequency};
use num_complex::Complex64;

/// Name, Young's modulus, density and thickness of one sheet, from what is easiest to cut on. Handbook values; the modulus of
/// plywood is that along its outer grain.
const USUAL: [(&str, f64, f64, f64); 5] = [
    ("plywood", 8e9, 680.0, 5e-3),
    ("aluminium", 70e9, 2700.0, 5e-3),
    ("plywood", 8e9, 680.0, 10e-3),
    ("steel", 200e9, 7850.0, 5e-3),
    ("aluminium", 70e9, 2700.0, 10e-3),
];
/// Boundaries over the span at which a frame is tried, and points of each field.
const PLACES: usize = 41;
const POINTS: usize = 257;
/// How much less than the light's limit a chosen frame moves, dB: the light's level is that of the table.
const MARGIN_DB: f64 = 1.0;

/// The frame of a design.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ChosenFrame {
    /// Its material.
    // JSON, text: Material of the frame
    #[serde(with = "crate::static_text")]
    pub material: StaticText,
    /// Thickness of each of its two sheets, metres.
    // JSON: Thickness of each of the frame's two sheets
    pub sheet_m: f64,
    /// Its mass, both sheets, kg.
    // JSON: Mass of the frame, both sheets
    pub mass_kg: f64,
    /// Its first bending with free ends, Hz.
    // JSON: First bending of the frame with free ends
    pub first_bending_hz: f64,
    /// Its largest motion beyond the boundary over what a usual finger just feels, dB, over the span at level 1; `None` where the
    /// plate's mass is not known.
    // JSON: Largest motion of the frame beyond the boundary over what a usual finger feels; null where unknown
    pub over_threshold_db: Option<f64>,
    /// The mass of the table to which it must be screwed, kg; 0 where it may lie free.
    // JSON: Mass of the table to which the frame must be screwed; 0 where it may lie free
    pub table_mass_kg: f64,
}

impl ChosenFrame {
    /// That it must be screwed to a table; `None` where it may lie free.
    pub(super) fn caution(&self) -> Option<String> {
        let over_db = self.over_threshold_db.filter(|_| self.table_mass_kg > 0.0)?;
        let side = if over_db < 0.0 { "below" } else { "over" };
        Some(format!(
            "No usual frame is still: the best one, two sheets of {} mm of {}, moves by {} dB {side} what a finger feels beyond \
             the boundary (its first bending is at {}). Screw it to a table of {} kg or more.",
            with_decimals(1e3 * self.sheet_m, 0),
            self.material,
            with_decimals(over_db.abs(), 0),
            show_frequency(self.first_bending_hz),
            with_decimals(self.table_mass_kg, 0)
        ))
    }
}

/// Chooses the frame of `plate`, with a rim of this width.
pub(super) fn choose(plate: &Plate, rim_m: f64) -> Option<(Frame, ChosenFrame)> {
    let fields = fields(plate);
    let mut best: Option<(Frame, ChosenFrame, f64)> = None;
    for (material, youngs_modulus_pa, density_kg_per_m3, sheet_m) in USUAL {
        let thickness_m = 2.0 * sheet_m;
        let frame = Frame { youngs_modulus_pa, density_kg_per_m3, thickness_m, rim_m, table_mass_kg: 0.0 };
        let moves = worst(plate, &frame, &fields);
        let (over_db, still_kg) = moves.unwrap_or((f64::NEG_INFINITY, 0.0));
        let mass_kg = frame.mass_kg(plate);
        let stands = over_db <= FRAME_DB.green - MARGIN_DB;
        let chosen = ChosenFrame {
            material,
            sheet_m,
            mass_kg,
            first_bending_hz: frame.first_bending_hz(plate),
            over_threshold_db: moves.map(|(over_db, _)| over_db),
            table_mass_kg: if stands { 0.0 } else { (still_kg - mass_kg).ceil().max(1.0) },
        };
        if best.as_ref().is_none_or(|(_, _, best_db)| over_db < *best_db) {
            best = Some((frame, chosen, over_db));
        }
        if stands {
            return Some((frame, chosen));
        }
    }
    best.map(|(frame, chosen, _)| (frame, chosen))
}

/// A field at level 1, metres.
struct Field {
    frequency_hz: f64,
    boundary_m: f64,
    metres: Vec<Complex64>,
}

/// The fields over the span, each as high as the lowest of their peaks: the level that a table reaches everywhere.
fn fields(plate: &Plate) -> Vec<Field> {
    let full_scale_m = plate.spec().full_scale_m;
    let responses: Vec<_> = plate
        .over_span_m(PLACES)
        .filter_map(|boundary_m| {
            let hertz = plate.frequency_for_boundary_hz(boundary_m);
            respond(plate, hertz, POINTS, Equation::Corrected).ok().map(|response| (boundary_m, response))
        })
        .collect();
    let lowest = responses.iter().map(|(_, response)| response.height()).fold(f64::INFINITY, f64::min);
    let field = |(boundary_m, response): (f64, crate::frequency::Response)| {
        let scale = full_scale_m * lowest / response.height().max(f64::MIN_POSITIVE);
        let metres = response.amplitude.iter().map(|f| f * scale).collect();
        Field { frequency_hz: response.frequency_hz, boundary_m, metres }
    };
    responses.into_iter().map(field).collect()
}

/// The largest motion of the frame over what is just felt, dB, and the mass that keeps it still at every boundary, kg. A free frame moves
/// most near its first bending, a screwed one, which does not bend, at another boundary.
fn worst(plate: &Plate, frame: &Frame, fields: &[Field]) -> Option<(f64, f64)> {
    let over = |field: &Field| {
        let motion = frame.motion(plate, field.frequency_hz, &field.metres, field.boundary_m)?;
        let over_db = decibels(motion.amplitude_m / Feeling::default().just_felt_m(field.frequency_hz));
        Some((over_db, motion.rigid_kg * from_decibels(over_db - FRAME_DB.green + MARGIN_DB)))
    };
    fields.iter().filter_map(over).reduce(|a, b| (a.0.max(b.0), a.1.max(b.1)))
}
