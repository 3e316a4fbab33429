//! What a device answers. It never speaks first.

use crate::board::{Analogue, BoardReport, BrownOut, ClockReport, FaultTrial, MutePin};
use crate::command::{TableHeader, TravelSetting};
pub use crate::fault::{Fault, Faults};
use crate::hold::Held;
use crate::limits::{FOLDBACK_PERIODS, MAX_CRASH, MAX_NAME, STORES};
use crate::listen::{Captured, InputsReport, Listened};
use crate::message::{Older, messages};
use crate::profile::ActuatorProfile;
use crate::refusal::Refusal;
use crate::schema::{body, choices};
use crate::units::SampleIndex;
use crate::version::Version;
use heapless::String;

messages! {
    /// An answer.
    pub enum Event {
        /// Who the device is. The first six bytes of the body are frozen for all versions.
        0x81 since 0 Hello(Identity),
        /// State, faults and counters.
        0x83 since 0 Status(Status),
        /// The data of maintenance.
        0x84 since 1 Maintenance(Maintenance),
        /// What the device has found on its board.
        0x85 since 3 Board(BoardReport),
        /// The profile of the board's actuator.
        0x86 since 3 Profile(ProfileReport),
        /// How worn the profile's flash is, and how many tables may be stored.
        0x87 since 3 Wear(Wear),
        /// What the start has found of the analogue supply, and how far the DAC's output is linear.
        0x88 since 3 Analogue(Analogue),
        /// The mute pin's level, and how long it took to go low.
        0x89 since 3 MutePin(MutePin),
        /// The sample index, the cycle counter and the USB's frame at one moment.
        0x8a since 3 Clock(ClockReport),
        /// Done, or will be done at this index.
        0x90 since 0 Accepted(Accepted),
        /// Not done; nothing has changed.
        0x91 since 0 Refused(Refusal),
        /// Done without a write, because the flash holds the requested content already. A host of 1.0 gets `Accepted`.
        0x92 since 1 Unchanged(Accepted) or Accepted,
        /// As `Accepted`, of a drive whose glide takes longer than asked. A host of a minor before 3 gets `Accepted`.
        0x93 since 3 AcceptedUntil(AcceptedUntil) or Accepted,
        /// The limit of the actuator's travel that is in force.
        0x97 since 1 TravelLimit(TravelSetting),
        /// Whether a drive waits for the trigger input, and where the last one began that had waited.
        0x98 since 1 Trigger(TriggerReport),
        /// The table in force.
        0xa4 since 0 Table(TableReport),
        /// The CRC-32 over a window of DAC codes.
        0xb1 since 0 Digest(Digest),
        /// The level of the brown-out reset, and whether the device restarts with it.
        0xc3 since 3 BrownOut(BrownOut),
        /// The token that lets the next command enter the bootloader.
        0xd0 since 0 BootloaderToken(u32),
        /// The token that lets the next command make the device fail, and how the last ordered fault ended.
        0xd2 since 3 FaultTrial(FaultTrial),
        /// Number, lock-ins, delay and lost blocks of the inputs.
        0xe0 since 3 Inputs(InputsReport),
        /// How the inputs answered each tone.
        0xe2 since 3 Listened(Listened),
        /// Values of a capture.
        0xe5 since 3 Captured(Captured),
        /// The state of the level hold.
        0xe8 since 3 Held(Held),
    }
}

body! {
    /// The body of [`Event::Accepted`].
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Accepted {
        /// The index from which the command shows in the samples; the present index for commands that do not show.
        pub at: SampleIndex ["samples"],
    }
}

body! {
    /// The body of [`Event::AcceptedUntil`].
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct AcceptedUntil {
        /// The index at which the drive begins; of one that waits for the trigger input, the first at which it may.
        pub at: SampleIndex ["samples"],
        /// The index from which nothing moves any more, if it begins there.
        pub until: SampleIndex ["samples"],
    }
}

impl Older<Accepted> for Accepted {
    fn older(&self) -> Accepted {
        *self
    }
}

impl Older<Accepted> for AcceptedUntil {
    fn older(&self) -> Accepted {
        Accepted { at: self.at }
    }
}

impl Event {
    /// Where an accepted command takes effect; `None` for every other answer.
    #[must_use]
    pub fn accepted_at(&self) -> Option<SampleIndex> {
        match self {
            Self::Accepted(Accepted { at }) | Self::AcceptedUntil(AcceptedUntil { at, .. }) => Some(*at),
            _ => None,
        }
    }
}

