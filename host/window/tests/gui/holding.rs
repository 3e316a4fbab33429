//! The level hold's controls: its switch, its largest rise, and what they say. What a hold sends and what ends it: the
//! tests of the instrument.

use crate::exports::file_menu;
use crate::plots::words;
use crate::sensors::Partial;
use crate::test_app::TestApp;
use crate::type_into;
use eframe::egui::accesskit::{Role, Toggled};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use slipline_instrument::bench::Bench;
use std::sync::Arc;
use std::sync::atomic::{AtomicU16, Ordering};

/// The app on a device with a sensor, driving; and what the sensor shows of the drive.
pub(crate) fn sensed() -> (TestApp, Arc<AtomicU16>) {
    let (sensor, shows) = Partial::free();
    (TestApp::sensed(Box::new(sensor), Bench::default()), shows)
}

fn press_switch(app: &mut TestApp) {
    let switch = app.window.get_by_role_and_label(Role::CheckBox, "Hold the level");
    switch.scroll_to_me();
    app.wait(400);
    app.window.get_by_role_and_label(Role::CheckBox, "Hold the level").click();
    app.wait(100);
}

fn is_on(app: &TestApp) -> bool {
    let switch = app.window.get_by_role_and_label(Role::CheckBox, "Hold the level");
    switch.accesskit_node().toggled() == Some(Toggled::True)
}

fn wait_for(app: &mut TestApp, part: &str) {
    for _ in 0..80 {
        if app.shows(part) {
            return;
        }
        app.wait(50);
    }
    panic!("never: {part}: {:?}", app.snapshot().record.log);
}

#[test]
fn the_holds_switch_is_offered_by_a_device_that_can_listen_and_held_tones_are_shown() {
    assert!(!TestApp::driving().shows("Hold the level"));
    let (mut app, shows) = sensed();
    assert!(!is_on(&app) && !app.shows("Listening") && !app.shows("Holding"));
    type_into(&mut app, "Level", "0.2");
    press_switch(&mut app);
    wait_for(&mut app, "Listening for ");
    assert!(app.shows("leave the plate untouched") && is_on(&app));
    wait_for(&mut app, "Holding: the plate may be touched.");
    type_into(&mut app, "Rise", "61 dB");
    assert!(app.shows("0 to 20 dB"));
    type_into(&mut app, "Rise", "3 dB");
    wait_for(&mut app, "Holding: the plate may be touched.");
    shows.store(Partial::TOUCHED, Ordering::Relaxed);
    wait_for(&mut app, "Holding, at a limit.");
    assert!(app.shows("Hz: +3.0 dB, at the largest rise that is allowed"));
    // Codes that the mirror does not know are neither drawn nor saved.
    assert!(words(app.window.output()).iter().any(|(text, _)| text == "not known while levels are held"));
    file_menu(&mut app, "Export drive (WAV)…");
    let notice = app.window.state().notice().map(|notice| notice.text.clone()).unwrap_or_default();
    assert!(notice.contains("it held levels"), "{notice}");
    assert!(app.files.saved.borrow().is_empty());
    assert!(app.shows("those of the drive's own levels"));
    press_switch(&mut app);
    app.wait(300);
    assert!(!is_on(&app) && !app.shows("Holding") && !app.shows(" dB, at the largest rise"));
    assert!(app.is_driving());
}
