//! Limits that host and device share. Times are in milliseconds; a device converts them into samples of its own rate.

/// Samples of a device's block: it takes up changes between blocks.
pub const BLOCK: usize = 128;
/// Tones that sound at once, at most.
pub const MAX_TONES: usize = 16;
/// Knots of a turning-point table, at most.
pub const MAX_KNOTS: usize = 1025;
/// Knots of a turning-point table, at least: interpolation needs two.
pub const MIN_KNOTS: usize = 2;
/// Knots of one `TableChunk`, at most: 22 knots of up to 10 bytes, the index of the first and their count fit into
/// [`MAX_BODY`].
pub const CHUNK_KNOTS: usize = 22;
/// Bytes of a message's body, at most.
pub const MAX_BODY: usize = 238;
/// Bytes of a frame before COBS: direction 1, session 4, sequence 2, id 1, body, CRC 4.
pub const MAX_RAW: usize = 8 + MAX_BODY + 4;
/// Bytes of a frame on the link, at most: COBS adds one byte and one more per 254; a zero delimiter follows, and a
/// second one where the length would be a multiple of 64 (a full last USB packet).
pub const MAX_ENCODED: usize = MAX_RAW + MAX_RAW / 254 + 3;
/// Bytes of a short text, such as a board's name, at most.
pub const MAX_NAME: usize = 24;
/// Bytes of a crash message, at most.
pub const MAX_CRASH: usize = 96;

/// The highest frequency of a tone, in thousandths of the sample rate.
pub const MAX_FREQUENCY_PER_MILLE: u32 = 450;
/// The highest phase step a knot may hold, Q0.32: 0.45 of a turn.
pub const MAX_KNOT_STEP: u32 = ((1u64 << 32) * MAX_FREQUENCY_PER_MILLE as u64 / 1000) as u32;

/// The quietest master level a drive may ask for, in hundredths of a decibel.
pub const MIN_MASTER_CDB: i16 = -9600;

/// The binary logarithm of a chord's period in samples: 128 to 16384. A period is a whole number of blocks, so every block
/// of a steady chord is one of those that the device has rendered before it accepted the chord.
pub const CHORD_PERIOD_LOG2: (u8, u8) = (7, 14);
/// The highest multiple of a chord's base frequency: 0.45 of the sample rate at the longest period.
pub const MAX_HARMONIC: u16 = ((1u32 << CHORD_PERIOD_LOG2.1) * MAX_FREQUENCY_PER_MILLE / 1000) as u16;
/// A comb's period in blocks of 128 samples: 128 to 8 388 480 samples.
pub const COMB_PERIOD_BLOCKS: (u16, u16) = (1, u16::MAX);
/// Samples in the block in which a comb's period is counted.
pub const COMB_BLOCK: u32 = BLOCK as u32;
/// Tones of one `Listened`: eight of up to 20 bytes and the rest fit into [`MAX_BODY`].
pub const LISTENED_TONES: usize = 8;
/// Values of a capture, at most.
pub const MAX_CAPTURE_VALUES: u16 = 4096;
/// The binary logarithm of the codes that a captured value sums up, at most: 1024 codes.
pub const MAX_CAPTURE_LOG2: u8 = 10;
/// Values of one `Captured`: 40 of up to 5 bytes and the rest fit into [`MAX_BODY`].
pub const CAPTURED_VALUES: usize = 40;
/// The amplitude that a level hold can hold, in 1/256 code: 1/16 code to the 2047 codes that fit the input's range.
pub const HELD_AMPLITUDE: (u32, u32) = (16, 2047 << 8);
/// Blocks from the end of a window of a level hold to the beginning of the next: by then the last codes have been sampled,
/// and the thread side has evaluated them.
pub const HOLD_PAUSE_BLOCKS: u16 = 12;
/// The lowest correction of a level hold is the negative of this, in hundredths of a decibel: a factor of 1024. It is the largest
/// slew per window, too.
pub const MAX_HOLD_CDB: i16 = 6020;
/// The largest rise of a level hold, in hundredths of a decibel: a factor of 10. A finger takes less; a sensor that slips off the
/// plate would ask for more.
pub const MAX_RISE_CDB: i16 = 2000;
/// A held tone that stays at its largest rise for this time is lost.
pub const MAX_AT_RISE_MS: u32 = 10_000;
/// The largest sum of a chord's amplitudes, in per mille of full scale: `4 sqrt(2)`. Beyond it the RMS of sixteen tones, and so
/// their peak, exceeds full scale with any phases.
pub const MAX_CHORD_SUM_PER_MILLE: u32 = 5657;

