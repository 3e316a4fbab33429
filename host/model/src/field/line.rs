//! The boundary line of a tone: its one place, in the window and in exports.
//!
//! ```text
//! line holds the felt edge (default):  turning point <--> felt edge of the tone alone, at its level
//! line holds the turning point:        the same place
//! ```
//! A felt edge is that of the tone alone, so that another tone does not move the line.

use crate::field::felt::{Felt, NotFelt};
use crate::field::steady_field::{SteadyField, SteadyTone, ToneWave};
use crate::setup::{BoundaryMode, Setup, ToneSetup};
use slipline_plate::DriveTable;
use slipline_plate::feeling::FeltEdge;

/// Largest error of a place that counts as found, in metres: a hundredth of the smallest step of the arrow
/// keys.
const CLOSE_M: f64 = 1e-6;
/// Largest number of solutions in the search for a place.
const TRIES: usize = 40;

/// The quantity at the place of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Holds {
    /// The turning point, because the user has chosen it or the tone's height is not known yet.
    TurningPoint,
    /// The felt edge.
    FeltEdge,
    /// The plate's end: the tone is felt up to the end.
    PlateEnd,
    /// The turning point, because the tone is not felt.
    Unfelt(NotFelt),
}

impl Holds {
    /// The quantity, in words.
    #[must_use]
    pub fn words(self) -> String {
        match self {
            Self::TurningPoint => "turning point".to_owned(),
            Self::FeltEdge => "felt edge".to_owned(),
            Self::PlateEnd => "plate's end: felt up to there".to_owned(),
            Self::Unfelt(why) => format!("turning point; {}", why.words()),
        }
    }
}

/// The boundary line of a tone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// The device's slot of the tone.
    pub slot: u8,
    /// Its place, in metres from the driven end.
    pub place_m: f64,
    /// The quantity at this place.
    pub holds: Holds,
}

impl Line {
    /// The line of a tone whose wave is solved; `wave` is `None` while its height is not known.
    fn of_wave(setup: &Setup, tone: &ToneSetup, wave: Option<&ToneWave>) -> Self {
        let turning_point = |holds| Self { slot: tone.slot, place_m: tone.position_m, holds };
        let (BoundaryMode::FeltEdge, Some(wave)) = (setup.boundary, wave) else {
            return turning_point(Holds::TurningPoint);
        };
        let felt = felt_alone(setup, wave);
        match felt.edge {
            FeltEdge::At(place_m) => Self { slot: tone.slot, place_m, holds: Holds::FeltEdge },
            FeltEdge::PlateEnd => {
                Self { slot: tone.slot, place_m: setup.plate.length_m(), holds: Holds::PlateEnd }
            }
            FeltEdge::Nowhere => turning_point(Holds::Unfelt(felt.not_felt.unwrap_or(NotFelt::TooWeak))),
        }
    }

    /// The line of a tone; `table` is that of the setup's plate, if it is known.
    #[must_use]
    pub fn of(setup: &Setup, tone: &ToneSetup, table: Option<&DriveTable>) -> Self {
        let is_solved = setup.boundary == BoundaryMode::FeltEdge;
        let field = table
            .filter(|_| is_solved)
            .map(|table| SteadyField::solve(&setup.plate, &[SteadyTone::of(setup, tone, table)]));
        Self::of_wave(setup, tone, field.as_ref().and_then(|field| field.tones.first()))
    }
}

/// The sensation of a tone alone, whose edge the line holds.
#[must_use]
pub(crate) fn felt_alone(setup: &Setup, wave: &ToneWave) -> Felt {
    let tone_alone = [(wave.tone.frequency_hz, &wave.wave[..])];
    Felt::of_tones(&setup.plate, &setup.feeling, &tone_alone)
}

