//! Devices that vanish and return, or are taken by another program, in virtual time.

use std::io::ErrorKind;
use std::time::Duration;

use slipline_link::connection::SEEK_PERIOD;
use slipline_link::{LinkError, LinkState, Outcome, Port, PortInfo, Request};
use slipline_protocol::event::{Fault, State};
use slipline_protocol::{Command, Event, Refusal};
use slipline_tests::faulty_ports::{Rewrite, as_real, board, identified};
use slipline_tests::link_rig::{LOST_AFTER_MS, LinkRig, drive};

#[test]
fn a_device_that_comes_back_under_another_name_is_found_and_stays_disarmed() {
    //
    let mut rig = LinkRig::armed();
    rig.ask_and_pass(drive(0.05), 300);
    assert_eq!(rig.state(), State::Driving);
    rig.states = vec![LinkState::Connected];
    rig.ports().unplug();
    rig.pass_ms(200);
    rig.ports().listed = vec![board("B")];
    // Within two seconds: the next look, and a greeting.
    rig.pass_ms(SEEK_PERIOD.as_millis() as u64 + 300);
    assert_eq!(
        rig.states,
        [
            LinkState::Connected,
            LinkState::Lost(LinkError::Gone),
            LinkState::Reconnecting(LinkError::Gone),
            LinkState::Connected
        ]
    );
    assert_eq!(rig.view().link.port, Some(Port::Serial("B".to_owned())));
    rig.pass_ms(300);
    assert_eq!(rig.state(), State::Idle);
    assert!(rig.view().table.report.active.is_some(), "what it holds was read again");
    let rearmed = rig.ports().commands.iter().filter(|(_, command)| *command == Command::Arm).count();
    assert_eq!(rearmed, 1, "only the first time");
}

/// A link that waits for port A, which is missing.
fn waiting() -> (LinkRig, LinkError) {
    let mut rig = LinkRig::new();
    rig.ports().listed.clear();
    let port = Port::Serial("A".to_owned());
    let connect = rig.ask(Request::Connect(port.clone()));
    let missing = LinkError::NoSuchPort(port);
    assert_eq!(rig.outcome(connect), Some(Outcome::Refused(missing.clone().into())), "refused at once");
    rig.pass_ms(5000);
    assert_eq!(rig.states, [LinkState::Reconnecting(missing.clone())]);
    assert_eq!(rig.view().link.error, Some(missing.clone()));
    let tries = rig.ports().opened.len();
    assert!((15..=21).contains(&tries), "{tries}");
    (rig, missing)
}

#[test]
fn a_port_that_is_missing_at_the_start_is_opened_when_it_appears() {
    let (mut rig, _) = waiting();
    rig.ports().listed = vec![board("A")];
    rig.pass_ms(SEEK_PERIOD.as_millis() as u64 + 300);
    assert_eq!(rig.view().link.state, LinkState::Connected);
    assert_eq!(rig.view().link.error, None);
    assert_eq!(rig.state(), State::Idle, "only the user arms it");
    // From here on it is a device like any other.
    rig.ports().unplug();
    rig.pass_ms(1000);
    assert_eq!(rig.view().link.state, LinkState::Reconnecting(LinkError::Gone));
}

#[test]
fn a_missing_port_is_waited_for_until_the_user_gives_it_up() {
    for given_up in [Request::Disconnect, Request::AutoReconnect(false)] {
        let (mut rig, missing) = waiting();
        rig.ask(given_up);
        assert_eq!(rig.view().link.state, LinkState::Disconnected);
        assert_eq!(rig.view().link.error, Some(missing));
        let tries = rig.ports().opened.len();
        rig.ports().listed = vec![board("A")];
        rig.pass_ms(5000);
        assert_eq!(rig.view().link.state, LinkState::Disconnected);
        assert_eq!(rig.ports().opened.len(), tries);
    }
    // Another port.
    let (mut rig, _) = waiting();
    rig.ports().listed = vec![board("B")];
    rig.ask_and_pass(Request::Connect(Port::Serial("B".to_owned())), 100);
    assert_eq!(rig.view().link.state, LinkState::Connected);
    assert_eq!(rig.view().link.port, Some(Port::Serial("B".to_owned())));
}

#[test]
fn a_missing_port_that_appears_but_cannot_be_used_reports_why_and_is_still_waited_for() {
    let (mut rig, _) = waiting();
    let port = Port::Serial("A".to_owned());
    rig.ports().listed = vec![board("A")];
    rig.ports().open_error = Some(LinkError::NoPermission(port.clone()));
    rig.pass_ms(1000);
    assert_eq!(rig.view().link.state, LinkState::Reconnecting(LinkError::NoPermission(port.clone())));
    rig.ports().open_error = None;
    rig.ports().drop_replies = u32::MAX;
    rig.pass_ms(LOST_AFTER_MS + 1000);
    assert_eq!(rig.view().link.state, LinkState::Reconnecting(LinkError::NoAnswer(port)));
    rig.ports().drop_replies = 0;
    rig.pass_ms(LOST_AFTER_MS + 1000);
    assert_eq!(rig.view().link.state, LinkState::Connected);
}

