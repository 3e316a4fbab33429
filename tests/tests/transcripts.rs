//! Recorded sessions of released versions against this build, R-23.

use std::sync::{Arc, Mutex};

use slipline_link::Outcome;
use slipline_protocol::event::{Event, Identity};
use slipline_protocol::frame::encode;
use slipline_protocol::version::Version;
use slipline_protocol::{Command, Header, Refusal};
use slipline_tests::transcript::{Line, Parts, Scripted, device, parse, parts, play, requests, split};

/// A host of 1.0 with a device of 1.0.
const MINOR_0: &str = include_str!("../transcripts/v1_0.txt");

/// The ids of the commands of minor 0.
fn ids_of_minor_0() -> Vec<u8> {
    Command::TABLE.iter().filter(|row| row.since == 0).map(|row| row.id).collect()
}

#[test]
fn the_transcript_holds_every_kind_of_exchange() {
    let lines = parse(MINOR_0);
    let ids: Vec<u8> = lines
        .iter()
        .flat_map(|line| match line {
            Line::Host(bytes) | Line::Device(bytes) => split(bytes),
            Line::Blocks(_) => Vec::new(),
        })
        .map(|frame| parts(&frame).header.id)
        .collect();
    // Hello, keep-alive, status, arm, disarm, drive, stops, faults, upload, digests, flash; and all their answers.
    for id in [1, 2, 3, 0x10, 0x11, 0x12, 0x13, 0x14, 0x15, 0x20, 0x21, 0x22, 0x24, 0x30, 0x31, 0x40, 0x41] {
        assert!(ids.contains(&id), "{id:#04x}");
    }
    for id in [0x81, 0x83, 0x90, 0x91, 0xa4, 0xb1] {
        assert!(ids.contains(&id), "{id:#04x}");
    }
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
fn this_builds_device_answers_a_host_of_1_0_as_the_device_of_1_0_did() {
    let mut device = device();
    // The device of the recording rendered a block ahead, so its indices are a block later.
    device.advance(1, |_| ());
    let (mut asked, mut refused) = (0, 0);
    let mut sessions: Option<(u32, u32)> = None;
    let mut said = std::collections::VecDeque::new();
    for (number, line) in parse(MINOR_0).into_iter().enumerate() {
        match line {
            Line::Blocks(blocks) => device.advance(blocks, |_| ()),
            Line::Host(bytes) => {
                asked = split(&bytes).last().map_or(0, |frame| parts(frame).header.id);
                match sessions {
                    Some((then, now)) if then != now => {
                        // The device draws other numbers for its sessions than it did then.
                        for frame in split(&bytes) {
                            let told = parts(&frame);
                            let session = if told.header.session == then { now } else { told.header.session };
                            device.feed(&reframed(Header { session, ..told.header }, &told.body));
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
    assert_eq!(refused, 1, "one Store of the transcript came while the device was armed");
    let mut bytes = Vec::new();
    device.take(&mut bytes);
    assert!(said.is_empty() && bytes.is_empty(), "it says no more than it did");
}

fn reframed(header: Header, body: &[u8]) -> Vec<u8> {
    let frame = encode(header, |buffer| {
        buffer[..body.len()].copy_from_slice(body);
        Ok(body.len())
    });
    frame.expect("it fitted once").to_vec()
}

#[test]
fn this_builds_host_gets_along_with_the_device_of_1_0() {
    let device = Arc::new(Mutex::new(Scripted::of(&parse(MINOR_0))));
    let outcomes = play(&device, |_| ());
    let device = device.lock().unwrap();
    for asked in &device.unknown {
        assert!(ids_of_minor_0().contains(&asked.header.id), "newer than the device: {asked:?}");
    }
    assert_eq!(device.unknown, [], "the host asks what it asked then");
    for ((request, _), outcome) in requests().into_iter().zip(outcomes) {
        let outcome = outcome.unwrap_or_else(|| panic!("{request:?} has not ended"));
        assert!(
            !matches!(outcome, Outcome::NotConnected | Outcome::DeviceTooOld),
            "{request:?}: {outcome:?}"
        );
    }
}
