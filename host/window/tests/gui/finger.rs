//! The finger on the plate: it moves by pointer and keys, the field under it follows, and nothing of it is sent.

use crate::background::open_plate;
use crate::test_app::TestApp;
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use slipline_link::{Request, Sounding};

pub(crate) fn choose(app: &mut TestApp, name: &str) {
    app.window.get_by_role_and_label(Role::RadioButton, name).click_accesskit();
    app.wait(100);
}

/// Drags the finger by each of these steps in points, one every 50 ms, and lets it go.
pub(crate) fn drag_by(app: &mut TestApp, steps: &[f32]) {
    let mut at = app.window.get_by_role_and_label(Role::Slider, "Finger").rect().center();
    app.grab(at, 50);
    for step in steps {
        at.x += step;
        app.hover(at, 50);
    }
    app.release(at, 50);
}

pub(crate) fn finger_mm(app: &TestApp) -> f64 {
    let finger = app.window.get_by_role_and_label(Role::Slider, "Finger");
    finger.accesskit_node().numeric_value().unwrap()
}

/// The peak height that the boundary panel shows, in micrometres.
fn height(app: &TestApp) -> String {
    let texts = crate::plots::words(app.window.output());
    let (_, name) = texts.iter().find(|(text, _)| text == "Peak height").unwrap().clone();
    let beside = texts
        .iter()
        .find(|(_, at)| (at.center().y - name.center().y).abs() < 4.0 && at.left() > name.right());
    beside.unwrap().0.clone()
}

#[test]
fn a_finger_is_dragged_along_the_plate_and_the_field_follows() {
    let mut app = TestApp::driving();
    let untouched = height(&app);
    assert!(app.window.query_by_role_and_label(Role::Slider, "Finger").is_none());
    app.take_sent();
    let before = app.setup_text();
    choose(&mut app, "Firm");
    let on_peak = height(&app);
    assert_ne!(on_peak, untouched);
    assert!(app.has("modal lines, touched, 1/200 speed"));
    assert!(app.has_part("boundary line and strip stay those"));
    let finger = app.window.get_by_role_and_label(Role::Slider, "Finger").rect().center();
    let place_mm = finger_mm(&app);
    app.grab(finger, 0);
    app.hover(finger - vec2(120.0, 0.0), 50);
    assert!(finger_mm(&app) < place_mm - 40.0, "{place_mm} {}", finger_mm(&app));
    assert_ne!(height(&app), on_peak);
    app.hover(finger - vec2(2000.0, 0.0), 50);
    assert_eq!(finger_mm(&app), 0.0, "it stays on the plate");
    app.release(finger - vec2(2000.0, 0.0), 50);
    choose(&mut app, "None");
    assert_eq!(height(&app), untouched);
    assert_eq!(app.setup_text(), before, "the finger is no part of the setup");
    assert!(!app.take_sent().iter().any(|request| matches!(request, Request::Play(Sounding::Drive(_)))));
}

#[test]
fn the_keys_move_the_finger_and_not_the_boundary() {
    let mut app = TestApp::driving();
    choose(&mut app, "Light");
    let (place_mm, boundary_mm) = (finger_mm(&app), crate::boundary_mm(&app));
    app.window.get_by_role_and_label(Role::Slider, "Finger").focus();
    app.wait(50);
    app.key(Key::ArrowRight, 50);
    assert!((finger_mm(&app) - place_mm - 1.0).abs() < 1e-6);
    assert_eq!(crate::boundary_mm(&app), boundary_mm);
}

#[test]
fn the_stage_says_that_the_simulated_plate_takes_no_finger_and_omits_it() {
    let mut app = TestApp::driving_with_sheet();
    let said = |app: &TestApp, text: &str| {
        crate::plots::words(app.window.output()).iter().any(|(word, _)| word == text)
    };
    assert!(said(&app, "simulated plate") && said(&app, "predicted"));
    choose(&mut app, "Firm");
    assert!(said(&app, "simulated plate: without a finger only") && said(&app, "predicted with the finger"));
    assert!(!said(&app, "simulated plate"));
    assert!(app.has("modal lines, touched, 1/200 speed"));
    choose(&mut app, "None");
    assert!(said(&app, "simulated plate") && said(&app, "predicted"));
    assert!(app.has("2-D sheet, 1/200 speed"), "lifted, the sheet goes on");
}

#[test]
fn a_plate_that_was_opened_under_the_finger_gets_its_sheet_when_the_finger_is_lifted() {
    let mut app = TestApp::driving_with_sheet();
    choose(&mut app, "Light");
    let text = slipline_plate::preset("membrane").unwrap().to_toml();
    open_plate(&mut app, text.replace("name = \"membrane\"", "name = \"another\""));
    app.wait(1500);
    let shown = |app: &TestApp, source: &str| app.has(&format!("{source}, 1/200 speed"));
    assert!(app.is_driving() && shown(&app, "modal lines, touched"));
    let jobs = app.sheet_jobs.get();
    choose(&mut app, "None");
    assert!(shown(&app, "2-D sheet") && app.sheet_jobs.get() > jobs);
}

#[test]
fn a_firm_finger_takes_more_than_a_light_one_where_the_peak_was() {
    let mut app = TestApp::driving();
    let micrometres = |app: &TestApp| height(app).trim_end_matches(" µm").parse::<f64>().unwrap();
    let none = micrometres(&app);
    choose(&mut app, "Light");
    let light = micrometres(&app);
    choose(&mut app, "Firm");
    let firm = micrometres(&app);
    assert!(firm < 0.5 * light && light < 0.9 * none, "{none} {light} {firm}");
    assert!(
        (finger_mm(&app) - 152.1).abs() < 1.0,
        "it began at the free peak and stays: {}",
        finger_mm(&app)
    );
}

#[test]
fn a_plate_of_unknown_weight_takes_no_finger_and_says_why() {
    let mut app = TestApp::driving();
    choose(&mut app, "Firm");
    let text = slipline_plate::preset("membrane").unwrap().to_toml();
    open_plate(&mut app, text.replace("tension_n_per_m = 40.0\n", ""));
    app.wait(500);
    assert!(app.window.get_by_role_and_label(Role::RadioButton, "Firm").accesskit_node().is_disabled());
    assert!(app.has_part("Tension is missing: a finger needs it"));
    assert!(app.window.query_by_role_and_label(Role::Slider, "Finger").is_none());
}
