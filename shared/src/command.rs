//! What a host tells a device.

use crate::limits::{CHUNK_KNOTS, MAX_TONES};
use crate::message::messages;
use crate::table::Knot;
use crate::units::{CentiDecibel, Level, Phase, Position, SampleIndex};
use crate::version::Version;
use heapless::Vec;
use serde::{Deserialize, Serialize};

messages! {
    /// A command. Every command is answered by exactly one [`Event`](crate::Event).
    pub enum Command {
        /// Who are you? Starts a session. Frozen for ever.
        0x01 Hello(Hello),
        /// The host lives; feeds the dead-man. Answered by the status. Not sequenced.
        0x02 KeepAlive(KeepAlive),
        /// How are you? Answered by the status. Not sequenced.
        0x03 Status,
        /// Unmute the amplifier and accept drives.
        0x10 Arm,
        /// Ramp to silence, mute, accept no drives.
        0x11 Disarm,
        /// Sound these tones from an index on.
        0x12 Drive(Drive),
        /// Ramp to silence, stay armed. Taken in every state, from every session.
        0x13 Stop,
        /// Ramp to silence at once, mute, latch a fault. Taken in every state, from every session.
        0x14 EmergencyStop,
        /// Clear the latched faults whose cause is gone.
        0x15 ClearFaults,
        /// Begin to upload a turning-point table into the staging slot.
        0x20 TableBegin(TableHeader),
        /// The next knots of the upload.
        0x21 TableChunk(TableChunk),
        /// Check the whole upload and swap it in.
        0x22 TableCommit,
        /// Drop the upload.
        0x23 TableAbort,
        /// What table is active? Answered by its digest.
        0x24 TableDigest,
        /// Make a CRC-32 of the DAC codes of a window that lies ahead.
        0x30 DigestStart(DigestWindow),
        /// Read the digest.
        0x31 DigestRead,
        /// Keep the active table in flash. Only when silent.
        0x40 Store,
        /// Forget what is kept in flash. Only when silent.
        0x41 Forget,
        /// First step into the ROM bootloader: ask for a token. Only when disarmed.
        0x50 BootloaderToken,
        /// Second step into the ROM bootloader: show the token.
        0x51 BootloaderEnter(u32),
    }
}

/// The body of [`Command::Hello`]. Frozen for ever.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Hello {
    /// What the host speaks.
    pub version: Version,
    /// A number the host draws once per connection, so that a repeated hello does not start a second session.
    pub nonce: [u8; 4],
}

/// The body of [`Command::KeepAlive`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeepAlive {
    /// Rises with every keep-alive of the session; a repeated or late one does not feed the dead-man.
    pub beat: u32,
}

/// One tone of a drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Tone {
    /// 0..16. A slot that sounds glides from where it is; a slot that a drive does not name fades out.
    pub slot: u8,
    /// Where its turning point is.
    pub position: Position,
    /// Its peak on the plate relative to the table's full scale.
    pub level: Level,
    /// Phase at the moment it starts from silence; ignored while it sounds (phase is continuous).
    pub phase: Phase,
}

/// When a change applies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Apply {
    /// At the next block; the reply names its index.
    Next,
    /// At this sample index, rounded up to a block boundary; the reply names it.
    At(SampleIndex),
}

/// The body of [`Command::Drive`].
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Drive {
    /// The tones, at most 16, each in a slot of its own. None: fade out, stay armed.
    pub tones: Vec<Tone, MAX_TONES>,
    /// Scales all tones; -9600..=0.
    pub master: CentiDecibel,
    /// How long the change takes, in samples; the device states its range in its hello.
    pub glide: u32,
    /// When it begins.
    pub apply: Apply,
}

/// The body of [`Command::TableBegin`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TableHeader {
    /// Knots, 2..=1025, uniform in position over the span.
    pub knots: u16,
    /// Where position 0 lies on the plate, in micrometres from the driven end.
    pub span_start_um: u32,
    /// Where position 65535 lies; above `span_start_um`.
    pub span_end_um: u32,
    /// The sample rate the steps are made for, in Hz; must be the device's own.
    pub sample_rate_hz: u32,
    /// CRC-32 of the table, see [`table::digest`](crate::table::digest).
    pub crc: u32,
}

/// The body of [`Command::TableChunk`].
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TableChunk {
    /// Index of the first knot.
    pub first: u16,
    /// The knots, at least one.
    pub knots: Vec<Knot, CHUNK_KNOTS>,
}

/// The body of [`Command::DigestStart`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct DigestWindow {
    /// Index of the first code.
    pub from: SampleIndex,
    /// Number of codes, 1..=2^20.
    pub count: u32,
}