#[test]
fn a_port_that_opens_later_is_greeted_then() {
    let mut rig = LinkRig::new();
    rig.ports().is_opening = true;
    let connect = rig.ask(Request::Connect(Port::Serial("A".to_owned())));
    // Longer than any device may take to answer.
    rig.pass_ms(LOST_AFTER_MS + 1000);
    assert_eq!(rig.states, [LinkState::Connecting]);
    assert!(rig.ports().commands.is_empty(), "nothing is written to a port that is shut");
    assert_eq!(rig.connection.deadline(rig.now), None, "it wakes the link itself");
    rig.ports().is_opening = false;
    rig.pass_ms(100);
    assert!(matches!(rig.outcome(connect), Some(Outcome::Done { .. })));
    // The same when it comes back after a loss.
    rig.ports().unplug();
    rig.pass_ms(10);
    rig.ports().is_opening = true;
    rig.ports().listed = vec![board("A")];
    rig.pass_ms(LOST_AFTER_MS + 1000);
    assert_eq!(rig.view().link.state, LinkState::Reconnecting(LinkError::Gone));
    // A port that is still listed, and fails: not why the device is missing.
    let tries = rig.ports().opened.len();
    rig.ports().error = Some(ErrorKind::ResourceBusy);
    rig.step();
    assert_eq!(rig.view().link.state, LinkState::Reconnecting(LinkError::Gone));
    assert_eq!(rig.view().link.error, Some(LinkError::Gone));
    rig.ports().error = None;
    rig.ports().is_opening = false;
    rig.pass_ms(1000);
    assert_eq!(rig.ports().opened.len(), tries + 1, "it is tried again");
    assert_eq!(rig.view().link.state, LinkState::Connected);
}

#[test]
fn an_opening_that_fails_later_reports_why_and_one_that_never_ends_can_be_given_up() {
    let port = Port::Serial("A".to_owned());
    let mut rig = LinkRig::new();
    rig.ports().is_opening = true;
    let connect = rig.ask(Request::Connect(port.clone()));
    rig.pass_ms(300);
    rig.ports().error = Some(ErrorKind::ResourceBusy);
    // The transport wakes the link.
    rig.step();
    let busy = LinkError::Busy(port.clone());
    assert_eq!(rig.outcome(connect), Some(Outcome::Refused(busy.clone().into())));
    assert_eq!((&rig.view().link.state, &rig.view().link.error), (&LinkState::Disconnected, &Some(busy)));
    rig.pass_ms(2000);
    assert_eq!(rig.ports().opened.len(), 1, "it is not taken from another program");
    // Given up, for good and for another port.
    rig.ports().error = None;
    rig.ask_and_pass(Request::Connect(port.clone()), 300);
    let leave = rig.ask(Request::Disconnect);
    rig.pass_ms(10);
    assert_eq!(rig.outcome(leave), Some(Outcome::Done { at: 0 }));
    assert_eq!(rig.view().link.state, LinkState::Disconnected);
    rig.ask_and_pass(Request::Connect(port.clone()), 300);
    rig.ask(Request::Connect(port));
    rig.ports().is_opening = false;
    rig.pass_ms(100);
    assert_eq!(rig.view().link.state, LinkState::Connected);
}

#[test]
fn the_hellos_of_two_sessions_have_different_numbers() {
    // A late answer to the first must not open the second.
    let mut rig = LinkRig::connected();
    rig.ports().unplug();
    rig.pass_ms(10);
    rig.ports().listed = vec![board("B")];
    rig.pass_ms(1000);
    let ports = rig.ports();
    let numbers: Vec<u16> =
        ports.commands.iter().filter(|(_, c)| matches!(c, Command::Hello(_))).map(|(s, _)| *s).collect();
    assert_eq!(numbers.len(), 2);
    assert_ne!(numbers[0], numbers[1]);
}

#[test]
fn a_simulated_device_that_stalled_while_it_drove_is_armed_again() {
    // When it goes on, it ramps to silence first and refuses to be armed meanwhile. Whether the link meets that depends
    // on the phase of its hellos, which are up to 300 ms apart.
    let mut refused = 0;
    for phase_ms in (0..300).step_by(10) {
        let mut rig = LinkRig::armed();
        // It calls itself simulated.
        rig.ports().rewrite = |event| event;
        rig.ask_and_pass(drive(0.05), 300);
        assert_eq!(rig.state(), State::Driving);
        rig.ports().stall(true);
        rig.pass_ms(4000 + phase_ms);
        assert_ne!(rig.view().link.state, LinkState::Connected);
        rig.ports().stall(false);
        rig.ports().commands.clear();
        rig.pass_ms(3000);
        assert_eq!(rig.view().link.state, LinkState::Connected);
        assert_eq!(rig.state(), State::Armed, "{phase_ms} ms");
        let arms = rig.ports().commands.iter().filter(|(_, command)| *command == Command::Arm).count();
        refused += arms - 1;
    }
    assert!(refused > 0, "no hello met the ramp");
}

