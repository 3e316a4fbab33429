//! What the rest of the program asks of the link.

use crate::log::Severity;
use crate::port::Port;
use crate::table::{self, DeviceTable};
use slipline_protocol::command::{Apply, DigestWindow, Drive, TableHeader, Tone};
use slipline_protocol::event::{Digest, Identity};
use slipline_protocol::limits::MIN_MASTER_CDB;
use slipline_protocol::units::{CentiDecibel, Phase};
use std::sync::Arc;

/// One tone, as a person thinks of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToneRequest {
    /// 0..16. A sounding slot glides from where it is; a slot that is not named fades out.
    pub slot: u8,
    /// Where its turning point is to lie, in metres from the driven end, within the device table's span.
    pub boundary_m: f64,
    /// Its peak relative to the table's full scale, 0..=1.
    pub level: f64,
    /// Phase at its start from silence, in turns.
    pub phase_turns: f64,
}

/// A drive, as a person thinks of it; the worker puts it into the device's units.
#[derive(Clone, Debug, PartialEq)]
pub struct DriveRequest {
    /// The tones, at most 16 and each in its own slot; none fades all out.
    pub tones: Vec<ToneRequest>,
    /// Scales all tones, in dB, -96..=0.
    pub master_db: f64,
    /// How long the change takes, in seconds; taken to the nearest time the device can.
    pub glide_s: f64,
    /// When it begins.
    pub apply: Apply,
}

impl DriveRequest {
    /// A drive at full master level that begins at once and takes 20 ms.
    #[must_use]
    pub fn of(tones: Vec<ToneRequest>) -> Self {
        Self { tones, master_db: 0.0, glide_s: 0.02, apply: Apply::Next }
    }

    /// As [`DriveRequest::of`] tones that are (place in metres, level) and begin at phase 0, in slots from 0 on.
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

/// One thing to do. Requests are done in order, but [`Request::Stop`] and [`Request::EmergencyStop`] overtake all
/// others, and a newer [`Request::Drive`] or a [`Request::Disarm`] replaces a drive that the device has not taken yet.
#[derive(Clone, Debug)]
pub enum Request {
    /// Open this port and say hello. An open connection is closed first.
    Connect(Port),
    /// Stop, disarm and close the port.
    Disconnect,
    /// Unmute the amplifier and accept drives.
    Arm,
    /// Ramp to silence and mute.
    Disarm,
    /// Sound these tones.
    Drive(DriveRequest),
    /// Ramp to silence; stay armed.
    Stop,
    /// Ramp to silence at once, mute, latch a fault.
    EmergencyStop,
    /// Clear the latched faults whose cause is gone.
    ClearFaults,
    /// Have the device hold this table: send it, swap it in, and read its digest back. A silent device that has held it
    /// since before this session is sent nothing.
    Upload(Arc<DeviceTable>),
    /// Give up the upload under way; nothing happens if there is none, or if its table is in force already.
    CancelUpload,
    /// Read the digest of the device's table.
    ReadBack,
    /// Keep the device's table in its flash. Only when silent.
    Store,
    /// Forget what is kept in the device's flash. Only when silent.
    Forget,
    /// Restart into the ROM bootloader (both steps). Only when disarmed.
    Bootloader,
    /// Rehearsal of the protocol's next minor: measure the coil's resistance.
    #[cfg(slipline_next)]
    MeasureCoil,
    /// Read the status at once.
    Refresh,
    /// Whether a lost device is looked for.
    AutoReconnect(bool),
    /// Take the digest of the DAC codes of a window that lies ahead; done when the window is over.
    Digest(DigestWindow),
    /// Write a line of the app's own into the log, which is one for link, device and app.
    Note(Severity, String),
}

impl Request {
    /// A word for the log.
    pub(crate) const fn name(&self) -> &'static str {
        match self {
            Self::Connect(_) => "connect",
            Self::Disconnect => "disconnect",
            Self::Arm => "arm",
            Self::Disarm => "disarm",
            Self::Drive(_) => "drive",
            Self::Stop => "stop",
            Self::EmergencyStop => "emergency stop",
            Self::ClearFaults => "clear faults",
            Self::Upload(_) => "upload",
            Self::CancelUpload => "cancel upload",
            Self::ReadBack => "read back",
            Self::Store => "store",
            Self::Forget => "forget",
            Self::Bootloader => "enter bootloader",
            #[cfg(slipline_next)]
            Self::MeasureCoil => "measure coil",
            Self::Refresh => "status",
            Self::AutoReconnect(_) => "reconnect switch",
            Self::Digest(_) => "digest",
            Self::Note(..) => "note",
        }
    }
}

