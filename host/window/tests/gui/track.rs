//! The finger of a first start: it is shown, the strip is its track, and the user hears it from the first move on.

use crate::finger::{choose, finger_mm};
use crate::test_app::TestApp;
use crate::{boundary_mm, line_rect};
use eframe::egui::{Event, Key, Modifiers, Pos2, Rect, Theme, accesskit::Role, pos2, vec2};
use egui_kittest::HarnessBuilder;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use slipline_model::scenes::SCENES;
use slipline_model::setup::file::Opened;
use slipline_window::settings::ThemeChoice;

fn first_start() -> TestApp {
    let builder = HarnessBuilder::default().with_size([1280.0, 800.0]).with_theme(Theme::Dark);
    TestApp::first_start(ThemeChoice::Dark, builder)
}

fn has_finger(app: &TestApp) -> bool {
    app.window.query_by_role_and_label(Role::Slider, "Finger").is_some()
}

/// A place on the strip, this share of the way from the driven end to the line.
fn on_track(app: &TestApp, share: f32) -> Pos2 {
    let line = line_rect(app);
    let left = app.window.get_by_label("Plate from above").rect().left();
    pos2(left + share * (line.center().x - left), line.bottom() - 12.0)
}

fn says(app: &TestApp, text: &str) -> bool {
    crate::plots::words(app.window.output()).iter().any(|(word, _)| word == text)
}

#[test]
fn the_first_scene_begins_with_a_finger_that_takes_nothing_and_makes_no_sound() {
    let builder = HarnessBuilder::default().with_size([1280.0, 800.0]).with_theme(Theme::Dark);
    let setup = slipline_window::app::first_setup().unwrap();
    let mut app = TestApp::driving_setup(setup, ThemeChoice::Dark, builder);
    assert!(has_finger(&app) && finger_mm(&app) < line_mm(&app));
    assert!(says(&app, "simulated plate") && says(&app, "predicted"), "the plate moves as without it");
    assert!(app.has_part("2-D sheet"));
    app.wait(500);
    assert!(app.speaker.played.borrow().0.is_silent());
    // Another plate begins without one.
    assert!(!has_finger(&TestApp::driving()));
}

fn line_mm(app: &TestApp) -> f64 {
    let line = app.window.get_by_role_and_label(Role::Slider, "Boundary");
    line.accesskit_node().numeric_value().unwrap()
}

#[test]
fn a_press_on_the_strip_moves_the_finger_which_follows_and_sounds() {
    let mut app = first_start();
    let (line, at) = (line_mm(&app), on_track(&app, 0.3));
    app.grab(at, 100);
    assert!((finger_mm(&app) / line - 0.3).abs() < 0.01, "{} {line}", finger_mm(&app));
    let to = on_track(&app, 0.6);
    app.hover(to, 100);
    assert!((finger_mm(&app) / line - 0.6).abs() < 0.01);
    assert!(app.speaker.loudness() > 0.0, "the user has moved it");
    app.release(to, 100);
    assert_eq!(line_mm(&app), line, "the line stays");
    // Where there is no finger, one comes.
    choose(&mut app, "None");
    assert!(!has_finger(&app));
    app.grab(at, 50);
    app.release(at, 100);
    assert!(has_finger(&app) && (finger_mm(&app) / line - 0.3).abs() < 0.01);
}

#[test]
fn the_fingers_print_is_dragged_along_its_track_also_where_it_lies_on_the_line() {
    let mut app = first_start();
    let line = line_mm(&app);
    for share in [0.5, 1.0] {
        let at = on_track(&app, share);
        app.grab(at, 50);
        app.hover(at - vec2(60.0, 0.0), 100);
        app.release(at - vec2(60.0, 0.0), 100);
        // On the line the line is taken, but not under the print.
        if share == 1.0 {
            assert!(line_mm(&app) < line, "{line}");
        } else {
            assert!(line_mm(&app) == line && finger_mm(&app) < 0.5 * line);
        }
    }
}

#[test]
fn the_sound_is_switched_beside_the_track_and_the_choice_is_kept() {
    let mut app = first_start();
    let strip = |app: &TestApp| -> Rect { app.window.get_by_label("Plate from above").rect() };
    let switch = app.window.get_by_role_and_label(Role::CheckBox, "Sound of the finger").rect();
    assert!(switch.left() >= strip(&app).right() && switch.width() >= 24.0 && switch.height() >= 24.0);
    app.grab(on_track(&app, 0.5), 100);
    let at = on_track(&app, 0.55);
    app.hover(at, 100);
    app.release(at, 100);
    assert!(app.speaker.loudness() > 0.0);
    let press = |app: &mut TestApp| {
        app.window.get_by_role_and_label(Role::CheckBox, "Sound of the finger").click();
        app.wait(100);
    };
    press(&mut app);
    assert!(app.speaker.played.borrow().0.is_silent() && !app.window.state().settings().hear_finger);
    press(&mut app);
    assert!(app.speaker.loudness() > 0.0 && app.window.state().settings().hear_finger);
}

#[test]
fn the_first_scene_lays_the_finger_down_again_and_the_others_do_not() {
    let mut app = TestApp::driving();
    let open = |app: &mut TestApp, name: &str| {
        app.click("File", 200);
        app.click_part("Scenes…", 200);
        app.click_part(name, 1500);
    };
    open(&mut app, SCENES[3].name);
    assert!(!has_finger(&app));
    open(&mut app, SCENES[0].name);
    assert!(has_finger(&app) && app.speaker.played.borrow().0.is_silent());
}

