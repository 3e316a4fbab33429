//! Stops on a bad line: what they overtake does not come back, and what is asked for after them is not undone.

use slipline::link::{Change, DriveRequest, LinkState, Outcome, Port, Request, ToneRequest};
use slipline_protocol::command::Apply;
use slipline_protocol::event::{Fault, State};
use slipline_protocol::limits::REPLY_TIMEOUT_MS;
use slipline_protocol::{Command, Event, Refusal};
use slipline_tests::bench::{Bench, drive};
use slipline_tests::world::{as_real, lock};

/// Longer than a lost word takes to be said again.
const AGAIN_MS: u64 = 2 * REPLY_TIMEOUT_MS as u64;

/// Armed, with one tone that sounds.
fn driving() -> Bench {
    let mut bench = Bench::armed();
    bench.ask(drive(0.05));
    bench.pass_ms(300);
    assert_eq!(bench.state(), State::Driving);
    bench
}

/// Whether a drive has been said since so many words.
fn has_driven_since(bench: &Bench, words: usize) -> bool {
    lock(&bench.world).heard.iter().skip(words).any(|(_, command)| matches!(command, Command::Drive(_)))
}

#[test]
fn a_drive_that_was_lost_before_a_stop_does_not_come_back_after_it() {
    let mut bench = Bench::armed();
    bench.world().mute_for = 1;
    bench.ask(drive(0.05));
    let stop = bench.ask(Request::Stop);
    bench.pass_ms(2000);
    assert!(matches!(bench.outcome(stop), Some(Outcome::Done { .. })));
    assert_eq!(bench.state(), State::Armed, "silent, and in step with the device");
    let again = bench.ask(drive(0.06));
    bench.pass_ms(300);
    assert!(matches!(bench.outcome(again), Some(Outcome::Done { .. })));
    assert_eq!(bench.state(), State::Driving);
}

#[test]
fn a_drive_that_was_busy_when_the_stop_came_is_not_said_again() {
    let mut bench = Bench::armed();
    bench.ask(drive(0.05));
    // Taken, but not taken up: the next one is refused as busy.
    bench.connection.step(bench.now);
    let busy = bench.ask(drive(0.06));
    bench.only_ask(Request::Stop);
    let words = bench.world().heard.len();
    bench.pass_ms(500);
    assert!(!has_driven_since(&bench, words));
    assert_eq!(bench.outcome(busy), Some(Outcome::Superseded));
    assert_eq!(bench.state(), State::Armed, "silent");
}

#[test]
fn a_drive_with_a_wrong_number_is_not_said_again_after_a_stop() {
    let mut bench = Bench::armed();
    bench.world().mute_for = 1;
    let lost = bench.ask(drive(0.05));
    bench.ask(Request::Stop);
    let words = bench.world().heard.len();
    // What takes the drive's place is refused for its number.
    bench.world().rewrite = |event| match as_real(event) {
        Event::Table(_) => Event::Refused(Refusal::BadSequence { expected: 1 }),
        event => event,
    };
    bench.pass_ms(AGAIN_MS);
    assert!(!has_driven_since(&bench, words));
    assert_eq!(bench.outcome(lost), Some(Outcome::Superseded));
    let again = bench.ask(drive(0.06));
    bench.pass_ms(100);
    assert!(matches!(bench.outcome(again), Some(Outcome::Done { .. })), "in step with the device");
}

#[test]
fn a_drive_told_only_after_the_stop_that_ended_it_does_not_count_as_sounding() {
    let mut bench = Bench::armed();
    bench.world().deaf_for = 1;
    bench.ask(drive(0.05));
    bench.pass_ms(20);
    bench.ask(Request::Stop);
    bench.pass_ms(AGAIN_MS);
    assert_eq!(bench.state(), State::Armed, "silent");
    let journal = &bench.view().journal;
    assert!(journal.iter().any(|entry| matches!(entry.change, Change::Drive(_))), "it did sound");
    assert_eq!(journal.back().map(|entry| &entry.change), Some(&Change::Stop));
}

#[test]
fn the_repeat_of_a_stop_does_not_end_the_drive_that_was_asked_for_after_it() {
    let mut bench = driving();
    bench.world().deaf_for = 1;
    bench.ask(Request::Stop);
    bench.pass_ms(50);
    let newer = bench.ask(drive(0.06));
    bench.pass_ms(1000);
    assert!(matches!(bench.outcome(newer), Some(Outcome::Done { .. })));
    assert_eq!(bench.state(), State::Driving);
}

#[test]
fn the_repeat_of_an_emergency_stop_does_not_undo_what_was_asked_for_after_it() {
    //
    let mut bench = driving();
    bench.world().deaf_for = 1;
    bench.ask(Request::EmergencyStop);
    bench.pass_ms(50);
    let due = bench.connection.deadline(bench.now);
    let newer = [Request::ClearFaults, Request::Arm, drive(0.06)].map(|request| bench.ask(request));
    assert_eq!(bench.connection.deadline(bench.now), due, "what waits for the answer is no reason to spin");
    bench.pass_ms(1000);
    assert!(newer.iter().all(|ticket| matches!(bench.outcome(*ticket), Some(Outcome::Done { .. }))));
    assert_eq!(bench.state(), State::Driving);
}

#[test]
fn a_lost_emergency_stop_is_said_again_though_a_stop_came_after_it() {
    //
    let mut bench = driving();
    bench.world().mute_stops_for = 1;
    let emergency = bench.ask(Request::EmergencyStop);
    bench.pass_ms(20);
    bench.ask(Request::Stop);
    bench.pass_ms(AGAIN_MS);
    assert!(matches!(bench.outcome(emergency), Some(Outcome::Done { .. })));
    assert!(bench.view().status.unwrap().faults.contains(Fault::EmergencyStop));
}

#[test]
fn a_lost_emergency_stop_is_said_again_by_the_farewell() {
    //
    let mut bench = driving();
    bench.world().mute_stops_for = 1;
    bench.ask(Request::EmergencyStop);
    bench.ask(Request::Disconnect);
    bench.pass_ms(1000);
    assert_eq!(bench.view().link, LinkState::Disconnected);
    bench.ask(Request::Connect(Port::Serial("A".to_owned())));
    bench.pass_ms(100);
    assert!(bench.view().status.unwrap().faults.contains(Fault::EmergencyStop));
}

#[test]
fn a_disarm_does_not_wait_for_a_drive_that_is_busy() {
    let mut bench = Bench::armed();
    let in_20_s = bench.world().device.now() + 20 * 400_000;
    let tones = vec![ToneRequest { slot: 0, boundary_m: 0.05, level: 0.5, phase_turns: 0.0 }];
    bench.ask(Request::Drive(DriveRequest { apply: Apply::At(in_20_s), ..DriveRequest::of(tones) }));
    bench.pass_ms(5);
    let busy = bench.ask(drive(0.06));
    let disarm = bench.ask(Request::Disarm);
    bench.pass_ms(5);
    assert_eq!(bench.outcome(busy), Some(Outcome::Superseded));
    assert!(matches!(bench.outcome(disarm), Some(Outcome::Done { .. })));
    assert!(bench.world().device.is_muted());
}
