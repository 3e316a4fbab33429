//! Golden bytes of every message, and the reference page made from the same tables.
//!
//! `wire/v1.snap` is never edited once released: a changed line means a changed wire, so bump `version::MAJOR` and
//! start `wire/v2.snap`; an added message means a new line, so bump `version::MINOR`. While this version has not been
//! released, write both files anew with `SLIPLINE_BLESS=1 cargo test -p slipline-protocol --test golden`.

use heapless::{String, Vec};
use slipline_protocol::command::*;
use slipline_protocol::event::*;
use slipline_protocol::limits::{CHUNK_KNOTS, MAX_BODY};
use slipline_protocol::refusal::{Busy, Field, Refusal};
use slipline_protocol::table::Knot;
use slipline_protocol::units::{CentiDecibel, Gain, Level, Phase, Position};
use slipline_protocol::version::{MAJOR, MINOR, Version};
use slipline_protocol::{Command, Event};
use std::fmt::Write as _;
use std::path::Path;

// Not `Version::OURS`: the schema is made from these very bytes.
const VERSION: Version = Version { major: 1, minor: 0, schema: [1, 2, 3, 4] };

fn commands() -> std::vec::Vec<Command> {
    let tone =
        Tone { slot: 15, position: Position(u16::MAX), level: Level(u16::MAX), phase: Phase(u16::MAX) };
    let knot = Knot { step: u32::MAX, gain: Gain(u32::MAX) };
    vec![
        Command::Hello(Hello { version: VERSION, nonce: [9, 8, 7, 6] }),
        Command::KeepAlive(KeepAlive { beat: 300 }),
        Command::Status,
        Command::Arm,
        Command::Disarm,
        Command::Drive(Drive {
            tones: Vec::from_slice(&[tone; 16]).unwrap(),
            master: CentiDecibel(i16::MIN),
            glide: u32::MAX,
            apply: Apply::At(u64::MAX),
        }),
        Command::Drive(Drive {
            tones: Vec::from_slice(&[Tone {
                slot: 0,
                position: Position(32768),
                level: Level(52428),
                phase: Phase(0),
            }])
            .unwrap(),
            master: CentiDecibel(-600),
            glide: 4000,
            apply: Apply::Next,
        }),
        Command::Stop,
        Command::EmergencyStop,
        Command::ClearFaults,
        Command::TableBegin(TableHeader {
            knots: 1025,
            span_start_um: 60_000,
            span_end_um: 290_000,
            sample_rate_hz: 400_000,
            crc: 0xdead_beef,
        }),
        Command::TableChunk(TableChunk {
            first: 1003,
            knots: Vec::from_slice(&[knot; CHUNK_KNOTS]).unwrap(),
        }),
        Command::TableCommit,
        Command::TableAbort,
        Command::TableDigest,
        Command::DigestStart(DigestWindow { from: 1 << 40, count: 4096 }),
        Command::DigestRead,
        Command::Store,
        Command::Forget,
        Command::BootloaderToken,
        Command::BootloaderEnter(0x1234_5678),
    ]
}

