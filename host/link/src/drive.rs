//! A drive in metres, levels and decibels, and its conversion to the device's units.

use crate::out_of_range::OutOfRange;
use crate::table;
use slipline_protocol::command::{Apply, Drive, TableHeader, Tone, TravelLimit};
use slipline_protocol::event::Identity;
use slipline_protocol::limits::MIN_MASTER_CDB;
use slipline_protocol::timing::Timing;
use slipline_protocol::units::{CentiDecibel, Level, Phase};

/// One tone, in metres and shares.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ToneRequest {
    /// 0..16. A sounding slot glides from its present place; a slot that is not listed fades out.
    pub slot: u8,
    /// Its turning point, in metres from the driven end, within the device table's span.
    pub boundary_m: f64,
    /// Its peak relative to the table's full scale, 0..=1.
    pub level: f64,
    /// Phase at its start from silence, in turns.
    pub phase_turns: f64,
}

/// A drive, in metres, decibels and seconds; the link converts it to the device's units.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct DriveRequest {
    /// The tones, at most 16, each in its own slot; an empty list fades all tones out.
    pub tones: Vec<ToneRequest>,
    /// Master level of all tones, in dB, -96..=0.
    pub master_db: f64,
    /// Duration of the change, in seconds; rounded to the nearest time that the device supports.
    pub glide_s: f64,
    /// When the change begins.
    pub apply: Apply,
}

impl DriveRequest {
    /// A drive at full master level that begins at once and takes 20 ms.
    #[must_use]
    pub fn of(tones: Vec<ToneRequest>) -> Self {
        Self { tones, master_db: 0.0, glide_s: 0.02, apply: Apply::Next }
    }

    /// As [`DriveRequest::of`], with tones given as (place in metres, level) at phase 0, in slots from 0 on.
    #[must_use]
    pub fn at(tones: &[(f64, f64)]) -> Self {
        let tones = (0u8..).zip(tones).map(|(slot, &(boundary_m, level))| ToneRequest {
            slot,
            boundary_m,
            level,
            phase_turns: 0.0,
        });
        Self::of(tones.collect())
    }
}

/// Why a drive cannot be converted to the device's units.
#[derive(Clone, Debug, PartialEq, thiserror::Error, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum DriveError {
    /// There is no table by which to place tones.
    #[error("the device has no turning-point table: upload one first")]
    NoTable,
    /// More tones than the device has slots.
    #[error("{got} tones; the device has {max}")]
    TooManyTones {
        /// Number of requested tones.
        got: usize,
        /// Number of slots.
        max: u8,
    },
    /// A value lies outside its range or is not a number.
    #[error("tone {}: {value}", u16::from(*slot) + 1)]
    Tone {
        /// The tone's slot; the text counts tones from 1.
        slot: u8,
        /// The value, and its range.
        value: OutOfRange,
    },
    /// The master level lies outside -96..=0 dB or is not a number; or the glide time is negative or not a
    /// number.
    #[error("the {0}")]
    OutOfRange(#[from] OutOfRange),
}

impl DriveRequest {
    /// Converts the drive to the device's units, placed by the span of its active table. A travel limit
    /// extends the glide to the time that the actuator needs to follow.
    ///
    /// # Errors
    /// [`DriveError`], naming the value and its range, by the device's own rule.
    pub fn for_device(
        &self,
        identity: &Identity,
        table: Option<&TableHeader>,
        travel: Option<&TravelLimit>,
    ) -> Result<Drive, DriveError> {
        let table = table.ok_or(DriveError::NoTable)?;
        let too_many = || DriveError::TooManyTones { got: self.tones.len(), max: identity.tones };
        if self.tones.len() > usize::from(identity.tones) {
            return Err(too_many());
        }
        let mut tones = heapless::Vec::new();
        for tone in &self.tones {
            let slot = tone.slot;
            let refuse = |value| DriveError::Tone { slot, value };
            let check = |field, got, min, max| OutOfRange::check(field, got, min, max).map_err(refuse);
            check("slot", f64::from(slot), 0.0, f64::from(identity.tones) - 1.0)?;
            let (start_m, end_m) = table::span_m(table);
            let position = table::position_in(table, tone.boundary_m).ok_or_else(|| {
                let (got, min, max) = (tone.boundary_m * 1e3, start_m * 1e3, end_m * 1e3);
                refuse(OutOfRange { field: "boundary (mm)".into(), got, min, max })
            })?;
            let level = level(tone.level).map_err(refuse)?;
            let phase = phase(tone.phase_turns).map_err(refuse)?;
            tones.push(Tone { slot, position, level, phase }).map_err(|_| too_many())?;
        }
        Ok(Drive {
            tones,
            master: master(self.master_db)?,
            glide: glide(self.glide_s, identity, travel)?,
            apply: self.apply,
        })
    }
}

/// A tone's level in the device's units.
pub(crate) fn level(level: f64) -> Result<Level, OutOfRange> {
    table::level(level).ok_or(OutOfRange { field: "level".into(), got: level, min: 0.0, max: 1.0 })
}

/// A phase of any number of turns in the device's units.
pub(crate) fn phase(turns: f64) -> Result<Phase, OutOfRange> {
    if !turns.is_finite() {
        return Err(OutOfRange { field: "phase (turns)".into(), got: turns, min: 0.0, max: 1.0 });
    }
    Ok(Phase((turns.rem_euclid(1.0) * 65536.0).round() as u32 as u16))
}

/// A master level in the device's units.
pub(crate) fn master(master_db: f64) -> Result<CentiDecibel, OutOfRange> {
    let lowest_db = f64::from(MIN_MASTER_CDB) / 100.0;
    OutOfRange::check("master level (dB)", master_db, lowest_db, 0.0)?;
    Ok(CentiDecibel((master_db * 100.0).round() as i16))
}

/// A glide in the device's units: the nearest time that the device supports and its actuator can follow.
pub(crate) fn glide(
    glide_s: f64,
    identity: &Identity,
    travel: Option<&TravelLimit>,
) -> Result<u32, OutOfRange> {
    OutOfRange::check("glide time (s)", glide_s, 0.0, f64::INFINITY)?;
    // A float beyond u32 saturates; the device's range is applied afterwards.
    let glide = (glide_s * f64::from(identity.sample_rate_hz)).round() as u32;
    let timing = Timing::at(identity.sample_rate_hz);
    let shortest = travel.map_or(0, |limit| timing.shortest_glide(limit)).max(identity.min_glide);
    Ok(glide.min(identity.max_glide).max(shortest))
}
