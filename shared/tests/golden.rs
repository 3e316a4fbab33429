//! The frozen frames of every message.
//!
//! `wire/v1.snap` holds the frames of protocol 1.0 and is never edited: every device and every host of major 1 can
//! read and write these very bytes. A later minor adds messages and variants, never changes one, and has a file of
//! its own beside it, which does not enter the fingerprint. The first line of such a file says whether it is open, because
//! the minor has not been released, or frozen like the first. An open one is renewed with `SLIPLINE_BLESS=1`.

mod examples;

use examples::{SEQUENCE, SESSION, VERSION, commands_of, events_of};
use slipline_protocol::command::Hello;
use slipline_protocol::event::{Accepted, Fault, Faults};
use slipline_protocol::frame::CRC;
use slipline_protocol::refusal::{Busy, Field};
use slipline_protocol::schema::MessageRow;
use slipline_protocol::version::{MINOR, Minor, SCHEMA, Version};
use slipline_protocol::{Command, Decoder, Event, Refusal};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// The file of minor 0.
const FROZEN: &str = include_str!("../wire/v1.snap");
/// How the file of a minor begins that is not released.
const OPEN: &str = "# Open: ";

/// The minor of this number, as it is shared with a host or a device that speaks it.
fn minor(number: u8) -> Minor {
    Version::OURS.shared_minor(Version { minor: number, ..Version::OURS })
}

/// Where the frames that a minor added are stored.
fn file_of(minor: u8) -> PathBuf {
    let name = if minor == 0 { "v1.snap".to_owned() } else { format!("v1_{minor}.snap") };
    Path::new(env!("CARGO_MANIFEST_DIR")).join("wire").join(name)
}

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

/// Every command and every event that an example shows, of all minors.
fn commands() -> impl Iterator<Item = Command> {
    (0..=MINOR).flat_map(commands_of).map(|(_, command)| command)
}

fn events() -> impl Iterator<Item = Event> {
    (0..=MINOR).flat_map(events_of).map(|(_, event)| event)
}

/// Every example of a minor with its label and its frame, as it goes to a side that speaks this minor.
fn made(number: u8) -> Vec<(String, Vec<u8>)> {
    let commands = commands_of(number)
        .into_iter()
        .map(|(label, command)| (label, command.frame_for(minor(number), SESSION, SEQUENCE)));
    let events = events_of(number)
        .into_iter()
        .map(|(label, event)| (label, event.frame_for(minor(number), SESSION, SEQUENCE)));
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
    if std::env::var_os("SLIPLINE_BLESS").is_some() {
        renew_what_is_open();
    }
    for number in 0..=MINOR {
        let text = std::fs::read_to_string(file_of(number)).unwrap_or_default();
        let stored: Vec<(&str, Vec<u8>)> = frozen(&text).collect();
        for (label, frame) in &stored {
            let made = made(number).into_iter().find(|(made, _)| made == label).map(|(_, frame)| hex(&frame));
            assert_eq!(
                made,
                Some(hex(frame)),
                "{label}: no minor changes the frames that 1.{number} brought"
            );
        }
        let is_stored = |label: &str| stored.iter().any(|(stored, _)| *stored == label);
        let missing = made(number).into_iter().filter(|(label, _)| !is_stored(label));
        let missing: Vec<String> = missing.map(|(label, frame)| format!("{label} {}", hex(&frame))).collect();
        assert!(missing.is_empty(), "not in {}:\n{}", file_of(number).display(), missing.join("\n"));
    }
}

/// Rewrites the files of open minors.
fn renew_what_is_open() {
    for number in 1..=MINOR {
        let text = std::fs::read_to_string(file_of(number)).unwrap_or_default();
        if text.starts_with(OPEN) {
            let head = text.lines().next().unwrap_or_default();
            let lines = made(number).into_iter().map(|(label, frame)| format!("{label} {}\n", hex(&frame)));
            let renewed = format!("{head}\n{}", lines.collect::<String>());
            // Another test reads the file at the same time.
            if renewed != text {
                std::fs::write(file_of(number), renewed).unwrap();
            }
        }
    }
}

#[test]
fn only_the_latest_minor_may_be_open() {
    for number in 0..=MINOR {
        let text = std::fs::read_to_string(file_of(number)).unwrap();
        let may_be_open = number == MINOR && number > 0;
        assert!(text.starts_with("# Frames of ") || (may_be_open && text.starts_with(OPEN)), "1.{number}");
    }
}