choices! {
    /// Why the device was last reset.
    #[derive(Default)]
    pub enum ResetCause {
        /// Power came on.
        #[default]
        0 since 0 PowerOn,
        /// The reset pin.
        1 since 0 Pin,
        /// Asked for by software.
        2 since 0 Software,
        /// The watchdog: a task had stopped.
        3 since 0 Watchdog,
        /// The supply voltage dipped.
        4 since 0 BrownOut,
        /// The program panicked.
        5 since 0 Panic,
        /// The processor faulted.
        6 since 0 HardFault,
    }
}

choices! {
    /// The result of reading the configuration kept in flash.
    #[derive(Default)]
    pub enum StoredConfig {
        /// There is none, or the device is in safe mode and has not looked.
        #[default]
        0 since 0 Empty,
        /// It was read and is in use.
        1 since 0 Loaded,
        /// It was made by another version; defaults are in use.
        2 since 0 WrongVersion,
        /// It is damaged; defaults are in use.
        3 since 0 Damaged,
        /// One of its two places is torn or has decayed; the table in the other is in use, and may be an older one. A
        /// host of 1.0 gets `Loaded`.
        4 since 1 FellBack or Self::Loaded,
    }
}

body! {
    /// The body of [`Event::Hello`].
    #[derive(Clone, Debug, PartialEq, Eq)]
    pub struct Identity {
        /// The device's protocol version. Frozen for all versions.
        pub version: Version [""],
        /// The firmware's version: major, minor, patch.
        pub firmware: (u8, u8, u8) [""],
        /// The board's name.
        pub board: String<MAX_NAME> [""],
        /// The commit or build that the firmware was made from.
        pub build: String<MAX_NAME> [""],
        /// The chip's unique id.
        pub unit: [u8; 12] [""],
        /// The device is simulated: no plate is connected, so the host may arm it without asking its user.
        pub simulated: bool [""],
        /// Samples per second.
        pub sample_rate_hz: u32 ["Hz"],
        /// Samples per block; changes begin at multiples of it.
        pub block: u16 ["samples"],
        /// Bits of a DAC code; mid-scale is `1 << (bits - 1)`.
        pub dac_bits: u8 ["bits"],
        /// Tones that can sound at once.
        pub tones: u8 [""],
        /// Knots that a table may have.
        pub max_knots: u16 [""],
        /// The shortest glide.
        pub min_glide: u32 ["samples"],
        /// The longest glide.
        pub max_glide: u32 ["samples"],
        /// The dead-man's time: without a keep-alive for this time the device ramps to silence and disarms.
        pub dead_man_ms: u32 ["ms"],
        /// Why it was last reset.
        pub reset: ResetCause [""],
        /// The result of reading the table kept in flash.
        pub stored: StoredConfig [""],
        /// The last panic's message, or nothing.
        pub crash: String<MAX_CRASH> [""],
    }
}

choices! {
    /// What the device is doing.
    #[derive(Default)]
    pub enum State {
        /// Muted, takes no drives.
        #[default]
        0 since 0 Idle,
        /// Unmuted, silent.
        1 since 0 Armed,
        /// Tones sound, or are about to.
        2 since 0 Driving,
        /// Ramping to silence.
        3 since 0 Stopping,
        /// A fault is latched: muted, or about to be.
        4 since 0 Fault,
        /// Started after repeated crashes: it answers and never drives.
        5 since 0 SafeMode,
        /// A drive waits for the trigger input; the previous drive continues until then. A host of 1.0 gets `Driving`.
        6 since 1 Waiting or Self::Driving,
    }
}

body! {
    /// Counters since the reset; they stop at their largest value.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct Counters {
        /// Good frames received.
        pub frames: u32 [""],
        /// Frames dropped for a wrong CRC or impossible COBS.
        pub crc_errors: u32 [""],
        /// Frames dropped for being too long.
        pub overlong: u32 [""],
        /// Commands that came twice and were answered from the cache.
        pub duplicates: u32 [""],
        /// Answers dropped because the host did not take them in time, and commands dropped because the queue was full
        /// or a stop came.
        pub dropped: u32 [""],
        /// Times the DAC ran out of samples.
        pub underruns: u32 [""],
        /// Samples clamped to the DAC's range.
        pub clips: u32 [""],
        /// The most processor cycles that one block took; 0 where the device has no cycle counter.
        pub max_cycles: u32 ["cycles"],
    }
}

