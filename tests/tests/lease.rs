//! Arming is a lease: a device whose host only keeps alive disarms by itself, without a fault.

use slipline_link::simulator::Options;
use slipline_link::{Change, Request};
use slipline_protocol::command::{Apply, ArmLease, Drive};
use slipline_protocol::event::{Event, Fault, State};
use slipline_protocol::limits::{LEASE_MS, MAX_DRIVE_MS, STOP_RAMP_MS};
use slipline_protocol::refusal::Field;
use slipline_protocol::{Command, Refusal};
use slipline_tests::client::Client;
use slipline_tests::link_rig::{self, LinkRig};
use slipline_tests::rig::{BLOCK, MID, Rig, Table, drive};
use std::time::Duration;

/// So that ten minutes are few blocks.
const RATE_HZ: u32 = 8000;

fn arm_for(lease_ms: u32) -> Command {
    Command::ArmFor(ArmLease { lease_ms })
}

fn one_tone(position: f64) -> Command {
    Command::Drive(drive(&[(0, position, 0.5)], 100))
}

/// A device with a table, said hello to by a host of this minor.
fn ready(minor: u8) -> Rig {
    let mut rig = Rig::new(Options { sample_rate_hz: RATE_HZ, ..Options::default() });
    rig.hello_of_minor(minor);
    rig.upload(&Table::usual().at_rate(RATE_HZ));
    rig
}

/// Armed for this time.
fn leased(lease_ms: u32) -> Rig {
    let mut rig = ready(3);
    rig.accepted(&arm_for(lease_ms));
    rig.live_ms(100);
    rig
}

/// Keeps alive until the device is disarmed, and returns the index at which it was found so.
fn disarmed(rig: &mut Rig, within_ms: u32) -> u64 {
    let end = rig.device.now() + rig.samples(within_ms);
    while rig.status().state != State::Idle {
        assert!(rig.device.now() < end, "still {:?}", rig.status().state);
        rig.live_blocks(1);
    }
    let found = rig.device.now();
    // The blocks of mid-scale before the mute.
    rig.live_blocks(8);
    assert_eq!((rig.status().first_fault, rig.device.is_muted()), (None, true));
    found
}

#[test]
fn a_client_that_only_keeps_alive_ends_with_its_lease() {
    // the ramp begins at the end of the lease, within two blocks.
    for lease_ms in [LEASE_MS.0, 3456, 60_000, LEASE_MS.1] {
        let mut rig = leased(lease_ms);
        let at = rig.accepted(&one_tone(0.5));
        rig.live_ms(lease_ms - 500);
        assert_eq!(rig.status().state, State::Driving);
        rig.record();
        rig.live_ms(800);
        let ends = at + rig.samples(lease_ms);
        let end_of_sound = rig.recording.end_of_sound().unwrap();
        let ramp = rig.samples(STOP_RAMP_MS);
        assert!((ends + ramp / 2..=ends + ramp + 2 * BLOCK).contains(&end_of_sound), "{lease_ms} ms");
        let before = &rig.recording.from(ends - 2 * BLOCK)[..BLOCK as usize];
        assert!(before.iter().any(|code| code.abs_diff(MID) > 500), "{lease_ms} ms: it sounds until then");
        let status = rig.status();
        assert_eq!((status.state, status.first_fault), (State::Idle, None));
        assert!(rig.device.is_muted());
        assert_eq!(rig.refused(&one_tone(0.5)), Refusal::NotArmed);
    }
}

#[test]
fn an_armed_device_that_is_never_driven_ends_with_its_lease_too() {
    //
    let mut rig = ready(3);
    let armed = rig.device.now();
    rig.accepted(&arm_for(1000));
    let until = disarmed(&mut rig, 3000);
    assert!(until.abs_diff(armed + rig.samples(1000)) <= 8 * BLOCK, "{}", until - armed);
}

#[test]
fn one_drag_a_second_keeps_the_shortest_lease_but_one() {
    //
    let mut rig = leased(1100);
    for drag in 0..200 {
        rig.accepted(&one_tone(0.3 + 0.4 * f64::from(drag % 10) / 10.0));
        rig.live_ms(1000);
        assert_eq!(rig.status().state, State::Driving, "drag {drag}");
    }
    disarmed(&mut rig, 400);
}

#[test]
fn chords_combs_and_rises_of_the_trigger_input_restart_the_lease() {
    //
    let tone = [(300, 0.3, 0.0)];
    for command in [
        Command::Chord(slipline_tests::rig::chord(12, &[(300, 0.5, 0.0)])),
        Command::Comb(slipline_tests::rig::comb(32, &tone)),
    ] {
        let mut rig = Rig::greeted();
        rig.upload(&Table::usual());
        rig.accepted(&arm_for(1000));
        rig.live_ms(800);
        rig.accepted(&command);
        rig.live_ms(900);
        assert_eq!(rig.status().state, State::Driving, "{command:?}");
        disarmed(&mut rig, 400);
    }
    let waiting = Command::Drive(Drive { apply: Apply::AtTrigger, ..drive(&[(0, 0.5, 0.5)], 100) });
    let mut rig = leased(1000);
    rig.accepted(&waiting);
    rig.live_ms(800);
    rig.device.raise_trigger();
    rig.live_ms(800);
    assert_eq!(rig.status().state, State::Driving);
    // A drive that waits for ever is dropped.
    rig.accepted(&waiting);
    disarmed(&mut rig, 1400);
    rig.device.raise_trigger();
    rig.record();
    rig.live_ms(500);
    assert_eq!(rig.recording.end_of_sound(), None);
}

