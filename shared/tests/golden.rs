//! The frozen frames of every message, and the reference page made from the same tables.
//!
//! `wire/v1.snap` holds the frames of protocol 1.0 and is never edited: every device and every host of major 1 can
//! read and write these very bytes. A later minor adds messages and variants, never changes one, and gets a file of
//! its own beside it.

mod examples;

use examples::{SEQUENCE, SESSION, VERSION, commands, events};
use slipline_protocol::command::Hello;
use slipline_protocol::event::{Fault, Faults};
use slipline_protocol::frame::CRC;
use slipline_protocol::limits::MAX_BODY;
use slipline_protocol::version::{MAJOR, MINOR, SCHEMA};
use slipline_protocol::{Command, Event, Refusal};
use std::fmt::Write as _;
use std::path::Path;

/// The file of minor 0.
const FROZEN: &str = include_str!("../wire/v1.snap");

/// The lines of a file of frames: label and frame.
fn frozen(text: &str) -> impl Iterator<Item = (&str, Vec<u8>)> {
    text.lines().filter(|line| !line.starts_with('#')).map(|line| {
        let (label, frame) = line.split_once(' ').expect("a label, a blank, a frame");
        let frame = (0..frame.len()).step_by(2).map(|at| u8::from_str_radix(&frame[at..at + 2], 16).unwrap());
        (label, frame.collect())
    })
}

/// Every example with its label and its frame.
fn made() -> Vec<(String, Vec<u8>)> {
    let commands = commands().into_iter().map(|(label, command)| (label, command.frame(SESSION, SEQUENCE)));
    let events = events().into_iter().map(|(label, event)| (label, event.frame(SESSION, SEQUENCE)));
    commands
        .chain(events)
        .map(|(label, frame)| (label, frame.expect("every example fits a frame").to_vec()))
        .collect()
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
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
    let stored: Vec<(&str, Vec<u8>)> = frozen(FROZEN).collect();
    for (label, frame) in &stored {
        let made = made().into_iter().find(|(made, _)| made == label).map(|(_, frame)| hex(&frame));
        assert_eq!(made, Some(hex(frame)), "{label}: the frames of 1.0 are frozen, no minor changes them");
    }
    let is_stored = |label: &str| stored.iter().any(|(stored, _)| *stored == label);
    let missing = made().into_iter().filter(|(label, _)| !is_stored(label));
    let missing: Vec<String> = missing.map(|(label, frame)| format!("{label} {}", hex(&frame))).collect();
    assert!(missing.is_empty(), "not stored:\n{}", missing.join("\n"));
}

#[test]
fn the_fingerprint_is_that_of_the_frozen_frames() {
    let mut crc = CRC.digest();
    for (_, frame) in frozen(FROZEN) {
        crc.update(&frame);
    }
    assert_eq!(SCHEMA, crc.finalize());
}

#[test]
fn every_message_is_among_the_golden_ones() {
    for &(id, name, _) in Command::TABLE {
        assert!(commands().iter().any(|(_, c)| c.id() == id), "{name} has no golden bytes");
    }
    for &(id, name, _) in Event::TABLE {
        assert!(events().iter().any(|(_, e)| e.id() == id), "{name} has no golden bytes");
    }
}

#[test]
fn every_message_comes_back_as_it_was_and_tolerates_no_other_length() {
    let mut body = [0u8; MAX_BODY + 1];
    for (_, command) in commands() {
        let length = command.encode_body(&mut body).unwrap();
        assert_eq!(Command::decode(command.id(), &body[..length]).as_ref(), Ok(&command));
        assert_eq!(Command::decode(command.id(), &body[..=length]), Err(Refusal::Malformed));
        for short in 0..length {
            assert_eq!(Command::decode(command.id(), &body[..short]), Err(Refusal::Malformed), "{command:?}");
        }
    }
    for (_, event) in events() {
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
    let ids: Vec<u8> = Command::TABLE.iter().chain(Event::TABLE).map(|row| row.0).collect();
    assert!(ids.windows(2).all(|pair| pair[0] < pair[1]));
}

#[test]
fn the_frozen_part_of_the_hello_stands_where_it_always_stood() {
    let mut body = [0u8; MAX_BODY];
    Command::Hello(Hello { version: VERSION, nonce: [9, 8, 7, 6] }).encode_body(&mut body).unwrap();
    assert_eq!(body[..10], [1, 0, 1, 2, 3, 4, 9, 8, 7, 6]);
    events()[0].1.encode_body(&mut body).unwrap();
    assert_eq!(body[..6], [1, 0, 1, 2, 3, 4]);
}

#[test]
fn every_fault_has_a_text_and_a_bit_of_its_own() {
    for (bit, fault) in Fault::ALL.into_iter().enumerate() {
        assert_eq!(fault as usize, bit);
        assert!(!fault.text().is_empty());
        assert_eq!(Faults::NONE.with(fault).iter().collect::<Vec<_>>(), [fault]);
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
            let doc: Vec<&str> = doc.iter().map(|line| line.trim()).collect();
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