/// The number of a request; rises by one with each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Ticket(pub u64);

/// How a request ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// Done; the sample index from which it shows, or the device's present one.
    Done {
        /// The index.
        at: u64,
    },
    /// The digest that was asked for.
    Digest(Digest),
    /// Not done; a sentence that says why.
    Refused(String),
    /// Not done: the device's firmware is older than this program and does not know the command.
    DeviceTooOld,
    /// A newer request or a stop took its place before the device had taken it.
    Superseded,
    /// The link was lost, or there was none.
    NotConnected,
}

/// Why a drive cannot be put into the device's units.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DriveError {
    /// There is no table to place tones by.
    #[error("the device has no turning-point table: upload one first")]
    NoTable,
    /// More tones than the device has slots.
    #[error("{got} tones; the device has {max}")]
    TooManyTones {
        /// How many were asked for.
        got: usize,
        /// How many it has.
        max: u8,
    },
    /// A value lies outside its range, or is no number.
    #[error("tone {slot}: {field} is {got}; allowed are {min} to {max}")]
    Tone {
        /// The tone's slot.
        slot: u8,
        /// Which value.
        field: &'static str,
        /// What came.
        got: f64,
        /// The lowest allowed value.
        min: f64,
        /// The highest allowed value.
        max: f64,
    },
    /// The master level lies outside -96..=0 dB, or is no number.
    #[error("the master level is {0} dB; allowed are -96 to 0")]
    Master(f64),
    /// The glide time is no number or negative.
    #[error("the glide time is {0} s; it must be 0 or more")]
    Glide(f64),
}

impl DriveRequest {
    /// The drive in a device's own units, placed by the span of its active table.
    ///
    /// # Errors
    /// [`DriveError`], naming the value and its range; the rule is the device's own.
    pub fn for_device(&self, identity: &Identity, table: Option<&TableHeader>) -> Result<Drive, DriveError> {
        let table = table.ok_or(DriveError::NoTable)?;
        let too_many = || DriveError::TooManyTones { got: self.tones.len(), max: identity.tones };
        if self.tones.len() > usize::from(identity.tones) {
            return Err(too_many());
        }
        let mut tones = heapless::Vec::new();
        for tone in &self.tones {
            let out_of_range =
                |field, got, min, max| DriveError::Tone { slot: tone.slot, field, got, min, max };
            if tone.slot >= identity.tones {
                let last = f64::from(identity.tones) - 1.0;
                return Err(out_of_range("slot", f64::from(tone.slot), 0.0, last));
            }
            let (start_m, end_m) = table::span_m(table);
            let position = table::position_in(table, tone.boundary_m).ok_or_else(|| {
                out_of_range("boundary (mm)", tone.boundary_m * 1e3, start_m * 1e3, end_m * 1e3)
            })?;
            let level =
                table::level(tone.level).ok_or_else(|| out_of_range("level", tone.level, 0.0, 1.0))?;
            if !tone.phase_turns.is_finite() {
                return Err(out_of_range("phase (turns)", tone.phase_turns, 0.0, 1.0));
            }
            let phase = Phase((tone.phase_turns.rem_euclid(1.0) * 65536.0).round() as u32 as u16);
            tones.push(Tone { slot: tone.slot, position, level, phase }).map_err(|_| too_many())?;
        }
        let lowest_db = f64::from(MIN_MASTER_CDB) / 100.0;
        if !(lowest_db..=0.0).contains(&self.master_db) {
            return Err(DriveError::Master(self.master_db));
        }
        if !(0.0..=f64::MAX).contains(&self.glide_s) {
            return Err(DriveError::Glide(self.glide_s));
        }
        // A float beyond u32 saturates, and the device's range is put over it.
        let glide = (self.glide_s * f64::from(identity.sample_rate_hz)).round() as u32;
        Ok(Drive {
            tones,
            master: CentiDecibel((self.master_db * 100.0).round() as i16),
            glide: glide.min(identity.max_glide).max(identity.min_glide),
            apply: self.apply,
        })
    }
}
