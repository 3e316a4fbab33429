//! Example messages: each has a label, and its frame stands under this label in a file of `wire/`.
//!
//! Together they hold every message, and every variant of every enumeration that a message carries. Those of minor 0
//! stand here, those of a later minor in a file of its own.

mod v1_1;
mod v1_2;
mod v1_3;

use heapless::{String, Vec};
use slipline_protocol::command::*;
use slipline_protocol::event::*;
use slipline_protocol::limits::CHUNK_KNOTS;
use slipline_protocol::refusal::{Busy, Field, Refusal};
use slipline_protocol::table::Knot;
use slipline_protocol::units::{CentiDecibel, Gain, Level, Phase, Position};
use slipline_protocol::version::Version;
use slipline_protocol::{Command, Event};

/// The session in the header of every example.
pub(crate) const SESSION: u32 = 0x0403_0201;
/// The sequence number in the header of every example.
pub(crate) const SEQUENCE: u16 = 0x0605;

/// Not `Version::OURS`: the fingerprint is made from these very frames.
pub(crate) const VERSION: Version = Version { major: 1, minor: 0, schema: [1, 2, 3, 4] };

/// A command or an event with its label.
pub(crate) type Example<T> = (std::string::String, T);

/// The commands that a minor added.
///
/// # Panics
/// If it has no examples.
pub(crate) fn commands_of(minor: u8) -> std::vec::Vec<Example<Command>> {
    match minor {
        0 => commands(),
        1 => v1_1::commands(),
        2 => v1_2::commands(),
        3 => v1_3::commands(),
        _ => panic!("minor {minor} needs a file of examples here"),
    }
}

/// The events that a minor added, or that carry a variant that it added.
///
/// # Panics
/// If it has no examples.
pub(crate) fn events_of(minor: u8) -> std::vec::Vec<Example<Event>> {
    match minor {
        0 => events(),
        1 => v1_1::events(),
        2 => v1_2::events(),
        3 => v1_3::events(),
        _ => panic!("minor {minor} needs a file of examples here"),
    }
}

/// The commands of minor 0.
fn commands() -> std::vec::Vec<Example<Command>> {
    let tone =
        Tone { slot: 15, position: Position(u16::MAX), level: Level(u16::MAX), phase: Phase(u16::MAX) };
    let one_tone = Tone { slot: 0, position: Position(32_768), level: Level(52_428), phase: Phase(16_384) };
    let knots =
        [Knot { step: 644_245_094, gain: Gain(1 << 30) }, Knot { step: 214_748_365, gain: Gain(1 << 31) }];
    let largest = Knot { step: u32::MAX, gain: Gain(u32::MAX) };
    let examples = [
        ("hello", Command::Hello(Hello { version: VERSION, nonce: [9, 8, 7, 6] })),
        ("keep-alive", Command::KeepAlive(KeepAlive { beat: 300 })),
        ("status", Command::Status),
        ("arm", Command::Arm),
        ("disarm", Command::Disarm),
        (
            "drive",
            Command::Drive(Drive {
                tones: Vec::from_slice(&[one_tone]).unwrap(),
                master: CentiDecibel(-600),
                glide: 4000,
                apply: Apply::Next,
            }),
        ),
        (
            "drive-nothing",
            Command::Drive(Drive {
                tones: Vec::new(),
                master: CentiDecibel(0),
                glide: 2000,
                apply: Apply::At(1_000_064),
            }),
        ),
        (
            "drive-largest",
            Command::Drive(Drive {
                tones: Vec::from_slice(&[tone; 16]).unwrap(),
                master: CentiDecibel(i16::MIN),
                glide: u32::MAX,
                apply: Apply::At(u64::MAX),
            }),
        ),
        ("stop", Command::Stop),
        ("emergency-stop", Command::EmergencyStop),
        ("clear-faults", Command::ClearFaults),
        (
            "table-begin",
            Command::TableBegin(TableHeader {
                knots: 1025,
                span_start_um: 60_000,
                span_end_um: 290_000,
                sample_rate_hz: 400_000,
                crc: 0xdead_beef,
            }),
        ),
        (
            "table-chunk",
            Command::TableChunk(TableChunk { first: 22, knots: Vec::from_slice(&knots).unwrap() }),
        ),
        (
            "table-chunk-largest",
            Command::TableChunk(TableChunk {
                first: 1003,
                knots: Vec::from_slice(&[largest; CHUNK_KNOTS]).unwrap(),
            }),
        ),
        ("table-commit", Command::TableCommit),
        ("table-abort", Command::TableAbort),
        ("table-digest", Command::TableDigest),
        ("digest-start", Command::DigestStart(DigestWindow { from: 1 << 40, count: 4096 })),
        ("digest-read", Command::DigestRead),
        ("store", Command::Store),
        ("forget", Command::Forget),
        ("bootloader-token", Command::BootloaderToken),
        ("bootloader-enter", Command::BootloaderEnter(0x1234_5678)),
    ];
    examples.map(|(label, command)| (label.to_owned(), command)).into()
}

