//! The comparison of the device's codes with the mirror's, turn by turn: it blocks no shell.

use crate::pluggable_port::SteppedLink;
use crate::session::Session;
use slipline_instrument::measure::{MeasureError, Run, Verified, Verifying};
use slipline_instrument::{Link, MeasureIntent};
use slipline_link::Request;
use std::rc::Rc;
use std::time::Duration;

/// Verifies three tones on the session's device, which holds the table of its plate; cancels it once this holds of the requests.
fn verified(session: &Session, is_enough: impl Fn(&[Request]) -> bool) -> Result<Verified, MeasureError> {
    let link = SteppedLink(Rc::clone(&session.worker));
    let mut run = Run::of(Verifying::new(&session.instrument.desk.setup().plate, 3, 0.05, 400e3));
    for _ in 0..2000 {
        if !run.turn(&link.snapshot(), |request| link.send(request)) {
            return run.finish();
        }
        if is_enough(&session.worker.borrow().sent) {
            run.cancel();
        }
        session.worker.borrow_mut().advance(Duration::from_millis(5));
    }
    panic!("it never ends");
}

#[test]
fn the_codes_of_four_windows_are_compared_and_the_device_is_silent_then() {
    let session = Session::driving();
    session.take_requests();
    let verified = verified(&session, |_| false).unwrap();
    let stages: Vec<&str> = verified.windows.iter().map(|window| window.stage).collect();
    assert_eq!(stages, ["start from silence", "steady tones", "drag", "stop"]);
    assert!(verified.equal && verified.windows.iter().all(|window| window.equal), "{verified:?}");
    let of_steady = &verified.windows[1];
    assert!(of_steady.device_crc.as_ref() == Some(&of_steady.mirror_crc) && of_steady.samples == 20_000);
    assert!(matches!(session.take_requests().last(), Some(Request::Stop)));
}

#[test]
fn a_comparison_that_is_cancelled_ends_with_a_stop() {
    let session = Session::driving();
    session.take_requests();
    let cancelled =
        verified(&session, |sent| sent.iter().any(|request| matches!(request, Request::Digest(_))));
    assert_eq!(cancelled, Err(MeasureError::Cancelled));
    assert!(matches!(session.take_requests().last(), Some(Request::Stop)));
}

#[test]
fn the_instrument_compares_the_codes_at_the_users_request_and_the_drive_stays_off() {
    let mut session = Session::driving();
    session.instrument.perform_measure(MeasureIntent::Verify);
    session.pass(200);
    assert!(session.is_measuring(), "{}", session.notice());
    session.end_of_measuring();
    assert_eq!(session.notice(), "The device sends the mirror's codes: 4 windows of 16 tones are equal.");
    assert!(!session.is_driving());
    // STOP ends it.
    session.instrument.perform_measure(MeasureIntent::Verify);
    session.pass(200);
    session.instrument.press_stop();
    session.end_of_measuring();
    assert_eq!(session.notice(), "The comparison of the codes was cancelled.");
    session.instrument.disarm();
    session.pass(500);
    assert!(!session.is_driving() && !session.is_measuring());
}
