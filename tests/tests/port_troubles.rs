//! What goes wrong with a port itself, R-26: each is one loss, told with its reason, and no busy loop.

use std::io::ErrorKind;

use slipline::link::{LinkState, Outcome, Port, Request, Trouble};
use slipline_tests::bench::{Bench, LOST_AFTER_MS};

#[test]
fn a_device_that_never_answers_is_given_up_with_a_reason() {
    let mut bench = Bench::new();
    bench.world().deaf_for = u32::MAX;
    let ticket = bench.ask(Request::Connect(Port::Serial("A".to_owned())));
    bench.pass_ms(LOST_AFTER_MS + 10);
    assert_eq!(bench.view().link, LinkState::Disconnected);
    assert_eq!(bench.view().trouble, Some(Trouble::NoAnswer(Port::Serial("A".to_owned()))));
    assert!(matches!(bench.outcome(ticket), Some(Outcome::Refused(_))));
}

#[test]
fn every_error_of_a_port_is_one_loss_and_no_busy_loop() {
    // UnexpectedEof stands for a read of Ok(0) here.
    for kind in [
        ErrorKind::UnexpectedEof,
        ErrorKind::BrokenPipe,
        ErrorKind::ConnectionReset,
        ErrorKind::NotConnected,
        ErrorKind::PermissionDenied,
        ErrorKind::ResourceBusy,
        ErrorKind::Other,
    ] {
        let mut bench = Bench::connected();
        bench.ask(Request::AutoReconnect(false));
        bench.states.clear();
        bench.world().error = Some(kind);
        let (steps, reads) = (bench.steps, bench.world().reads);
        bench.pass_ms(10_000);
        assert_eq!(bench.states.len(), 1, "{kind:?}: {:?}", bench.states);
        assert!(matches!(bench.states[0], LinkState::Lost(_)), "{kind:?}");
        assert!(bench.steps - steps <= 2, "{kind:?}: {} steps", bench.steps - steps);
        assert!(bench.world().reads - reads <= 2, "{kind:?}");
        assert!(bench.view().trouble.is_some());
    }
}

#[test]
fn a_port_that_only_says_not_yet_is_not_hammered_and_lost_for_its_silence() {
    //
    for kind in [ErrorKind::TimedOut, ErrorKind::WouldBlock] {
        let mut bench = Bench::connected();
        bench.ask(Request::AutoReconnect(false));
        bench.world().error = Some(kind);
        let steps = bench.steps;
        bench.pass_ms(LOST_AFTER_MS + 250);
        assert_eq!(bench.view().link, LinkState::Lost(Trouble::Silent), "{kind:?}");
        // A write that does not go through is tried every millisecond.
        assert!(bench.steps - steps <= LOST_AFTER_MS + 260);
    }
}

#[test]
fn a_port_that_cannot_be_opened_says_why_and_is_not_tried_again() {
    let port = Port::Serial("A".to_owned());
    for trouble in
        [Trouble::Busy(port.clone()), Trouble::NoPermission(port.clone()), Trouble::NoSuchPort(port.clone())]
    {
        let mut bench = Bench::new();
        bench.world().open_error = Some(trouble.clone());
        let ticket = bench.ask(Request::Connect(port.clone()));
        assert_eq!(bench.outcome(ticket), Some(Outcome::Refused(trouble.to_string())));
        bench.pass_ms(5000);
        assert_eq!(bench.view().link, LinkState::Disconnected);
        assert_eq!(bench.world().opened.len(), 1);
    }
}
