//! Commands: the messages from a host to a device, and their bodies.

use crate::board::{BrownOutOrder, FaultOrder, MuteStep};
use crate::hold::HoldSetting;
use crate::limits::{
    CHORD_PERIOD_LOG2, CHUNK_KNOTS, COMB_PERIOD_BLOCKS, LEASE_MS, MAX_DIGEST_SAMPLES, MAX_HARMONIC,
    MAX_KNOTS, MAX_TONES, MIN_KNOTS, MIN_MASTER_CDB,
};
use crate::listen::{CapturePart, CaptureWindow, ListenPart, ListenWindow};
use crate::message::messages;
use crate::profile::ActuatorProfile;
pub use crate::profile::TravelLimit;
use crate::schema::{body, choices};
use crate::table::Knot;
use crate::units::{CentiDecibel, Level, Phase, Position, SampleIndex};
use crate::version::Version;
use heapless::Vec;

messages! {
    /// A command.
    ///
    /// A device answers each command that it takes up by exactly one [`Event`](crate::Event). It may also drop one
    /// unanswered: a frame that was damaged on the way, a command for which its queue of eight has no room, one that
    /// waited when a stop came, and an answer that the host does not take in time. So a host that gets no answer sends
    /// the command again.
    pub enum Command {
        /// Asks who the device is and begins a session, which ends the one before. Frozen for all versions.
        0x01 since 0 Hello(Hello) -> Hello,
        /// Sign of life of the host: restarts the dead-man's time. Not numbered.
        0x02 since 0 KeepAlive(KeepAlive) -> Status,
        /// Asks for the status. Not numbered. Does not feed the dead-man.
        0x03 since 0 Status -> Status,
        /// Asks for the data of maintenance: the wear of the flash, and whether the supply is guarded.
        0x04 since 1 Maintenance -> Maintenance,
        /// Asks what the device has found on its board: its mute resistor, its user button, its clock.
        0x05 since 3 Board -> Board,
        /// Asks for the profile of the board's actuator, which the device keeps.
        0x06 since 3 Profile -> Profile,
        /// Asks how worn the profile's flash is, and how many tables may be stored in a row.
        0x07 since 3 Wear -> Wear,
        /// Asks for what the start has found of the analogue supply, and for the linear share of the DAC's output.
        0x08 since 3 Analogue -> Analogue,
        /// Reads the mute pin back, or measures how long it takes to go low. A trial needs an armed device that is silent, has
        /// unmuted the amplifier (`Arm`, not `Bench`) and is past the index of its answer; it takes up to 25 ms, in which the device
        /// receives no stop, and then the device is disarmed.
        0x09 since 3 MutePin(MuteStep) -> MutePin,
        /// Asks for the sample index, the processor's cycle counter and the USB's frame at one moment. It may take 2 ms.
        0x0a since 3 Clock -> Clock,
        /// Stops the DAC's DMA for 1 ms, as a blocked bus would, to test that the device notices and recovers: it counts an
        /// underrun, and has the fault `Underrun` where a tone sounded. Only on the bench (`Bench`).
        0x0b since 3 Stall -> Accepted,
        /// Unmutes the amplifier and accepts drives. Needs a device without latched faults. An armed device stays as it is, with
        /// its lease if it has one (`ArmFor`).
        0x10 since 0 Arm -> Accepted,
        /// Ramps to silence, mutes, and accepts no more drives.
        0x11 since 0 Disarm -> Accepted,
        /// Sounds these tones from an index on. Needs an armed device with a table.
        0x12 since 0 Drive(Drive) -> Accepted,
        /// Ramps to silence; the device stays armed. Not numbered; taken in every state and from every session, before
        /// any session, too.
        0x13 since 0 Stop -> Accepted,
        /// Ramps to silence at once, mutes, and latches a fault. Not numbered; taken in every state and from every
        /// session, before any session, too.
        0x14 since 0 EmergencyStop -> Accepted,
        /// Clears the latched faults whose cause is gone.
        0x15 since 0 ClearFaults -> Accepted,
        /// Limits the actuator's travel for this session, or sets it free again. Only while nothing sounds.
        0x16 since 1 SetTravelLimit(TravelSetting) -> TravelLimit,
        /// Asks which limit of the travel is in force.
        0x17 since 1 TravelLimit -> TravelLimit,
        /// Asks whether a drive waits for the trigger input, and where the last drive began that had waited.
        0x18 since 1 Trigger -> Trigger,
        /// Sounds tones that are multiples of one base frequency, from silence on. Needs an armed device with a table. It may
        /// take some milliseconds: the device renders a period of them before it answers.
        0x19 since 2 Chord(Chord) -> Accepted,
        /// Sounds tones that are multiples of one low base frequency, from silence on, within the table's frequencies or beyond
        /// them. Needs an armed device with a table.
        0x1a since 3 Comb(Comb) -> Accepted,
        /// As `Arm`, on a lease: where no drive, chord or comb is accepted and no rise of the trigger input begins one for so long,
        /// the device ramps to silence as by a stop, mutes and accepts no more drives, without a fault. The time begins with this
        /// command, and again where each drive begins. An armed device takes the new lease in the place of the old one,
        /// or of none.
        0x1b since 3 ArmFor(ArmLease) -> Accepted,
        /// As `ArmFor`, but the mute pin stays low until the device is disarmed: drives sound at the DAC's output alone. All that ends
        /// a drive ends one on the bench. Refused (`Armed`) while the device is armed otherwise, as `Arm` and `ArmFor` are on the bench.
        /// A drive that begins to wait for the trigger input there raises the trigger output itself, at the index of its answer: a wire
        /// between the two pins lets it begin.
        0x1c since 3 Bench(ArmLease) -> Accepted,
        /// Begins to upload a turning-point table. The drive continues by the table in force.
        0x20 since 0 TableBegin(TableHeader) -> Accepted,
        /// Carries the next knots of the upload.
        0x21 since 0 TableChunk(TableChunk) -> Accepted,
        /// Checks the whole upload and puts it in force.
        0x22 since 0 TableCommit -> Accepted,
        /// Gives up the upload; accepted when there is none, too.
        0x23 since 0 TableAbort -> Accepted,
        /// Asks which table is in force.
        0x24 since 0 TableDigest -> Table,
        /// Orders a CRC-32 over the DAC codes of a window that lies ahead.
        0x30 since 0 DigestStart(DigestWindow) -> Accepted,
        /// Asks for that CRC-32.
        0x31 since 0 DigestRead -> Digest,
        /// Keeps the table in force in flash. Only while the device is disarmed and nothing sounds, because it may take up
        /// to 5 s, in which the device does not answer and takes no stop. A table that is kept already is not written
        /// again; `Unchanged` says so. 16 may be stored or forgotten in a row, then one a minute (`StoresSpent`).
        0x40 since 0 Store -> Accepted,
        /// Erases what is kept in flash. Only while the device is disarmed and nothing sounds; may take up to 5 s, in
        /// which the device does not answer. Where nothing is kept nothing is written; `Unchanged` says so.
        0x41 since 0 Forget -> Accepted,
        /// Keeps a profile of the board's actuator in flash and puts it in force, or erases it. Only while the device is disarmed,
        /// nothing sounds, and the board's user button is held and was pressed within the last 30 s (`HoldButton`). That is a guard
        /// against mistakes, not a lock: a button that was held while the device started counts as pressed for 30 s from its
        /// release. It may take up to 5 s,
        /// in which the device does not answer. A profile that is kept already is not written again; `Unchanged` says so. `Forget`
        /// leaves it.
        0x42 since 3 WriteProfile(ProfileSetting) -> Accepted,
        /// Reads the level of the brown-out reset, or writes the one that the board needs into the chip's option bytes. It is written only
        /// while the device is disarmed, nothing sounds, the board's user button is held as for `WriteProfile`, the chip's read
        /// protection is off (`ReadProtection`) and the reference voltage is at least 2.9 V (`ReferenceVoltage`). It may take up to 5 s,
        /// in which the device does not answer; then the device answers and restarts, and the level is in force. A level that is high
        /// enough is not written again. If the power fails meanwhile, some chips erase their program (`firmware/BOARDS.md`).
        0x43 since 3 BrownOut(BrownOutOrder) -> BrownOut,
        /// First step into the ROM bootloader: asks for a token. Only while disarmed.
        0x50 since 0 BootloaderToken -> BootloaderToken,
        /// Second step into the ROM bootloader: shows the token. Only while disarmed, and where an actuator's profile is kept only
        /// with the board's user button held as for `WriteProfile`; the device answers and then restarts.
        0x51 since 0 BootloaderEnter(u32) -> Accepted,
        /// First step to a fault on purpose: asks for a token, and how the last ordered fault ended.
        0x52 since 3 FaultToken -> FaultTrial,
        /// Second step to a fault on purpose, by which a board shows that it mutes: shows the token. Needs an armed device that is silent
        /// and whose mute pin is high (`Arm`, not `Bench`), so unplug the amplifier first. The device answers, fails 0.1 s later unless
        /// it is disarmed or driven before, and is reset by the fault. The reset is reported as any other, but does not count
        /// towards safe mode.
        0x53 since 3 FaultOrder(FaultOrder) -> Accepted,
        /// Asks for the number, lock-ins and delay of the device's inputs, and how many of their blocks were lost.
        0x60 since 3 Inputs -> Inputs,
        /// Begins to measure how the inputs answer each tone, over a window that lies ahead; forgets the last measurement. The
        /// answer names the window's first sample. Needs a device with inputs; the hello of a new session drops a measurement
        /// under way.
        0x61 since 3 Listen(ListenWindow) -> Accepted,
        /// Asks for the measurement.
        0x62 since 3 ListenRead(ListenPart) -> Listened,
        /// Drops the measurement; accepted when there is none, too.
        0x63 since 3 ListenStop -> Accepted,
        /// Begins to capture the codes of an input, from an index on; forgets the last capture. The answer names the index. As
        /// for a measurement, a new session drops it.
        0x64 since 3 Capture(CaptureWindow) -> Accepted,
        /// Asks for values of the capture.
        0x65 since 3 CaptureRead(CapturePart) -> Captured,
        /// Ends the capture; what has been captured can still be read. Accepted when there is none, too.
        0x66 since 3 CaptureStop -> Accepted,
        /// Holds the measured amplitudes of sounding tones at these values, until another command or a fault changes the drive.
        /// The answer names the first window's first sample; for a list without tones, the index at which the levels begin to
        /// return to those of the drive. Needs a device with inputs.
        0x67 since 3 Hold(HoldSetting) -> Accepted,
        /// Asks for the state of the hold.
        0x68 since 3 HoldRead -> Held,
    }
}

