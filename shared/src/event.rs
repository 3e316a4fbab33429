//! What a device answers. It never speaks first.

use crate::command::TableHeader;
pub use crate::fault::{Fault, Faults};
use crate::limits::{FOLDBACK_PERIODS, MAX_CRASH, MAX_NAME};
use crate::message::messages;
use crate::refusal::Refusal;
use crate::units::SampleIndex;
use crate::version::Version;
use heapless::String;
use serde::{Deserialize, Serialize};

messages! {
    /// An answer.
    pub enum Event {
        /// Who the device is. The first six bytes of the body are frozen for ever.
        0x81 Hello(Identity),
        /// State, faults and counters.
        0x83 Status(Status),
        /// Done, or will be done at this index.
        0x90 Accepted(Accepted),
        /// Not done; nothing has changed.
        0x91 Refused(Refusal),
        /// The active table.
        0xa4 Table(TableReport),
        /// The digest of the DAC codes.
        0xb1 Digest(Digest),
        /// The token that lets the next command enter the bootloader.
        0xd0 BootloaderToken(u32),
    }
}

/// The body of [`Event::Accepted`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Accepted {
    /// The index from which the command shows in the samples; the current index for commands that do not show.
    pub at: SampleIndex,
}

/// Why the device was last reset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[repr(u8)]
pub enum ResetCause {
    /// Power came on.
    #[default]
    PowerOn,
    /// The reset pin.
    Pin,
    /// Asked for by software.
    Software,
    /// The watchdog: a task had stopped.
    Watchdog,
    /// The supply dipped.
    BrownOut,
    /// The program panicked.
    Panic,
    /// The processor faulted.
    HardFault,
}

/// What became of the configuration kept in flash.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[repr(u8)]
pub enum StoredConfig {
    /// There is none, or the device is in safe mode and has not looked.
    #[default]
    Empty,
    /// It was read and is in use.
    Loaded,
    /// It was made by another version; defaults are in use.
    WrongVersion,
    /// It is damaged; defaults are in use.
    Damaged,
}

/// The body of [`Event::Hello`].
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// What the device speaks. Frozen for ever.
    pub version: Version,
    /// Firmware version.
    pub firmware: (u8, u8, u8),
    /// The board's name.
    pub board: String<MAX_NAME>,
    /// The commit or build the firmware came from.
    pub build: String<MAX_NAME>,
    /// The chip's unique id.
    pub unit: [u8; 12],
    /// No real plate hangs on it: the host may arm by itself.
    pub simulated: bool,
    /// Samples per second, in Hz.
    pub sample_rate_hz: u32,
    /// Samples per block; changes begin at block boundaries.
    pub block: u16,
    /// Bits of a DAC code; mid-scale is `1 << (bits - 1)`.
    pub dac_bits: u8,
    /// Tones that sound at once.
    pub tones: u8,
    /// Knots a table may have.
    pub max_knots: u16,
    /// The shortest glide in samples.
    pub min_glide: u32,
    /// The longest glide in samples.
    pub max_glide: u32,
    /// The dead-man's time in milliseconds.
    pub dead_man_ms: u32,
    /// Why it was last reset.
    pub reset: ResetCause,
    /// What was kept in flash.
    pub stored: StoredConfig,
    /// The last panic's message, or nothing.
    pub crash: String<MAX_CRASH>,
}

/// What the device is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[repr(u8)]
pub enum State {
    /// Muted, takes no drives.
    #[default]
    Idle,
    /// Unmuted, silent.
    Armed,
    /// Tones sound, or are about to.
    Driving,
    /// Ramping to silence.
    Stopping,
    /// A latched fault stands: muted, or on the way there.
    Fault,
    /// Started after repeated crashes: talks, never drives.
    SafeMode,
}

/// Counters since reset; they stop at their largest value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Good frames received.
    pub frames: u32,
    /// Frames dropped for a wrong CRC or impossible COBS.
    pub crc_errors: u32,
    /// Frames dropped for being too long.
    pub overlong: u32,
    /// Frames answered from the cache because they came twice.
    pub duplicates: u32,
    /// Replies dropped because the host did not take them in time, or commands because the queue was full.
    pub dropped: u32,
    /// Times the DAC ran out of samples.
    pub underruns: u32,
    /// Samples clamped to the DAC's range.
    pub clips: u32,
    /// The most processor cycles one block took; 0 where the device cannot tell.
    pub max_cycles: u32,
}

/// The body of [`Event::Status`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Status {
    /// What it is doing.
    pub state: State,
    /// Latched faults.
    pub faults: Faults,
    /// The first of them, if any.
    pub first_fault: Option<Fault>,
    /// When that was.
    pub first_fault_at: SampleIndex,
    /// The index of the next block to be rendered.
    pub now: SampleIndex,
    /// The worst-case sum of the sounding tones, per mille of full scale.
    pub sum_per_mille: u16,
    /// The computed temperature rise, per mille of its limit.
    pub heat_per_mille: u16,
    /// What the thermal fold-back leaves of every amplitude in the present fold-back period, per mille; 1000 when cool.
    /// It changes only where a period begins (see [`FOLDBACK_PERIOD_MS`](crate::limits::FOLDBACK_PERIOD_MS)): this is
    /// the period of the last sample before `now`.
    pub foldback_per_mille: u16,
    /// The same in the periods before it, the latest first. A host that missed some answers reads here what the
    /// fold-back did meanwhile. Periods before the reset show the first value after it.
    pub foldback_before_per_mille: [u16; FOLDBACK_PERIODS],
    /// How often the fold-back has changed since the reset; wraps. A host that missed more periods than are listed
    /// learns here whether it missed a change.
    pub foldback_changes: u32,
    /// The active table's CRC; 0 when there is none.
    pub table_crc: u32,
    /// Since reset.
    pub counters: Counters,
}

/// The body of [`Event::Table`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TableReport {
    /// The active table's header, CRC included, recomputed from the knots; `None` when there is none.
    pub active: Option<TableHeader>,
    /// Knots received of an upload under way.
    pub staged: u16,
}

/// The body of [`Event::Digest`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Digest {
    /// The window.
    pub from: SampleIndex,
    /// Codes in the window.
    pub count: u32,
    /// CRC-32 of the codes, each as two bytes, little-endian; `None` while the window is not over.
    pub crc: Option<u32>,
}
