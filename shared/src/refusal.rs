//! Refusals: why a device did not do a command, and what the host can do about it.

use crate::fault::Faults;
use crate::schema::choices;
use crate::units::{Gain, per_mille};

choices! {
    /// A field of a command that has a range.
    pub enum Field {
        /// The number of tones in a drive.
        0 since 0 ToneCount,
        /// A tone's slot.
        1 since 0 ToneSlot,
        /// The master level in hundredths of a decibel.
        2 since 0 MasterLevel,
        /// The glide time in samples.
        3 since 0 Glide,
        /// The index to apply at.
        4 since 0 ApplyAt,
        /// The number of knots.
        5 since 0 KnotCount,
        /// A knot's phase step.
        6 since 0 KnotStep,
        /// A knot's gain.
        7 since 0 KnotGain,
        /// The index of a chunk's first knot.
        8 since 0 ChunkFirst,
        /// The table's sample rate in Hz.
        9 since 0 SampleRate,
        /// The table's span in micrometres.
        10 since 0 Span,
        /// The digest window's length in samples.
        11 since 0 DigestCount,
        /// An actuator's resonance in uHz.
        12 since 1 Resonance or Self::SampleRate,
        /// The quality factor of an actuator's resonance, in thousandths.
        13 since 1 Quality or Self::SampleRate,
        /// An actuator's travel at full scale, in millionths of its peak travel.
        14 since 1 StaticTravel or Self::SampleRate,
        /// The binary logarithm of a chord's period in samples.
        15 since 2 ChordPeriod or Self::Glide,
        /// A tone's multiple of a chord's base frequency.
        16 since 2 Harmonic or Self::ToneSlot,
        /// A comb's period in blocks.
        17 since 3 CombPeriod or Self::Glide,
        /// The number of blocks that an input is measured over.
        18 since 3 WindowBlocks or Self::DigestCount,
        /// The number of tones to be measured at once.
        19 since 3 LockIns or Self::ToneCount,
        /// The number of an input.
        20 since 3 Input or Self::ToneSlot,
        /// The binary logarithm of the codes that a captured value sums up.
        21 since 3 CaptureCodes or Self::DigestCount,
        /// The number of values of a capture.
        22 since 3 CaptureValues or Self::DigestCount,
        /// A plate's time constant in samples.
        23 since 3 TimeConstant or Self::Glide,
        /// How far above its drive's level a tone may rise, in hundredths of a decibel.
        24 since 3 MaxRise or Self::MasterLevel,
        /// The largest change of a level from one window to the next, in hundredths of a decibel.
        25 since 3 Slew or Self::MasterLevel,
        /// The amplitude to hold in 1/256 code.
        26 since 3 HeldAmplitude or Self::MasterLevel,
        /// How long a device stays armed without a drive, in milliseconds.
        27 since 3 Lease or Self::Glide,
        /// An actuator's largest sum of amplitudes, in per mille of full scale.
        28 since 3 ProfileSum or Self::MasterLevel,
        /// A time constant of an actuator's coil, in milliseconds.
        29 since 3 CoilTime or Self::Glide,
        /// The rise of an actuator's coil by a sine of full scale, in per mille of its limit.
        30 since 3 FullSine or Self::MasterLevel,
        /// An actuator's longest drive, in milliseconds.
        31 since 3 DriveTime or Self::Glide,
        /// The reference voltage VREF+ in millivolts.
        32 since 3 ReferenceVoltage or Self::MasterLevel,
        /// The byte by which a chip codes its level of read protection.
        33 since 3 ReadProtection or Self::MasterLevel,
    }
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
            Self::Resonance => "actuator resonance (uHz)",
            Self::Quality => "actuator quality (1/1000)",
            Self::StaticTravel => "static travel (1e-6 of the peak travel)",
            Self::ChordPeriod => "chord period (log2 of samples)",
            Self::Harmonic => "multiple of the base frequency",
            Self::CombPeriod => "comb's period (blocks)",
            Self::WindowBlocks => "window (blocks)",
            Self::LockIns => "tones to be measured",
            Self::Input => "input",
            Self::CaptureCodes => "codes in a value (log2)",
            Self::CaptureValues => "captured values",
            Self::TimeConstant => "time constant (samples)",
            Self::MaxRise => "largest rise (1/100 dB)",
            Self::Slew => "largest change from window to window (1/100 dB)",
            Self::HeldAmplitude => "amplitude to hold (1/256 code)",
            Self::Lease => "lease (ms)",
            Self::ProfileSum => "largest sum of amplitudes (1/1000 of full scale)",
            Self::CoilTime => "time constant of the coil (ms)",
            Self::FullSine => "rise by a full-scale sine (1/1000 of its limit)",
            Self::DriveTime => "longest drive (ms)",
            Self::ReferenceVoltage => "reference voltage VREF+ (mV)",
            Self::ReadProtection => "byte of the chip's read protection",
        }
    }
}

