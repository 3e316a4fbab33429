//! The page Play: two setups to compare, a recorded drag, and the time of the wave.

use crate::test_app::TestApp;
use crate::{arrow_right, boundary_mm, drives, line_rect, type_into};
use eframe::egui::{Key, Modifiers, Rect, accesskit::Role, pos2, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use slipline_link::{Request, Sounding};

fn open_play(app: &mut TestApp) {
    app.window.get_by_role_and_label(Role::Button, "Play").click();
    app.wait(100);
}

fn press(app: &mut TestApp, key: Key) {
    app.window.key_press_modifiers(Modifiers::COMMAND, key);
    app.wait(100);
}

#[test]
fn a_key_switches_between_two_setups_whose_names_are_shown_and_undo_takes_it_back() {
    let mut app = TestApp::driving();
    open_play(&mut app);
    let has = |app: &TestApp, name: &str| app.window.query_by_label(name).is_some();
    assert!(
        has(&app, "Setup A: membrane, 1 tone, turning at 180.0 mm") && has(&app, "Setup B: begins as a copy")
    );
    press(&mut app, Key::B);
    arrow_right(&mut app);
    assert!(has(&app, "Setup A: membrane, 1 tone, turning at 180.0 mm"));
    assert!(has(&app, "Setup B: membrane, 1 tone, turning at 181.0 mm"));
    app.take_sent();
    press(&mut app, Key::B);
    assert!((boundary_mm(&app) - 180.0).abs() < 1e-6);
    let sent = drives(&app.take_sent());
    assert!(sent.len() == 1 && (sent[0] - 180.0).abs() < 1e-6, "the device follows: {sent:?}");
    app.window.get_by_label_contains("Setup B: ").click();
    app.wait(100);
    assert!((boundary_mm(&app) - 181.0).abs() < 1e-6);
    press(&mut app, Key::Z);
    assert!((boundary_mm(&app) - 180.0).abs() < 1e-6);
    assert!(has(&app, "Setup B: membrane, 1 tone, turning at 181.0 mm"), "B waits again");
    press(&mut app, Key::Y);
    assert!((boundary_mm(&app) - 181.0).abs() < 1e-6);
    assert!(has(&app, "Setup A: membrane, 1 tone, turning at 180.0 mm"));
}

/// Records a drag of the line by 60 points in 12 steps; returns where it was at each.
fn record_drag(app: &mut TestApp) -> Vec<f64> {
    open_play(app);
    app.window.get_by_label("Record").click();
    app.wait(100);
    let line = line_rect(app).center();
    app.window.drag_at(line);
    app.window.step();
    let mut places = Vec::new();
    for step in 1..=12 {
        app.window.hover_at(line + vec2(5.0 * step as f32, 0.0));
        app.wait(100);
        places.push(boundary_mm(app));
    }
    app.window.drop_at(line + vec2(60.0, 0.0));
    app.wait(100);
    app.window.get_by_label("End recording").click();
    app.wait(100);
    places
}

/// The places of the boundary while the window runs for so many frames.
fn watch(app: &mut TestApp, frames: usize) -> Vec<f64> {
    (0..frames)
        .map(|_| {
            app.wait(50);
            boundary_mm(app)
        })
        .collect()
}

#[test]
fn a_recorded_drag_is_played_through_the_way_of_a_drag() {
    let mut app = TestApp::driving();
    let recorded = record_drag(&mut app);
    assert_eq!(app.window.state().recorder().recording().moves().len(), recorded.len());
    type_into(&mut app, "Speed", "1");
    app.take_sent();
    app.window.get_by_label("Play the recording").click();
    let mut seen = watch(&mut app, 40);
    seen.dedup();
    let last = *recorded.last().unwrap();
    assert!(seen.contains(&last) && seen.len() >= recorded.len() - 2, "{seen:?} {recorded:?}");
    let sent = app.take_sent();
    assert!(drives(&sent).len() >= recorded.len() - 2, "{sent:?}");
    assert!(sent.iter().all(|request| matches!(request, Request::Play(Sounding::Drive(_)))), "{sent:?}");
    assert!(app.window.query_by_label("Play the recording").is_some(), "it has ended");
    // Undo takes the whole replay back.
    press(&mut app, Key::Z);
    assert!((boundary_mm(&app) - last).abs() < 1e-9, "it began and ended there");
}

#[test]
fn a_replay_ends_with_the_drive_and_starts_none() {
    let mut app = TestApp::driving();
    record_drag(&mut app);
    app.window.get_by_label("Loop").click();
    app.wait(50);
    app.window.get_by_label("Play the recording").click();
    // Longer than the recording.
    let first = watch(&mut app, 120);
    assert!(app.window.query_by_label("End replay").is_some());
    assert!(first[60..].iter().any(|mm| (mm - first[70]).abs() > 1.0), "it goes on moving");
    app.window.key_press(Key::Escape);
    app.wait(200);
    assert!(!app.is_driving() && app.window.query_by_label("Play the recording").is_some());
    app.take_sent();
    let still = boundary_mm(&app);
    assert!(watch(&mut app, 20).iter().all(|mm| *mm == still));
    // A replay while nothing is driven moves the picture alone.
    app.window.get_by_label("Play the recording").click();
    assert!(watch(&mut app, 30).iter().any(|mm| *mm != still));
    assert!(app.take_sent().is_empty() && !app.is_driving());
    // A drive that ends by itself, such as after a stall of the window, ends the replay.
    app.window.get_by_role_and_label(Role::Button, "Drive").click();
    app.wait(300);
    assert!(app.is_driving());
    app.hang(2000);
    app.wait(300);
    assert!(!app.is_driving() && app.window.query_by_label("Play the recording").is_some());
    app.wait(300);
    assert!(!app.is_driving());
}

#[test]
fn a_hand_on_the_line_ends_the_replay() {
    let mut app = TestApp::driving();
    record_drag(&mut app);
    app.window.get_by_label("Loop").click();
    app.wait(50);
    app.window.get_by_label("Play the recording").click();
    watch(&mut app, 5);
    app.window.drag_at(line_rect(&app).center());
    app.wait(100);
    assert!(app.window.query_by_label("End replay").is_none());
    assert!(app.is_driving());
}

#[test]
fn a_recording_is_exported_and_imported_and_a_bad_one_is_refused() {
    let mut app = TestApp::driving();
    record_drag(&mut app);
    app.window.get_by_label("Export…").click();
    app.wait(100);
    let (name, bytes) = app.files.saved.borrow()[0].clone();
    let text = String::from_utf8(bytes).unwrap();
    assert!(name == "drag.csv" && text.starts_with("time_s,tone,place_m\n0.0000,1,0.18"), "{name} {text}");
    app.open("bad.csv", Ok(text.replacen("0.0000,1", "0.0000,77", 1)));
    let told = app.window.state().notice().unwrap().text.clone();
    assert!(told.contains("bad.csv was not opened") && told.contains("tone = 77: must be 1 to 16"), "{told}");
    assert_eq!(app.window.state().recorder().recording().to_csv(), text);
    app.open("two.csv", Ok("time_s,tone,place_m\n0,1,0.1\n0.5,1,99\n".replace("99", "9.9")));
    assert_eq!(app.window.state().recorder().recording().moves().len(), 2);
    app.window.get_by_label("Play the recording").click();
    app.wait(3000);
    // A place off the span is as near as the line can be.
    assert!((boundary_mm(&app) - 280.0).abs() < 1e-6);
}

#[test]
fn the_wave_is_slowed_and_shown_at_a_chosen_time() {
    let mut app = TestApp::driving_with_sheet();
    open_play(&mut app);
    assert!(app.window.query_by_label("2-D sheet, 1/200 speed").is_some());
    type_into(&mut app, "Speed", "0,5");
    assert!(app.window.query_by_label("2-D sheet, 1/400 speed").is_some());
    type_into(&mut app, "Speed", "9");
    assert!(app.window.query_by_label_contains("Speed 9: must be 0.05 to 4").is_some());
    type_into(&mut app, "Time", "3 ms");
    assert!(app.window.query_by_label("modal lines, 1/400 speed, paused").is_some());
    let time = |app: &TestApp| {
        app.window.get_by_role_and_label(Role::TextInput, "Time").accesskit_node().value().unwrap()
    };
    assert_eq!(time(&app), "3.00 ms");
    app.wait(300);
    assert_eq!(time(&app), "3.00 ms", "it stands");
    type_into(&mut app, "Time", "3 s");
    assert!(app.window.query_by_label_contains("Time 3 s: must be 0 to 14.46 ms").is_some());
    app.window.key_press(Key::P);
    app.wait(300);
    assert!(app.window.query_by_label("2-D sheet, 1/400 speed").is_some());
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
fn a_recorded_drag_has_a_time_line_under_the_axis_on_which_a_time_is_chosen() {
    let mut app = TestApp::driving();
    assert_eq!(time_line(&app), None);
    let recorded = record_drag(&mut app);
    let line = time_line(&app).unwrap();
    let strip = line_rect(&app);
    assert!(line.top() > strip.bottom() && line.width() > 400.0 && line.height() >= 24.0, "{line} {strip}");
    let last = boundary_mm(&app);
    // The places are as far apart in time as the moves were.
    let moves = app.window.state().recorder().recording().moves().to_vec();
    let length_s = moves.last().unwrap().time_s;
    let at = |share: f32| pos2(line.left() + share * line.width(), line.center().y);
    app.take_sent();
    app.window.drag_at(at(0.5));
    app.wait(100);
    let due = moves.iter().rfind(|step| step.time_s <= 0.5 * length_s + 1e-6).unwrap().place_m * 1e3;
    assert!((boundary_mm(&app) - due).abs() < 1e-6 && recorded.contains(&boundary_mm(&app)), "{due}");
    assert!((head_s(&app) / length_s - 0.5).abs() < 0.01, "{}", head_s(&app));
    app.window.hover_at(at(0.0));
    app.wait(100);
    assert!((boundary_mm(&app) - recorded[0]).abs() < 1e-6, "{} {recorded:?}", boundary_mm(&app));
    app.window.drop_at(at(0.0));
    app.wait(100);
    assert!(drives(&app.take_sent()).len() >= 2, "the plate follows, as it is driven");
    // The whole drag along it is one step.
    press(&mut app, Key::Z);
    assert!((boundary_mm(&app) - last).abs() < 1e-9);
    // A replay begins where it stands, and a press while it plays goes on from there.
    app.window.drag_at(at(0.9));
    app.wait(50);
    app.window.drop_at(at(0.9));
    app.wait(50);
    app.window.get_by_label("Play the recording").click();
    app.wait(50);
    assert!(head_s(&app) >= 0.89 * length_s, "{}", head_s(&app));
    app.window.drag_at(at(0.2));
    app.wait(50);
    app.window.drop_at(at(0.2));
    app.wait(50);
    assert!(app.window.query_by_label("End replay").is_some());
    assert!(head_s(&app) < 0.6 * length_s, "{}", head_s(&app));
    // Another page has no time line.
    app.window.get_by_role_and_label(Role::Button, "Tones").click();
    app.wait(100);
    assert_eq!(time_line(&app), None);
}

#[test]
fn the_time_line_starts_no_drive_fits_a_small_screen_and_goes_by_keys() {
    let mut app = TestApp::driving();
    app.window.set_size(vec2(640.0, 480.0));
    app.wait(100);
    open_play(&mut app);
    app.open("two.csv", Ok("time_s,tone,place_m\n0,1,0.1\n1,1,0.2\n2,1,0.25\n".to_owned()));
    app.window.key_press(Key::Space);
    app.wait(300);
    app.take_sent();
    let line = time_line(&app).unwrap();
    assert!(Rect::from_min_size(pos2(0.0, 0.0), vec2(640.0, 480.0)).contains_rect(line), "{line}");
    app.window.drag_at(line.center() + vec2(2.0, 0.0));
    app.wait(100);
    app.window.drop_at(line.center() + vec2(2.0, 0.0));
    app.wait(100);
    assert!((boundary_mm(&app) - 200.0).abs() < 1e-6, "{}", boundary_mm(&app));
    let before_s = head_s(&app);
    app.window.key_press(Key::ArrowLeft);
    app.wait(100);
    assert!((before_s - head_s(&app) - 0.04).abs() < 1e-6, "{before_s} {}", head_s(&app));
    assert!((boundary_mm(&app) - 100.0).abs() < 1e-6, "the line itself has no step: {}", boundary_mm(&app));
    assert!(app.take_sent().is_empty() && !app.is_driving());
}
