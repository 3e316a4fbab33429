//! Parameters of a hold, and their checks.

use super::octaves::Octaves;
use slipline_dds::bank::TONES;
use slipline_protocol::limits::HELD_AMPLITUDE;
use slipline_protocol::units::Gain;

/// The least amplitude that can be held: 1/16 code, in 1/256 code.
pub const MIN_AMPLITUDE: u32 = HELD_AMPLITUDE.0;
/// The largest amplitude that fits the inputs' range, 2047 codes, in 1/256 code.
pub const MAX_AMPLITUDE: u32 = HELD_AMPLITUDE.1;

/// Parameters of the loops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LoopSetting {
    /// From the beginning of one window to that of the next, in samples: twice the shortest glide (10 ms) at least.
    pub period: u32,
    /// The plate's time constant `2 / (eta omega)`, in samples; any. Of several tones the longest.
    pub tau: u32,
    /// How far above the table's level a tone may rise, 0 to [`Octaves::MAX`].
    pub max_rise: Octaves,
    /// How long a tone may stay at that, in samples; any.
    pub at_rise: u32,
    /// The largest change of a level per period, above 0 to [`Octaves::MAX`]. With less than an octave the loop is slower
    /// than it could be.
    pub slew: Octaves,
}

/// A tone to hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ToneToHold {
    /// Its slot, below 16.
    pub slot: u8,
    /// The amplitude to hold, in 1/256 code at the input, [`MIN_AMPLITUDE`]`..=`[`MAX_AMPLITUDE`].
    pub amplitude: u32,
    /// Its level by the drive in force, master included; above 0, at most 1. The largest rise counts from here.
    pub level: Gain,
    /// The level that sounds, in the same range: another one where an earlier hold of this drive has left it.
    pub sounding: Gain,
}

/// Why a hold cannot begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SettingError {
    /// `period` is too short.
    Period {
        /// The shortest, in samples.
        shortest: u32,
    },
    /// `max_rise` is below 0 or above [`Octaves::MAX`].
    MaxRise,
    /// `slew` is not above 0, or above [`Octaves::MAX`].
    Slew,
    /// There is no such slot; the highest is 15.
    Slot {
        /// Which.
        slot: u8,
    },
    /// A slot is named twice.
    SlotTwice {
        /// Which.
        slot: u8,
    },
    /// The amplitude is not in [`MIN_AMPLITUDE`]`..=`[`MAX_AMPLITUDE`].
    Amplitude {
        /// Whose.
        slot: u8,
        /// The requested amplitude.
        amplitude: u32,
    },
    /// The level is 0 or above 1: a silent tone cannot be measured.
    Level {
        /// Whose.
        slot: u8,
    },
}

impl LoopSetting {
    pub(super) fn check(&self, min_glide: u32) -> Result<(), SettingError> {
        let shortest = min_glide.max(1).saturating_mul(2);
        if self.period < shortest {
            return Err(SettingError::Period { shortest });
        }
        if !(Octaves::NONE..=Octaves::MAX).contains(&self.max_rise) {
            return Err(SettingError::MaxRise);
        }
        if self.slew <= Octaves::NONE || self.slew > Octaves::MAX {
            return Err(SettingError::Slew);
        }
        Ok(())
    }
}

impl ToneToHold {
    pub(super) fn check(&self) -> Result<(), SettingError> {
        let slot = self.slot;
        if usize::from(slot) >= TONES {
            return Err(SettingError::Slot { slot });
        }
        if !(MIN_AMPLITUDE..=MAX_AMPLITUDE).contains(&self.amplitude) {
            return Err(SettingError::Amplitude { slot, amplitude: self.amplitude });
        }
        if [self.level, self.sounding].iter().any(|level| !(1..=Gain::FULL.0).contains(&level.0)) {
            return Err(SettingError::Level { slot });
        }
        Ok(())
    }
}
