//! The stage alone: no menus, STOP as everywhere; scenes in turn for visitors, one plate in a frame of another page.

use crate::test_app::TestApp;
use crate::{boundary_mm, line_rect};
use eframe::egui::{Key, Modifiers, Theme, accesskit::Role, vec2};
use egui_kittest::HarnessBuilder;
use egui_kittest::kittest::Queryable as _;
use slipline_link::protocol::event::State;
use slipline_model::scenes::SCENES;
use slipline_window::settings::ThemeChoice;

fn opened(size: [f32; 2]) -> TestApp {
    let builder = HarnessBuilder::default().with_size(size).with_theme(Theme::Dark);
    let mut app = TestApp::first_start(ThemeChoice::Dark, builder);
    app.window.state_mut().open_to_visitors();
    app.wait(1500);
    app
}

/// Lets this many seconds pass in one frame of the window.
fn pass(app: &mut TestApp, seconds: f64) {
    let now_s = app.window.ctx.input(|input| input.time);
    app.window.input_mut().time = Some(now_s + seconds);
    app.wait(50);
    app.window.input_mut().time = None;
    app.wait(1500);
}

fn plate_name(app: &TestApp) -> String {
    app.window.state().setup().plate.name().to_owned()
}

#[test]
fn visitors_have_the_stage_and_stop_and_neither_menus_nor_pages() {
    for size in [[1280.0, 800.0], [800.0, 480.0]] {
        let mut app = opened(size);
        for name in ["File", "Edit", "View", "Help", "Boundary position", "Log", "Play"] {
            assert!(!app.has(name), "{name}");
        }
        assert!(app.has(SCENES[0].name) && app.is_driving());
        let (before, line) = (boundary_mm(&app), line_rect(&app).center());
        app.grab(line, 0);
        app.hover(line - vec2(40.0, 0.0), 100);
        app.release(line - vec2(40.0, 0.0), 100);
        assert!(boundary_mm(&app) < before, "the line is dragged");
        // No key opens a page, menu or dialog.
        for (modifiers, key) in [
            (Modifiers::NONE, Key::F1),
            (Modifiers::COMMAND, Key::Num0),
            (Modifiers::COMMAND, Key::Num4),
            (Modifiers::COMMAND, Key::O),
        ] {
            app.keys(modifiers, key, 100);
            assert!(!app.has("Tones") && !app.has("Shortcuts"));
        }
        app.click("STOP", 600);
        assert!(!app.is_driving());
    }
}

#[test]
fn the_next_scene_comes_without_a_touch_and_drives_again_after_a_stop() {
    let mut app = opened([1280.0, 800.0]);
    let first = plate_name(&app);
    pass(&mut app, 30.0);
    assert_eq!(plate_name(&app), first);
    app.key(Key::Space, 600);
    assert!(!app.is_driving());
    pass(&mut app, 30.0);
    assert_eq!(plate_name(&app), first, "counted from the latest input");
    pass(&mut app, 20.0);
    let scene = SCENES[1].setup().unwrap();
    assert_eq!(plate_name(&app), scene.plate.name());
    app.until("driving", TestApp::is_driving);
    assert!(app.window.query_by_role_and_label(Role::Slider, "Finger").is_some());
    assert!(app.speaker.played.borrow().0.is_silent());
    assert_eq!(app.snapshot().drive.status.unwrap().state, State::Driving);
}

#[test]
fn the_demonstration_attracts_visitors_until_one_comes_and_again_with_the_next_scene() {
    let mut app = opened([1280.0, 800.0]);
    let is_shown = |app: &TestApp| app.window.state().is_demonstrating();
    assert!(is_shown(&app));
    let before = boundary_mm(&app);
    let mut farthest = 0.0_f64;
    // Once more than it lasts, in the harness's frames.
    for _ in 0..700 {
        app.wait(50);
        farthest = farthest.max((boundary_mm(&app) - before).abs());
    }
    assert!(farthest > 5.0 && is_shown(&app), "{farthest}: it begins again");
    app.click("STOP", 100);
    assert!(!is_shown(&app) && boundary_mm(&app) == before, "{} {before}", boundary_mm(&app));
    pass(&mut app, 50.0);
    assert_eq!(plate_name(&app), SCENES[1].setup().unwrap().plate.name());
    assert!(is_shown(&app));
}

#[test]
fn a_frame_of_another_page_shows_plate_and_line_alone_with_state_and_stop() {
    // The last is 400 x 300 pixels: a low window is shown smaller.
    for size in [[800.0, 500.0], [711.0, 400.0], [571.0, 428.0]] {
        let builder = HarnessBuilder::default().with_size(size).with_theme(Theme::Light);
        let mut app = TestApp::first_start(ThemeChoice::Light, builder);
        app.window.state_mut().open_in_frame();
        app.wait(500);
        for name in ["File", "Edit", "View", "Help", "Boundary position", "Log", "Play"] {
            assert!(!app.has(name), "{size:?}: {name}");
        }
        for (modifiers, key) in [(Modifiers::NONE, Key::F1), (Modifiers::COMMAND, Key::Num2)] {
            app.keys(modifiers, key, 100);
            assert!(!app.has("Shortcuts") && !app.has("Add tone"));
        }
        let plate = plate_name(&app);
        assert!(app.is_driving() && app.has("State: driving"), "{size:?}");
        let whole = app.window.ctx.content_rect();
        for name in ["STOP", "State: driving"] {
            let rect = app.window.get_by_label(name).rect();
            assert!(whole.contains_rect(rect), "{size:?}, {name}: {rect}");
        }
        let (before, line) = (boundary_mm(&app), line_rect(&app));
        assert!(whole.contains_rect(line) && line.height() >= 100.0, "{size:?}: {line}");
        app.drag(line.center(), line.center() - vec2(30.0, 0.0));
        assert!(boundary_mm(&app) < before, "{size:?}: the line is dragged");
        // No scene comes by itself.
        pass(&mut app, 100.0);
        assert_eq!(plate_name(&app), plate);
        app.click("STOP", 600);
        assert!(!app.is_driving());
        app.click("Drive", 600);
        assert!(app.is_driving(), "{size:?}");
    }
}
