//! The device plays the setup on the screen, whichever command or edit has set it.

use crate::session::{Session, drives};
use slipline_link::Request;
use slipline_link::protocol::Refusal;
use slipline_model::setup::edit::Edit;
use slipline_model::sounding::sounding;

/// The device plays, within a thousandth, the frequencies that the screen's setup asks for.
fn assert_screen_sounds(session: &Session) {
    let acknowledged = sounding(session.instrument.drive.snapshot()).expect("something sounds");
    let acknowledged: Vec<f64> = acknowledged.tones.iter().map(|tone| tone.frequency_hz).collect();
    let setup = session.instrument.desk.setup();
    let wanted: Vec<f64> =
        setup.tones.iter().map(|tone| setup.plate.frequency_for_boundary_hz(tone.position_m)).collect();
    assert_eq!(acknowledged.len(), wanted.len(), "{acknowledged:?} sounds, {wanted:?} is on the screen");
    for (acknowledged, wanted) in acknowledged.iter().zip(&wanted) {
        assert!(
            (acknowledged / wanted - 1.0).abs() < 1e-3,
            "{acknowledged} Hz sounds, {wanted} Hz is on the screen"
        );
    }
}

/// A driven membrane with a second tone.
fn two_tones() -> Session {
    let mut session = Session::driving();
    session.edit(&Edit::Add { position_m: 0.12 });
    session.pass(300);
    session
}

/// Moves the second tone to this place, in millimetres.
fn move_second(session: &mut Session, mm: f64) {
    let slot = session.instrument.desk.setup().tones[1].slot;
    session.edit(&Edit::Move { slot, position_m: mm * 1e-3 });
}

#[test]
fn a_setup_that_is_opened_or_taken_back_sounds_also_on_the_same_plate() {
    let mut session = Session::driving();
    session.move_to(100.0);
    session.pass(200);
    let opened = session.instrument.desk.setup().clone();
    session.move_to(250.0);
    session.pass(200);
    assert_screen_sounds(&session);
    session.edit(&Edit::Replace(Box::new(opened)));
    session.pass(1500);
    assert!((session.line_mm() - 100.0).abs() < 0.01);
    assert_screen_sounds(&session);
    session.instrument.undo();
    session.pass(1500);
    assert!((session.line_mm() - 250.0).abs() < 0.01);
    assert_screen_sounds(&session);
}

#[test]
fn a_tone_that_is_added_can_be_dragged_anywhere() {
    let mut session = two_tones();
    for mm in [80.0, 103.0, 150.0, 200.0, 280.0] {
        move_second(&mut session, mm);
        session.pass(200);
        assert!(session.instrument.out.notices().all(|notice| !notice.is_error), "{mm} mm");
        assert_screen_sounds(&session);
    }
}

#[test]
fn a_glide_that_would_be_too_loud_on_its_way_goes_by_rest() {
    let mut session = two_tones();
    // Two tones at the place of the smallest gain, then at the place of the largest, each time at the highest
    // level that fits.
    let [least, most] = extremes(&session);
    let fits_db = |gain: f64| -20.0 * (2.0 * gain).log10() - 0.1;
    for (place_m, gain) in [least, most] {
        let mut setup = session.instrument.desk.setup().clone();
        setup.master_db = fits_db(gain);
        for tone in &mut setup.tones {
            tone.position_m = place_m;
            tone.level = 1.0;
        }
        session.edit(&Edit::Replace(Box::new(setup)));
        session.pass(2500);
        assert!(session.is_driving());
        assert_screen_sounds(&session);
    }
}

#[test]
fn a_drive_that_is_refused_for_another_reason_leaves_what_sounds_as_it_is() {
    let mut session = two_tones();
    session.take_requests();
    session.worker.borrow().refuse_drives(Some(Refusal::SlotTwice { slot: 3 }));
    move_second(&mut session, 150.0);
    session.pass(500);
    let sent = session.take_requests();
    assert!(!sent.iter().any(|request| matches!(request, Request::Stop)), "{sent:?}");
    assert!(session.is_driving());
    let notice = session.notice();
    assert!(notice.contains("Refused: tone slot 3 is named twice"), "{notice}");

    // Too loud on its way: rest helps.
    session.worker.borrow().refuse_drives(Some(Refusal::Headroom { sum_per_mille: 1200 }));
    move_second(&mut session, 160.0);
    session.pass(500);
    assert!(session.take_requests().iter().any(|request| matches!(request, Request::Stop)));
}

/// A stopped session with another plate, whose table is not made yet.
fn stopped_before_another_plate() -> Session {
    let mut session = Session::driving();
    session.instrument.press_stop();
    session.pass(500);
    session.change_plate(slipline_plate::preset("al-bending").unwrap());
    session
}

#[test]
fn drive_after_another_plate_was_opened_at_rest_is_sent_once() {
    let mut session = stopped_before_another_plate();
    session.pass(2000);
    assert!(!session.is_driving(), "a stop holds over another plate");
    session.take_requests();
    session.instrument.start();
    session.pass(1500);
    assert_screen_sounds(&session);
    assert_eq!(drives(&session.take_requests()).len(), 1);
}

#[test]
fn drive_while_a_table_is_on_its_way_is_sent_once_the_device_holds_it() {
    let mut session = stopped_before_another_plate();
    session.take_requests();
    session.instrument.start();
    session.pass(2500);
    assert_screen_sounds(&session);
    assert_eq!(drives(&session.take_requests()).len(), 1);
}

/// The places of the table's smallest and largest gain: place in metres and gain.
fn extremes(session: &Session) -> [(f64, f64); 2] {
    let plate = &session.instrument.desk.setup().plate;
    let (table, _) = slipline_model::field::simulation::table_for(plate, 400_000).expect("a table");
    let places = (80..=280).map(|mm| 1e-3 * f64::from(mm)).map(|place_m| (place_m, table.gain(place_m)));
    let least = places.clone().min_by(|a, b| a.1.total_cmp(&b.1)).expect("places");
    let most = places.max_by(|a, b| a.1.total_cmp(&b.1)).expect("places");
    [least, most]
}
