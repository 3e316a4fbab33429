//! Changes of a setup, their limits, and the resulting requests to the device.
//!
//! ```text
//! view --Edit--> apply (limits) --> Setup --> drive --> DriveRequest --> link worker
//!                                     \--> crate::setup::undo (undo, redo)
//! ```

use crate::setup::{BoundaryMode, GLIDE_RANGE_S, MASTER_MIN_DB, MAX_TONES, Setup, ToneSetup};
use slipline_link::protocol::command::Apply;
use slipline_link::{DriveRequest, ToneRequest};
use slipline_plate::Plate;
use slipline_plate::feeling::Feeling;
use slipline_plate::quantity::{OutOfRange, Range};
use std::sync::Arc;

/// One change of the setup.
#[derive(Clone, Debug)]
pub enum Edit {
    /// Move a tone's turning point; a place outside the span is clamped to the span's end.
    Move {
        /// The slot of the tone.
        slot: u8,
        /// The new place, in metres.
        position_m: f64,
    },
    /// Set a tone's level, 0..=1.
    Level {
        /// The slot of the tone.
        slot: u8,
        /// The level, 0..=1.
        level: f64,
    },
    /// Set the phase with which a tone starts, in turns.
    Phase {
        /// The slot of the tone.
        slot: u8,
        /// Any number of turns; only the fraction counts.
        turns: f64,
    },
    /// Add a tone in the lowest free slot, with its turning point here.
    Add {
        /// The place, in metres.
        position_m: f64,
    },
    /// Remove a tone. The last one cannot be removed.
    Remove {
        /// The slot of the tone.
        slot: u8,
    },
    /// Set the master level, in dB.
    Master(f64),
    /// Set the glide time, in seconds.
    Glide(f64),
    /// Choose the place that the boundary lines hold.
    Boundary(BoundaryMode),
    /// Set the parameters of a finger's sensation.
    Feeling(Feeling),
    /// Change the plate; the tones keep their places as far as its span allows.
    Plate(Arc<Plate>),
    /// Play these tones of a texture, as a chord if its gain in dB is given.
    Texture {
        /// The tones; the first is the boundary.
        tones: Vec<ToneSetup>,
        /// See [`Setup::chord_gain_db`].
        chord_gain_db: Option<f64>,
    },
    /// Replace the whole setup, for example by one read from a file.
    Replace(Box<Setup>),
    /// Start again with this setup.
    New(Box<Setup>),
    /// Show the other of the two compared setups.
    Switch(Box<Setup>),
}

/// Why a change was refused. The setup is unchanged.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EditError {
    /// A value is outside its range, or not a number. The field has the name that the user sees.
    #[error("{}", .0.in_suitable_units())]
    OutOfRange(#[source] OutOfRange),
    /// There is no tone in this slot.
    #[error("there is no tone {}", u16::from(*.0) + 1)]
    NoTone(u8),
    /// All slots are in use.
    #[error("all {MAX_TONES} tones are in use")]
    Full,
    /// The boundary itself cannot be removed.
    #[error("the last tone stays: stop the drive instead")]
    LastTone,
}

/// The name of [`Edit::Switch`].
pub const SWITCH: &str = "switch of A and B";

impl Edit {
    /// Its name in a menu, as in `Undo move`.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Move { .. } => "move",
            Self::Level { .. } => "level",
            Self::Phase { .. } => "phase",
            Self::Add { .. } => "add tone",
            Self::Remove { .. } => "remove tone",
            Self::Master(_) => "master level",
            Self::Glide(_) => "glide",
            Self::Boundary(_) => "kind of boundary line",
            Self::Feeling(_) => "feeling",
            Self::Plate(_) => "plate",
            Self::Texture { .. } => "texture",
            Self::Replace(_) => "open setup",
            Self::New(_) => "new setup",
            Self::Switch(_) => SWITCH,
        }
    }

    /// The tone that it changes, if it changes only one.
    pub(crate) const fn slot(&self) -> Option<u8> {
        let (Self::Move { slot, .. }
        | Self::Level { slot, .. }
        | Self::Phase { slot, .. }
        | Self::Remove { slot }) = *self
        else {
            return None;
        };
        Some(slot)
    }
}

