//! A level hold in seconds, decibels and codes, and its conversion to the device's units.

use crate::drive::DriveError;
use crate::out_of_range::OutOfRange;
use slipline_protocol::command::TravelLimit;
use slipline_protocol::event::Identity;
pub use slipline_protocol::hold::{HeldTone, HoldLimit, HoldLoss, HoldProgress, HoldState};
use slipline_protocol::hold::{HoldSetting, HoldTone};
use slipline_protocol::limits::{
    BLOCK, HELD_AMPLITUDE, HOLD_PAUSE_BLOCKS, MAX_APPLY_AHEAD_MS, MAX_HOLD_CDB, MAX_RISE_CDB,
};
use slipline_protocol::timing::Timing;
use slipline_protocol::units::CentiDecibel;

/// Steps per code of an amplitude on the wire.
const CODE: f64 = 256.0;

/// A tone to hold.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct HoldToneRequest {
    /// Its slot, 0..16. It must sound.
    pub slot: u8,
    /// The amplitude to hold, in codes at the input, 1/16..=2047, as measured by a
    /// [`ListenRequest`](crate::ListenRequest).
    pub amplitude_codes: f64,
}

/// Holds the measured amplitudes of sounding tones at these values until another command changes the drive.
/// While it is on, [`DriveView::hold`](crate::DriveView::hold) has its state, a
/// [`ListenRequest`](crate::ListenRequest) is refused, and the mirror does not know the codes. To change a
/// hold, end it first.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct HoldRequest {
    /// The input, from 0.
    pub input: u8,
    /// The plate's time constant `2 / (loss factor * angular frequency)` in seconds, 0..=60; the longest one
    /// of several tones.
    pub time_constant_s: f64,
    /// The length of a window in blocks of 128 samples; extended where the device's drives must be slower.
    pub blocks: u16,
    /// Largest rise of a tone above its drive level, in dB, 0..=20.
    pub max_rise_db: f64,
    /// The largest change of a level from one window to the next, in dB, 0.01..=60.2. Less than 6 dB makes
    /// the hold slower than possible.
    pub slew_db: f64,
    /// The tones, at most 16, each in its own slot; an empty list ends the hold.
    pub tones: Vec<HoldToneRequest>,
}

impl HoldRequest {
    /// The end of the hold: the levels return to those of the drive.
    pub const OFF: Self = Self {
        input: 0,
        time_constant_s: 0.0,
        blocks: 1,
        max_rise_db: 0.0,
        slew_db: 6.02,
        tones: Vec::new(),
    };

    /// Converts the hold to the device's units. A travel limit extends the windows to the time that the
    /// actuator needs to follow the levels.
    ///
    /// # Errors
    /// [`DriveError`], naming the value and its range. The device checks that the tones sound.
    pub fn for_device(
        &self,
        identity: &Identity,
        travel: Option<&TravelLimit>,
    ) -> Result<HoldSetting, DriveError> {
        let timing = Timing::at(identity.sample_rate_hz);
        let glide = travel.map_or(timing.min_glide, |limit| timing.shortest_glide(limit));
        // The levels glide for half of a window and its pause.
        let shortest =
            glide.saturating_mul(2).div_ceil(BLOCK as u32).saturating_sub(HOLD_PAUSE_BLOCKS.into());
        let shortest = u16::try_from(shortest).unwrap_or(u16::MAX);
        let longest_s = f64::from(MAX_APPLY_AHEAD_MS) / 1000.0;
        OutOfRange::check("time constant (s)", self.time_constant_s, 0.0, longest_s)?;
        let level = |field, got, least, most: i16| {
            OutOfRange::check(field, got, least, f64::from(most) / 100.0)?;
            Ok::<_, OutOfRange>(CentiDecibel((got * 100.0).round() as i16))
        };
        let (least, most) = HELD_AMPLITUDE;
        let mut tones = heapless::Vec::new();
        for tone in &self.tones {
            let (least, most) = (f64::from(least) / CODE, f64::from(most) / CODE);
            let checked = OutOfRange::check("amplitude to hold (codes)", tone.amplitude_codes, least, most);
            checked.map_err(|value| DriveError::Tone { slot: tone.slot, value })?;
            let amplitude = (tone.amplitude_codes * CODE).round() as u32;
            let too_many = |_| DriveError::TooManyTones { got: self.tones.len(), max: identity.tones };
            tones.push(HoldTone { slot: tone.slot, amplitude }).map_err(too_many)?;
        }
        Ok(HoldSetting {
            input: self.input,
            time_constant: (self.time_constant_s * f64::from(identity.sample_rate_hz)).round() as u32,
            blocks: if self.tones.is_empty() { self.blocks } else { self.blocks.max(shortest) },
            max_rise: level("largest rise (dB)", self.max_rise_db, 0.0, MAX_RISE_CDB)?,
            slew: level("largest change from window to window (dB)", self.slew_db, 0.01, MAX_HOLD_CDB)?,
            tones,
        })
    }
}
