//! What a device answers. It never speaks first.

use crate::command::TableHeader;
use crate::limits::{MAX_CRASH, MAX_NAME};
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

/// One kind of fault: its bit is its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[repr(u8)]
pub enum Fault {
    /// The host fell silent while driving.
    HostLost,
    /// The emergency stop was used.
    EmergencyStop,
    /// The DAC ran out of samples.
    Underrun,
    /// The coil's computed temperature reached its limit.
    Overheat,
    /// Driven for the longest allowed time with no command from the user.
    DriveTime,
    /// The watchdog reset the device.
    Watchdog,
    /// The program had panicked or faulted.
    Crash,
    /// The supply had dipped.
    BrownOut,
    /// The stored configuration was damaged.
    StoreDamaged,
}

impl Fault {
    /// Every fault, in the order of the bits.
    pub const ALL: [Self; 9] = [
        Self::HostLost,
        Self::EmergencyStop,
        Self::Underrun,
        Self::Overheat,
        Self::DriveTime,
        Self::Watchdog,
        Self::Crash,
        Self::BrownOut,
        Self::StoreDamaged,
    ];

    /// What happened, as a user reads it.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::HostLost => "the host fell silent while driving",
            Self::EmergencyStop => "emergency stop",
            Self::Underrun => "the DAC ran out of samples",
            Self::Overheat => "the actuator is too hot",
            Self::DriveTime => "10 minutes without a command",
            Self::Watchdog => "the watchdog reset the device",
            Self::Crash => "the firmware crashed",
            Self::BrownOut => "the supply voltage dipped",
            Self::StoreDamaged => "the stored configuration was damaged",
        }
    }
}

/// A set of latched faults; bit `n` is the fault numbered `n`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Faults(pub u32);

impl Faults {
    /// No fault.
    pub const NONE: Self = Self(0);

    /// This set and one more.
    #[must_use]
    pub const fn with(self, fault: Fault) -> Self {
        Self(self.0 | 1 << fault as u8)
    }

    /// This set without one.
    #[must_use]
    pub const fn without(self, fault: Fault) -> Self {
        Self(self.0 & !(1 << fault as u8))
    }

    /// Whether a fault is in the set.
    #[must_use]
    pub const fn contains(self, fault: Fault) -> bool {
        self.0 & (1 << fault as u8) != 0
    }

    /// Whether there is none.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The faults in the set, in the order of their bits.
    pub fn iter(self) -> impl Iterator<Item = Fault> {
        Fault::ALL.into_iter().filter(move |&fault| self.contains(fault))
    }
}

impl core::fmt::Display for Faults {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        if self.is_empty() {
            return f.write_str("none");
        }
        for (i, fault) in self.iter().enumerate() {
            if i > 0 {
                f.write_str(", ")?;
            }
            f.write_str(fault.text())?;
        }
        Ok(())
    }
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
    /// What the thermal fold-back leaves of the amplitude, per mille; 1000 when cool. It changes at multiples of 320 ms
    /// (in whole blocks) only, so this is the limit since the last of them before `now`.
    pub foldback_per_mille: u16,
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

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    fn the_drive_time_is_told_as_long_as_it_is() {
        let minutes = crate::limits::MAX_DRIVE_MS / 60_000;
        assert!(Fault::DriveTime.text().starts_with(&std::format!("{minutes} minutes ")));
    }
}