body! {
    /// The body of [`Command::Hello`]. Its ten bytes are frozen for all versions.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Hello {
        /// The host's protocol version.
        pub version: Version [""],
        /// A number that the host draws once for each session. A hello with the nonce of the present session is a
        /// repeat: it is answered again and begins nothing.
        pub nonce: [u8; 4] [""],
    }
}

body! {
    /// The body of [`Command::KeepAlive`].
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct KeepAlive {
        /// Rises with every keep-alive of the session; one that is not higher than the last does not feed the dead-man.
        pub beat: u32 [""],
    }
}

body! {
    /// One tone of a drive.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Tone {
        /// The number of the tone generator. A slot that sounds glides from its present place; a slot that the drive does
        /// not name fades out.
        pub slot: u8 ["", 0, MAX_TONES - 1],
        /// Where its turning point is, along the span of the table.
        pub position: Position ["1/65535 of the span"],
        /// Its peak on the plate relative to the table's full scale.
        pub level: Level ["1/65535"],
        /// Its phase when it starts from silence; ignored while it sounds, since the phase is continuous.
        pub phase: Phase ["1/65536 turn"],
    }
}

choices! {
    /// When a change begins.
    pub enum Apply {
        /// At the next block; the answer names its index.
        0 since 0 Next,
        /// At this sample index, rounded up to a block boundary; the answer names it.
        1 since 0 At(SampleIndex),
        /// With the first block that is rendered after the trigger input rises. The drive is planned at once; the answer
        /// names the index from which on a rise counts, where the glide under way is over. Until then it waits
        /// (`State::Waiting`), and the previous drive continues. A newer drive takes its place; a stop, a disarm, a fault
        /// and the end of the session drop it. A device without the input refuses it (`NotSupported`). It is not sent to a
        /// device of 1.0.
        2 since 1 AtTrigger or Self::At(SampleIndex::MAX),
    }
}

