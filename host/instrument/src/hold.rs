//! Planning of the level hold: how long to listen to the sounding tones, and which amplitudes to hold.
//!
//! ```text
//! Plate, frequencies by slot --HoldPlan--> Listen, once the plate has settled --Listened--> Hold
//!                                                      snapshot.drive.hold --ToneWords--> sentences
//! the user's switch, snapshot --Holding--> these requests, one after the other, and how the hold stands
//! ```
//! The held amplitudes are those of the untouched plate when the hold begins: they are measured in one window
//! and held from then on. So the amplitudes need no model of the plate. The model gives only the plate's time
//! constant, `tau = 2 / (eta omega)` with its loss factor and the lowest tone.
//!
//! **The window** is a Hann window of at least two periods of the lowest tone, and of two periods of the
//! smallest difference frequency between tones, which separates their main lobes. It is at least 24 times as
//! long as the pause between two windows (0.1 s at 400 kS/s), so that the pauses add little to the recovery
//! time: -6 dB by a finger are corrected to within 1 dB after five times the longer of `tau` and the window.

mod course;
mod end;
mod holding;
mod standing;
mod words;

pub use end::HoldEnd;
pub use holding::Holding;
pub use standing::Standing;
pub use words::{ToneWords, progress_words, state_words, words};

use slipline_link::BLOCK;
use slipline_link::protocol::limits::{HELD_AMPLITUDE, HOLD_PAUSE_BLOCKS, MAX_RISE_CDB, MAX_TONES};
use slipline_link::{HoldRequest, HoldToneRequest, ListenRequest, Listened, WindowShape};
use slipline_plate::Plate;
use slipline_plate::quantity::Range;
use std::f64::consts::TAU;

/// Allowed limits for the rise of a held tone above its drive level.
pub const MAX_RISE: Range = Range::new(0.0, MAX_RISE_CDB as f64 / 100.0, "dB");
/// Largest rise without a user's choice, dB.
pub const USUAL_RISE_DB: f64 = 12.0;

/// Time constants to wait before the reference amplitudes are measured: 0.25 % of a transient remains.
const SETTLED: f64 = 6.0;
/// Pauses in the shortest window.
const PAUSES: u16 = 24;
/// The longest window, seconds. The device accepts 20 s, too long for a user to wait.
const LONGEST_S: f64 = 5.0;
/// The longest time constant that the device accepts, seconds.
const TIME_CONSTANT_MAX_S: f64 = 60.0;
/// The largest level change from window to window, dB: a factor of 2, the fastest hold.
const SLEW_DB: f64 = 6.02;
/// The smallest amplitude that can be held, codes: below it the noise of a window exceeds a tenth of a
/// decibel.
const LEAST_CODES: f64 = 1.0;

/// Why tones cannot be held.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum HoldError {
    /// The device has no inputs, or its firmware is too old to measure them.
    #[error("the device has no inputs that it can measure, so it cannot hold a level")]
    NoInputs,
    /// No tone sounds.
    #[error("no tone sounds that could be held")]
    NoTones,
    /// There are more tones than the device measures at once.
    #[error("{tones} tones sound, and the device measures {lock_ins} at once; hold fewer tones")]
    TooMany {
        /// Sounding tones.
        tones: usize,
        /// Tones that the device measures at once.
        lock_ins: usize,
    },
    /// Two tones are so close that the window to separate them would be too long.
    #[error(
        "two tones are {apart_hz:.3} Hz apart: to separate them takes {window_s:.1} s; {LONGEST_S} s are allowed"
    )]
    TooClose {
        /// Their frequency difference.
        apart_hz: f64,
        /// The window that separates them.
        window_s: f64,
    },
    /// The lowest tone is so low that a window of two periods would be too long.
    #[error("a tone of {frequency_hz:.3} Hz takes a window of {window_s:.1} s; {LONGEST_S} s are allowed")]
    TooLow {
        /// Its frequency.
        frequency_hz: f64,
        /// The window that it needs.
        window_s: f64,
    },
    /// A code of the input was at an end of its range.
    #[error("the sensor's input is clipped: lower its gain, or drive less loudly")]
    Clipped,
    /// All codes of the input were the same.
    #[error("the sensor's input does not move: nothing is connected to it, or its converter is stuck")]
    Stuck,
    /// A tone did not sound through the whole window.
    #[error("the tone in slot {slot} was interrupted while it was measured; hold again")]
    NotFollowed {
        /// Its slot.
        slot: u8,
    },
    /// The sensor's signal of a tone is too small.
    #[error(
        "the sensor receives only {codes:.2} codes of the tone in slot {slot}; at least {LEAST_CODES} are needed: \
         check the sensor, move it before the boundary, raise its gain, or drive louder"
    )]
    TooWeak {
        /// Its slot.
        slot: u8,
        /// The measured amplitude.
        codes: f64,
    },
}

