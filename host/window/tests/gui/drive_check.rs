//! "Is it on?" before a measurement: its switch, the circuit that the user states, and the result with a drive that is off.

use crate::measure::open_measure;
use crate::measuring::wait_for_the_end;
use crate::real_device;
use crate::sensors::{Half, NoCurrent};
use crate::test_app::{TestApp, opened};
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable as _;
use slipline_instrument::bench::Bench;
use slipline_link::protocol::event::State;

const SWITCH: &str = "Test the drive first";

fn switch_on(app: &mut TestApp) {
    open_measure(app);
    app.window.get_by_role_and_label(Role::CheckBox, SWITCH).click();
    app.wait(100);
}

#[test]
fn the_check_is_switched_on_and_the_page_says_that_it_runs_and_what_it_found() {
    let mut app = TestApp::sensed(Box::new(NoCurrent(Half(5))), Bench::default());
    switch_on(&mut app);
    assert!(!app.has("Amplifier"), "the rig states its circuit itself");
    app.click_button("Measure now", 200);
    app.wait(500);
    assert!(app.shows("Quiet tones first") && app.shows("Cancel measuring"));
    wait_for_the_end(&mut app);
    assert!(
        app.shows("Not measured. No current flows: a wire of the drive is open"),
        "{:?}",
        app.snapshot().record.log
    );
    assert!(!app.shows("run 1") && !app.shows("Quiet tones first"));
}

#[test]
fn the_circuit_of_a_real_drive_is_typed_with_units_and_refused_beyond_its_range() {
    let mut link = real_device(State::Idle);
    std::sync::Arc::make_mut(&mut link.snapshot).link.port = None;
    let mut window = opened(link, [1280.0, 900.0]);
    for (role, name) in [(Role::Button, "Plate"), (Role::Button, "Measure"), (Role::CheckBox, SWITCH)] {
        window.get_by_role_and_label(role, name).click();
        window.run_steps(5);
    }
    let mut typed = |name: &str, text: &str| {
        window.get_by_role_and_label(Role::TextInput, name).focus();
        window.step();
        window.key_press_modifiers(Modifiers::COMMAND, Key::A);
        window.step();
        window.get_by_role_and_label(Role::TextInput, name).type_text(text);
        window.step();
        window.key_press(Key::Enter);
        window.run_steps(4);
        let value = window.get_by_role_and_label(Role::TextInput, name).value().unwrap();
        let is_refused = window.query_by_label_contains("must be").is_some();
        (value, is_refused)
    };
    assert_eq!(typed("Amplifier", "500mV"), ("500 mV".to_owned(), false));
    assert_eq!(typed("Resistance", "8"), ("8 ohm".to_owned(), false));
    assert_eq!(typed("Shunt", "0.33 A"), ("330 mA".to_owned(), false));
    assert_eq!(typed("Amplifier", "99kV"), ("99kV".to_owned(), true));
    assert_eq!(typed("Amplifier", "2 V"), ("2 V".to_owned(), false));
    window.get_by_role_and_label(Role::ComboBox, "Drive: voice coil").click();
    window.run_steps(4);
    window.get_by_label("piezo").click();
    window.run_steps(4);
    let capacitance = window.get_by_role_and_label(Role::TextInput, "Capacitance").value();
    assert_eq!(capacitance.as_deref(), Some("100 nF"));
    assert!(window.query_by_role_and_label(Role::TextInput, "Resistance").is_none());
}
