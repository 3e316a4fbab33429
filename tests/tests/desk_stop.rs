//! The stop on the desk: the board's user button, and what the device has found on its board.

use slipline_link::simulator::Options;
use slipline_link::{Change, Request};
use slipline_protocol::board::{BoardReport, MuteResistor, UserButton};
use slipline_protocol::event::{Fault, Faults, State};
use slipline_protocol::limits::{DESK_STOP_MS, EMERGENCY_RAMP_MS};
use slipline_protocol::{Command, Refusal};
use slipline_tests::answer;
use slipline_tests::client::Client;
use slipline_tests::link_rig::{self, LinkRig};
use slipline_tests::rig::{BLOCK, MID, Rig, Table, drive};

fn driving() -> Rig {
    Rig::driving(&[(0, 0.5, 0.5)], 2000, 10)
}

fn board(rig: &mut Rig) -> BoardReport {
    answer!(rig, Command::Board, Board)
}

#[test]
fn the_button_is_an_emergency_stop_with_its_own_name() {
    // silence within 5 ms, the amplifier off within 10 ms, without a word of the host.
    let mut rig = driving();
    rig.record();
    let pressed = rig.device.now();
    rig.device.press_button(true);
    rig.silent_ms(4);
    rig.device.press_button(false);
    rig.silent_ms(20);
    let ramp = rig.samples(EMERGENCY_RAMP_MS);
    let end = rig.recording.end_of_sound().unwrap();
    assert!((pressed + ramp / 2..=pressed + ramp + 3 * BLOCK).contains(&end), "{}", end - pressed);
    assert!(end < pressed + rig.samples(5) && rig.recording.was_muted(pressed + rig.samples(10)));
    let status = rig.status();
    assert_eq!((status.state, status.first_fault), (State::Fault, Some(Fault::DeskStop)));
    assert!(status.first_fault_at.abs_diff(pressed) <= 2 * BLOCK);
    rig.live_ms(DESK_STOP_MS);
    rig.accepted(&Command::ClearFaults);
    rig.arm();
    assert_eq!(rig.status().state, State::Armed);
}

#[test]
fn one_sample_is_no_press() {
    //
    let mut rig = driving();
    for _ in 0..20 {
        rig.device.press_button(true);
        rig.live_blocks(1);
        rig.device.press_button(false);
        rig.live_blocks(1);
    }
    assert_eq!(rig.status().state, State::Driving);
}

#[test]
fn a_held_button_prevents_arming_and_does_nothing_else_while_disarmed() {
    //
    let mut rig = Rig::greeted();
    rig.upload(&Table::usual());
    assert_eq!(board(&mut rig).user_button, UserButton::Released);
    rig.device.press_button(true);
    rig.live_ms(1000);
    assert_eq!((rig.status().state, board(&mut rig).user_button), (State::Idle, UserButton::Pressed));
    rig.record();
    assert!(matches!(rig.refused(&Command::Arm), Refusal::Faulted { .. }));
    rig.live_ms(20);
    assert_eq!(rig.status().faults, Faults::NONE.with(Fault::DeskStop));
    assert!(rig.recording.was_muted(rig.device.now() - BLOCK));
    rig.accepted(&Command::ClearFaults);
    assert_eq!(rig.status().faults, Faults::NONE.with(Fault::DeskStop), "its cause is still there");
    rig.device.press_button(false);
    rig.live_ms(DESK_STOP_MS + 10);
    rig.accepted(&Command::ClearFaults);
    rig.arm();
    assert_eq!(rig.status().state, State::Armed);
}

#[test]
fn no_host_moves_the_plate_again_before_two_seconds_have_passed_since_the_release() {
    // a host that clears, arms and drives as fast as it can; it presses no button, and the user only once.
    for held_ms in [10, 500] {
        let mut rig = driving();
        rig.device.press_button(true);
        rig.live_ms(held_ms);
        rig.device.press_button(false);
        let released = rig.device.now();
        rig.record();
        while rig.device.now() < released + rig.samples(DESK_STOP_MS + 100) {
            rig.send(&Command::ClearFaults);
            rig.send(&Command::Arm);
            rig.send(&Command::Drive(drive(&[(0, 0.5, 0.5)], 2000)));
            rig.live_blocks(3);
        }
        let rest = rig.samples(DESK_STOP_MS) as usize;
        let after_ramp = rig.samples(EMERGENCY_RAMP_MS) as usize + 3 * BLOCK as usize;
        let codes = rig.recording.from(released);
        assert!(
            codes[after_ramp..rest - BLOCK as usize].iter().all(|code| *code == MID),
            "held {held_ms} ms"
        );
        assert!(codes[rest..].iter().any(|code| *code != MID), "and not much longer");
    }
}

#[test]
fn a_host_of_1_2_gets_an_emergency_stop() {
    //
    let mut rig = Rig::default();
    rig.hello_of_minor(2);
    rig.arm();
    rig.device.press_button(true);
    rig.live_ms(10);
    let status = rig.status();
    assert_eq!(status.faults, Faults::NONE.with(Fault::EmergencyStop));
    assert_eq!(status.first_fault, Some(Fault::EmergencyStop));
}

#[test]
fn without_its_mute_resistor_a_device_does_everything_but_unmute() {
    //
    let mut rig = Rig::greeted_with(Options { mute_resistor_missing: true, ..Options::default() });
    rig.upload(&Table::usual());
    assert_eq!(board(&mut rig).mute_resistor, MuteResistor::Missing);
    rig.arm();
    let mut with = Rig::armed();
    assert_eq!(board(&mut with).mute_resistor, MuteResistor::Present);
    for rig in [&mut rig, &mut with] {
        rig.record();
        let command = Command::Drive(drive(&[(0, 0.5, 0.5)], 2000));
        rig.accepted(&command);
        rig.live_ms(100);
        assert_eq!(rig.status().state, State::Driving);
    }
    assert_eq!(rig.recording.codes, with.recording.codes);
    assert!(
        (0..rig.device.now())
            .step_by(128)
            .skip(1)
            .all(|index| { index < rig.recording.first || rig.recording.was_muted(index) })
    );
    assert!(!with.recording.was_muted(with.device.now() - BLOCK));
}

#[test]
fn the_link_reads_what_the_board_is_and_ends_the_drive_in_its_journal() {
    //
    let mut rig = LinkRig::armed_as(Options { mute_resistor_missing: true, ..Options::default() });
    let missing = |rig: &LinkRig| {
        rig.view()
            .record
            .log
            .iter()
            .filter(|line| line.text.starts_with("Muted: no resistor at the mute pin."))
            .count()
    };
    assert_eq!((rig.view().device.board.unwrap().mute_resistor, missing(&rig)), (MuteResistor::Missing, 1));
    rig.ask_and_pass(link_rig::drive(0.05), 300);
    rig.ports().device.press_button(true);
    rig.pass_ms(500);
    assert_eq!(rig.state(), State::Fault);
    let last = rig.view().record.journal.back().unwrap();
    assert_eq!((&last.change, last.is_exact), (&Change::Stop, false));
    assert!(rig.view().record.log.iter().any(|line| line.text.contains(Fault::DeskStop.text())));
    rig.ports().device.press_button(false);
    rig.pass_ms(u64::from(DESK_STOP_MS) + 300);
    rig.ask_and_pass(Request::ClearFaults, 300);
    assert_eq!(rig.state(), State::Idle);
}