/// The setup after a change.
///
/// # Errors
/// [`EditError`], naming the field and its range; the given setup stays unchanged.
pub fn apply(setup: &Setup, edit: &Edit) -> Result<Setup, EditError> {
    let mut next = setup.clone();
    match *edit {
        Edit::Move { slot, position_m } => {
            let span = setup.plate.span_m();
            finite("boundary", position_m, Range::new(span.0, span.1, "m"))?;
            tone_mut(&mut next, slot)?.position_m = position_m.clamp(span.0, span.1);
        }
        Edit::Level { slot, level } => {
            tone_mut(&mut next, slot)?.level = within("level", level, (0.0, 1.0), "")?;
        }
        Edit::Phase { slot, turns } => {
            finite("phase", turns, Range::new(0.0, 1.0, "turn"))?;
            tone_mut(&mut next, slot)?.phase_turns = turns.rem_euclid(1.0);
        }
        Edit::Add { position_m } => {
            let span = setup.plate.span_m();
            finite("tone", position_m, Range::new(span.0, span.1, "m"))?;
            let slot = setup.free_slot().ok_or(EditError::Full)?;
            let level = setup.tones.first().map_or(0.5, |tone| tone.level);
            let position_m = position_m.clamp(span.0, span.1);
            next.tones.push(ToneSetup { slot, position_m, level, phase_turns: 0.0 });
        }
        Edit::Remove { slot } => {
            setup.tone(slot).ok_or(EditError::NoTone(slot))?;
            if setup.tones.len() == 1 {
                return Err(EditError::LastTone);
            }
            next.tones.retain(|tone| tone.slot != slot);
        }
        Edit::Master(db) => {
            next.master_db = within("master level", db, (MASTER_MIN_DB, 0.0), "dB")?;
        }
        Edit::Glide(seconds) => {
            next.glide_s = within("glide", seconds, GLIDE_RANGE_S, "s")?;
        }
        Edit::Boundary(mode) => next.boundary = mode,
        Edit::Feeling(feeling) => next.feeling = feeling.checked().map_err(EditError::OutOfRange)?,
        Edit::Plate(ref plate) => {
            let (start, end) = plate.span_m();
            let (old_start, old_end) = setup.plate.span_m();
            let fits = setup.tones.iter().all(|tone| (start..=end).contains(&tone.position_m));
            for tone in &mut next.tones {
                // Clamping would collect the tones at one end, so on a plate with another span the tones keep
                // their proportions.
                if !fits {
                    let share = (tone.position_m - old_start) / (old_end - old_start);
                    tone.position_m = (start + share * (end - start)).clamp(start, end);
                }
            }
            next.plate = Arc::clone(plate);
        }
        Edit::Texture { ref tones, chord_gain_db } => {
            // The texture keeps its loudness; none of its tones alone has a felt edge.
            let (tones, boundary) = (tones.clone(), BoundaryMode::TurningPoint);
            return Ok(Setup { tones, boundary, master_db: 0.0, chord_gain_db, ..next });
        }
        Edit::Replace(ref setup) | Edit::New(ref setup) | Edit::Switch(ref setup) => {
            return Ok((**setup).clone());
        }
    }
    // Tones that have moved may no longer be multiples, and their peak is another.
    if !matches!(edit, Edit::Master(_) | Edit::Glide(_) | Edit::Boundary(_) | Edit::Feeling(_)) {
        next.chord_gain_db = None;
    }
    Ok(next)
}

/// The drive request for a setup.
#[must_use]
pub fn drive(setup: &Setup) -> DriveRequest {
    let tone = |&ToneSetup { slot, position_m, level, phase_turns }: &ToneSetup| ToneRequest {
        slot,
        boundary_m: position_m,
        level,
        phase_turns,
    };
    let tones = setup.tones.iter().map(tone).collect();
    DriveRequest { tones, master_db: setup.master_db, glide_s: setup.glide_s, apply: Apply::Next }
}