body! {
    /// The body of [`Command::Drive`].
    #[derive(Clone, Debug, PartialEq, Eq)]
    pub struct Drive {
        /// The tones, each in a slot of its own. None: all fade out and the device stays armed.
        pub tones: Vec<Tone, MAX_TONES> [""],
        /// Scales all tones.
        pub master: CentiDecibel ["1/100 dB", MIN_MASTER_CDB, 0],
        /// How long the change takes; from `min_glide` to `max_glide` of the device's hello.
        pub glide: u32 ["samples"],
        /// When it begins.
        pub apply: Apply [""],
    }
}

body! {
    /// One tone of a chord; it sounds in the slot of its place in the list.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct ChordTone {
        /// Which multiple of the base frequency it is. The multiples rise strictly from tone to tone, and their frequencies lie
        /// within those of the table.
        pub harmonic: u16 ["", 1, MAX_HARMONIC],
        /// Its peak on the plate relative to the table's full scale, at the place that the table gives its frequency.
        pub level: Level ["1/65535"],
        /// Its phase at the start.
        pub phase: Phase ["1/65536 turn"],
    }
}

body! {
    /// The body of [`Command::Chord`].
    #[derive(Clone, Debug, PartialEq, Eq)]
    pub struct Chord {
        /// The binary logarithm of the period in samples, so the period is 128 to 16384 samples. The base frequency is the sample
        /// rate divided by the period.
        pub period_log2: u8 ["", CHORD_PERIOD_LOG2.0, CHORD_PERIOD_LOG2.1],
        /// The tones, at least one.
        pub tones: Vec<ChordTone, MAX_TONES> [""],
        /// Scales all tones.
        pub master: CentiDecibel ["1/100 dB", MIN_MASTER_CDB, 0],
        /// How long all of them together rise from silence; from `min_glide` to `max_glide` of the device's hello.
        pub glide: u32 ["samples"],
        /// When it begins.
        pub apply: Apply [""],
    }
}

