//! The level hold: the bodies of the command that orders it and of the event that reports its state.

use crate::limits::{HELD_AMPLITUDE, MAX_HOLD_CDB, MAX_RISE_CDB, MAX_TONES};
use crate::schema::{body, choices};
use crate::units::{CentiDecibel, SampleIndex};
use heapless::Vec;

body! {
    /// A tone to hold.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct HoldTone {
        /// Its slot. It must sound.
        pub slot: u8 ["", 0, MAX_TONES - 1],
        /// The amplitude to hold at the input.
        pub amplitude: u32 ["1/256 code", HELD_AMPLITUDE.0, HELD_AMPLITUDE.1],
    }
}

body! {
    /// The body of [`Command::Hold`](crate::Command::Hold).
    #[derive(Clone, Debug, Default, PartialEq, Eq)]
    pub struct HoldSetting {
        /// The input, from 0.
        pub input: u8 [""],
        /// The plate's time constant `2 / (loss factor * angular frequency)`; of several tones the longest. At most 60 s.
        pub time_constant: u32 ["samples"],
        /// The length of a window. New levels come by a glide of half of it and of the pause after it, which must not be shorter
        /// than a drive's shortest glide.
        pub blocks: u16 ["blocks", 1, u16::MAX],
        /// How far above its drive's level a tone may rise.
        pub max_rise: CentiDecibel ["1/100 dB", 0, MAX_RISE_CDB],
        /// The largest change of a level from one window to the next. Less than 6 dB makes the hold slower than it could be.
        pub slew: CentiDecibel ["1/100 dB", 1, MAX_HOLD_CDB],
        /// The tones, each in a slot of its own. None: the hold ends.
        pub tones: Vec<HoldTone, MAX_TONES> [""],
    }
}

choices! {
    /// Progress of a hold.
    #[derive(Default)]
    pub enum HoldProgress {
        /// None has been ordered in this session, or the host has ended it.
        #[default]
        0 since 0 Off,
        /// The hold is on.
        1 since 0 On,
        /// A drive, a chord, a comb, a table, a stop, a disarm or a fault has ended it.
        2 since 0 Ended,
        /// Every tone was lost, and all are back at their drive's levels.
        3 since 0 Lost,
    }
}

choices! {
    /// The limit that keeps a tone from rising or falling further.
    pub enum HoldLimit {
        /// The largest rise that the host allows.
        0 since 0 Rise,
        /// The tone's own full level.
        1 since 0 Level,
        /// The sum of all tones is full scale.
        2 since 0 Headroom,
        /// The thermal fold-back.
        3 since 0 Thermal,
        /// The limit of the travel.
        4 since 0 Travel,
        /// The lowest level: 60 dB below that of the drive.
        5 since 0 Fall,
    }
}

choices! {
    /// Why a tone was lost.
    pub enum HoldLoss {
        /// It was silent for a while, or its phase jumped.
        0 since 0 NotFollowed,
        /// Its answer stays below a quarter of the set amplitude: the sensor is unplugged, or the plate is held fast.
        1 since 0 TooWeak,
        /// A code of the input was at an end of its range.
        2 since 0 Clipped,
        /// All codes of the input were the same.
        3 since 0 Stuck,
        /// Codes of the input were lost.
        4 since 0 Broken,
        /// It was at its largest rise for 10 s: the sensor has slipped, or more lies on the plate than a finger.
        5 since 0 AtRise,
    }
}

choices! {
    /// The state of a held tone.
    pub enum HoldState {
        /// It is on its way to the set amplitude.
        0 since 0 Settling,
        /// It is within 1 dB of it.
        1 since 0 Held,
        /// It is further off, and a limit keeps it there.
        2 since 0 AtLimit(HoldLimit),
        /// It is no longer held and has its drive's level.
        3 since 0 Lost(HoldLoss),
    }
}

body! {
    /// A held tone.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct HeldTone {
        /// Its slot.
        pub slot: u8 ["", 0, MAX_TONES - 1],
        /// Its state, now or when the hold ended.
        pub state: HoldState [""],
        /// The level in force relative to its drive's level.
        pub correction: CentiDecibel ["1/100 dB"],
        /// The amplitude that the last window has measured; 0 before the first.
        pub amplitude: u32 ["1/256 code"],
    }
}

body! {
    /// The body of [`Event::Held`](crate::Event::Held).
    #[derive(Clone, Debug, Default, PartialEq, Eq)]
    pub struct Held {
        /// Progress of the hold.
        pub progress: HoldProgress [""],
        /// The input whose amplitudes are held.
        pub input: u8 [""],
        /// The first sample of the window under way, or of the last one.
        pub begin: SampleIndex ["samples"],
        /// The windows that have been taken; stops at its largest value.
        pub windows: u32 [""],
        /// The held tones, by their slots. They stay as they were when the hold ended; none after the host has ended it.
        pub tones: Vec<HeldTone, MAX_TONES> [""],
    }
}
