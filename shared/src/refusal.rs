//! Why a device did not do what it was told, and what the other side can do about it.

use crate::fault::Faults;
use serde::{Deserialize, Serialize};

/// A field of a command that has a range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[repr(u8)]
pub enum Field {
    /// The number of tones in a drive.
    ToneCount,
    /// A tone's slot.
    ToneSlot,
    /// The master level in hundredths of a decibel.
    MasterLevel,
    /// The glide time in samples.
    Glide,
    /// The index to apply at.
    ApplyAt,
    /// The number of knots.
    KnotCount,
    /// A knot's phase step.
    KnotStep,
    /// A knot's gain.
    KnotGain,
    /// The index of a chunk's first knot.
    ChunkFirst,
    /// The table's sample rate in Hz.
    SampleRate,
    /// The table's span in micrometres.
    Span,
    /// The digest window's length in samples.
    DigestCount,
}

impl Field {
    /// The field's name as a user reads it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::ToneCount => "number of tones",
            Self::ToneSlot => "tone slot",
            Self::MasterLevel => "master level (1/100 dB)",
            Self::Glide => "glide (samples)",
            Self::ApplyAt => "apply-at (sample index)",
            Self::KnotCount => "number of knots",
            Self::KnotStep => "knot phase step",
            Self::KnotGain => "knot gain",
            Self::ChunkFirst => "first knot of the chunk",
            Self::SampleRate => "sample rate (Hz)",
            Self::Span => "span (um)",
            Self::DigestCount => "digest length (samples)",
        }
    }
}

/// Why a command has to wait.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[repr(u8)]
pub enum Busy {
    /// The last drive has not been taken up yet.
    CommitPending,
    /// The output is not silent.
    DriveActive,
    /// The other slot is still needed: the last table swap has not begun, or what went by the old table fades out.
    TableInUse,
    /// A digest is under way.
    DigestPending,
}

/// A refusal, as it goes over the wire. What sounds, and what is kept, is as it was before the command; but the command
/// has used its number, a wrong token the one given, and a damaged upload is given up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[repr(u8)]
pub enum Refusal {
    /// No message has this id in this version.
    UnknownMessage {
        /// The id.
        id: u8,
    },
    /// The body is too short, too long or holds an impossible value.
    Malformed,
    /// The frame belongs to no session or an ended one: say hello again.
    StaleSession,
    /// The sequence number is not the next one: send `expected`, or say hello again.
    BadSequence {
        /// The number the device waits for.
        expected: u16,
    },
    /// The versions differ: identify, stop and the bootloader only.
    VersionMismatch,
    /// Arm first.
    NotArmed,
    /// A latched fault stands: read it, remove its cause, clear it.
    Faulted {
        /// All latched faults.
        faults: Faults,
    },
    /// Try again later.
    Busy(Busy),
    /// A value lies outside its range.
    OutOfRange {
        /// Which one.
        field: Field,
        /// The lowest allowed value.
        min: i64,
        /// The highest allowed value.
        max: i64,
        /// What came.
        got: i64,
    },
    /// Two tones name the same slot.
    SlotTwice {
        /// The slot.
        slot: u8,
    },
    /// The tones' worst-case sum exceeds full scale: lower the levels.
    Headroom {
        /// The worst-case sum in per mille of full scale.
        sum_per_mille: u16,
    },
    /// No turning-point table is active: upload one.
    NoTable,
    /// No upload is under way (or it timed out): begin again.
    NoUpload,
    /// Chunks come in order, without gaps or repeats.
    ChunkOrder {
        /// The knot the device waits for.
        expected: u16,
    },
    /// Knots are missing.
    UploadIncomplete {
        /// Knots received so far.
        received: u16,
    },
    /// The knots' CRC is not the announced one.
    TableCrc,
    /// The phase steps are not strictly monotonic at this knot.
    NotMonotonic {
        /// The knot's index.
        knot: u16,
    },
    /// The token is wrong or too old: ask for a new one.
    BadToken,
    /// This device cannot do that (no flash store, no bootloader).
    NotSupported,
    /// The flash did not take the data.
    StoreFailed,
    /// Only when disarmed.
    Armed,
    /// Started after repeated crashes: it talks but does not drive. Flash new firmware or power-cycle.
    SafeMode,
    /// No digest has been asked for.
    NoDigest,
}

impl core::fmt::Display for Refusal {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match *self {
            Self::UnknownMessage { id } => write!(f, "the device does not know message {id:#04x}"),
            Self::Malformed => f.write_str("the device could not read the command"),
            Self::StaleSession => {
                f.write_str("another program has taken over the device, or it was restarted")
            }
            Self::BadSequence { expected } => write!(f, "the device waits for command number {expected}"),
            Self::VersionMismatch => {
                f.write_str("program and firmware do not match: only identify, stop and the bootloader work")
            }
            Self::NotArmed => f.write_str("the device is not armed"),
            Self::Faulted { faults } => write!(f, "a fault stands: {faults}"),
            Self::Busy(Busy::CommitPending) => f.write_str("the last change has not been taken up yet"),
            Self::Busy(Busy::DriveActive) => f.write_str("only when the output is silent"),
            Self::Busy(Busy::TableInUse) => f.write_str("the last table has not been taken up yet"),
            Self::Busy(Busy::DigestPending) => f.write_str("a digest is under way"),
            Self::OutOfRange { field, min, max, got } => {
                write!(f, "{} is {got}; allowed are {min} to {max}", field.name())
            }
            Self::SlotTwice { slot } => write!(f, "tone slot {slot} is named twice"),
            Self::Headroom { sum_per_mille } => {
                write!(
                    f,
                    "the tones add up to {}.{} % of full scale; lower their levels",
                    sum_per_mille / 10,
                    sum_per_mille % 10
                )
            }
            Self::NoTable => f.write_str("the device has no turning-point table"),
            Self::NoUpload => f.write_str("no table upload is under way"),
            Self::ChunkOrder { expected } => write!(f, "the table upload continues at knot {expected}"),
            Self::UploadIncomplete { received } => {
                write!(f, "the table is incomplete: {received} knots came")
            }
            Self::TableCrc => f.write_str("the table was damaged on the way (its CRC is wrong)"),
            Self::NotMonotonic { knot } => {
                write!(f, "the table's frequencies do not rise or fall strictly at knot {knot}")
            }
            Self::BadToken => f.write_str("the bootloader token is wrong or too old"),
            Self::NotSupported => f.write_str("this device cannot do that"),
            Self::StoreFailed => f.write_str("the device's flash did not take the data"),
            Self::Armed => f.write_str("only when the device is disarmed"),
            Self::SafeMode => f.write_str("the device is in safe mode after repeated crashes"),
            Self::NoDigest => f.write_str("no digest has been asked for"),
        }
    }
}