/// The resonance of an actuator whose travel is limited: 0.1 Hz to 10 MHz, in uHz.
pub const RESONANCE_UHZ: (u64, u64) = (100_000, 10_000_000_000_000);
/// The quality factor of its resonance: 0.1 to 1000, in thousandths.
pub const QUALITY_PER_MILLE: (u32, u32) = (100, 1_000_000);
/// Its travel at full scale far below the resonance, in millionths of its peak travel: up to 1000 times as far.
pub const STATIC_TRAVEL_PPM: (u32, u32) = (1, 1_000_000_000);
/// Periods of the resonance that a drive with a limit of the travel takes at least. Within two of them a raised cosine leaves
/// little free motion.
pub const GLIDE_PERIODS: u64 = 2;

/// A connected host sends a keep-alive after each period of this length.
pub const KEEP_ALIVE_PERIOD_MS: u32 = 200;
/// An armed device that gets no new keep-alive for this time ramps to silence and disarms.
pub const DEAD_MAN_MS: u32 = 1000;
// A drive survives four lost keep-alives in a row.
const _: () = assert!(DEAD_MAN_MS >= 5 * KEEP_ALIVE_PERIOD_MS);

/// The length of the dead-man's ramp to silence.
pub const DEAD_MAN_RAMP_MS: u32 = 50;
/// The length of a stop's ramp to silence.
pub const STOP_RAMP_MS: u32 = 30;
/// The length of an emergency stop's ramp to silence.
pub const EMERGENCY_RAMP_MS: u32 = 2;
/// The shortest glide a drive may ask for: shorter amplitude ramps click.
pub const MIN_GLIDE_MS: u32 = 5;
/// The longest glide a drive may ask for.
pub const MAX_GLIDE_MS: u32 = 10_000;
/// The farthest that an apply-at index may lie ahead. The device refuses a later one: the host has probably miscounted.
pub const MAX_APPLY_AHEAD_MS: u32 = 60_000;
/// A table upload that gets no chunk for this time is dropped.
pub const STAGING_TIMEOUT_MS: u32 = 2000;
/// A reply that the host has not taken after this time is dropped.
pub const TRANSMIT_TIMEOUT_MS: u32 = 20;
/// After its button was released a desk stop cannot be cleared for this time.
pub const DESK_STOP_MS: u32 = 2000;
/// For this time after a press of the button the hand counts as being on the board: a profile may be written then.
pub const HAND_MS: u32 = 30_000;
/// Tables that may be stored or forgotten in a row; one more every [`STORE_PERIOD_MS`]. It spares the flash.
pub const STORES: u8 = 16;
/// The time after which one more table may be stored.
pub const STORE_PERIOD_MS: u32 = 60_000;
/// A bootloader token is valid for this time.
pub const BOOTLOADER_TOKEN_MS: u32 = 5000;
/// The longest drive with no command from the user.
pub const MAX_DRIVE_MS: u32 = 10 * 60 * 1000;
/// For how long a device may be armed without a drive, by its lease: from a drag that pauses to the longest drive.
pub const LEASE_MS: (u32, u32) = (1000, MAX_DRIVE_MS);
/// The shortest time that an actuator's profile may allow a drive.
pub const MIN_DRIVE_MS: u32 = 1000;
/// The largest sum of amplitudes that an actuator's profile may allow, in per mille of full scale.
pub const PROFILE_SUM_PER_MILLE: (u16, u16) = (1, 1000);
/// The time constants of a coil's heat: the shortest is three periods of the fold-back.
pub const COIL_TIME_MS: (u32, u32) = (1000, 3_600_000);
/// The rise of a coil by a sine of full scale, in per mille of its limit.
pub const FULL_SINE_PER_MILLE: (u16, u16) = (10, 20_000);
/// The longest window of DAC codes one digest may cover.
pub const MAX_DIGEST_SAMPLES: u32 = 1 << 20;

/// The thermal fold-back changes only at multiples of this time, rounded down to whole blocks (at least one). It is
/// 1/25 of the time constant of the coil's winding.
pub const FOLDBACK_PERIOD_MS: u32 = 320;
/// Earlier fold-back periods whose factors a status holds besides the present one. Together they cover the longest time
/// between two statuses of one connection: a host gives up after a second without an answer.
pub const FOLDBACK_PERIODS: usize = 3;
const _: () = assert!(
    (FOLDBACK_PERIODS as u32 + 1) * FOLDBACK_PERIOD_MS >= REPLY_TIMEOUT_MS * (MAX_RETRIES + 2),
    "a host that is still connected can replay every period"
);

/// Host side: after this time without a reply the command is sent again.
pub const REPLY_TIMEOUT_MS: u32 = 200;
/// Host side: how often a command is sent again before the link counts as lost.
pub const MAX_RETRIES: u32 = 3;