/// Parameters of a level hold.
#[derive(Clone, Debug, PartialEq)]
pub struct HoldPlan {
    slots: u16,
    /// The input, from 0.
    pub input: u8,
    /// The plate's time constant at the lowest tone, seconds, at most 60.
    pub time_constant_s: f64,
    /// The length of a window, in blocks of 128 samples.
    pub blocks: u16,
    /// Largest rise of a tone above its drive level, dB, 0..=20.
    pub max_rise_db: f64,
    rate_hz: f64,
}

impl HoldPlan {
    /// Plans the hold of tones (slot, frequency in Hz) on a plate, for a device with this sample rate and
    /// number of lock-ins.
    ///
    /// # Errors
    /// [`HoldError`]
    pub fn new(
        plate: &Plate,
        tones: &[(u8, f64)],
        rate_hz: f64,
        lock_ins: usize,
        max_rise_db: f64,
    ) -> Result<Self, HoldError> {
        if lock_ins == 0 {
            return Err(HoldError::NoInputs);
        }
        let mut frequencies: Vec<f64> = tones.iter().map(|(_, hz)| *hz).collect();
        frequencies.sort_by(f64::total_cmp);
        let Some(&lowest_hz) = frequencies.first() else { return Err(HoldError::NoTones) };
        if tones.len() > lock_ins.min(MAX_TONES) {
            return Err(HoldError::TooMany { tones: tones.len(), lock_ins });
        }
        let apart_hz = frequencies.windows(2).map(|two| two[1] - two[0]).fold(f64::INFINITY, f64::min);
        let (of_period_s, of_distance_s) = (2.0 / lowest_hz, 2.0 / apart_hz);
        if of_period_s.is_nan() || of_period_s > LONGEST_S {
            return Err(HoldError::TooLow { frequency_hz: lowest_hz, window_s: of_period_s });
        }
        if of_distance_s > LONGEST_S {
            return Err(HoldError::TooClose { apart_hz, window_s: of_distance_s });
        }
        let blocks =
            (of_period_s.max(of_distance_s) * rate_hz / BLOCK as f64).ceil().min(f64::from(u16::MAX)) as u16;
        let time_constant_s = 2.0 / (plate.loss_factor_at(lowest_hz).max(1e-4) * TAU * lowest_hz);
        Ok(Self {
            slots: tones
                .iter()
                .fold(0, |slots, (slot, _)| slots | 1_u16.checked_shl((*slot).into()).unwrap_or(0)),
            input: 0,
            time_constant_s: time_constant_s.min(TIME_CONSTANT_MAX_S),
            blocks: blocks.max(PAUSES * HOLD_PAUSE_BLOCKS),
            max_rise_db,
            rate_hz,
        })
    }

    /// The length of a window, seconds.
    #[must_use]
    pub fn window_s(&self) -> f64 {
        f64::from(self.blocks) * BLOCK as f64 / self.rate_hz
    }

    /// Time after which -6 dB by a finger are corrected to within 1 dB, seconds: five times the longer of
    /// time constant and window.
    #[must_use]
    pub fn recovery_s(&self) -> f64 {
        5.0 * self.time_constant_s.max(self.window_s())
    }

    /// Settling time plus one window, seconds: how long the plate must stay untouched.
    #[must_use]
    pub(crate) fn listening_s(&self) -> f64 {
        SETTLED * self.time_constant_s + self.window_s()
    }

    /// The window in which the reference amplitudes are measured. `reached` is the sample index at which the
    /// tones have reached their levels; the plate's settling time is added. `None` listens at once.
    #[must_use]
    pub fn listen(&self, reached: Option<u64>) -> ListenRequest {
        let settle = (SETTLED * self.time_constant_s * self.rate_hz).ceil() as u64;
        ListenRequest {
            from: reached.map(|index| index.saturating_add(settle)),
            blocks: self.blocks,
            shape: WindowShape::Hann,
            slots: self.slots,
            input: self.input,
        }
    }

    /// Request to hold the measured amplitudes.
    ///
    /// # Errors
    /// [`HoldError`]: the input is clipped or stuck, or the signal of a tone is too small.
    pub fn hold(&self, listened: &Listened) -> Result<HoldRequest, HoldError> {
        if listened.lowest == listened.highest {
            return Err(HoldError::Stuck);
        }
        if listened.lowest == 0 || listened.highest >= 4095 {
            return Err(HoldError::Clipped);
        }
        let mut tones = Vec::new();
        for slot in (0..MAX_TONES as u8).filter(|slot| self.slots >> slot & 1 == 1) {
            let answer = listened.answers.get(usize::from(slot)).copied().flatten();
            let (re, im) = answer.ok_or(HoldError::NotFollowed { slot })?;
            let codes = re.hypot(im);
            if codes < LEAST_CODES {
                return Err(HoldError::TooWeak { slot, codes });
            }
            let most = f64::from(HELD_AMPLITUDE.1) / 256.0;
            tones.push(HoldToneRequest { slot, amplitude_codes: codes.min(most) });
        }
        Ok(HoldRequest {
            input: self.input,
            time_constant_s: self.time_constant_s,
            blocks: self.blocks,
            max_rise_db: self.max_rise_db,
            slew_db: SLEW_DB,
            tones,
        })
    }
}

#[cfg(test)]
mod tests;
