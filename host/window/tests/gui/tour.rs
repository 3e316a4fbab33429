//! The tour over the real controls, and the plate before and after a calibration by one key.

use crate::calibrate::{answers, go_through};
use crate::small_screens::{screen, small};
use crate::test_app::TestApp;
use crate::{boundary_mm, line_rect};
use eframe::egui::{Key, Modifiers, accesskit::Role, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use std::sync::Arc;

fn begin(app: &mut TestApp) {
    app.click("Help", 200);
    app.click_part("Take the tour", 200);
}

#[test]
fn help_begins_the_tour_over_the_real_controls() {
    let mut app = TestApp::driving();
    app.click("Play", 100);
    begin(&mut app);
    assert!(app.shows("Tour: the line") && app.has("1 of 6") && !app.has("Done"));
    assert!(app.has("Boundary position") && app.is_driving());
    let (line, before) = (line_rect(&app).center(), boundary_mm(&app));
    app.drag(line, line - vec2(60.0, 0.0));
    app.wait(200);
    assert!(boundary_mm(&app) < before - 5.0 && app.has("Done"));
    // What each step speaks of can be pressed at once.
    let steps: [(&str, Role, &str); 5] = [
        ("Tour: the finger", Role::Slider, "Finger"),
        ("Tour: a texture", Role::Button, "Play this"),
        ("Tour: measure", Role::Button, "Measure now"),
        ("Tour: calibrate", Role::Button, "Calibrate…"),
        ("Tour: your own plate", Role::ComboBox, "Plate: membrane"),
    ];
    for (title, role, control) in steps {
        app.click_button("Next", 300);
        assert!(app.shows(title), "{title}");
        let rect = app.window.get_by_role_and_label(role, control).rect();
        assert!(screen([1280.0, 800.0]).contains_rect(rect), "{control}: {rect}");
    }
    app.click_button("Back", 200);
    assert!(app.shows("Tour: calibrate"));
    app.click_button("Next", 200);
    app.click_button("Finish", 200);
    assert!(!app.shows("Tour: ") && app.has("Plate: membrane"));
}

#[test]
fn the_tours_card_stop_and_line_are_on_every_screen() {
    for size in [[390.0, 844.0], [640.0, 480.0], [800.0, 480.0], [1280.0, 720.0]] {
        let mut app = small(size);
        begin(&mut app);
        let screen = app.window.ctx.content_rect();
        for step in 1..=6 {
            for name in ["End tour", "Back", "STOP"] {
                let rect = app.window.get_by_label(name).rect();
                assert!(screen.contains_rect(rect), "{size:?}, step {step}, {name}: {rect}");
            }
            let line = line_rect(&app);
            assert!(screen.contains_rect(line) && line.height() >= 100.0, "{size:?}, {step}: {line}");
            let next = if step == 6 { "Finish" } else { "Next" };
            app.click_button(next, 200);
        }
        assert!(!app.has("End tour"));
    }
}

#[test]
fn b_shows_the_plate_before_a_calibration_and_after_it() {
    let mut app = TestApp::driving();
    let plate = |app: &TestApp| Arc::clone(&app.window.state().setup().plate);
    let before = plate(&app);
    app.click("Edit", 200);
    let entry = app.window.get_by_label_contains("Show before the calibration");
    assert!(entry.accesskit_node().is_disabled());
    app.click("Edit", 200);
    go_through(&mut app, &answers(1.04));
    app.click_button("Use this plate", 1500);
    let after = plate(&app);
    assert_ne!(after.spec(), before.spec());
    app.keys(Modifiers::NONE, Key::B, 1500);
    assert!(Arc::ptr_eq(&plate(&app), &before));
    assert!(app.shows("Before the calibration"), "{:?}", app.window.state().notice());
    assert!(app.is_driving(), "{:?}", app.snapshot().record.log);
    app.keys(Modifiers::NONE, Key::B, 1500);
    assert!(Arc::ptr_eq(&plate(&app), &after));
    assert!(app.shows("After the calibration"), "{:?}", app.window.state().notice());
    assert!(app.is_driving(), "{:?}", app.snapshot().record.log);
}
