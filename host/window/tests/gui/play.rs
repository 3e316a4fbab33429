//! The page Play: two setups to compare, a recorded drag, and the time of the wave.

use crate::test_app::TestApp;
use crate::{arrow_right, boundary_mm, line_rect, type_into};
use eframe::egui::{Key, Modifiers, Rect, accesskit::Role, pos2, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};

fn open_play(app: &mut TestApp) {
    app.click_button("Play", 100);
}

fn press(app: &mut TestApp, key: Key) {
    app.keys(Modifiers::COMMAND, key, 100);
}

#[test]
fn a_key_or_a_press_switches_between_two_setups_whose_names_are_shown() {
    let mut app = TestApp::driving();
    open_play(&mut app);
    let has = |app: &TestApp, name: &str| app.has(name);
    assert!(has(&app, "Setup A: membrane, 1 tone, 138.3 Hz") && has(&app, "Setup B: copy of A"));
    press(&mut app, Key::B);
    arrow_right(&mut app);
    assert!(has(&app, "Setup A: membrane, 1 tone, 138.3 Hz"));
    assert!(has(&app, "Setup B: membrane, 1 tone, 138.9 Hz"));
    press(&mut app, Key::B);
    assert!((boundary_mm(&app) - 180.0).abs() < 1e-6);
    app.click_part("Setup B: ", 100);
    assert!((boundary_mm(&app) - 181.0).abs() < 1e-6);
}

/// Records a drag of the line by 60 points in 12 steps; returns where it was at each.
fn record_drag(app: &mut TestApp) -> Vec<f64> {
    open_play(app);
    app.click("Record", 100);
    let line = line_rect(app).center();
    app.grab(line, 0);
    let mut places = Vec::new();
    for step in 1..=12 {
        app.hover(line + vec2(5.0 * step as f32, 0.0), 100);
        places.push(boundary_mm(app));
    }
    app.release(line + vec2(60.0, 0.0), 100);
    app.click("Stop the recording", 100);
    places
}

#[test]
fn a_drag_is_recorded_played_ended_by_a_hand_exported_and_opened() {
    let mut app = TestApp::driving();
    let recorded = record_drag(&mut app);
    assert_eq!(app.window.state().recorder().recording().moves().len(), recorded.len());
    app.click("Loop", 50);
    app.click("Play the recording", 500);
    assert!(app.has("Stop the replay"));
    app.grab(line_rect(&app).center(), 100);
    assert!(!app.has("Stop the replay") && app.is_driving());
    app.window.drop_at(line_rect(&app).center());
    app.click("Export…", 100);
    let (name, bytes) = app.files.saved.borrow()[0].clone();
    let text = String::from_utf8(bytes).unwrap();
    assert_eq!(name, "drag.csv");
    assert_eq!(text, app.window.state().recorder().recording().to_csv());
    app.open("two.csv", Ok("time_s,tone,place_m\n0,1,0.1\n0.5,1,0.2\n".to_owned()));
    assert_eq!(app.window.state().recorder().recording().moves().len(), 2);
}

#[test]
fn the_wave_is_slowed_and_shown_at_a_chosen_time() {
    let mut app = TestApp::driving_with_sheet();
    open_play(&mut app);
    assert!(app.has("2-D sheet, 1/200 speed"));
    type_into(&mut app, "Speed", "0,5");
    assert!(app.has("2-D sheet, 1/400 speed"));
    type_into(&mut app, "Speed", "9");
    assert!(app.has_part("Speed 9: must be 0.05 to 4"));
    type_into(&mut app, "Time", "3 ms");
    assert!(app.has("modal lines, 1/400 speed, paused"));
    let time = |app: &TestApp| {
        app.window.get_by_role_and_label(Role::TextInput, "Time").accesskit_node().value().unwrap()
    };
    assert_eq!(time(&app), "3.00 ms");
    app.wait(300);
    assert_eq!(time(&app), "3.00 ms", "it stands");
    type_into(&mut app, "Time", "3 s");
    assert!(app.has_part("Time 3 s: must be 0 to 14.46 ms"));
    app.key(Key::P, 300);
    assert!(app.has("2-D sheet, 1/400 speed"));
    assert_ne!(time(&app), "3.00 ms");
}