body! {
    /// The body of [`Event::Status`].
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct Status {
        /// What the device is doing.
        pub state: State [""],
        /// The latched faults.
        pub faults: Faults ["bits, see Faults"],
        /// The first of them, if any.
        pub first_fault: Option<Fault> [""],
        /// When that was latched; 0 if there is none.
        pub first_fault_at: SampleIndex ["samples"],
        /// The index of the next block to be rendered.
        pub now: SampleIndex ["samples"],
        /// The worst-case sum of the sounding tones.
        pub sum_per_mille: u16 ["1/1000 of full scale"],
        /// The computed temperature rise of the coil.
        pub heat_per_mille: u16 ["1/1000 of its limit"],
        /// The factor of the thermal fold-back on every amplitude in the present fold-back period; 1000 when cool. It
        /// changes only where a fold-back period begins; the present one is that of the last sample before `now`.
        pub foldback_per_mille: u16 ["1/1000"],
        /// The same in the periods before it, the latest first. A host that missed some answers reads here what the
        /// fold-back did meanwhile. Periods before the reset show the first value after it.
        pub foldback_before_per_mille: [u16; FOLDBACK_PERIODS] ["1/1000"],
        /// How often the fold-back has changed since the reset; wraps. A host that missed more periods than are listed
        /// learns here whether it missed a change.
        pub foldback_changes: u32 [""],
        /// The CRC of the table in force; 0 when there is none.
        pub table_crc: u32 [""],
        /// Counters since the reset.
        pub counters: Counters [""],
    }
}

body! {
    /// The body of [`Event::Maintenance`].
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct Maintenance {
        /// How often the two places of the kept table have been erased, both together. One that a power failure cut short
        /// counts only if it left a trace. It counts from the start when both places have become unreadable.
        pub erasures: u32 [""],
        /// The erasures that the chip's data sheet promises, both places together; 0 where the device keeps nothing.
        pub erasures_promised: u32 [""],
        /// Whether the brown-out reset level is set as the board needs it, so that a failing supply stops the chip before
        /// it goes wrong; true where there is no such level.
        pub brown_out_guarded: bool [""],
    }
}

body! {
    /// The body of [`Event::Wear`].
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct Wear {
        /// How often the two places of the actuator's profile have been erased, counted as the table's in `Maintenance`.
        pub profile_erasures: u32 [""],
        /// The erasures that the chip's data sheet promises, both places together; 0 where the device keeps no profile.
        pub profile_erasures_promised: u32 [""],
        /// How many tables may be stored or forgotten now; one more each minute, up to 16.
        pub stores_left: u8 ["", 0, STORES],
    }
}

body! {
    /// The body of [`Event::Profile`].
    #[derive(Clone, Debug, Default, PartialEq, Eq)]
    pub struct ProfileReport {
        /// The profile in force; `None` if there is none.
        pub profile: Option<ActuatorProfile> [""],
        /// The result of reading it from the flash. Where it is `Damaged` the device cannot be armed until a profile is written or
        /// erased.
        pub stored: StoredConfig [""],
    }
}

body! {
    /// The body of [`Event::Trigger`].
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct TriggerReport {
        /// Whether a drive waits for the trigger input.
        pub waits: bool [""],
        /// Where the last drive began that had waited for it; `None` if none has since the reset. A drive that waits no
        /// more and has not begun since its answer's index was dropped.
        pub began: Option<SampleIndex> ["samples"],
    }
}

body! {
    /// The body of [`Event::Table`].
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct TableReport {
        /// The header of the table in force, with a CRC computed again from the knots; `None` when there is no table.
        pub active: Option<TableHeader> [""],
        /// Knots received of an upload under way.
        pub staged: u16 [""],
    }
}

body! {
    /// The body of [`Event::Digest`].
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Digest {
        /// The index of the window's first code.
        pub from: SampleIndex ["samples"],
        /// The number of codes in the window.
        pub count: u32 ["samples"],
        /// CRC-32 of the codes, each as two bytes, little-endian; `None` while the window is not over.
        pub crc: Option<u32> [""],
    }
}