fn identity() -> Identity {
    Identity {
        version: VERSION,
        firmware: (0, 12, 255),
        board: String::try_from("stm32f4discovery").unwrap(),
        build: String::try_from("0123abc").unwrap(),
        unit: *b"\x00\x11\x22\x33\x44\x55\x66\x77\x88\x99\xaa\xbb",
        simulated: false,
        sample_rate_hz: 400_000,
        block: 128,
        dac_bits: 12,
        tones: 16,
        max_knots: 1025,
        min_glide: 2000,
        max_glide: 4_000_000,
        dead_man_ms: 1000,
        reset: ResetCause::PowerOn,
        stored: StoredConfig::Empty,
        crash: String::new(),
    }
}

fn status() -> Status {
    Status {
        state: State::Driving,
        faults: Faults::NONE,
        first_fault: None,
        first_fault_at: 0,
        now: 128_000_000,
        sum_per_mille: 750,
        heat_per_mille: 901,
        foldback_per_mille: 747,
        foldback_before_per_mille: [758, 770, 1000],
        foldback_changes: 17,
        table_crc: 0x89ab_cdef,
        counters: Counters {
            frames: 1,
            crc_errors: 2,
            overlong: 3,
            duplicates: 4,
            dropped: 5,
            underruns: 6,
            clips: 7,
            max_cycles: 20_000,
        },
    }
}

fn identities() -> impl Iterator<Item = Example<Event>> {
    let full = |c: char| std::iter::repeat_n(c, 96).collect::<std::string::String>();
    let longest = Identity {
        firmware: (255, 255, 255),
        board: String::try_from(&full('b')[..24]).unwrap(),
        build: String::try_from(&full('c')[..24]).unwrap(),
        unit: [0xff; 12],
        simulated: true,
        sample_rate_hz: u32::MAX,
        block: u16::MAX,
        min_glide: u32::MAX,
        max_glide: u32::MAX,
        crash: String::try_from(full('!').as_str()).unwrap(),
        ..identity()
    };
    let resets = [
        ResetCause::Pin,
        ResetCause::Software,
        ResetCause::Watchdog,
        ResetCause::BrownOut,
        ResetCause::Panic,
        ResetCause::HardFault,
    ];
    let stored = [StoredConfig::Loaded, StoredConfig::WrongVersion, StoredConfig::Damaged];
    [("hello-reply".to_owned(), identity()), ("hello-reply-largest".to_owned(), longest)]
        .into_iter()
        .chain(
            resets.into_iter().map(|reset| {
                (format!("hello-reply-reset-{}", reset as u8), Identity { reset, ..identity() })
            }),
        )
        .chain(stored.into_iter().map(|stored| {
            (format!("hello-reply-stored-{}", stored as u8), Identity { stored, ..identity() })
        }))
        .map(|(label, identity)| (label, Event::Hello(identity)))
}

fn statuses() -> impl Iterator<Item = Example<Event>> {
    let largest = Status {
        state: State::SafeMode,
        // The nine faults of this minor: towards it, no later one is ever set.
        faults: Faults(0x1ff),
        first_fault: Some(Fault::StoreDamaged),
        first_fault_at: u64::MAX,
        now: u64::MAX,
        sum_per_mille: u16::MAX,
        heat_per_mille: u16::MAX,
        foldback_per_mille: u16::MAX,
        foldback_before_per_mille: [u16::MAX; 3],
        foldback_changes: u32::MAX,
        table_crc: u32::MAX,
        counters: Counters {
            frames: u32::MAX,
            crc_errors: u32::MAX,
            overlong: u32::MAX,
            duplicates: u32::MAX,
            dropped: u32::MAX,
            underruns: u32::MAX,
            clips: u32::MAX,
            max_cycles: u32::MAX,
        },
    };
    let states = [State::Idle, State::Armed, State::Driving, State::Stopping, State::Fault, State::SafeMode];
    [("status-reply".to_owned(), status()), ("status-reply-largest".to_owned(), largest)]
        .into_iter()
        .chain(
            states
                .into_iter()
                .map(|state| (format!("status-reply-state-{}", state as u8), Status { state, ..status() })),
        )
        .chain(FAULTS.into_iter().map(|fault| {
            let faults = Faults::NONE.with(fault);
            let status = Status {
                state: State::Fault,
                faults,
                first_fault: Some(fault),
                first_fault_at: 127_999_872,
                ..status()
            };
            (format!("status-reply-fault-{}", fault as u8), status)
        }))
        .map(|(label, status)| (label, Event::Status(status)))
}

