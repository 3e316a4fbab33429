//! The device plays the setup on the screen, whichever command or edit has set it.

use crate::background::open_plate;
use crate::test_app::TestApp;
use crate::{add_tone, boundary_mm, type_into};
use eframe::egui::{Key, Modifiers, accesskit::Role};
use egui_kittest::kittest::Queryable as _;
use slipline_link::Request;
use slipline_link::protocol::Refusal;
use slipline_model::sounding::sounding;

/// Frequencies that the device has acknowledged, in Hz, in the order of their tones.
fn sounding_hz(app: &TestApp) -> Vec<f64> {
    let acknowledged = sounding(&app.snapshot()).expect("something sounds");
    acknowledged.tones.iter().map(|tone| tone.frequency_hz).collect()
}

/// Frequencies that the screen's setup asks for.
fn wanted_hz(app: &TestApp) -> Vec<f64> {
    let setup = app.window.state().setup();
    setup.tones.iter().map(|tone| setup.plate.frequency_for_boundary_hz(tone.position_m)).collect()
}

fn assert_screen_sounds(app: &TestApp) {
    let (acknowledged, wanted) = (sounding_hz(app), wanted_hz(app));
    assert_eq!(acknowledged.len(), wanted.len(), "{acknowledged:?} sounds, {wanted:?} is on the screen");
    for (acknowledged, wanted) in acknowledged.iter().zip(&wanted) {
        assert!(
            (acknowledged / wanted - 1.0).abs() < 1e-3,
            "{acknowledged} Hz sounds, {wanted} Hz is on the screen"
        );
    }
}

#[test]
fn a_setup_that_is_opened_or_taken_back_sounds_also_on_the_same_plate() {
    let mut app = TestApp::driving();
    type_into(&mut app, "Boundary position", "100 mm");
    app.wait(200);
    let text = app.setup_text();
    type_into(&mut app, "Boundary position", "250 mm");
    app.wait(200);
    assert_screen_sounds(&app);
    open_plate(&mut app, text);
    app.wait(1500);
    assert!((boundary_mm(&app) - 100.0).abs() < 0.01);
    assert_screen_sounds(&app);
    app.window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    app.wait(1500);
    assert!((boundary_mm(&app) - 250.0).abs() < 0.01);
    assert_screen_sounds(&app);
}

#[test]
fn a_tone_that_is_added_can_be_dragged_anywhere() {
    let mut app = TestApp::driving();
    add_tone(&mut app);
    for place in ["80 mm", "103 mm", "150 mm", "200 mm", "280 mm"] {
        type_into(&mut app, "Position of tone 2", place);
        app.wait(200);
        assert!(app.window.state().notice().is_none_or(|notice| !notice.is_error), "{place}");
        assert_screen_sounds(&app);
    }
}

#[test]
fn a_glide_that_would_be_too_loud_on_its_way_goes_by_rest() {
    let mut app = TestApp::driving();
    add_tone(&mut app);
    // Two tones at the place of the smallest gain, then at the place of the largest, each time at the highest
    // level that fits.
    let [least, most] = extremes(&app);
    let text = |app: &TestApp, master: f64, place_mm: f64| {
        let mut setup = app.window.state().setup().clone();
        setup.master_db = master;
        for tone in &mut setup.tones {
            tone.position_m = place_mm * 1e-3;
            tone.level = 1.0;
        }
        slipline_model::setup::file::write(&setup)
    };
    let fits_db = |gain: f64| -20.0 * (2.0 * gain).log10() - 0.1;
    let next = text(&app, fits_db(least.1), least.0);
    open_plate(&mut app, next);
    app.wait(1500);
    assert_screen_sounds(&app);
    let next = text(&app, fits_db(most.1), most.0);
    open_plate(&mut app, next);
    app.wait(2500);
    assert!(app.is_driving());
    assert_screen_sounds(&app);
}

#[test]
fn a_drive_that_is_refused_for_another_reason_leaves_what_sounds_as_it_is() {
    let mut app = TestApp::driving();
    add_tone(&mut app);
    app.wait(300);
    app.take_sent();
    app.refuse_drives(Some(Refusal::SlotTwice { slot: 3 }));
    type_into(&mut app, "Position of tone 2", "150 mm");
    app.wait(500);
    let sent = app.take_sent();
    assert!(!sent.iter().any(|request| matches!(request, Request::Stop)), "{sent:?}");
    assert!(app.is_driving());
    let notice = app.window.state().notice().expect("a notice").text.clone();
    assert!(notice.contains("Refused: tone slot 3 is named twice"), "{notice}");

    // Too loud on its way: rest helps.
    app.refuse_drives(Some(Refusal::Headroom { sum_per_mille: 1200 }));
    type_into(&mut app, "Position of tone 2", "160 mm");
    app.wait(500);
    assert!(app.take_sent().iter().any(|request| matches!(request, Request::Stop)));
}

/// A stopped app that has opened another plate, whose table is not made yet.
fn stopped_before_another_plate() -> TestApp {
    let mut app = TestApp::driving();
    app.window.key_press(Key::Space);
    app.wait(500);
    open_plate(&mut app, slipline_plate::preset("al-bending").unwrap().to_toml());
    app
}

#[test]
fn drive_after_another_plate_was_opened_at_rest_is_sent_once() {
    let mut app = stopped_before_another_plate();
    app.wait(2000);
    assert!(!app.is_driving(), "a stop holds over another plate");
    app.take_sent();
    app.window.get_by_role_and_label(Role::Button, "Drive").click();
    app.wait(1500);
    assert_screen_sounds(&app);
    assert_eq!(crate::drives(&app.take_sent()).len(), 1);
}

#[test]
fn drive_while_a_table_is_on_its_way_is_sent_once_the_device_holds_it() {
    let mut app = stopped_before_another_plate();
    app.take_sent();
    app.window.key_press_modifiers(Modifiers::COMMAND, Key::Enter);
    app.wait(2500);
    assert_screen_sounds(&app);
    assert_eq!(crate::drives(&app.take_sent()).len(), 1);
}

/// The places of the table's smallest and largest gain: place in mm and gain.
fn extremes(app: &TestApp) -> [(f64, f64); 2] {
    let plate = &app.window.state().setup().plate;
    let (table, _) = slipline_model::field::simulation::table_for(plate, 400_000).expect("a table");
    let places = (80..=280).map(|mm| (f64::from(mm), table.gain(f64::from(mm) * 1e-3)));
    let least = places.clone().min_by(|a, b| a.1.total_cmp(&b.1)).expect("places");
    let most = places.max_by(|a, b| a.1.total_cmp(&b.1)).expect("places");
    [least, most]
}
