//! The frozen frames of every message.
//!
//! `wire/v1.snap` holds the frames of protocol 1.0 and is never edited: every device and every host of major 1 can
//! read and write these very bytes. A later minor adds messages and variants, never changes one, and gets a file of
//! its own beside it, which does not enter the fingerprint.

mod examples;

use examples::{SEQUENCE, SESSION, VERSION, commands, events};
use slipline_protocol::command::Hello;
use slipline_protocol::event::{Fault, Faults};
use slipline_protocol::frame::CRC;
use slipline_protocol::schema::MessageRow;
use slipline_protocol::version::{Minor, SCHEMA};
use slipline_protocol::{Command, Decoder, Event, Refusal};
use std::fmt::Write as _;

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

/// The body in a frame.
fn body_of(frame: &[u8]) -> Vec<u8> {
    let mut decoder = Decoder::new();
    frame.iter().find_map(|&byte| decoder.push(byte, |frame| frame.body.to_vec())).expect("a whole frame")
}

/// Every example with its label and its frame.
fn made() -> Vec<(String, Vec<u8>)> {
    let commands = commands()
        .into_iter()
        .map(|(label, command)| (label, command.frame_for(Minor::FIRST, SESSION, SEQUENCE)));
    let events =
        events().into_iter().map(|(label, event)| (label, event.frame_for(Minor::FIRST, SESSION, SEQUENCE)));
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
    for MessageRow { id, name, .. } in Command::TABLE {
        assert!(commands().iter().any(|(_, c)| c.id() == *id), "{name} has no golden bytes");
    }
    for MessageRow { id, name, .. } in Event::TABLE {
        assert!(events().iter().any(|(_, e)| e.id() == *id), "{name} has no golden bytes");
    }
}

#[test]
fn every_message_comes_back_as_it_was_and_tolerates_no_other_length() {
    for (_, command) in commands() {
        let mut body = body_of(&command.frame_for(Minor::OURS, SESSION, SEQUENCE).unwrap());
        assert_eq!(Command::decode(command.id(), &body).as_ref(), Ok(&command));
        for short in 0..body.len() {
            assert_eq!(Command::decode(command.id(), &body[..short]), Err(Refusal::Malformed), "{command:?}");
        }
        body.push(0);
        assert_eq!(Command::decode(command.id(), &body), Err(Refusal::Malformed));
    }
    for (_, event) in events() {
        let mut body = body_of(&event.frame_for(Minor::OURS, SESSION, SEQUENCE).unwrap());
        assert_eq!(Event::decode(event.id(), &body).as_ref(), Ok(&event));
        body.push(0);
        assert_eq!(Event::decode(event.id(), &body), Err(Refusal::Malformed));
    }
}

#[test]
fn every_id_outside_the_tables_is_unknown() {
    for id in 0..=255u8 {
        if !Command::TABLE.iter().any(|row| row.id == id) {
            assert_eq!(Command::decode(id, &[]), Err(Refusal::UnknownMessage { id }));
        }
    }
}

#[test]
fn ids_rise_and_the_two_directions_share_none() {
    let ids: Vec<u8> = Command::TABLE.iter().chain(Event::TABLE).map(|row| row.id).collect();
    assert!(ids.windows(2).all(|pair| pair[0] < pair[1]));
}

#[test]
fn the_frozen_part_of_the_hello_stands_where_it_always_stood() {
    let hello = Command::Hello(Hello { version: VERSION, nonce: [9, 8, 7, 6] });
    assert_eq!(body_of(&hello.frame_for(Minor::OURS, 0, 1).unwrap()), [1, 0, 1, 2, 3, 4, 9, 8, 7, 6]);
    let (_, identity) = &events()[0];
    assert_eq!(body_of(&identity.frame_for(Minor::FIRST, 1, 1).unwrap())[..6], [1, 0, 1, 2, 3, 4]);
}

#[test]
fn every_fault_has_a_text_and_a_bit_of_its_own() {
    for (bit, fault) in Fault::ALL.iter().copied().enumerate() {
        assert_eq!(fault as usize, bit);
        assert!(!fault.text().is_empty());
        assert_eq!(Faults::NONE.with(fault).iter().collect::<Vec<_>>(), [fault]);
        assert!(Faults::NONE.with(fault).without(fault).is_empty());
    }
}
