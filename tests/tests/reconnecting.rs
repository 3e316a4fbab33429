//! Devices that vanish and return, or are taken by another program, in virtual time.

use std::time::Duration;

use slipline::link::connection::SEEK_PERIOD;
use slipline::link::{LinkState, Outcome, Port, PortInfo, Request, Trouble};
use slipline_protocol::event::{Fault, State};
use slipline_protocol::{Command, Event, Refusal};
use slipline_tests::bench::{Bench, drive};
use slipline_tests::world::{Rewrite, as_real, board};

#[test]
fn a_device_that_comes_back_under_another_name_is_found_and_stays_disarmed() {
    //
    let mut bench = Bench::armed();
    bench.ask(drive(0.05));
    bench.pass_ms(300);
    assert_eq!(bench.state(), State::Driving);
    bench.states = vec![LinkState::Connected];
    bench.world().unplug();
    bench.pass_ms(200);
    bench.world().ports = vec![board("B")];
    // Within two seconds: the next look, and a greeting.
    bench.pass_ms(SEEK_PERIOD.as_millis() as u64 + 300);
    assert_eq!(
        bench.states,
        [
            LinkState::Connected,
            LinkState::Lost(Trouble::Gone),
            LinkState::Reconnecting(Trouble::Gone),
            LinkState::Connected
        ]
    );
    assert_eq!(bench.view().port, Some(Port::Serial("B".to_owned())));
    bench.pass_ms(300);
    assert_eq!(bench.state(), State::Idle);
    assert!(bench.view().table.active.is_some(), "what it holds was read again");
    let rearmed = bench.world().heard.iter().filter(|(_, command)| *command == Command::Arm).count();
    assert_eq!(rearmed, 1, "only the first time");
}

#[test]
fn the_hellos_of_two_sessions_have_different_numbers() {
    // A late answer to the first must not open the second.
    let mut bench = Bench::connected();
    bench.world().unplug();
    bench.pass_ms(10);
    bench.world().ports = vec![board("B")];
    bench.pass_ms(1000);
    let world = bench.world();
    let numbers: Vec<u16> =
        world.heard.iter().filter(|(_, c)| matches!(c, Command::Hello(_))).map(|(s, _)| *s).collect();
    assert_eq!(numbers.len(), 2);
    assert_ne!(numbers[0], numbers[1]);
}

#[test]
fn a_lost_device_is_not_looked_for_when_that_is_switched_off() {
    let mut bench = Bench::connected();
    bench.ask(Request::AutoReconnect(false));
    bench.world().unplug();
    bench.pass_ms(50);
    bench.world().ports = vec![board("A")];
    bench.pass_ms(5000);
    assert_eq!(bench.view().link, LinkState::Lost(Trouble::Gone));
    assert_eq!(bench.world().opened.len(), 1);
    bench.ask(Request::AutoReconnect(true));
    bench.pass_ms(300);
    assert_eq!(bench.view().link, LinkState::Connected);
}

#[test]
fn a_device_that_another_program_keeps_taking_is_left_to_it() {
    let mut bench = Bench::connected();
    let refused: Rewrite = |event| match as_real(event) {
        Event::Status(_) => Event::Refused(Refusal::StaleSession),
        event => event,
    };
    bench.world().rewrite = refused;
    bench.pass_ms(20_000);
    assert_eq!(bench.view().link, LinkState::Disconnected);
    assert_eq!(bench.view().trouble, Some(Trouble::SessionEnded));
    let hellos = bench.world().heard.iter().filter(|(_, c)| matches!(c, Command::Hello(_))).count();
    assert!((2..=4).contains(&hellos), "{hellos}");
    // Asked for again, it is tried again.
    bench.world().rewrite = as_real;
    bench.ask(Request::Connect(Port::Serial("A".to_owned())));
    bench.pass_ms(100);
    assert_eq!(bench.view().link, LinkState::Connected);
}

#[test]
fn another_board_in_its_place_is_not_taken_for_it() {
    let mut bench = Bench::connected();
    bench.world().unplug();
    bench.pass_ms(50);
    let mut other = board("A");
    other.usb_serial = Some("0002".to_owned());
    bench.world().ports = vec![other];
    bench.pass_ms(2000);
    assert!(matches!(bench.view().link, LinkState::Reconnecting(_)));
    assert_eq!(bench.world().opened.len(), 1, "not even opened");
}

#[test]
fn a_port_with_another_board_is_passed_over_for_the_next_one() {
    let nameless = |name| PortInfo { usb_serial: None, ..board(name) };
    let mut bench = Bench::new();
    bench.world().ports = vec![nameless("A")];
    bench.ask(Request::Connect(Port::Serial("A".to_owned())));
    bench.pass_ms(100);
    bench.world().unplug();
    // Another board answers at the first port of its kind...
    bench.world().ports = vec![nameless("B"), nameless("C")];
    bench.world().rewrite = |event| match as_real(event) {
        Event::Hello(mut identity) => {
            identity.unit = *b"another-unit";
            Event::Hello(identity)
        }
        event => event,
    };
    bench.pass_ms(100);
    assert!(matches!(bench.view().link, LinkState::Reconnecting(_)));
    // ...and the one that was lost at the second.
    bench.world().rewrite = as_real;
    bench.pass_ms(SEEK_PERIOD.as_millis() as u64);
    assert_eq!(bench.view().link, LinkState::Connected);
    assert_eq!(bench.world().opened, ["A", "B", "C"].map(|name| Port::Serial(name.to_owned())));
}

#[test]
fn a_host_that_sleeps_for_an_hour_finds_the_device_silent_and_starts_it_again() {
    // R-25, at 8 kS/s, so that the hour is few blocks.
    let mut bench = Bench::armed_at(8000);
    bench.ask(drive(0.05));
    bench.pass_ms(500);
    assert_eq!(bench.state(), State::Driving);
    bench.world().heard.clear();
    assert!(!bench.sleep(Duration::from_secs(3600)), "muted and silent");
    bench.pass_ms(500);
    assert_eq!(bench.view().link, LinkState::Connected);
    let status = bench.view().status.unwrap();
    assert_eq!((status.state, status.first_fault), (State::Fault, Some(Fault::HostLost)));
    let rearmed = bench.world().heard.iter().any(|(_, command)| *command == Command::Arm);
    assert!(!rearmed, "only the user may");
    for request in [Request::ClearFaults, Request::Arm, drive(0.06)] {
        let ticket = bench.ask(request.clone());
        bench.pass_ms(500);
        assert!(matches!(bench.outcome(ticket), Some(Outcome::Done { .. })), "{request:?}");
    }
    assert_eq!(bench.state(), State::Driving);
}