fn time_line(app: &TestApp) -> Option<Rect> {
    app.window.query_by_role_and_label(Role::Slider, "Time of the recording").map(|node| node.rect())
}

/// The time at which it stands, in seconds.
fn head_s(app: &TestApp) -> f64 {
    let line = app.window.get_by_role_and_label(Role::Slider, "Time of the recording");
    line.accesskit_node().numeric_value().unwrap()
}

#[test]
fn the_time_line_of_a_recorded_drag_selects_a_time_and_leaves_the_stage_its_size() {
    let mut app = TestApp::driving();
    assert_eq!(time_line(&app), None);
    let stage = line_rect(&app).y_range();
    let recorded = record_drag(&mut app);
    let line = time_line(&app).unwrap();
    assert_eq!(line_rect(&app).y_range(), stage);
    assert!(line.width() >= 240.0 && line.height() >= 24.0, "{line}");
    let last = boundary_mm(&app);
    // The places are as far apart in time as the moves were.
    let moves = app.window.state().recorder().recording().moves().to_vec();
    let length_s = moves.last().unwrap().time_s;
    let at = |share: f32| pos2(line.left() + share * line.width(), line.center().y);
    app.grab(at(0.5), 100);
    let due = moves.iter().rfind(|step| step.time_s <= 0.5 * length_s + 1e-6).unwrap().place_m * 1e3;
    assert!((boundary_mm(&app) - due).abs() < 1e-6 && recorded.contains(&boundary_mm(&app)), "{due}");
    assert!((head_s(&app) / length_s - 0.5).abs() < 0.01, "{}", head_s(&app));
    app.hover(at(0.0), 100);
    assert!((boundary_mm(&app) - recorded[0]).abs() < 1e-6, "{} {recorded:?}", boundary_mm(&app));
    app.release(at(0.0), 100);
    // The whole drag along it is one step.
    press(&mut app, Key::Z);
    assert!((boundary_mm(&app) - last).abs() < 1e-9);
    // A press on it ends no replay.
    app.click("Play the recording", 50);
    app.grab(at(0.2), 50);
    app.release(at(0.2), 50);
    assert!(app.has("Stop the replay"));
    assert!(head_s(&app) < 0.6 * length_s, "{}", head_s(&app));
    // Another page has no time line.
    app.click_button("Tones", 100);
    assert_eq!(time_line(&app), None);
}

#[test]
fn the_time_line_fits_a_small_screen_and_follows_keys() {
    let mut app = TestApp::driving();
    app.resize(vec2(640.0, 480.0), 100);
    open_play(&mut app);
    app.open("two.csv", Ok("time_s,tone,place_m\n0,1,0.1\n1,1,0.2\n2,1,0.25\n".to_owned()));
    let line = time_line(&app).unwrap();
    assert!(Rect::from_min_size(pos2(0.0, 0.0), vec2(640.0, 480.0)).contains_rect(line), "{line}");
    app.grab(line.center() + vec2(2.0, 0.0), 100);
    app.release(line.center() + vec2(2.0, 0.0), 100);
    assert!((boundary_mm(&app) - 200.0).abs() < 1e-6, "{}", boundary_mm(&app));
    let before_s = head_s(&app);
    app.key(Key::ArrowLeft, 100);
    assert!((before_s - head_s(&app) - 0.04).abs() < 1e-6, "{before_s} {}", head_s(&app));
    assert!((boundary_mm(&app) - 100.0).abs() < 1e-6, "the line itself has no step: {}", boundary_mm(&app));
}