fn events() -> std::vec::Vec<Event> {
    let name: String<24> = String::try_from("STM32F4DISCOVERY........").unwrap();
    let header =
        TableHeader { knots: 1025, span_start_um: 1, span_end_um: 2, sample_rate_hz: 400_000, crc: 3 };
    let mut crash = String::new();
    while crash.push('!').is_ok() {}
    vec![
        Event::Hello(Identity {
            version: VERSION,
            firmware: (255, 255, 255),
            board: name.clone(),
            build: name,
            unit: [0xff; 12],
            simulated: true,
            sample_rate_hz: u32::MAX,
            block: u16::MAX,
            dac_bits: 12,
            tones: 16,
            max_knots: 1025,
            min_glide: u32::MAX,
            max_glide: u32::MAX,
            dead_man_ms: 1000,
            reset: ResetCause::HardFault,
            stored: StoredConfig::Damaged,
            crash,
        }),
        Event::Status(Status {
            state: State::SafeMode,
            faults: Faults(u32::MAX),
            first_fault: Some(Fault::StoreDamaged),
            first_fault_at: u64::MAX,
            now: u64::MAX,
            sum_per_mille: u16::MAX,
            heat_per_mille: u16::MAX,
            foldback_per_mille: u16::MAX,
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
        }),
        Event::Accepted(Accepted { at: 128 }),
        Event::Table(TableReport { active: Some(header), staged: 7 }),
        Event::Digest(Digest { from: 4096, count: 4096, crc: Some(0xcafe_f00d) }),
        Event::BootloaderToken(77),
        Event::Refused(Refusal::UnknownMessage { id: 0xfe }),
        Event::Refused(Refusal::Malformed),
        Event::Refused(Refusal::StaleSession),
        Event::Refused(Refusal::BadSequence { expected: 513 }),
        Event::Refused(Refusal::VersionMismatch),
        Event::Refused(Refusal::NotArmed),
        Event::Refused(Refusal::Faulted { faults: Faults::NONE.with(Fault::HostLost).with(Fault::Overheat) }),
        Event::Refused(Refusal::Busy(Busy::CommitPending)),
        Event::Refused(Refusal::Busy(Busy::DriveActive)),
        Event::Refused(Refusal::Busy(Busy::TableInUse)),
        Event::Refused(Refusal::Busy(Busy::DigestPending)),
        Event::Refused(Refusal::OutOfRange { field: Field::Glide, min: 2000, max: 4_000_000, got: -1 }),
        Event::Refused(Refusal::SlotTwice { slot: 3 }),
        Event::Refused(Refusal::Headroom { sum_per_mille: 1600 }),
        Event::Refused(Refusal::NoTable),
        Event::Refused(Refusal::NoUpload),
        Event::Refused(Refusal::ChunkOrder { expected: 22 }),
        Event::Refused(Refusal::UploadIncomplete { received: 44 }),
        Event::Refused(Refusal::TableCrc),
        Event::Refused(Refusal::NotMonotonic { knot: 5 }),
        Event::Refused(Refusal::BadToken),
        Event::Refused(Refusal::NotSupported),
        Event::Refused(Refusal::StoreFailed),
        Event::Refused(Refusal::Armed),
        Event::Refused(Refusal::SafeMode),
        Event::Refused(Refusal::NoDigest),
    ]
}