choices! {
    /// Why a command has to wait.
    pub enum Busy {
        /// The last drive is not in force yet.
        0 since 0 CommitPending,
        /// The output is not silent.
        1 since 0 DriveActive,
        /// The place for a new table is in use: the last change of tables has not begun, or tones of the old table
        /// still fade out.
        2 since 0 TableInUse,
        /// A digest is under way.
        3 since 0 DigestPending,
        /// The level hold measures: end it first.
        4 since 3 Holding or Self::DriveActive,
    }
}

choices! {
    /// A refusal, as it goes over the wire. The sound and the stored table stay as they were before the command. But
    /// the command has used its number; a wrong bootloader token ends the one that the device gave; and a complete
    /// upload that is not a valid table is dropped.
    pub enum Refusal {
        /// No message has this id in this version.
        0 since 0 UnknownMessage {
            /// The id.
            id: u8 [""],
        },
        /// The body is too short, too long or holds an impossible value.
        1 since 0 Malformed,
        /// The frame belongs to no session, or to one that has ended: say hello again.
        2 since 0 StaleSession,
        /// The sequence number is not the next one: send `expected`, or say hello again.
        3 since 0 BadSequence {
            /// The number the device waits for.
            expected: u16 [""],
        },
        /// The versions do not match: the device only does hello, keep-alive, status, the stops, disarm and the
        /// bootloader's commands.
        4 since 0 VersionMismatch,
        /// Arm first.
        5 since 0 NotArmed,
        /// A fault is latched: read it, remove its cause, clear it.
        6 since 0 Faulted {
            /// All latched faults.
            faults: Faults [""],
        },
        /// Try again later.
        7 since 0 Busy(Busy),
        /// A value lies outside its range.
        8 since 0 OutOfRange {
            /// The field.
            field: Field [""],
            /// The lowest allowed value.
            min: i64 [""],
            /// The highest allowed value.
            max: i64 [""],
            /// The value that came.
            got: i64 [""],
        },
        /// Two tones name the same slot.
        9 since 0 SlotTwice {
            /// The slot.
            slot: u8 [""],
        },
        /// The tones' worst-case sum exceeds full scale: lower the levels.
        10 since 0 Headroom {
            /// The worst-case sum in per mille of full scale.
            sum_per_mille: u16 ["1/1000 of full scale"],
        },
        /// No turning-point table is active: upload one.
        11 since 0 NoTable,
        /// No upload is under way (or it timed out): begin again.
        12 since 0 NoUpload,
        /// The chunk is not the next one: chunks come in order, without gaps or repeats.
        13 since 0 ChunkOrder {
            /// The knot the device waits for.
            expected: u16 [""],
        },
        /// Knots are missing.
        14 since 0 UploadIncomplete {
            /// Knots received so far.
            received: u16 [""],
        },
        /// The knots' CRC is not the announced one.
        15 since 0 TableCrc,
        /// The phase steps are not strictly monotonic at this knot.
        16 since 0 NotMonotonic {
            /// The knot's index.
            knot: u16 [""],
        },
        /// The token is wrong or too old: ask for a new one.
        17 since 0 BadToken,
        /// This device cannot do that (no flash store, no bootloader, no trigger input, no inputs that are measured).
        18 since 0 NotSupported,
        /// The flash reported an error, or what was written reads back wrong.
        19 since 0 StoreFailed,
        /// The command is only done while the device is disarmed.
        20 since 0 Armed,
        /// The device started after repeated crashes: it answers but does not drive. Flash new firmware, or switch the
        /// power off and on.
        21 since 0 SafeMode,
        /// No digest has been asked for.
        22 since 0 NoDigest,
        /// The flash is only written while the device is disarmed, because the device takes no stop meanwhile. A host of 1.0
        /// gets `Armed`.
        23 since 1 DisarmFirst or Self::Armed,
        /// The tones together would move the actuator beyond its peak travel, at rest or on their way: lower the levels, or
        /// stop first.
        24 since 1 Travel {
            /// The steady travel at worst, in per mille of the peak travel.
            travel_per_mille: u16 ["1/1000 of the peak travel"],
            /// The factor that brings the levels to the limit; 0 if no levels help, because the sounding tones are too loud
            /// on the way.
            allowed_per_mille: u16 ["1/1000"],
        } or Self::Headroom { sum_per_mille: *travel_per_mille },
        /// A chord's tones exceed full scale: the device has rendered a period of them. Lower the levels, or choose other
        /// phases.
        25 since 2 Peak {
            /// The largest sample of the period, in per mille of full scale.
            peak_per_mille: u16 ["1/1000 of full scale"],
        } or Self::Headroom { sum_per_mille: *peak_per_mille },
        /// A tone that is to be held does not sound.
        26 since 3 SilentTone {
            /// Its slot.
            slot: u8 [""],
        } or Self::NotSupported,
        /// The command needs the board's user button, pressed within the last 30 s and still held.
        27 since 3 HoldButton or Self::NotSupported,
        /// Too many tables were stored or forgotten in a row, and the flash is spared for a while.
        28 since 3 StoresSpent {
            /// The time after which one more is stored.
            wait_s: u16 ["s"],
        } or Self::StoreFailed,
        /// The clock that times the samples was absent at the start: the device answers and cannot be armed. Restore the clock and reset.
        29 since 3 NoClock or Self::NotSupported,
    }
}

