//! The controls of a measurement with the connected device, on its page and in the calibration. What is sent and kept,
//! and what ends it: the tests of the instrument.

use crate::measure::open_measure;
use crate::sensors::Half;
use crate::test_app::TestApp;
use crate::type_into;
use eframe::egui::{Key, accesskit::Role, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use slipline_instrument::bench::Bench;
use slipline_link::{Request, Sounding};

/// How much is measured, in words.
fn progress(app: &TestApp) -> Option<String> {
    let bars = app.window.query_all_by_role(Role::ProgressIndicator);
    let labels = bars.filter_map(|bar| bar.accesskit_node().label());
    labels.into_iter().find(|label| label.starts_with("Measured: "))
}

/// Waits until nothing is measured any more.
pub(crate) fn wait_for_the_end(app: &mut TestApp) {
    for _ in 0..400 {
        app.wait(100);
        if !app.has("Cancel measuring") {
            return;
        }
    }
    panic!("it never ends: {:?}", app.snapshot().record.log);
}

/// The page of measurements, with a simulated plate that nobody knows.
pub(crate) fn on_a_secret_plate() -> TestApp {
    let bench = Bench::default();
    let mut app = TestApp::sensed(bench.inputs(), bench);
    open_measure(&mut app);
    app.click("Hidden test plate (its numbers differ)", 200);
    app
}

#[test]
fn the_page_measures_cancels_shows_how_far_it_is_and_lists_the_run() {
    let mut app = TestApp::sensed(Box::new(Half(1)), Bench::default());
    open_measure(&mut app);
    type_into(&mut app, "Sensor at", "900 mm");
    assert!(app.shows("320 mm"));
    type_into(&mut app, "Sensor at", "30 mm");
    type_into(&mut app, "Level", "2");
    assert!(app.shows("level"));
    let level = app.window.get_by_role_and_label(Role::TextInput, "Level").value();
    assert_eq!(level.as_deref(), Some("2"), "it stays to be corrected");
    app.click_button("Measure now", 200);
    assert!(app.has("STOP"));
    app.wait(500);
    app.click_button("Cancel measuring", 200);
    app.wait(500);
    assert!(!app.has("Cancel measuring") && !app.shows("run 1"));
    app.click_button("Measure now", 200);
    app.wait(1500);
    let share = progress(&app).unwrap();
    assert!(share != "Measured: 0 %" && share != "Measured: 100 %", "{share}");
    wait_for_the_end(&mut app);
    assert!(app.has("30.0 mm, run 1"));
    assert!(app.shows("60 from ") && app.shows("acceleration") && app.shows("Measured differs"));
}

#[test]
fn a_measurement_is_seen_from_every_page_and_cancelled_there() {
    let mut app = TestApp::sensed(Box::new(Half(1)), Bench::default());
    // The chip of a narrower window has no room for the progress.
    app.resize(vec2(1280.0, 800.0), 200);
    open_measure(&mut app);
    app.click_button("Measure now", 200);
    app.wait(1500);
    let line = crate::line_rect(&app);
    for page in ["Boundary", "Tones", "Device"] {
        app.click_button(page, 100);
        let mut states = app.window.query_all_by_label_contains("State: ");
        let state = states.next().expect("the chip");
        let words = state.accesskit_node().value().expect("its words");
        assert!(
            words.contains("measuring: ") && words.contains(" %, ") && words.ends_with(" s left"),
            "{page}: {words}"
        );
        assert!(app.shows("being measured") && is_painted(&app, "Measuring: "), "{page}");
        assert!(!app.has("Drive") && !is_painted(&app, "drives the plate"), "{page}");
    }
    let mut counts: Vec<String> = Vec::new();
    for plot in ["Drive waveform", "Spectrum", "Finger trace"] {
        app.click_button(plot, 100);
        app.wait(1000);
        let words = crate::plots::words(app.window.output());
        let so_far = words.iter().find(|(words, _)| words.contains("model: line"));
        counts.push(so_far.unwrap_or_else(|| panic!("{plot}: {words:?}")).0.clone());
    }
    assert_ne!(counts[0], counts[2], "the answers appear as they come");
    // The line stays where it is, by pointer and by keys.
    app.window.drag_at(line.center());
    app.release(line.center() + vec2(-60.0, 0.0), 300);
    app.key(Key::ArrowRight, 200);
    assert_eq!(crate::line_rect(&app), line);
    app.click_button("Cancel measuring", 300);
    app.wait(500);
    assert!(app.has("Drive") && !is_painted(&app, "Measuring: "));
}

/// Whether these words are painted: the status line is no label.
fn is_painted(app: &TestApp, part: &str) -> bool {
    crate::plots::words(app.window.output()).iter().any(|(words, _)| words.contains(part))
}

#[test]
fn while_it_is_measured_nothing_moves_under_a_pointer_that_presses_twice() {
    let mut app = TestApp::sensed(Box::new(Half(2)), Bench::default());
    crate::calibrate::open_calibration(&mut app);
    app.click_button("Next", 200);
    app.click_button("Next", 200);
    let is_disabled = |app: &TestApp, name: &str| {
        app.window.get_by_role_and_label(Role::Button, name).accesskit_node().is_disabled()
    };
    app.click_button("Measure now", 200);
    assert!(is_disabled(&app, "Next"));
    wait_for_the_end(&mut app);
    let place = app.window.get_by_role_and_label(Role::TextInput, "Sensor at").value().unwrap();
    assert!(!is_disabled(&app, "Next") && app.shows(&format!("{place}, run 1 at {place}")));
    app.click_button("Next", 200);
    let at = |app: &TestApp, name: &str| app.window.get_by_role_and_label(Role::Button, name).rect();
    let before = ["Measure now", "Open file…", "Next", "Back", "Cancel"].map(|name| at(&app, name));
    let level = app.window.get_by_role_and_label(Role::TextInput, "Level");
    assert!(level.accesskit_node().is_disabled(), "it stays as it was at the first place");
    app.click_button("Measure now", 200);
    assert_eq!(["Measure now", "Open file…", "Next", "Back", "Cancel"].map(|name| at(&app, name)), before);
    for name in ["Measure now", "Next"] {
        assert!(is_disabled(&app, name), "{name}");
    }
    wait_for_the_end(&mut app);
}

#[test]
fn a_tap_on_the_simulated_plate_is_seen_by_its_sensor() {
    let bench = Bench::default();
    let mut app = TestApp::sensed(bench.inputs(), bench);
    app.key(Key::Space, 500);
    crate::calibrate::open_calibration(&mut app);
    app.click_button("Next", 200);
    app.wait(2500);
    let level_db = |app: &TestApp| -> f64 {
        let node = app.window.query_all_by_label_contains("The sensor now:").next().unwrap();
        let text = node.accesskit_node().label().or_else(|| node.accesskit_node().value()).unwrap();
        let number = text.split(": ").nth(1).and_then(|rest| rest.split(' ').next());
        number.and_then(|number| number.replace('\u{2212}', "-").parse().ok()).unwrap_or(-99.0)
    };
    assert!(app.shows("dB of full scale. Tap the plate"));
    let quiet = level_db(&app);
    app.click_button("Tap the simulated plate", 200);
    app.wait(200);
    let tapped = level_db(&app);
    assert!(tapped > quiet + 10.0, "{quiet} {tapped}");
}

#[test]
fn harmonics_are_measured_on_the_page_and_cancelled_beside_the_level() {
    let bench = Bench::default();
    let mut app = TestApp::sensed(bench.inputs(), bench);
    assert!(!app.has("Cancel harmonics"), "the plate states none");
    open_measure(&mut app);
    app.click_button("Measure harmonics", 200);
    for _ in 0..400 {
        app.wait(100);
        if app.shows("Second harmonic: ") {
            break;
        }
    }
    assert!(app.shows("Undo takes it back"));
    app.click_button("Drive", 1500);
    app.click_button("Boundary", 200);
    app.take_sent();
    app.click_button("Cancel harmonics", 500);
    let requests = app.take_sent();
    assert!(requests.iter().any(|it| matches!(it, Request::Play(Sounding::Comb(_)))), "{requests:?}");
    assert!(app.is_driving());
}
