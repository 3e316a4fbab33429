//! The user's setup: the plate, the tones on it, the levels.
//!
//! A [`Setup`] is always valid: it is made from a valid plate and changed only through
//! [`crate::setup::edit`], which enforces the limits below.

pub mod compare;
pub mod edit;
pub mod file;
pub mod fragment;
pub mod undo;

use slipline_plate::Plate;
use slipline_plate::feeling::Feeling;
use slipline_plate::quantity::{decibels, from_decibels};
use std::sync::Arc;

/// Tones a setup may have; the device may allow fewer.
pub const MAX_TONES: usize = slipline_link::protocol::limits::MAX_TONES;
/// The quietest master level, in dB.
pub const MASTER_MIN_DB: f64 = slipline_link::protocol::limits::MIN_MASTER_CDB as f64 / 100.0;
/// The lowest master level of the slider, in dB; a typed value may go down to [`MASTER_MIN_DB`].
pub const MASTER_SLIDER_MIN_DB: f64 = -48.0;
/// Glide times a setup may have, in seconds: the protocol's own range.
pub const GLIDE_RANGE_S: (f64, f64) = (
    slipline_link::protocol::limits::MIN_GLIDE_MS as f64 * 1e-3,
    slipline_link::protocol::limits::MAX_GLIDE_MS as f64 * 1e-3,
);

/// Allowed gain of a chord over the sum of its amplitudes, in dB: the sum of sixteen is 12 dB above their
/// RMS.
pub(crate) const CHORD_GAIN_RANGE_DB: (f64, f64) = (0.0, 15.0);

/// One tone: one peak on the plate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToneSetup {
    /// The device's slot, 0..16. It does not change when other tones are removed, so that each tone glides
    /// undisturbed.
    pub slot: u8,
    /// Where its turning point lies, in metres from the driven end, within the plate's span.
    pub position_m: f64,
    /// Its peak relative to the table's full scale, 0..=1.
    pub level: f64,
    /// Phase when it starts from silence, in turns, 0..1.
    pub phase_turns: f64,
}

/// The place that the boundary line of a tone holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BoundaryMode {
    /// The felt edge: beyond it the tone is not felt. See [`crate::field::line`].
    #[default]
    FeltEdge,
    /// The turning point x0 of the tone.
    TurningPoint,
}

impl BoundaryMode {
    /// Its word, in files and on the command line.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::FeltEdge => "felt-edge",
            Self::TurningPoint => "turning-point",
        }
    }
}

/// Everything the user has set up.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The plate; the table is made for it.
    pub plate: Arc<Plate>,
    /// The tones in the order they were added; the first is the boundary.
    pub tones: Vec<ToneSetup>,
    /// Master level of all tones, in dB, -96..=0.
    pub master_db: f64,
    /// The glide time of a change, in seconds.
    pub glide_s: f64,
    /// The place that the boundary lines hold.
    pub boundary: BoundaryMode,
    /// Parameters of a finger's sensation. Illustrative: calibrate on your own plate.
    pub feeling: Feeling,
    /// Gain of its tones in dB when they are played as a chord, whose peak the device computes; `None` if
    /// they are not a chord, as after each change of a tone.
    pub chord_gain_db: Option<f64>,
}

impl PartialEq for Setup {
    fn eq(&self, other: &Self) -> bool {
        (Arc::ptr_eq(&self.plate, &other.plate) || self.plate.spec() == other.plate.spec())
            && self.tones == other.tones
            && self.master_db == other.master_db
            && self.glide_s == other.glide_s
            && self.boundary == other.boundary
            && self.feeling == other.feeling
            && self.chord_gain_db == other.chord_gain_db
    }
}

impl Setup {
    /// One boundary in the middle of the plate's span.
    #[must_use]
    pub fn new(plate: Arc<Plate>) -> Self {
        let (start, end) = plate.span_m();
        let tone = ToneSetup { slot: 0, position_m: 0.5 * (start + end), level: 0.8, phase_turns: 0.0 };
        Self {
            plate,
            tones: vec![tone],
            master_db: 0.0,
            glide_s: 0.02,
            boundary: BoundaryMode::default(),
            feeling: Feeling::default(),
            chord_gain_db: None,
        }
    }

    /// The master level in dB at which tones whose sum is `sum` times full scale (more than 1) fit the DAC. It is
    /// slightly lower than needed, because the device rounds to hundredths of a decibel.
    #[must_use]
    pub fn fitting_master_db(&self, sum: f64) -> f64 {
        (self.master_db - decibels(sum) - 0.05).max(MASTER_MIN_DB)
    }

    /// The factor of its tones as a chord; 1 if they are not a chord.
    #[must_use]
    pub(crate) fn chord_factor(&self) -> f64 {
        from_decibels(self.chord_gain_db.unwrap_or(0.0))
    }

    /// The same setup on a plate whose drive adds no harmonics, as after their cancellation.
    #[must_use]
    pub fn without_harmonics(&self) -> Self {
        Self { plate: Arc::new(self.plate.without_harmonics()), ..self.without_chord() }
    }

    /// The level at which a tone is played, 0 to 1: its own with the gain of a chord and the master level.
    #[must_use]
    pub fn played_level(&self, tone: &ToneSetup) -> f64 {
        (tone.level * self.chord_factor()).min(1.0) * self.master()
    }

    /// The same tones without a chord, as after a change of one of them.
    #[must_use]
    pub fn without_chord(&self) -> Self {
        Self { chord_gain_db: None, ..self.clone() }
    }

    /// The tone in a slot.
    #[must_use]
    pub fn tone(&self, slot: u8) -> Option<&ToneSetup> {
        self.tones.iter().find(|tone| tone.slot == slot)
    }

    /// The master level as a factor, 0..=1.
    #[must_use]
    pub fn master(&self) -> f64 {
        from_decibels(self.master_db)
    }

    /// The lowest free slot.
    #[must_use]
    pub fn free_slot(&self) -> Option<u8> {
        (0..MAX_TONES as u8).find(|&slot| self.tone(slot).is_none())
    }
}
