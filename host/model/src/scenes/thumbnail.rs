//! Small pictures of the scenes: the envelope and its sensation.

use super::SCENES;
use crate::field::felt::{Felt, Zone};
use crate::field::steady_field::{SteadyField, interpolate, steady_tones};
use crate::jobs::Task;
use slipline_plate::DriveTable;

/// Places of a picture along the plate.
const PLACES: usize = 96;
/// Knots of the table that gives the heights.
const KNOTS: usize = 33;
/// The usual sample rate, Hz.
const SAMPLE_RATE_HZ: f64 = 400e3;

/// Content of a small picture of a scene at places uniform from 0 to the plate's end.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Thumbnail {
    /// Half-width of the plate over its largest, 0 to 1.
    pub half_width: Vec<f32>,
    /// Displacement over the largest anywhere, 0 to 1: for one tone the largest, for several the mean.
    pub height: Vec<f32>,
    /// The zone of each place.
    pub zones: Vec<Zone>,
}

/// The pictures of all [`SCENES`], in their order; a picture that cannot be drawn is empty. `None` if the
/// task was cancelled.
#[must_use]
pub fn thumbnails(task: &Task) -> Option<Vec<Thumbnail>> {
    let mut drawn = Vec::with_capacity(SCENES.len());
    for (number, scene) in SCENES.iter().enumerate() {
        if !task.report(number as f64 / SCENES.len() as f64) {
            return None;
        }
        drawn.push(thumbnail(scene).unwrap_or_default());
    }
    Some(drawn)
}

fn thumbnail(scene: &super::Scene) -> Option<Thumbnail> {
    let setup = scene.setup()?;
    let plate = &setup.plate;
    let table = DriveTable::build(plate, SAMPLE_RATE_HZ, KNOTS).ok()?;
    let field = SteadyField::solve(plate, &steady_tones(&setup, Some(&table)));
    let felt = Felt::of(plate, &setup.feeling, &field);
    // For several tones the mean: their largest possible sum lasts for a moment only.
    let envelope = if field.tones.len() > 1 { &field.rms_m } else { &field.bound_m };
    let highest_m = envelope.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let shares = (0..PLACES).map(|place| place as f64 / (PLACES - 1) as f64);
    Some(Thumbnail {
        half_width: shares
            .clone()
            .map(|share| (plate.half_width_m(share * plate.length_m()) / plate.half_width_m(0.0)) as f32)
            .collect(),
        height: shares.clone().map(|share| (interpolate(envelope, share) / highest_m) as f32).collect(),
        zones: shares.map(|share| Zone::of(interpolate(&felt.strength, share))).collect(),
    })
}
