//! After ten minutes without a request the device stops by itself, the instrument says so, and Drive starts it
//! again.

use crate::fixed_link::{FixedLink, real_device};
use crate::session::{Session, setup};
use slipline_instrument::bench::Bench;
use slipline_instrument::{Instrument, Jobs};
use slipline_link::protocol::event::{Fault, Faults, State};
use slipline_link::protocol::limits::MAX_DRIVE_MS;
use slipline_link::{Request, Sounding};
use std::sync::Arc;
use std::time::Duration;

#[test]
#[ignore = "ten minutes of a device's samples: .ci/run long_tests"]
fn the_simulated_plate_goes_on_with_one_press_after_ten_minutes() {
    let mut session = Session::driving();
    session.worker.borrow_mut().advance(Duration::from_millis(u64::from(MAX_DRIVE_MS)));
    session.pass(500);
    let told = "Stopped after 10 minutes without a command. Press Drive to resume.";
    assert_eq!(session.notice(), told);
    assert!(session.instrument.drive.snapshot().record.log.iter().any(|entry| entry.text == told), "whole");
    session.pass(1000);
    assert!(!session.is_driving(), "not before it is asked to");
    session.instrument.start();
    session.pass(1000);
    assert!(session.is_driving() && session.instrument.out.notices().next().is_none());
}

/// An instrument on this device.
fn on(link: &FixedLink) -> Instrument {
    let mut instrument = Instrument::new(Box::new(link.clone()), Jobs::inline(), Bench::default(), setup());
    turn(&mut instrument);
    instrument
}

fn turn(instrument: &mut Instrument) {
    for _ in 0..5 {
        instrument.take_reports();
        instrument.turn();
    }
}

fn notice(instrument: &Instrument) -> String {
    instrument
        .out
        .notices()
        .max_by_key(|notice| notice.number)
        .map_or_else(String::new, |notice| notice.text.clone())
}

/// A device that a fault has stopped.
fn stopped(faults: Faults, is_simulated: bool) -> FixedLink {
    let mut link = real_device(State::Fault);
    let snapshot = Arc::make_mut(&mut link.snapshot);
    snapshot.drive.status.as_mut().unwrap().faults = faults;
    Arc::make_mut(snapshot.device.identity.as_mut().unwrap()).simulated = is_simulated;
    link
}

#[test]
fn a_real_device_and_every_other_fault_are_cleared_by_hand() {
    let drive_time = Faults::NONE.with(Fault::DriveTime);
    for link in [stopped(drive_time, false), stopped(drive_time.with(Fault::Overheat), true)] {
        let mut instrument = on(&link);
        let told = notice(&instrument);
        assert!(told.starts_with("Stopped after 10 minutes") && told.contains("Clear fault"), "{told}");
        link.sent.borrow_mut().clear();
        instrument.start();
        turn(&mut instrument);
        let sent = link.sent.borrow();
        let is_kept =
            |request: &Request| matches!(request, Request::ClearFaults | Request::Play(Sounding::Drive(_)));
        assert!(!sent.iter().any(is_kept), "{sent:?}");
    }
}

#[test]
fn a_simulated_drive_is_paused_before_its_limit_and_a_real_one_is_not() {
    for is_simulated in [true, false] {
        let mut link = real_device(State::Driving);
        let snapshot = Arc::make_mut(&mut link.snapshot);
        Arc::make_mut(snapshot.device.identity.as_mut().unwrap()).simulated = is_simulated;
        let mut instrument = on(&link);
        instrument.start();
        turn(&mut instrument);
        let stops = |link: &FixedLink| {
            link.sent.borrow_mut().drain(..).filter(|request| matches!(request, Request::Stop)).count()
        };
        let later = |minutes: f64| {
            let mut snapshot = (*link.snapshot).clone();
            let rate_hz = f64::from(snapshot.device.identity.as_ref().unwrap().sample_rate_hz);
            snapshot.drive.status.as_mut().unwrap().now = (60.0 * minutes * rate_hz) as u64;
            link.become_known(snapshot);
        };
        stops(&link);
        later(9.8);
        turn(&mut instrument);
        assert_eq!(stops(&link), 0);
        later(9.95);
        turn(&mut instrument);
        assert_eq!(stops(&link), usize::from(is_simulated));
        let text = notice(&instrument);
        assert_eq!(text.starts_with("Paused: nothing was changed for 10 minutes."), is_simulated, "{text}");
    }
}