/// The faults of minor 0.
const FAULTS: [Fault; 9] = [
    Fault::HostLost,
    Fault::EmergencyStop,
    Fault::Underrun,
    Fault::Overheat,
    Fault::DriveTime,
    Fault::Watchdog,
    Fault::Crash,
    Fault::BrownOut,
    Fault::StoreDamaged,
];

/// The fields of minor 0.
const FIELDS: [Field; 12] = [
    Field::ToneCount,
    Field::ToneSlot,
    Field::MasterLevel,
    Field::Glide,
    Field::ApplyAt,
    Field::KnotCount,
    Field::KnotStep,
    Field::KnotGain,
    Field::ChunkFirst,
    Field::SampleRate,
    Field::Span,
    Field::DigestCount,
];

fn refusals() -> impl Iterator<Item = Example<Event>> {
    let plain = [
        ("unknown-message", Refusal::UnknownMessage { id: 0xfe }),
        ("malformed", Refusal::Malformed),
        ("stale-session", Refusal::StaleSession),
        ("bad-sequence", Refusal::BadSequence { expected: 513 }),
        ("version-mismatch", Refusal::VersionMismatch),
        ("not-armed", Refusal::NotArmed),
        ("faulted", Refusal::Faulted { faults: Faults::NONE.with(Fault::HostLost).with(Fault::Overheat) }),
        ("busy-commit-pending", Refusal::Busy(Busy::CommitPending)),
        ("busy-drive-active", Refusal::Busy(Busy::DriveActive)),
        ("busy-table-in-use", Refusal::Busy(Busy::TableInUse)),
        ("busy-digest-pending", Refusal::Busy(Busy::DigestPending)),
        ("out-of-range", Refusal::OutOfRange { field: Field::Glide, min: 2000, max: 4_000_000, got: -1 }),
        (
            "out-of-range-largest",
            Refusal::OutOfRange { field: Field::DigestCount, min: i64::MIN, max: i64::MAX, got: i64::MIN },
        ),
        ("slot-twice", Refusal::SlotTwice { slot: 3 }),
        ("headroom", Refusal::Headroom { sum_per_mille: 1600 }),
        ("no-table", Refusal::NoTable),
        ("no-upload", Refusal::NoUpload),
        ("chunk-order", Refusal::ChunkOrder { expected: 22 }),
        ("upload-incomplete", Refusal::UploadIncomplete { received: 44 }),
        ("table-crc", Refusal::TableCrc),
        ("not-monotonic", Refusal::NotMonotonic { knot: 5 }),
        ("bad-token", Refusal::BadToken),
        ("not-supported", Refusal::NotSupported),
        ("store-failed", Refusal::StoreFailed),
        ("armed", Refusal::Armed),
        ("safe-mode", Refusal::SafeMode),
        ("no-digest", Refusal::NoDigest),
    ];
    let fields = FIELDS.map(|field| {
        let refusal = Refusal::OutOfRange { field, min: 0, max: 1, got: 2 };
        (format!("refused-out-of-range-field-{}", field as u8), Event::Refused(refusal))
    });
    plain
        .into_iter()
        .map(|(label, refusal)| (format!("refused-{label}"), Event::Refused(refusal)))
        .chain(fields)
}

/// The events of minor 0.
fn events() -> std::vec::Vec<Example<Event>> {
    let header = TableHeader {
        knots: 513,
        span_start_um: 80_000,
        span_end_um: 270_000,
        sample_rate_hz: 400_000,
        crc: 0x89ab_cdef,
    };
    let waiting = Digest { from: 4096, count: 1 << 20, crc: None };
    let others = [
        ("accepted", Event::Accepted(Accepted { at: 128_000 })),
        ("table-reply", Event::Table(TableReport { active: Some(header), staged: 44 })),
        ("table-reply-none", Event::Table(TableReport { active: None, staged: 0 })),
        ("digest-reply", Event::Digest(Digest { crc: Some(0xcafe_f00d), ..waiting })),
        ("digest-reply-waiting", Event::Digest(waiting)),
        ("bootloader-token-reply", Event::BootloaderToken(0x1234_5678)),
    ];
    identities()
        .chain(statuses())
        .chain(others.into_iter().map(|(label, event)| (label.to_owned(), event)))
        .chain(refusals())
        .collect()
}