fn tone_mut(setup: &mut Setup, slot: u8) -> Result<&mut ToneSetup, EditError> {
    setup.tones.iter_mut().find(|tone| tone.slot == slot).ok_or(EditError::NoTone(slot))
}

/// Refuses NaN and infinity; a number beyond the range is accepted.
fn finite(field: &'static str, value: f64, range: Range) -> Result<(), EditError> {
    if value.is_finite() { Ok(()) } else { Err(EditError::OutOfRange(OutOfRange { field, value, range })) }
}

/// The value if it lies in the range; NaN does not.
fn within(
    field: &'static str,
    value: f64,
    (low, high): (f64, f64),
    unit: &'static str,
) -> Result<f64, EditError> {
    OutOfRange::check(field, value, Range::new(low, high, unit)).map_err(EditError::OutOfRange)?;
    Ok(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn setup() -> Setup {
        let preset = &slipline_plate::presets()[0];
        Setup::new(Arc::new(slipline_plate::preset(preset.name).unwrap()))
    }

    #[test]
    fn a_tone_cannot_be_moved_off_the_span_and_nan_is_refused() {
        let setup = setup();
        let (start, end) = setup.plate.span_m();
        for (to, want) in [(-1.0, start), (9.0, end), (0.5 * (start + end), 0.5 * (start + end))] {
            let moved = apply(&setup, &Edit::Move { slot: 0, position_m: to }).unwrap();
            assert_eq!(moved.tones[0].position_m, want);
        }
        for bad in [f64::NAN, f64::INFINITY] {
            assert!(apply(&setup, &Edit::Move { slot: 0, position_m: bad }).is_err());
            assert!(apply(&setup, &Edit::Level { slot: 0, level: bad }).is_err());
            assert!(apply(&setup, &Edit::Master(bad)).is_err());
            assert!(apply(&setup, &Edit::Glide(bad)).is_err());
            assert!(apply(&setup, &Edit::Phase { slot: 0, turns: bad }).is_err());
        }
    }

    #[test]
    fn a_refused_value_names_its_field_and_range() {
        let error = apply(&setup(), &Edit::Master(3.0)).unwrap_err().to_string();
        assert_eq!(error, "master level = 3 dB: must be -96 to 0 dB");
        let error = apply(&setup(), &Edit::Glide(0.001)).unwrap_err().to_string();
        assert_eq!(error, "glide = 1 ms: must be 5 ms to 10 s");
    }

    #[test]
    fn sixteen_tones_fit_and_slots_stay_when_one_goes() {
        let mut setup = setup();
        for _ in 1..MAX_TONES {
            setup = apply(&setup, &Edit::Add { position_m: 0.1 }).unwrap();
        }
        assert_eq!(apply(&setup, &Edit::Add { position_m: 0.1 }).unwrap_err(), EditError::Full);
        setup = apply(&setup, &Edit::Remove { slot: 5 }).unwrap();
        assert_eq!(setup.tones.iter().map(|tone| tone.slot).filter(|&slot| slot > 5).count(), 10);
        assert_eq!(apply(&setup, &Edit::Remove { slot: 5 }).unwrap_err(), EditError::NoTone(5));
        setup = apply(&setup, &Edit::Add { position_m: 0.1 }).unwrap();
        assert!(setup.tone(5).is_some());
    }

    #[test]
    fn tones_keep_their_proportions_on_a_plate_with_another_span() {
        let setup = setup();
        for preset in slipline_plate::presets() {
            let plate = Arc::new(slipline_plate::preset(preset.name).unwrap());
            let (start, end) = plate.span_m();
            let next = apply(&setup, &Edit::Plate(plate)).unwrap();
            assert!(
                next.tones.iter().all(|tone| (start..=end).contains(&tone.position_m)),
                "{}",
                preset.name
            );
        }
    }
}
