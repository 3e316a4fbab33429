//! Texts about an accepted hold and its tones.

use slipline_link::protocol::hold::Held;
use slipline_link::{HoldLimit, HoldLoss, HoldProgress, HoldState};

/// Report on one held tone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToneWords {
    /// Its slot.
    pub slot: u8,
    /// The correction in force above its drive level, dB.
    pub correction_db: f64,
    /// The amplitude measured last, codes.
    pub amplitude_codes: f64,
    /// Its state in a few words.
    pub words: &'static str,
    /// Whether it is at its amplitude or approaches it.
    pub is_well: bool,
}

/// Reports on the tones of a hold, by slot.
pub fn words(held: &Held) -> impl Iterator<Item = ToneWords> + '_ {
    held.tones.iter().map(|tone| ToneWords {
        slot: tone.slot,
        correction_db: f64::from(tone.correction.0) / 100.0,
        amplitude_codes: f64::from(tone.amplitude) / 256.0,
        words: state_words(tone.state),
        is_well: matches!(tone.state, HoldState::Settling | HoldState::Held),
    })
}

/// A tone's state in a few words.
#[must_use]
pub const fn state_words(state: HoldState) -> &'static str {
    match state {
        HoldState::Settling => "settling",
        HoldState::Held => "held",
        HoldState::AtLimit(limit) => match limit {
            HoldLimit::Rise => "at the largest rise that is allowed",
            HoldLimit::Level => "at its full level",
            HoldLimit::Headroom => "at full scale: there is no more headroom",
            HoldLimit::Thermal => {
                "at the thermal limit: the actuator is warm, or the device takes it for warm, as in the first 4 s after a reset"
            }
            HoldLimit::Travel => "at the limit of the actuator's travel",
            HoldLimit::Fall => "at the lowest level",
        },
        HoldState::Lost(loss) => match loss {
            HoldLoss::NotFollowed => "lost: the tone was interrupted",
            HoldLoss::TooWeak => "lost: too weak at the sensor",
            HoldLoss::Clipped => "lost: the sensor's input is clipped",
            HoldLoss::Stuck => "lost: the sensor's input does not move",
            HoldLoss::Broken => "lost: codes of the sensor's input were lost",
            HoldLoss::AtRise => "lost: at its largest rise for 10 s, the sensor may have slipped",
        },
    }
}

/// A hold's state as a sentence without a full stop.
#[must_use]
pub const fn progress_words(progress: HoldProgress) -> &'static str {
    match progress {
        HoldProgress::Off => "Nothing is held",
        HoldProgress::On => "The levels are held",
        HoldProgress::Ended => "The hold has ended: another command has changed the drive",
        HoldProgress::Lost => "The hold has lost all tones: they sound at the drive's levels",
    }
}
