//! A stop that begins in a block that has been rendered and waits while the one before it plays, as in a board's ring.

use slipline_app::Stop;
use slipline_app::safety::fade::fade;
use slipline_link::mirror::Mirror;
use slipline_link::simulator::Options;
use slipline_protocol::Command;
use slipline_protocol::command::{DigestWindow, Drive};
use slipline_protocol::event::{Event, Fault, State};
use slipline_protocol::frame::CRC;
use slipline_protocol::limits::{EMERGENCY_RAMP_MS, STOP_RAMP_MS};
use slipline_protocol::units::SampleIndex;
use slipline_tests::client::Client;
use slipline_tests::rig::{BLOCK, RATE_HZ, Rig, Table, drive};

const STOPS: [(Command, Stop, u32); 2] = [
    (Command::Stop, Stop::Normal, STOP_RAMP_MS),
    (Command::EmergencyStop, Stop::Emergency, EMERGENCY_RAMP_MS),
];

/// Armed, with the mirror from the table on.
fn armed() -> (Rig, Mirror) {
    armed_with(true)
}

fn armed_with(block_waits: bool) -> (Rig, Mirror) {
    let mut rig = Rig::greeted_with(Options { block_waits, ..Options::default() });
    let table = Table::usual();
    let at = rig.upload(&table);
    let mut mirror = Mirror::new(RATE_HZ, 0);
    mirror.acknowledge_table(table.knots.as_slice().into(), at).unwrap();
    rig.arm();
    (rig, mirror)
}

/// Drives; returns the index of the begin.
fn begin(rig: &mut Rig, mirror: &mut Mirror, drive: &Drive) -> SampleIndex {
    let at = rig.accepted(&Command::Drive(drive.clone()));
    mirror.acknowledge_play(drive.clone(), at).unwrap();
    at
}

fn two_tones() -> Drive {
    drive(&[(0, 1.0, 0.6), (3, 0.2, 0.3)], 2000)
}

/// The mirror's codes of the whole time.
fn replayed(mirror: &mut Mirror, rig: &Rig) -> Vec<u16> {
    let mut codes = Vec::new();
    mirror.render(rig.device.now(), |_, block| codes.extend_from_slice(block));
    assert!(mirror.is_true());
    codes
}

#[test]
fn a_stop_begins_in_the_block_that_waits() {
    // the block that leaves next. The twin is not stopped.
    for (command, stop, ramp_ms) in STOPS {
        let [(mut rig, mut mirror), (mut twin, mut twins_mirror)] = [armed(), armed()];
        for (rig, mirror) in [(&mut rig, &mut mirror), (&mut twin, &mut twins_mirror)] {
            begin(rig, mirror, &two_tones());
            rig.live_ms(20);
        }
        let waiting = rig.device.now();
        let at = rig.accepted(&command);
        mirror.acknowledge_stop(stop, at).unwrap();
        assert_eq!(at, waiting + 1);
        rig.live_ms(60);
        twin.live_ms(60);
        let ramp = rig.samples(ramp_ms);
        assert_eq!(rig.recording.codes[..at as usize], twin.recording.codes[..at as usize]);
        let changed = (at..).find(|&n| rig.recording.from(n)[0] != twin.recording.from(n)[0]).unwrap();
        assert!(changed < waiting + BLOCK, "{changed}: in that block");
        let end = rig.recording.end_of_sound().unwrap();
        assert!(end <= waiting + ramp + BLOCK && end > waiting + ramp * 8 / 10, "{}", end - waiting);
        assert_eq!(replayed(&mut mirror, &rig), rig.recording.codes);
    }
}

#[test]
fn a_drive_that_begins_in_the_stopped_block_is_stopped_and_a_later_one_is_dropped() {
    for (command, stop, _) in STOPS {
        for blocks in [0, 1, 2] {
            let (mut rig, mut mirror) = armed();
            begin(&mut rig, &mut mirror, &drive(&[(0, 1.0, 0.5)], 2000));
            rig.live_ms(20);
            let at = begin(&mut rig, &mut mirror, &two_tones());
            rig.live_blocks(blocks);
            let stopped = rig.accepted(&command);
            assert_eq!(stopped, at - BLOCK + blocks * BLOCK + 1);
            mirror.acknowledge_stop(stop, stopped).unwrap();
            rig.live_ms(60);
            assert_eq!(
                replayed(&mut mirror, &rig),
                rig.recording.codes,
                "{blocks} blocks after it was accepted"
            );
        }
    }
}

