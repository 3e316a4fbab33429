//! The level hold: what its switch sends, what it says, and everything that ends it.

use crate::sensors::Partial;
use crate::session::{Session, membrane};
use slipline_instrument::calibration::WizardPage;
use slipline_instrument::hold::{Standing, ToneWords, words};
use slipline_instrument::{CalibrateIntent, MeasureIntent};
use slipline_link::protocol::event::State;
use slipline_link::{Request, Sounding};
use slipline_model::field::touch::Touch;
use slipline_model::setup::edit::Edit;
use std::sync::Arc;
use std::sync::atomic::{AtomicU16, Ordering};

/// A drive of full scale less 12 dB on a device with a sensor, and what the sensor shows of it.
fn sensed() -> (Session, Arc<AtomicU16>) {
    let (sensor, shows) = Partial::free();
    (quieter(Session::sensed(sensor)), shows)
}

/// The drive at a level that leaves room for a rise.
fn quieter(mut session: Session) -> Session {
    session.edit(&Edit::Level { slot: 0, level: 0.2 });
    session.pass(200);
    session
}

fn standing(session: &Session) -> String {
    session.instrument.shown().hold.standing.to_string()
}

fn is_on(session: &Session) -> bool {
    session.instrument.shown().hold.holding.is_on()
}

fn wait_for(session: &mut Session, part: &str) {
    session.until(part, |session| standing(session).contains(part));
}

fn switch(session: &mut Session, is_on: bool) {
    session.instrument.switch_hold(is_on);
    session.pass(100);
}

/// The states of the held tones.
fn tones(session: &Session) -> Vec<ToneWords> {
    let Standing::Holding(held) = session.instrument.shown().hold.standing else { return Vec::new() };
    held.into_iter().flat_map(words).collect()
}

/// Waits until the held tone has this correction in dB, in these words.
fn wait_for_tone(session: &mut Session, correction_db: f64, words: &str) {
    let is_so =
        |tone: &ToneWords| (tone.correction_db - correction_db).abs() < 0.05 && tone.words.starts_with(words);
    session.until(words, |session| matches!(&tones(session)[..], [tone] if is_so(tone)));
}

/// Switches it on, and waits until the level is held.
fn hold(session: &mut Session) {
    switch(session, true);
    wait_for(session, "Holding: the plate may be touched");
}

/// A level that is held.
fn held() -> (Session, Arc<AtomicU16>) {
    let (mut session, shows) = sensed();
    hold(&mut session);
    session.take_requests();
    (session, shows)
}

/// The orders of a hold, and their ends, since the last call.
fn orders(session: &Session) -> (usize, usize) {
    let holds: Vec<bool> = session
        .take_requests()
        .iter()
        .filter_map(
            |request| if let Request::Hold(hold) = request { Some(hold.tones.is_empty()) } else { None },
        )
        .collect();
    let ends = holds.iter().filter(|is_end| **is_end).count();
    (holds.len() - ends, ends)
}

#[test]
fn a_drag_ends_the_hold_which_restarts_where_the_line_rests() {
    let (mut session, _) = held();
    session.attention.is_dragging = true;
    let there_mm = session.line_mm();
    session.move_to(there_mm + 10.0);
    session.pass(700);
    assert!(standing(&session).contains("Waiting until nothing is changed") && is_on(&session));
    assert_eq!(orders(&session), (0, 0));
    session.attention.is_dragging = false;
    wait_for(&mut session, "Holding: the plate may be touched");
    assert_eq!(orders(&session), (1, 0));
    assert!(!session.is_logged("not held any more"), "the user has meant it");
}

#[test]
fn stop_ends_the_hold_and_drive_does_not_resume_it() {
    let (mut session, _) = held();
    session.instrument.press_stop();
    session.turn();
    assert!(matches!(session.take_requests().first(), Some(Request::Stop)), "nothing comes before the stop");
    session.pass(300);
    assert!(!is_on(&session));
    assert_eq!(session.state(), Some(State::Armed));
    assert_eq!(standing(&session), "Not held any more: the drive was stopped");
    session.instrument.start();
    session.pass(1000);
    assert!(session.is_driving() && !is_on(&session) && !session.instrument.drive.snapshot().is_holding());
}