/// The very first start, as the window begins it.
fn demonstrated() -> TestApp {
    let mut app = first_start();
    app.window.state_mut().demonstrate();
    app
}

#[test]
fn the_demonstration_moves_line_and_finger_for_ten_seconds_in_silence_and_leaves_no_trace() {
    let mut app = demonstrated();
    let (before, text) = (boundary_mm(&app), app.setup_text());
    let (mut lines, mut fingers, mut crossed) = (0, 0, false);
    let mut latest = (before, finger_mm(&app));
    // 10 s in the harness's frames.
    for _ in 0..610 {
        app.wait(50);
        let now = (boundary_mm(&app), finger_mm(&app));
        lines += usize::from(now.0 != latest.0);
        fingers += usize::from(now.1 != latest.1);
        crossed |= now.1 > line_mm(&app);
        assert!(app.speaker.played.borrow().0.is_silent());
        latest = now;
    }
    assert!(lines > 60 && fingers > 200 && crossed, "{lines} {fingers} {crossed}");
    assert_eq!(app.setup_text(), text, "everything is where it was");
    app.wait(1000);
    assert_eq!((boundary_mm(&app), finger_mm(&app)), latest, "it is over");
    app.click("Edit", 200);
    assert!(
        app.window.query_by_label_contains("Undo ").is_none_or(|undo| undo.accesskit_node().is_disabled())
    );
}

/// In the middle of the demonstration's move of the line.
fn halfway() -> (TestApp, String) {
    let mut app = demonstrated();
    let text = app.setup_text();
    for _ in 0..330 {
        app.wait(50);
    }
    assert_ne!(app.setup_text(), text);
    (app, text)
}

#[test]
fn a_setup_that_is_opened_ends_the_demonstration_and_keeps_its_line() {
    let mut app = demonstrated();
    app.wait(50);
    let mut setup = app.window.state().setup().clone();
    setup.tones[0].position_m = 0.15;
    app.window.state_mut().use_opened(Opened::Setup(Box::new(setup)));
    app.wait(1000);
    assert!(!app.window.state().is_demonstrating());
    assert_eq!(boundary_mm(&app), 150.0);
}

#[test]
fn a_press_or_a_key_ends_the_demonstration_at_once_and_counts() {
    let inputs: [fn(&mut TestApp); 2] = [
        |app| app.window.key_press_modifiers(Modifiers::NONE, Key::P),
        |app| app.window.drag_at(pos2(300.0, 36.0)),
    ];
    for input in inputs {
        let (mut app, text) = halfway();
        input(&mut app);
        app.wait(100);
        assert_eq!(app.setup_text(), text);
        let finger = finger_mm(&app);
        app.wait(500);
        assert_eq!(finger_mm(&app), finger);
    }
}

#[test]
fn what_a_window_manager_does_to_a_new_window_ends_no_demonstration() {
    let (mut app, text) = halfway();
    for event in [
        Event::WindowFocused(true),
        Event::ModifiersChanged(Modifiers::NONE),
        Event::MouseMoved(vec2(30.0, 4.0)),
        Event::PointerMoved(pos2(300.0, 300.0)),
        Event::PointerMoved(pos2(700.0, 20.0)),
        Event::PointerGone,
        Event::WindowFocused(false),
        Event::Key {
            key: Key::Enter,
            physical_key: None,
            pressed: false,
            repeat: false,
            modifiers: Modifiers::NONE,
        },
    ] {
        app.window.event(event.clone());
        app.wait(50);
        assert!(app.window.state().is_demonstrating(), "{event:?}");
        assert_ne!(app.setup_text(), text, "{event:?}");
    }
    // The kept setup stays the user's meanwhile.
    assert_eq!(slipline_model::setup::file::write(&app.window.state().kept_setup()), text);
}

#[test]
fn help_shows_the_demonstration_again_and_drives_the_simulated_plate_for_it() {
    let mut app = first_start();
    app.key(Key::Space, 600);
    assert!(!app.is_driving());
    app.click("Help", 200);
    app.click_part("Show the demonstration", 100);
    app.until("driving", TestApp::is_driving);
    let (before, text) = (finger_mm(&app), app.setup_text());
    for _ in 0..100 {
        app.wait(50);
    }
    assert!(app.window.state().is_demonstrating() && finger_mm(&app) != before);
    app.keys(Modifiers::NONE, Key::P, 100);
    assert_eq!(app.setup_text(), text);
}

#[test]
fn a_start_that_is_not_the_first_and_a_real_device_get_no_demonstration() {
    let mut app = first_start();
    let (text, finger) = (app.setup_text(), finger_mm(&app));
    app.wait(3000);
    assert_eq!((app.setup_text(), finger_mm(&app)), (text, finger));
    let link = crate::real_device(slipline_link::protocol::event::State::Driving);
    let files = crate::fake_files::FakeFiles::default();
    let builder = HarnessBuilder::default().with_size([1280.0, 800.0]);
    let mut window = crate::test_app::open_window(Box::new(link), &files, ThemeChoice::Light, builder);
    window.state_mut().demonstrate();
    let before = window.state().setup().clone();
    window.run_steps(300);
    assert_eq!(window.state().setup(), &before);
    assert!(window.query_by_role_and_label(Role::Slider, "Finger").is_none());
}