#[test]
fn the_fingerprint_matches_the_frozen_frames() {
    let mut crc = CRC.digest();
    for (_, frame) in frozen(FROZEN) {
        crc.update(&frame);
    }
    assert_eq!(SCHEMA, crc.finalize());
}

#[test]
fn every_message_is_among_the_golden_ones() {
    for MessageRow { id, name, since, .. } in Command::TABLE {
        assert!(commands_of(*since).iter().any(|(_, c)| c.id() == *id), "{name} has no golden bytes");
    }
    for MessageRow { id, name, since, .. } in Event::TABLE {
        assert!(events_of(*since).iter().any(|(_, e)| e.id() == *id), "{name} has no golden bytes");
    }
}

#[test]
fn every_message_comes_back_as_it_was_and_tolerates_no_other_length() {
    for command in commands() {
        let mut body = body_of(&command.frame_for(Minor::OURS, SESSION, SEQUENCE).unwrap());
        assert_eq!(Command::decode(command.id(), &body).as_ref(), Ok(&command));
        for short in 0..body.len() {
            assert_eq!(Command::decode(command.id(), &body[..short]), Err(Refusal::Malformed), "{command:?}");
        }
        body.push(0);
        assert_eq!(Command::decode(command.id(), &body), Err(Refusal::Malformed));
    }
    for event in events() {
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

/// An event as a host of an older minor gets it; nothing if it does not.
fn as_received(event: &Event, minor: Minor) -> Option<Event> {
    let frame = event.frame_for(minor, SESSION, SEQUENCE).ok()?;
    let mut decoder = Decoder::new();
    frame.iter().find_map(|&byte| decoder.push(byte, |it| Event::decode(it.header.id, it.body).unwrap()))
}

/// What a side of 1.1 gets in the place of each addition of 1.2.
#[test]
fn each_addition_of_1_2_reaches_1_1_as_a_substitute_or_not_at_all() {
    let seen: Vec<String> = events_of(2)
        .iter()
        .map(|(_, event)| format!("{:?}", as_received(event, minor(1)).unwrap()))
        .collect();
    // No host of 1.1 sends a chord; so none ever gets these.
    let expected = [
        "Refused(Headroom { sum_per_mille: 1213 })",
        "Refused(OutOfRange { field: Glide, min: 7, max: 14, got: 15 })",
        "Refused(OutOfRange { field: ToneSlot, min: 7, max: 14, got: 15 })",
    ];
    assert_eq!(seen, expected);
    for (label, command) in commands_of(2) {
        assert!(command.frame_for(minor(1), SESSION, SEQUENCE).is_err(), "{label} goes to no device of 1.1");
    }
}

/// What a side of 1.2 gets in the place of each addition of 1.3.
#[test]
fn each_addition_of_1_3_reaches_1_2_as_a_substitute_or_not_at_all() {
    let mut received = events_of(3).into_iter().map(|(_, event)| as_received(&event, minor(2)));
    assert!(received.by_ref().take(23).all(|event| event.is_none()), "what the board is");
    let Some(Some(Event::Status(status))) = received.next() else { panic!("a stop on the desk is known") };
    let emergency = Fault::EmergencyStop;
    assert_eq!((status.faults, status.first_fault), (Faults::NONE.with(emergency), Some(emergency)));
    let Some(Some(Event::Status(status))) = received.next() else { panic!("an older profile is known") };
    let fell_back = Fault::StoreFellBack;
    assert_eq!((status.faults, status.first_fault), (Faults::NONE.with(fell_back), Some(fell_back)));
    let seen: Vec<Option<Event>> = received.collect();
    // No host of 1.2 sends what these refuse; so none ever gets these.
    let refused = |field| Some(Event::Refused(Refusal::OutOfRange { field, min: 0, max: 1, got: 2 }));
    let mut expected = vec![Some(Event::Accepted(Accepted { at: 128_000 }))];
    expected.extend(vec![None; 12]);
    expected.push(Some(Event::Refused(Refusal::Busy(Busy::DriveActive))));
    expected.push(Some(Event::Refused(Refusal::NotSupported)));
    expected.push(Some(Event::Refused(Refusal::NotSupported)));
    expected.push(Some(Event::Refused(Refusal::StoreFailed)));
    expected.push(Some(Event::Refused(Refusal::NotSupported)));
    let stand_ins = [
        Field::Glide,
        Field::DigestCount,
        Field::ToneCount,
        Field::ToneSlot,
        Field::DigestCount,
        Field::DigestCount,
        Field::Glide,
        Field::MasterLevel,
        Field::MasterLevel,
        Field::MasterLevel,
        Field::Glide,
        Field::MasterLevel,
        Field::Glide,
        Field::MasterLevel,
        Field::Glide,
        Field::MasterLevel,
        Field::MasterLevel,
    ];
    expected.extend(stand_ins.map(refused));
    assert_eq!(seen, expected);
    for (label, command) in commands_of(3) {
        assert!(command.frame_for(minor(2), SESSION, SEQUENCE).is_err(), "{label} goes to no device of 1.2");
    }
}

/// What a side of 1.0 gets in the place of each addition of 1.1.
#[test]
fn each_addition_of_1_1_reaches_1_0_as_a_substitute_or_not_at_all() {
    let old = |event: &Event| as_received(event, Minor::FIRST);
    let mut seen = Vec::new();
    for (label, event) in events_of(1) {
        let received = match (label.as_str(), old(&event)) {
            (
                "maintenance-reply"
                | "maintenance-reply-largest"
                | "trigger-reply"
                | "trigger-reply-began"
                | "travel-limit-reply"
                | "travel-limit-reply-none",
                None,
            ) => "nothing".to_owned(),
            (_, Some(Event::Hello(identity))) => format!("{:?}", identity.stored),
            (_, Some(Event::Status(status))) => {
                format!("{:?} {} {:?}", status.state, status.faults, status.first_fault)
            }
            (_, Some(other)) => format!("{other:?}"),
            (label, None) => panic!("{label} does not reach a host of 1.0"),
        };
        seen.push((label, received));
    }
    let damaged = format!("Fault {} {:?}", Fault::StoreDamaged.text(), Some(Fault::StoreDamaged));
    let range = "Refused(OutOfRange { field: SampleRate, min: 1, max: 1000000000, got: 0 })";
    let expected = [
        ("maintenance-reply", "nothing"),
        ("maintenance-reply-largest", "nothing"),
        ("unchanged", "Accepted(Accepted { at: 128000 })"),
        ("refused-disarm-first", "Refused(Armed)"),
        ("hello-reply-stored-4", "Loaded"),
        ("status-reply-fault-9", damaged.as_str()),
        ("status-reply-state-6", "Driving none None"),
        ("trigger-reply", "nothing"),
        ("trigger-reply-began", "nothing"),
        ("travel-limit-reply", "nothing"),
        ("travel-limit-reply-none", "nothing"),
        ("refused-travel", "Refused(Headroom { sum_per_mille: 1340 })"),
        // No host of 1.0 sends a limit; so none ever gets these.
        ("refused-out-of-range-resonance", range),
        ("refused-out-of-range-quality", range),
        ("refused-out-of-range-static-travel", range),
    ];
    assert_eq!(seen, expected.map(|(label, text)| (label.to_owned(), text.to_owned())));
    for (label, command) in commands_of(1) {
        assert!(
            command.frame_for(Minor::FIRST, SESSION, SEQUENCE).is_err(),
            "{label} goes to no device of 1.0"
        );
    }
}

#[test]
fn the_frozen_part_of_the_hello_stands_where_it_always_stood() {
    let hello = Command::Hello(Hello { version: VERSION, nonce: [9, 8, 7, 6] });
    assert_eq!(body_of(&hello.frame_for(Minor::OURS, 0, 1).unwrap()), [1, 0, 1, 2, 3, 4, 9, 8, 7, 6]);
    let (_, identity) = &events_of(0)[0];
    assert_eq!(body_of(&identity.frame_for(Minor::FIRST, 1, 1).unwrap())[..6], [1, 0, 1, 2, 3, 4]);
}

#[test]
fn every_fault_has_its_own_text_and_bit() {
    for (bit, fault) in Fault::ALL.iter().copied().enumerate() {
        assert_eq!(fault as usize, bit);
        assert!(!fault.text().is_empty());
        assert_eq!(Faults::NONE.with(fault).iter().collect::<Vec<_>>(), [fault]);
        assert!(Faults::NONE.with(fault).without(fault).is_empty());
    }
}