body! {
    /// One tone of a comb; it sounds in the slot of its place in the list.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct CombTone {
        /// Which multiple of the base frequency it is. The multiples rise strictly from tone to tone, up to 0.45 of the sample
        /// rate.
        pub harmonic: u16 ["", 1, u16::MAX],
        /// Its peak on the plate relative to the table's full scale, where the table has its frequency. A frequency beyond the
        /// table's ends has the gain of that end.
        pub level: Level ["1/65535"],
        /// Its phase at the start.
        pub phase: Phase ["1/65536 turn"],
    }
}

body! {
    /// The body of [`Command::Comb`].
    #[derive(Clone, Debug, PartialEq, Eq)]
    pub struct Comb {
        /// The period in blocks of 128 samples. The base frequency is the sample rate divided by the period.
        pub period_blocks: u16 ["blocks", COMB_PERIOD_BLOCKS.0, COMB_PERIOD_BLOCKS.1],
        /// The tones, at least one.
        pub tones: Vec<CombTone, MAX_TONES> [""],
        /// Scales all tones.
        pub master: CentiDecibel ["1/100 dB", MIN_MASTER_CDB, 0],
        /// How long all of them together rise from silence; from `min_glide` to `max_glide` of the device's hello.
        pub glide: u32 ["samples"],
        /// When it begins.
        pub apply: Apply [""],
    }
}

body! {
    /// The body of [`Command::ArmFor`] and of [`Command::Bench`].
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct ArmLease {
        /// How long the device stays armed without a drive.
        pub lease_ms: u32 ["ms", LEASE_MS.0, LEASE_MS.1],
    }
}

body! {
    /// The body of [`Command::WriteProfile`].
    #[derive(Clone, Debug, Default, PartialEq, Eq)]
    pub struct ProfileSetting {
        /// The profile; `None` to erase it.
        pub profile: Option<ActuatorProfile> [""],
    }
}

body! {
    /// The body of [`Command::SetTravelLimit`] and of [`Event::TravelLimit`](crate::Event::TravelLimit).
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct TravelSetting {
        /// The limit; `None` if the travel is not limited, as after each hello.
        pub limit: Option<TravelLimit> [""],
    }
}

body! {
    /// A table without its knots; the body of [`Command::TableBegin`].
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct TableHeader {
        /// The number of knots, which are uniform in position over the span.
        pub knots: u16 ["", MIN_KNOTS, MAX_KNOTS],
        /// Where position 0 lies on the plate, from the driven end.
        pub span_start_um: u32 ["um"],
        /// Where position 65535 lies; above `span_start_um`.
        pub span_end_um: u32 ["um"],
        /// The sample rate that the phase steps are made for; must be the device's own.
        pub sample_rate_hz: u32 ["Hz"],
        /// The table's CRC: the CRC-32 of this header's other fields and all knots.
        pub crc: u32 [""],
    }
}

body! {
    /// The body of [`Command::TableChunk`].
    #[derive(Clone, Debug, PartialEq, Eq)]
    pub struct TableChunk {
        /// The index of the first knot: the number of knots sent so far.
        pub first: u16 [""],
        /// The knots, at least one.
        pub knots: Vec<Knot, CHUNK_KNOTS> [""],
    }
}

body! {
    /// The body of [`Command::DigestStart`].
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct DigestWindow {
        /// The index of the first code.
        pub from: SampleIndex ["samples"],
        /// The number of codes.
        pub count: u32 ["samples", 1, MAX_DIGEST_SAMPLES],
    }
}