/// A tone that begins this long from now, and the index.
fn later(rig: &Rig, ms: u32) -> (Command, u64) {
    let at = rig.device.now() + rig.samples(ms);
    (Command::Drive(Drive { apply: Apply::At(at), ..drive(&[(0, 0.5, 0.5)], 100) }), at)
}

#[test]
fn a_drive_begins_the_lease_where_it_begins_and_not_where_it_is_sent() {
    //
    let mut rig = leased(1000);
    let (command, at) = later(&rig, 700);
    rig.accepted(&command);
    rig.live_ms(1500);
    assert_eq!(rig.status().state, State::Driving);
    let until = disarmed(&mut rig, 1000);
    assert!(until.abs_diff(at + rig.samples(1000)) <= 8 * BLOCK);
}

#[test]
fn a_drive_at_a_later_index_does_not_extend_the_lease() {
    // the sounding drive ends with its own lease, and the one that waits is dropped, whether anything sounds or not.
    for sounds in [false, true] {
        let mut rig = leased(1000);
        let mut from = rig.device.now() - rig.samples(100);
        if sounds {
            from = rig.accepted(&one_tone(0.3));
            rig.live_ms(50);
        }
        let (command, at) = later(&rig, 3000);
        rig.accepted(&command);
        rig.live_ms(500);
        // Neither does a command that is refused, nor the lease of an armed device that is asked for again later than it ends.
        rig.refused(&one_tone(0.7));
        let until = disarmed(&mut rig, 1000);
        assert!(until.abs_diff(from + rig.samples(1000)) <= 8 * BLOCK, "sounds: {sounds}");
        rig.record();
        rig.live_ms(3000);
        assert!(rig.device.now() > at);
        assert_eq!(rig.recording.end_of_sound(), None, "sounds: {sounds}");
    }
}

#[test]
fn hosts_that_know_no_lease_drive_ten_minutes_as_before() {
    //
    for minor in 0..=2 {
        let mut rig = ready(minor);
        assert_eq!(rig.refused(&arm_for(1000)), Refusal::UnknownMessage { id: 0x1b });
        rig.arm();
        rig.accepted(&one_tone(0.5));
        rig.live_ms(MAX_DRIVE_MS - 1000);
        assert_eq!(rig.status().state, State::Driving);
        rig.live_ms(2000);
        assert_eq!(rig.status().first_fault, Some(Fault::DriveTime));
    }
}

#[test]
fn an_armed_device_takes_a_new_lease_and_arming_without_one_changes_nothing() {
    //
    let mut rig = leased(60_000);
    rig.accepted(&arm_for(1000));
    rig.accepted(&Command::Arm);
    disarmed(&mut rig, 1400);
    // The lease ends with it: armed again without one the device stays armed.
    rig.accepted(&Command::Arm);
    rig.live_ms(5000);
    assert_eq!(rig.status().state, State::Armed);
    rig.accepted(&arm_for(1000));
    disarmed(&mut rig, 1400);
    rig.accepted(&arm_for(1000));
    rig.hello();
    rig.arm();
    rig.live_ms(5000);
    assert_eq!(rig.status().state, State::Armed, "a new session has no lease");
}

#[test]
fn a_lease_out_of_range_is_refused_and_arms_nothing() {
    let mut rig = ready(3);
    let (least, most) = LEASE_MS;
    for lease_ms in [0, least - 1, most + 1, u32::MAX] {
        let refusal = Refusal::OutOfRange {
            field: Field::Lease,
            min: least.into(),
            max: most.into(),
            got: lease_ms.into(),
        };
        assert_eq!(rig.send(&arm_for(lease_ms)), Event::Refused(refusal));
        assert_eq!(rig.status().state, State::Idle);
    }
}

#[test]
fn the_link_reports_that_a_lease_is_over_once() {
    //
    let mut rig = LinkRig::armed_at(RATE_HZ);
    rig.ask_and_pass(Request::Disarm, 500);
    let lease = Duration::from_secs(2);
    rig.done(Request::ArmFor(lease), 300);
    rig.ask_and_pass(link_rig::drive(0.05), 1800);
    assert_eq!((rig.state(), rig.view().drive.leases_over), (State::Driving, 0));
    rig.pass_ms(800);
    assert_eq!((rig.state(), rig.view().drive.leases_over), (State::Idle, 1));
    assert_eq!(rig.view().drive.lease_over, Some(lease));
    let last = rig.view().record.journal.back().unwrap();
    assert_eq!((&last.change, last.is_exact), (&Change::Disarmed, false));
    let ended = "The device disarmed itself: no drive for 2 s.";
    assert_eq!(rig.view().record.log.iter().filter(|line| line.text == ended).count(), 1);
    rig.pass_ms(5000);
    assert_eq!(rig.view().drive.leases_over, 1);
    // A stop leaves it armed, and a disarm by the user is no end of a lease.
    rig.ask_and_pass(Request::ArmFor(lease), 100);
    rig.ask_and_pass(Request::Stop, 500);
    assert_eq!((rig.state(), rig.view().drive.leases_over), (State::Armed, 1));
    rig.ask_and_pass(Request::Disarm, 5000);
    assert_eq!((rig.state(), rig.view().drive.leases_over), (State::Idle, 1));
}
