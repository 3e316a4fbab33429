//! Recorded sessions of released versions against this build, R-23.

use std::sync::{Arc, Mutex};

use slipline_link::Outcome;
use slipline_protocol::command::{Apply, Drive, Hello, KeepAlive, TableChunk, TableHeader, Tone};
use slipline_protocol::event::{Event, Identity};
use slipline_protocol::frame::encode;
use slipline_protocol::table::{Knot, digest};
use slipline_protocol::units::{CentiDecibel, Gain, Level, Phase, Position};
use slipline_protocol::version::{Minor, Version};
use slipline_protocol::{Command, Header, Refusal};
use slipline_tests::source_tree::root;
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

/// The session in bytes on the protocol's page: what passes before each command, and the command.
fn session_in_bytes() -> Vec<(u64, Command)> {
    let gain = Gain(1 << 30);
    let knots =
        [2000.0, 500.0].map(|hz: f64| Knot { step: (hz / 4e5 * 4_294_967_296.0).round() as u32, gain });
    let header = TableHeader {
        knots: 2,
        span_start_um: 50_000,
        span_end_um: 250_000,
        sample_rate_hz: 400_000,
        crc: digest(50_000, 250_000, 400_000, 2, |index| knots[usize::from(index)]),
    };
    let chunk = TableChunk { first: 0, knots: heapless::Vec::from_slice(&knots).expect("two") };
    let tone = Tone { slot: 0, position: Position(32_768), level: Level(30_000), phase: Phase(0) };
    let drive = |tones: &[Tone]| {
        let tones = heapless::Vec::from_slice(tones).expect("one");
        Command::Drive(Drive { tones, master: CentiDecibel(-600), glide: 4000, apply: Apply::Next })
    };
    vec![
        (0, Command::Hello(Hello { version: Version::OURS, nonce: *b"page" })),
        (1, Command::TableBegin(header)),
        (1, Command::TableChunk(chunk)),
        (1, Command::TableCommit),
        (4, Command::Arm),
        (100, Command::KeepAlive(KeepAlive { beat: 0 })),
        (1, drive(&[tone])),
        (100, Command::Status),
        (1, Command::Stop),
        (100, Command::Disarm),
    ]
}

#[test]
fn the_session_on_the_protocols_page_matches_a_devices_answers() {
    let path = root().join("shared/tests/protocol_page/session.txt");
    let stands = std::fs::read_to_string(&path).expect("the page's session");
    let mut device = device();
    let (mut session, mut sequence) = (0, 1);
    let mut lines: Vec<Line> = Vec::new();
    for (blocks, command) in session_in_bytes() {
        device.advance(blocks, |_| {});
        if blocks > 0 {
            lines.push(Line::Blocks(blocks));
        }
        // Unnumbered frames get numbers far from the others.
        let number = if command.is_sequenced() { sequence } else { 0x8000 };
        sequence += u16::from(command.is_sequenced());
        let is_first = lines.is_empty();
        let frame = command.frame_for(Minor::OURS, session, number).expect("known");
        let bytes = if is_first { [&[0], &frame[..]].concat() } else { frame.to_vec() };
        device.feed(&bytes);
        lines.push(Line::Host(bytes));
        let mut answer = Vec::new();
        device.take(&mut answer);
        session = parts(&answer).header.session;
        lines.push(Line::Device(answer));
    }
    let hex = |bytes: &[u8]| bytes.iter().map(|byte| format!("{byte:02x}")).collect::<String>();
    if std::env::var_os("SLIPLINE_BLESS").is_some() {
        let remark = stands.lines().next().unwrap_or_default();
        let text = lines.iter().map(|line| match line {
            Line::Blocks(blocks) => format!("+ {blocks}\n"),
            Line::Host(bytes) => format!("> {}\n", hex(bytes)),
            Line::Device(bytes) => format!("< {}\n", hex(bytes)),
        });
        std::fs::write(&path, format!("{remark}\n{}", text.collect::<String>())).expect("written");
        return;
    }
    let recorded = parse(&stands);
    assert_eq!(recorded.len(), lines.len());
    for (recorded, line) in recorded.iter().zip(&lines) {
        match (recorded, line) {
            (Line::Device(recorded), Line::Device(answer)) if parts(answer).header.id == 0x81 => {
                // In the hello's answer, the firmware's version and build are those of the day.
                let identity = |bytes: &[u8]| match Event::decode(0x81, &parts(bytes).body) {
                    Ok(Event::Hello(identity)) => {
                        Identity { firmware: (0, 0, 0), build: heapless::String::new(), ..identity }
                    }
                    other => panic!("{other:?}"),
                };
                assert_eq!(identity(recorded), identity(answer));
            }
            _ => assert_eq!(recorded, line),
        }
    }
}
