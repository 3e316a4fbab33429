//! Recorded sessions of released versions against this build, R-23.

use std::sync::{Arc, Mutex};

use slipline_link::Outcome;
use slipline_protocol::event::{Event, Identity};
use slipline_protocol::frame::encode;
use slipline_protocol::version::Version;
use slipline_protocol::{Command, Header, Refusal};
use slipline_tests::transcript::{Line, Parts, Scripted, device, parse, parts, play, requests, split};

/// A host of each released minor with a device of the same.
const MINORS: [&str; 3] = [
    include_str!("../transcripts/v1_0.txt"),
    include_str!("../transcripts/v1_1.txt"),
    include_str!("../transcripts/v1_2.txt"),
];

/// The ids of the commands that a minor knows.
fn ids_of(minor: u8) -> Vec<u8> {
    Command::TABLE.iter().filter(|row| row.since <= minor).map(|row| row.id).collect()
}

#[test]
fn the_transcripts_hold_every_kind_of_exchange() {
    // Hello, keep-alive, status, arm, disarm, drive, stops, faults, upload, digests, flash; and all their answers.
    let commands =
        [1, 2, 3, 0x10, 0x11, 0x12, 0x13, 0x14, 0x15, 0x20, 0x21, 0x22, 0x24, 0x30, 0x31, 0x40, 0x41];
    let events = [0x81, 0x83, 0x90, 0x91, 0xa4, 0xb1];
    // The upkeep, the limit of the travel, the trigger.
    let since_1 = [4, 0x16, 0x18, 0x84, 0x92, 0x97, 0x98];
    let first: Vec<u8> = commands.into_iter().chain(events).collect();
    let second: Vec<u8> = first.iter().copied().chain(since_1).collect();
    // The chord.
    let third: Vec<u8> = second.iter().copied().chain([0x19]).collect();
    for (transcript, wanted) in MINORS.iter().zip([first, second, third]) {
        let ids = ids_in(transcript);
        for id in wanted {
            assert!(ids.contains(&id), "{id:#04x}");
        }
    }
}

fn ids_in(transcript: &str) -> Vec<u8> {
    parse(transcript)
        .iter()
        .flat_map(|line| match line {
            Line::Host(bytes) | Line::Device(bytes) => split(bytes),
            Line::Blocks(_) => Vec::new(),
        })
        .map(|frame| parts(&frame).header.id)
        .collect()
}

/// What of a hello's answer may differ between versions of the firmware.
fn without_version(identity: Identity) -> Identity {
    let version = Version { minor: 0, ..identity.version };
    Identity { version, firmware: (0, 0, 0), build: heapless::String::new(), ..identity }
}

/// Where a device of today refuses what the device of 1.0 did: an armed one does not write its flash, since it takes no
/// stop meanwhile. To a host of 1.0 it says so by a refusal of 1.0.
fn is_refused_since_1_1(asked: u8, then: &Parts, now: &Parts) -> bool {
    let answers = [then, now].map(|it| Event::decode(it.header.id, &it.body));
    asked == Command::Store.id()
        && matches!(answers, [Ok(Event::Accepted(_)), Ok(Event::Refused(Refusal::Armed))])
        && Header { id: then.header.id, ..now.header } == then.header
}

#[test]
fn this_builds_device_answers_hosts_of_older_minors_as_their_devices_did() {
    // The device of 1.0's recording rendered a block ahead, so its indices are a block later; and one Store of that
    // transcript came while the device was armed.
    for (transcript, blocks_ahead, refusals) in [(MINORS[0], 1, 1), (MINORS[1], 0, 0), (MINORS[2], 0, 0)] {
        let refused = answers_as_recorded(transcript, blocks_ahead);
        assert_eq!(refused, refusals);
    }
}

/// Compares the answers with those of a transcript; returns how many of them refuse what was done then.
fn answers_as_recorded(transcript: &str, blocks_ahead: u64) -> u32 {
    let mut device = device();
    device.advance(blocks_ahead, |_| ());
    let (mut asked, mut refused) = (0, 0);
    let mut sessions: Option<(u32, u32)> = None;
    let mut said = std::collections::VecDeque::new();
    for (number, line) in parse(transcript).into_iter().enumerate() {
        match line {
            Line::Blocks(blocks) => device.advance(blocks, |_| ()),
            Line::Host(bytes) => {
                asked = split(&bytes).last().map_or(0, |frame| parts(frame).header.id);
                match sessions {
                    Some((then, now)) if then != now => {
                        // The device draws other numbers for its sessions than it did then.
                        for frame in split(&bytes) {
                            let recorded = parts(&frame);
                            let session =
                                if recorded.header.session == then { now } else { recorded.header.session };
                            device.feed(&reframed(Header { session, ..recorded.header }, &recorded.body));
                        }
                    }
                    _ => device.feed(&bytes),
                }
            }
            Line::Device(frame) => {
                let want = parts(&frame);
                let mut bytes = Vec::new();
                device.take(&mut bytes);
                said.extend(split(&bytes));
                let frame = said.pop_front().unwrap_or_else(|| panic!("line {number}: no answer"));
                let got = parts(&frame);
                if want.header.id == 0x81 {
                    sessions = Some((want.header.session, got.header.session));
                }
                let session = sessions.map_or(0, |(_, now)| now);
                let then = Parts { header: Header { session, ..want.header }, body: want.body.clone() };
                if is_refused_since_1_1(asked, &then, &got) {
                    refused += 1;
                    continue;
                }
                assert_eq!(got.header, Header { session, ..want.header }, "line {number}");
                if got.body != want.body {
                    let identity = |body: &[u8]| match Event::decode(want.header.id, body) {
                        Ok(Event::Hello(identity)) => without_version(identity),
                        other => panic!(
                            "line {number}: {other:?}, not {:?}",
                            Event::decode(want.header.id, &want.body)
                        ),
                    };
                    assert_eq!(identity(&got.body), identity(&want.body), "line {number}");
                }
            }
        }
    }
    let mut bytes = Vec::new();
    device.take(&mut bytes);
    assert!(said.is_empty() && bytes.is_empty(), "it says no more than it did");
    refused
}

fn reframed(header: Header, body: &[u8]) -> Vec<u8> {
    let frame = encode(header, |buffer| {
        buffer[..body.len()].copy_from_slice(body);
        Ok(body.len())
    });
    frame.expect("it fitted once").to_vec()
}

#[test]
fn this_builds_host_gets_along_with_the_devices_of_older_minors() {
    for (minor, transcript) in (0..).zip(MINORS) {
        let device = Arc::new(Mutex::new(Scripted::of(&parse(transcript))));
        let outcomes = play(&device, minor, |_| ());
        let device = device.lock().unwrap();
        for asked in &device.unknown {
            assert!(ids_of(minor).contains(&asked.header.id), "newer than the device: {asked:?}");
        }
        assert_eq!(device.unknown, [], "the host asks what it asked then");
        for ((request, _), outcome) in requests(minor).into_iter().zip(outcomes) {
            let outcome = outcome.unwrap_or_else(|| panic!("{request:?} has not ended"));
            assert!(
                !matches!(outcome, Outcome::NotConnected | Outcome::DeviceTooOld),
                "{request:?}: {outcome:?}"
            );
        }
    }
}
