//! The reason of a refused value is under its field, and moves nothing beside it.

use crate::test_app::TestApp;
use crate::type_into;
use eframe::egui::{Key, Modifiers, Rect, accesskit::Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};

fn rect(app: &TestApp, role: Role, name: &str) -> Rect {
    app.window.get_by_role_and_label(role, name).rect()
}

/// The place of the boundary line and the width of the side panel: neither may change.
fn outside(app: &TestApp) -> [Rect; 2] {
    [rect(app, Role::Slider, "Boundary"), rect(app, Role::Button, "Tones")]
}

#[test]
fn a_bad_place_leaves_the_frequency_where_it_is() {
    let mut app = TestApp::driving();
    let beside = |app: &TestApp| {
        let below = app.window.get_by_label("Peak at").rect();
        (rect(app, Role::TextInput, "Boundary frequency"), below, outside(app))
    };
    let before = beside(&app);
    let panel = rect(&app, Role::Button, "Play").right();
    for (text, reason) in [
        ("1e30", "outside 80 to 280 mm"),
        ("12 bananas", "is no unit that fits here"),
        ("1 Hz", "cannot enter this plate"),
        ("abcdefghijklmnopqrstuvwxyzabcdefghijklmnopqrstuvwxyz", "does not begin"),
    ] {
        type_into(&mut app, "Boundary position", text);
        app.wait(100);
        let field = rect(&app, Role::TextInput, "Boundary position");
        let reason = app.window.get_by_label_contains(reason).rect();
        assert!(reason.left() >= field.left() && reason.right() <= panel, "{text}: {reason}");
        assert!(reason.top() >= field.bottom() && reason.bottom() <= before.1.top(), "{text}: {reason}");
        assert_eq!(beside(&app), before, "{text}");
    }
    type_into(&mut app, "Boundary position", "abc");
    let reason = app.window.get_by_label_contains("does not begin");
    let reason = reason.accesskit_node().value().or(reason.accesskit_node().label()).unwrap();
    assert!(reason.ends_with("Type 80 to 280 mm, or 87.6 Hz to 219.0 Hz."), "{reason}");
}

#[test]
fn a_bad_place_of_a_tone_leaves_its_row_and_the_plate_as_they_are() {
    let mut app = TestApp::driving();
    app.click("Tones", 100);
    let remove = |app: &TestApp| rect(app, Role::Button, "Remove tone 1");
    let before = (remove(&app).x_range(), outside(&app));
    type_into(&mut app, "Position of tone 1", "abc");
    app.wait(100);
    assert!(app.has_part("does not begin"));
    assert_eq!((remove(&app).x_range(), outside(&app)), before);
}

#[test]
fn a_bad_number_of_the_plate_leaves_the_panel_as_wide_as_it_is() {
    let mut app = TestApp::driving();
    app.click("Plate", 100);
    let before = outside(&app);
    for name in ["Wave speed", "Loss factor"] {
        type_into(&mut app, name, "1e300");
        app.wait(100);
        assert_eq!(outside(&app), before, "{name}");
    }
}

#[test]
fn a_refused_value_goes_when_undo_changes_what_it_was_typed_over() {
    let mut app = TestApp::driving();
    let value = |app: &TestApp| {
        app.window.get_by_role_and_label(Role::TextInput, "Boundary position").value().unwrap()
    };
    type_into(&mut app, "Boundary position", "120 mm");
    type_into(&mut app, "Boundary position", "900 mm");
    assert_eq!(value(&app), "900 mm");
    assert!(app.has_part("outside 80"));
    app.keys(Modifiers::COMMAND, Key::Z, 100);
    assert_eq!(value(&app), "180.0 mm");
    assert!(!app.has_part("outside 80"));
}

#[test]
fn a_bad_number_of_the_plate_is_reported_in_the_words_of_the_panel() {
    let mut app = TestApp::driving();
    app.click("Plate", 100);
    for (field, bad, reason) in [
        ("Length", "11 m", "Length 11000 mm: must be 5 to 10000 mm"),
        ("Span to", "1 m", "Span to 1000 mm: must be 80.32 to 320 mm"),
        ("Wave speed", "0,01 m/s", "Wave speed 0.01 m/s: must be 0.1 to 20000 m/s"),
        ("Loss factor", "7", "Loss factor 7: must be 0 to 0.5"),
        ("At full scale", "1 m", "At full scale 1000 mm: must be 0.000001 to 100 mm"),
    ] {
        type_into(&mut app, field, bad);
        app.wait(100);
        assert!(app.has(reason), "{field}: {reason}");
    }
    assert!(app.window.state().setup().plate.spec().loss_factor < 0.5);
}
