//! Stops on a bad line: what they overtake does not come back, and what is asked for after them is not undone.

use slipline_link::DeviceTable;
use slipline_link::{Change, DriveRequest, LinkState, Outcome, Played, Port, Request, Sounding, ToneRequest};
use slipline_protocol::command::Apply;
use slipline_protocol::event::{Fault, State};
use slipline_protocol::limits::REPLY_TIMEOUT_MS;
use slipline_protocol::{Command, Event, Refusal};
use slipline_tests::faulty_ports::{as_real, lock};
use slipline_tests::link_rig::{LinkRig, drive};
use std::sync::Arc;

/// Longer than the time after which a lost command is sent again.
const AGAIN_MS: u64 = 2 * REPLY_TIMEOUT_MS as u64;

/// Armed, with one tone that sounds.
fn driving() -> LinkRig {
    let mut rig = LinkRig::armed();
    rig.ask_and_pass(drive(0.05), 300);
    assert_eq!(rig.state(), State::Driving);
    rig
}

/// Whether a drive has been sent after the first `words` commands.
fn has_driven_since(rig: &LinkRig, words: usize) -> bool {
    lock(&rig.ports).commands.iter().skip(words).any(|(_, command)| matches!(command, Command::Drive(_)))
}

#[test]
fn a_drive_that_was_lost_before_a_stop_does_not_come_back_after_it() {
    let mut rig = LinkRig::armed();
    rig.ports().drop_commands = 1;
    rig.ask(drive(0.05));
    rig.done(Request::Stop, 2000);
    assert_eq!(rig.state(), State::Armed, "silent, and in step with the device");
    rig.done(drive(0.06), 300);
    assert_eq!(rig.state(), State::Driving);
}

#[test]
fn a_drive_that_was_busy_when_the_stop_came_is_not_sent_again() {
    let mut rig = LinkRig::armed();
    rig.ask(drive(0.05));
    // Taken, but not taken up: the next one is refused as busy.
    rig.connection.step(rig.now);
    let busy = rig.ask(drive(0.06));
    rig.only_ask(Request::Stop);
    let words = rig.ports().commands.len();
    rig.pass_ms(500);
    assert!(!has_driven_since(&rig, words));
    assert_eq!(rig.outcome(busy), Some(Outcome::Superseded));
    assert_eq!(rig.state(), State::Armed, "silent");
}

#[test]
fn a_drive_with_a_wrong_number_is_not_sent_again_after_a_stop() {
    let mut rig = LinkRig::armed();
    rig.ports().drop_commands = 1;
    let lost = rig.ask(drive(0.05));
    rig.ask(Request::Stop);
    let words = rig.ports().commands.len();
    // The frame that takes the drive's place is refused for its number.
    rig.ports().rewrite = |event| match as_real(event) {
        Event::Table(_) => Event::Refused(Refusal::BadSequence { expected: 1 }),
        event => event,
    };
    rig.pass_ms(AGAIN_MS);
    assert!(!has_driven_since(&rig, words));
    assert_eq!(rig.outcome(lost), Some(Outcome::Superseded));
    let again = rig.ask(drive(0.06));
    rig.pass_ms(100);
    assert!(matches!(rig.outcome(again), Some(Outcome::Done { .. })), "in step with the device");
}

#[test]
fn a_drive_reported_after_the_stop_that_ended_it_does_not_count_as_sounding() {
    let mut rig = LinkRig::armed();
    rig.ports().drop_replies = 1;
    rig.ask_and_pass(drive(0.05), 20);
    rig.ask_and_pass(Request::Stop, AGAIN_MS);
    assert_eq!(rig.state(), State::Armed, "silent");
    let journal = &rig.view().record.journal;
    assert!(
        journal.iter().any(|entry| matches!(entry.change, Change::Play(Played::Drive(_)))),
        "it did sound"
    );
    assert_eq!(journal.back().map(|entry| &entry.change), Some(&Change::Stop));
}

#[test]
fn the_repeat_of_a_stop_does_not_end_a_drive_requested_after_it() {
    let mut rig = driving();
    rig.ports().drop_replies = 1;
    rig.ask_and_pass(Request::Stop, 50);
    rig.done(drive(0.06), 1000);
    assert_eq!(rig.state(), State::Driving);
}

#[test]
fn the_repeat_of_an_emergency_stop_does_not_undo_a_later_request() {
    //
    let mut rig = driving();
    rig.ports().drop_replies = 1;
    rig.ask_and_pass(Request::EmergencyStop, 50);
    let due = rig.connection.deadline(rig.now);
    let newer = [Request::ClearFaults, Request::Arm, drive(0.06)].map(|request| rig.ask(request));
    assert_eq!(rig.connection.deadline(rig.now), due, "what waits for the answer is no reason to spin");
    rig.pass_ms(1000);
    assert!(newer.iter().all(|ticket| matches!(rig.outcome(*ticket), Some(Outcome::Done { .. }))));
    assert_eq!(rig.state(), State::Driving);
}