impl Refusal {
    /// A value outside its allowed range, `min..=max`.
    #[must_use]
    pub const fn out_of_range(field: Field, min: i64, max: i64, got: i64) -> Self {
        Self::OutOfRange { field, min, max, got }
    }

    /// Refuses a value outside its allowed range, `min..=max`.
    ///
    /// # Errors
    /// [`Refusal::OutOfRange`].
    #[inline]
    pub fn check(field: Field, min: i64, max: i64, got: i64) -> Result<(), Self> {
        if (min..=max).contains(&got) { Ok(()) } else { Err(Self::out_of_range(field, min, max, got)) }
    }

    /// Refuses amplitudes whose sum is above a ceiling, both Q1.31.
    ///
    /// # Errors
    /// [`Refusal::Headroom`].
    pub fn check_sum(sum: u64, ceiling: Gain) -> Result<(), Self> {
        if sum > u64::from(ceiling.0) {
            return Err(Self::Headroom { sum_per_mille: per_mille(sum) });
        }
        Ok(())
    }
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
            Self::Busy(Busy::Holding) => f.write_str("the level hold measures; end it first"),
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
                write!(f, "the table is incomplete: {received} knots arrived")
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
            Self::DisarmFirst => f.write_str(
                "disarm the device first: while it writes its flash, for up to 5 s, it can take no stop",
            ),
            Self::Travel { travel_per_mille, allowed_per_mille: 0 } => write!(
                f,
                "on their way the tones would move the actuator by {}.{} % of its peak travel; stop them first",
                travel_per_mille / 10,
                travel_per_mille % 10
            ),
            Self::Travel { travel_per_mille, allowed_per_mille } => write!(
                f,
                "the tones would move the actuator by {}.{} % of its peak travel; lower their levels to {}.{} % of \
                 what they are, or less",
                travel_per_mille / 10,
                travel_per_mille % 10,
                allowed_per_mille / 10,
                allowed_per_mille % 10
            ),
            Self::Peak { peak_per_mille } => write!(
                f,
                "the chord's peak is {}.{} % of full scale; lower its levels or choose other phases",
                peak_per_mille / 10,
                peak_per_mille % 10
            ),
            Self::SilentTone { slot } => write!(f, "no tone sounds in slot {slot}"),
            Self::HoldButton => f.write_str(
                "press and hold the user button on the board while this is done (after 30 s press it again)",
            ),
            Self::NoClock => f.write_str(
                "the clock that times the device's samples is absent: power the board's ST-LINK, and reset the board",
            ),
            Self::StoresSpent { wait_s } => write!(
                f,
                "16 tables in a row were stored or forgotten, and flash wears; the next one can be in {wait_s} s"
            ),
        }
    }
}