#[test]
fn a_lost_device_is_not_looked_for_when_that_is_switched_off() {
    let mut rig = LinkRig::connected();
    rig.ask(Request::AutoReconnect(false));
    rig.ports().unplug();
    rig.pass_ms(50);
    rig.ports().listed = vec![board("A")];
    rig.pass_ms(5000);
    assert_eq!(rig.view().link.state, LinkState::Lost(LinkError::Gone));
    assert_eq!(rig.ports().opened.len(), 1);
    rig.ask_and_pass(Request::AutoReconnect(true), 300);
    assert_eq!(rig.view().link.state, LinkState::Connected);
}

#[test]
fn a_device_that_another_program_keeps_taking_is_left_to_it() {
    let mut rig = LinkRig::connected();
    let refused: Rewrite = |event| match as_real(event) {
        Event::Status(_) => Event::Refused(Refusal::StaleSession),
        event => event,
    };
    rig.ports().rewrite = refused;
    rig.pass_ms(20_000);
    assert_eq!(rig.view().link.state, LinkState::Disconnected);
    assert_eq!(rig.view().link.error, Some(LinkError::SessionEnded));
    let hellos = rig.ports().commands.iter().filter(|(_, c)| matches!(c, Command::Hello(_))).count();
    assert!((2..=4).contains(&hellos), "{hellos}");
    // Asked for again, it is tried again.
    rig.ports().rewrite = as_real;
    rig.ask_and_pass(Request::Connect(Port::Serial("A".to_owned())), 100);
    assert_eq!(rig.view().link.state, LinkState::Connected);
}

#[test]
fn another_board_at_the_same_port_is_not_opened() {
    let mut rig = LinkRig::connected();
    rig.ports().unplug();
    rig.pass_ms(50);
    let mut other = board("A");
    other.usb_serial = Some("0002".to_owned());
    rig.ports().listed = vec![other];
    rig.pass_ms(2000);
    assert!(matches!(rig.view().link.state, LinkState::Reconnecting(_)));
    assert_eq!(rig.ports().opened.len(), 1, "not even opened");
}

#[test]
fn a_port_with_another_board_is_passed_over_for_the_next_one() {
    let nameless = |name| PortInfo { usb_serial: None, ..board(name) };
    let mut rig = LinkRig::new();
    rig.ports().listed = vec![nameless("A")];
    rig.ask_and_pass(Request::Connect(Port::Serial("A".to_owned())), 100);
    rig.ports().unplug();
    // Another board answers at the first port of its kind...
    rig.ports().listed = vec![nameless("B"), nameless("C")];
    rig.ports().rewrite = |event| identified(event, |identity| identity.unit = *b"another-unit");
    rig.pass_ms(100);
    assert!(matches!(rig.view().link.state, LinkState::Reconnecting(_)));
    // ...and the one that was lost at the second.
    rig.ports().rewrite = as_real;
    rig.pass_ms(SEEK_PERIOD.as_millis() as u64);
    assert_eq!(rig.view().link.state, LinkState::Connected);
    assert_eq!(rig.ports().opened, ["A", "B", "C"].map(|name| Port::Serial(name.to_owned())));
}

#[test]
fn a_host_that_sleeps_for_an_hour_finds_the_device_silent_and_starts_it_again() {
    // R-25, at 8 kS/s, so that the hour is few blocks.
    let mut rig = LinkRig::armed_at(8000);
    rig.ask_and_pass(drive(0.05), 500);
    assert_eq!(rig.state(), State::Driving);
    rig.ports().commands.clear();
    assert!(!rig.sleep(Duration::from_secs(3600)), "muted and silent");
    rig.pass_ms(500);
    assert_eq!(rig.view().link.state, LinkState::Connected);
    let status = rig.view().drive.status.unwrap();
    assert_eq!((status.state, status.first_fault), (State::Fault, Some(Fault::HostLost)));
    let rearmed = rig.ports().commands.iter().any(|(_, command)| *command == Command::Arm);
    assert!(!rearmed, "only the user may");
    for request in [Request::ClearFaults, Request::Arm, drive(0.06)] {
        let ticket = rig.ask(request.clone());
        rig.pass_ms(500);
        assert!(matches!(rig.outcome(ticket), Some(Outcome::Done { .. })), "{request:?}");
    }
    assert_eq!(rig.state(), State::Driving);
}