#[test]
fn an_unplugged_sensor_or_device_ends_the_hold_with_the_reason() {
    let (mut session, shows) = held();
    shows.store(Partial::UNPLUGGED, Ordering::Relaxed);
    wait_for(&mut session, "Not held any more: every tone was lost");
    assert!(!is_on(&session) && session.is_driving());
    assert!(session.notice().contains("the sensor's input does not move"), "{}", session.notice());
    // No signal from the beginning.
    switch(&mut session, true);
    wait_for(&mut session, "Not held any more: the sensor's input does not move");
    shows.store(Partial::FREE, Ordering::Relaxed);
    hold(&mut session);
    session.plug(false, 1500);
    session.plug(true, 2000);
    assert!(!is_on(&session));
    assert_eq!(standing(&session), "Not held any more: the device disconnected");
}

#[test]
fn a_measurement_ends_the_hold_and_refuses_it_while_it_runs() {
    let (mut session, _) = held();
    session.instrument.perform_measure(MeasureIntent::Begin(None));
    session.pass(100);
    let sent = session.take_requests();
    let place = |is_it: fn(&Request) -> bool| sent.iter().position(is_it);
    let end = place(|request| matches!(request, Request::Hold(hold) if hold.tones.is_empty()));
    assert!(end.is_some_and(|end| {
        place(|request| matches!(request, Request::Play(Sounding::Comb(_)))).is_none_or(|comb| end < comb)
    }));
    let notice = session.notice();
    assert!(notice.contains("the sensor is needed to measure the plate"), "{notice}");
    session.pass(500);
    assert!(session.is_measuring());
    switch(&mut session, true);
    let notice = session.notice();
    assert!(!is_on(&session) && notice.contains("The plate is being measured"), "{notice}");
    assert!(!session.take_requests().iter().any(|request| matches!(request, Request::Hold(_))));
}

#[test]
fn the_calibrations_look_at_the_sensor_ends_the_hold() {
    let (mut session, _) = held();
    session.instrument.perform_calibrate(CalibrateIntent::Open);
    session.pass(200);
    assert!(session.instrument.drive.snapshot().is_holding(), "the first page needs no sensor");
    session.open_wizard(WizardPage::FirstPlace);
    session.pass(1500);
    assert!(!session.instrument.drive.snapshot().is_holding() && session.is_driving());
    assert!(session.instrument.shown().measure.live.signal.is_some());
}

#[test]
fn another_plate_ends_the_hold() {
    let (mut session, _) = held();
    session.change_plate(membrane(1.01));
    session.pass(1500);
    assert!(!is_on(&session));
    assert_eq!(standing(&session), "Not held any more: the plate was changed");
    session.instrument.undo();
    session.pass(1500);
    assert!(!is_on(&session));
}

#[test]
fn the_largest_rise_is_reported_as_a_limit() {
    let (mut session, shows) = held();
    session.instrument.choose_max_rise(3.0);
    wait_for(&mut session, "Listening for ");
    wait_for(&mut session, "Holding: the plate may be touched");
    shows.store(Partial::TOUCHED, Ordering::Relaxed);
    wait_for(&mut session, "Holding, at a limit");
    wait_for_tone(&mut session, 3.0, "at the largest rise that is allowed");
    shows.store(Partial::FREE, Ordering::Relaxed);
    wait_for(&mut session, "Holding: the plate may be touched");
}

#[test]
fn the_finger_on_the_screen_touches_the_simulated_plate_while_the_level_is_held() {
    let mut session = quieter(Session::at_bench().0);
    hold(&mut session);
    let correction_db = |session: &Session| tones(session)[0].correction_db;
    assert!(correction_db(&session).abs() < 0.2);
    session.instrument.touch(Touch::Light);
    session.pass(2500);
    let touched_db = correction_db(&session);
    assert!(touched_db.abs() > 0.7, "{touched_db}");
    assert!(standing(&session).contains("Holding: the plate may be touched"));
    // A drag: the finger is lifted while the plate is listened to, and comes back.
    let there_mm = session.line_mm();
    session.move_to(there_mm + 1.0);
    wait_for(&mut session, "Waiting until nothing is changed");
    wait_for(&mut session, "Listening");
    wait_for(&mut session, "Holding: the plate may be touched");
    session.pass(2500);
    let again_db = correction_db(&session);
    assert!((again_db - touched_db).abs() < 0.5, "{again_db} {touched_db}");
    session.instrument.touch(Touch::None);
    session.pass(2500);
    assert!(correction_db(&session).abs() < 0.3, "{}", correction_db(&session));
}