#[test]
fn of_two_stops_in_a_block_the_quicker_one_holds_in_the_mirror_too() {
    for block_waits in [false, true] {
        for order in [[0, 1], [1, 0]] {
            let (mut rig, mut mirror) = armed_with(block_waits);
            begin(&mut rig, &mut mirror, &two_tones());
            rig.live_ms(20);
            let now = rig.device.now();
            for (command, stop, _) in order.map(|n| &STOPS[n]) {
                let at = rig.accepted(command);
                mirror.acknowledge_stop(*stop, at).unwrap();
            }
            rig.live_ms(60);
            let ramp = rig.samples(EMERGENCY_RAMP_MS);
            assert!(rig.recording.end_of_sound().unwrap() <= now + BLOCK + ramp);
            assert_eq!(replayed(&mut mirror, &rig), rig.recording.codes, "{block_waits} {order:?}");
        }
    }
}

#[test]
fn a_digest_matches_the_codes_that_are_played() {
    // the window ends in the block that waits, in the one before it, after it; or begins in it.
    for (first, count) in [(-300, 428), (-300, 400), (-300, 300), (-300, 2000), (0, 5), (100, 600)] {
        let (mut rig, mut mirror) = armed();
        begin(&mut rig, &mut mirror, &two_tones());
        rig.live_ms(20);
        let waiting = rig.device.now() + 10 * BLOCK;
        let window = DigestWindow { from: waiting.strict_add_signed(first), count };
        rig.accepted(&Command::DigestStart(window));
        rig.live_blocks(10);
        let early = rig.send(&Command::DigestRead);
        let may_be_told = window.from + u64::from(count) <= waiting;
        assert!(matches!(early, Event::Digest(digest) if digest.crc.is_some() == may_be_told), "{early:?}");
        assert_eq!(rig.accepted(&Command::EmergencyStop), waiting + 1);
        rig.live_ms(20);
        let codes = &rig.recording.from(window.from)[..count as usize];
        let bytes: Vec<u8> = codes.iter().flat_map(|code| code.to_le_bytes()).collect();
        let answer = rig.send(&Command::DigestRead);
        assert!(
            matches!(answer, Event::Digest(digest) if digest.crc == Some(CRC.checksum(&bytes))),
            "{first} {count}: {answer:?}"
        );
    }
}

#[test]
fn codes_that_come_too_late_for_the_block_that_waits_are_an_underrun() {
    // the block is played as it was, and one line follows it.
    let (mut rig, mut mirror) = armed();
    begin(&mut rig, &mut mirror, &two_tones());
    rig.live_ms(20);
    let waiting = rig.device.now();
    rig.device.inject_underrun();
    rig.accepted(&Command::EmergencyStop);
    rig.live_ms(20);
    let mut unstopped = Vec::new();
    mirror.render(waiting + BLOCK, |_, block| unstopped.extend_from_slice(block));
    let line = fade(*unstopped.last().unwrap());
    let expected: Vec<u16> = unstopped.into_iter().chain(line).take(rig.recording.codes.len()).collect();
    assert_eq!(rig.recording.codes, expected);
    let status = rig.status();
    assert_eq!((status.state, status.first_fault), (State::Fault, Some(Fault::EmergencyStop)));
    assert!(status.faults.contains(Fault::Underrun));
}

#[test]
fn in_silence_a_stop_changes_nothing_and_is_reported_with_the_next_block() {
    let (mut rig, _) = armed();
    let at = rig.accepted(&Command::Stop);
    assert_eq!(at, rig.device.now() + BLOCK);
    rig.live_ms(5);
    assert_eq!(rig.status().state, State::Armed);
}
