//! A comb in shares and seconds, and its conversion to the device's units.

use crate::drive::{self, DriveError};
use crate::harmonic::{HarmonicRequest, harmonics};
use crate::out_of_range::OutOfRange;
use slipline_protocol::command::{Apply, Comb, CombTone, TravelLimit};
use slipline_protocol::event::Identity;
use slipline_protocol::limits::{COMB_BLOCK, COMB_PERIOD_BLOCKS, MAX_FREQUENCY_PER_MILLE};

/// Tones that are multiples of the base frequency `rate / (128 period_blocks)`, within the table's
/// frequencies or beyond them. They begin in silence; their amplitudes may add up to full scale at most. A
/// window of whole periods separates them exactly ([`ListenRequest`](crate::ListenRequest)).
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CombRequest {
    /// The period in blocks of 128 samples, at least 1.
    pub period_blocks: u16,
    /// The tones, 1 to 16; tone i sounds in slot i.
    pub tones: Vec<HarmonicRequest>,
    /// Master level of all tones, in dB, -96..=0.
    pub master_db: f64,
    /// Rise time from silence, in seconds; rounded to the nearest time that the device supports.
    pub glide_s: f64,
    /// When the comb begins.
    pub apply: Apply,
}

impl CombRequest {
    /// A comb at full master level that begins at once and rises in 20 ms.
    #[must_use]
    pub const fn of(period_blocks: u16, tones: Vec<HarmonicRequest>) -> Self {
        Self { period_blocks, tones, master_db: 0.0, glide_s: 0.02, apply: Apply::Next }
    }

    /// Converts the comb to the device's units. A travel limit extends the rise to the time that the actuator
    /// needs to follow.
    ///
    /// # Errors
    /// [`DriveError`], naming the value and its range. The device checks that the multiples rise and that the
    /// amplitudes fit.
    pub fn for_device(&self, identity: &Identity, travel: Option<&TravelLimit>) -> Result<Comb, DriveError> {
        let (shortest, longest) = COMB_PERIOD_BLOCKS;
        OutOfRange::check(
            "comb's period (blocks)",
            self.period_blocks.into(),
            shortest.into(),
            longest.into(),
        )?;
        let period = f64::from(COMB_BLOCK) * f64::from(self.period_blocks);
        let highest = (period * f64::from(MAX_FREQUENCY_PER_MILLE) / 1000.0).floor().min(65_535.0);
        let tone = |harmonic, level, phase| CombTone { harmonic, level, phase };
        Ok(Comb {
            period_blocks: self.period_blocks,
            tones: harmonics(&self.tones, highest, identity, tone)?,
            master: drive::master(self.master_db)?,
            glide: drive::glide(self.glide_s, identity, travel)?,
            apply: self.apply,
        })
    }
}