/// The lines of a setup's tones, in their order; `field` is the field of the setup without a finger in metres of
/// displacement, if that is known.
#[must_use]
pub fn lines(setup: &Setup, field: Option<&SteadyField>) -> Vec<Line> {
    let wave = |slot| field.and_then(|field| field.tone(slot));
    setup.tones.iter().map(|tone| Line::of_wave(setup, tone, wave(tone.slot))).collect()
}

/// The places of the line with the tone's turning point at either end of the plate's span, in metres. A tone
/// that moves is not part of a chord.
#[must_use]
pub fn limits_m(setup: &Setup, tone: &ToneSetup, table: Option<&DriveTable>) -> (f64, f64) {
    let setup = &setup.without_chord();
    let (start_m, end_m) = setup.plate.span_m();
    let at = |position_m| Line::of(setup, &ToneSetup { position_m, ..*tone }, table).place_m;
    (at(start_m), at(end_m))
}

/// The turning point that puts the tone's line at `place_m`, or as near to it as the plate's span allows, in
/// metres.
///
/// Nearer to the driven end than any felt edge, the line can only be at the turning point of a tone that is
/// not felt.
#[must_use]
pub fn turning_point_m(setup: &Setup, tone: &ToneSetup, table: Option<&DriveTable>, place_m: f64) -> f64 {
    let setup = &setup.without_chord();
    let (start_m, end_m) = setup.plate.span_m();
    let clamped_m = place_m.clamp(start_m, end_m);
    if setup.boundary == BoundaryMode::TurningPoint || table.is_none() {
        return clamped_m;
    }
    let line = |position_m| Line::of(setup, &ToneSetup { position_m, ..*tone }, table);
    // Distance of the felt edge beyond the wanted place; it rises with the turning point.
    let off_m = |position_m| match line(position_m) {
        Line { holds: Holds::Unfelt(_), .. } => f64::NEG_INFINITY,
        Line { place_m: found_m, .. } => found_m - place_m,
    };
    let (mut low_m, mut high_m) = (start_m, end_m);
    let mut at_m = tone.position_m.clamp(start_m, end_m);
    let mut latest: Option<(f64, f64)> = None;
    for _ in 0..TRIES {
        let off = off_m(at_m);
        if off.abs() < CLOSE_M {
            return at_m;
        }
        if off < 0.0 {
            low_m = at_m;
        } else {
            high_m = at_m;
        }
        if high_m - low_m < CLOSE_M {
            break;
        }
        // Secant through the latest two points; at first, as if the edge kept its distance from the turning
        // point.
        let slope = latest.map_or(1.0, |(before_m, before)| (off - before) / (at_m - before_m));
        let next_m = at_m - off / slope;
        latest = off.is_finite().then_some((at_m, off));
        at_m = if next_m > low_m && next_m < high_m {
            next_m
        } else if next_m >= high_m && high_m == end_m {
            end_m
        } else if next_m <= low_m && low_m == start_m && off.is_finite() {
            start_m
        } else {
            0.5 * (low_m + high_m)
        };
    }
    // There is no such felt edge: take the place itself if a tone that turns there is not felt, else the
    // nearest felt edge.
    match line(clamped_m).holds {
        Holds::Unfelt(_) => clamped_m,
        Holds::TurningPoint | Holds::FeltEdge | Holds::PlateEnd => high_m,
    }
}

/// The setup with its lines moved back to these places, as far as possible: the quantity that the line holds
/// keeps its place when a level changes. `places_m` has the places of tones' lines, by their slots.
#[must_use]
pub fn held(mut setup: Setup, places_m: &[(u8, f64)], table: Option<&DriveTable>) -> Setup {
    for i in 0..setup.tones.len() {
        let tone = setup.tones[i];
        if let Some(&(_, place_m)) = places_m.iter().find(|(slot, _)| *slot == tone.slot) {
            setup.tones[i].position_m = turning_point_m(&setup, &tone, table, place_m);
        }
    }
    setup
}

#[cfg(test)]
mod tests;