#[test]
fn a_lost_emergency_stop_is_sent_again_though_a_stop_came_after_it() {
    //
    let mut rig = driving();
    rig.ports().drop_stops = 1;
    let emergency = rig.ask(Request::EmergencyStop);
    rig.pass_ms(20);
    rig.ask_and_pass(Request::Stop, AGAIN_MS);
    assert!(matches!(rig.outcome(emergency), Some(Outcome::Done { .. })));
    assert!(rig.view().drive.status.unwrap().faults.contains(Fault::EmergencyStop));
}

#[test]
fn a_lost_emergency_stop_is_sent_again_when_the_link_closes() {
    //
    let mut rig = driving();
    rig.ports().drop_stops = 1;
    rig.ask(Request::EmergencyStop);
    rig.ask_and_pass(Request::Disconnect, 1000);
    assert_eq!(rig.view().link.state, LinkState::Disconnected);
    rig.ask_and_pass(Request::Connect(Port::Serial("A".to_owned())), 100);
    assert!(rig.view().drive.status.unwrap().faults.contains(Fault::EmergencyStop));
}

#[test]
fn a_link_that_is_closed_twice_stops_and_disarms_once() {
    // A signal closes it, then the command that it ended does.
    let mut rig = driving();
    rig.ports().commands.clear();
    // The first has sent its stop and waits for the answer.
    rig.ports().stall(true);
    let first = rig.ask(Request::Disconnect);
    rig.pass_ms(1);
    let second = rig.ask(Request::Disconnect);
    rig.pass_ms(1);
    rig.ports().stall(false);
    rig.pass_ms(1000);
    assert_eq!(rig.view().link.state, LinkState::Disconnected);
    assert_eq!(rig.outcome(first), Some(Outcome::Superseded));
    assert!(matches!(rig.outcome(second), Some(Outcome::Done { .. })));
    let ports = rig.ports();
    let sent: Vec<&Command> = ports
        .commands
        .iter()
        .map(|(_, command)| command)
        .filter(|command| matches!(command, Command::Stop | Command::Disarm))
        .collect();
    assert_eq!(sent, [&Command::Stop, &Command::Disarm]);
}

#[test]
fn a_disarm_does_not_wait_for_a_drive_that_is_busy() {
    let mut rig = LinkRig::armed();
    let in_20_s = rig.ports().device.now() + 20 * 400_000;
    let tones = vec![ToneRequest { slot: 0, boundary_m: 0.05, level: 0.5, phase_turns: 0.0 }];
    rig.ask_and_pass(
        Request::Play(Sounding::Drive(DriveRequest { apply: Apply::At(in_20_s), ..DriveRequest::of(tones) })),
        5,
    );
    let busy = rig.ask(drive(0.06));
    let disarm = rig.ask(Request::Disarm);
    rig.pass_ms(5);
    assert_eq!(rig.outcome(busy), Some(Outcome::Superseded));
    assert!(matches!(rig.outcome(disarm), Some(Outcome::Done { .. })));
    assert!(rig.ports().device.is_muted());
}

#[test]
fn a_stop_and_a_disarm_take_effect_between_two_chunks_of_an_upload() {
    // What Esc, Space and STOP send to a real device, in the midst of an upload and with more work behind it.
    let mut rig = driving();
    let knots = (0..1000).map(|i| (100.0 + f64::from(i), 0.5));
    let table = DeviceTable::from_knots((0.0, 0.1), 400e3, knots, 1e-6).unwrap();
    let upload = rig.ask(Request::Upload(Arc::new(table)));
    rig.pass_ms(10);
    assert!(rig.outcome(upload).is_none(), "it is under way");
    let tickets = [Request::Stop, Request::Disarm].map(|request| rig.ask(request));
    rig.pass_ms(5);
    for ticket in tickets {
        assert!(matches!(rig.outcome(ticket), Some(Outcome::Done { .. })), "{:?}", rig.outcome(ticket));
    }
    assert!(rig.outcome(upload).is_none(), "they did not wait for it");
    rig.pass_ms(1000);
    assert_eq!(rig.state(), State::Idle);
    // The second press: an emergency stop is taken by a device that is disarmed, too.
    rig.done(Request::EmergencyStop, 300);
    assert_eq!(rig.state(), State::Fault);
}