fn hex(bytes: &[u8]) -> std::string::String {
    bytes.iter().fold(std::string::String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

fn snapshot() -> std::string::String {
    let mut text = std::string::String::new();
    for command in commands() {
        let bytes = command.frame(0x0403_0201, 0x0605).expect("every command fits a frame");
        writeln!(text, "{command:?}\n  {}", hex(&bytes)).unwrap();
    }
    for event in events() {
        let bytes = event.frame(0x0403_0201, 0x0605).expect("every event fits a frame");
        writeln!(text, "{event:?}\n  {}", hex(&bytes)).unwrap();
    }
    text
}

/// Writes the file when asked to, else demands that it stands as made.
fn hold(path: &str, made: &str, hint: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    if std::env::var_os("SLIPLINE_BLESS").is_some() {
        std::fs::write(&path, made).unwrap();
    }
    let stands = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(stands == made, "{} differs from what the code makes. {hint}", path.display());
}

#[test]
fn golden_bytes_have_not_changed() {
    hold(
        "wire/v1.snap",
        &snapshot(),
        "A changed line: bump version::MAJOR and start a new file. An added line: bump version::MINOR.",
    );
}

#[test]
fn every_message_is_among_the_golden_ones() {
    for &(id, name, _) in Command::TABLE {
        assert!(commands().iter().any(|c| c.id() == id), "{name} has no golden bytes");
    }
    for &(id, name, _) in Event::TABLE {
        assert!(events().iter().any(|e| e.id() == id), "{name} has no golden bytes");
    }
}

#[test]
fn every_message_comes_back_as_it_was_and_tolerates_no_other_length() {
    let mut body = [0u8; MAX_BODY + 1];
    for command in commands() {
        let length = command.encode_body(&mut body).unwrap();
        assert_eq!(Command::decode(command.id(), &body[..length]).as_ref(), Ok(&command));
        assert_eq!(Command::decode(command.id(), &body[..=length]), Err(Refusal::Malformed));
        for short in 0..length {
            assert_eq!(Command::decode(command.id(), &body[..short]), Err(Refusal::Malformed), "{command:?}");
        }
    }
    for event in events() {
        let length = event.encode_body(&mut body).unwrap();
        assert_eq!(Event::decode(event.id(), &body[..length]).as_ref(), Ok(&event));
        assert_eq!(Event::decode(event.id(), &body[..=length]), Err(Refusal::Malformed));
    }
}

#[test]
fn every_id_outside_the_tables_is_unknown() {
    for id in 0..=255u8 {
        if !Command::TABLE.iter().any(|row| row.0 == id) {
            assert_eq!(Command::decode(id, &[]), Err(Refusal::UnknownMessage { id }));
        }
    }
}

#[test]
fn ids_rise_and_the_two_directions_share_none() {
    let ids: std::vec::Vec<u8> = Command::TABLE.iter().chain(Event::TABLE).map(|row| row.0).collect();
    assert!(ids.windows(2).all(|pair| pair[0] < pair[1]));
}

#[test]
fn the_frozen_part_of_the_hello_stands_where_it_always_stood() {
    let mut body = [0u8; MAX_BODY];
    Command::Hello(Hello { version: VERSION, nonce: [9, 8, 7, 6] }).encode_body(&mut body).unwrap();
    assert_eq!(body[..10], [1, 0, 1, 2, 3, 4, 9, 8, 7, 6]);
    events()[0].encode_body(&mut body).unwrap();
    assert_eq!(body[..6], [1, 0, 1, 2, 3, 4]);
}

#[test]
fn every_fault_has_a_text_and_a_bit_of_its_own() {
    for (bit, fault) in Fault::ALL.into_iter().enumerate() {
        assert_eq!(fault as usize, bit);
        assert!(!fault.text().is_empty());
        assert_eq!(Faults::NONE.with(fault).iter().collect::<std::vec::Vec<_>>(), [fault]);
        assert!(Faults::NONE.with(fault).without(fault).is_empty());
    }
}

#[test]
fn the_reference_page_is_up_to_date() {
    let mut page = format!(
        "# The Slipline protocol, version {MAJOR}.{MINOR}\n\n\
         Made from the message tables in `src/` by `tests/golden.rs`; do not edit. Golden bytes: `wire/v1.snap`.\n\n\
         A frame is `COBS(direction 1 | session 4 | sequence 2 | id 1 | body | crc 4) 00`, integers little-endian, the \
         body in postcard's encoding, the CRC-32 over all before it. Direction is `a5` to the device and `5a` to the \
         host. The device speaks only when spoken to: one answer per command, with the command's session and \
         sequence. The fields of a body are documented at the type of the same name.\n"
    );
    for (title, table) in [("Commands", Command::TABLE), ("Events", Event::TABLE)] {
        writeln!(page, "\n## {title}\n\n| id | name | meaning |\n|---|---|---|").unwrap();
        for (id, name, doc) in table {
            let doc: std::vec::Vec<&str> = doc.iter().map(|line| line.trim()).collect();
            writeln!(
                page,
                "| `{id:02x}` | `{name}` | {} |",
                doc.join(" ").replace("[`Event`](crate::Event)", "event")
            )
            .unwrap();
        }
    }
    writeln!(page, "\n## Faults\n\n| bit | name | text |\n|---|---|---|").unwrap();
    for (bit, fault) in Fault::ALL.into_iter().enumerate() {
        writeln!(page, "| {bit} | `{fault:?}` | {} |", fault.text()).unwrap();
    }
    hold("PROTOCOL.md", &page, "Write it anew with SLIPLINE_BLESS=1.");
}
