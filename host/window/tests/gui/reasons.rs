//! A value that is not taken has its reason under its field, and moves nothing beside it.

use crate::bench::Bench;
use crate::type_into;
use eframe::egui::{Key, Modifiers, Rect, accesskit::Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};

fn rect(bench: &Bench, role: Role, name: &str) -> Rect {
    bench.window.get_by_role_and_label(role, name).rect()
}

/// Where the plate's line is, and how wide the panel at the side: neither may change.
fn outside(bench: &Bench) -> [Rect; 2] {
    [rect(bench, Role::Slider, "Boundary"), rect(bench, Role::Button, "Tones")]
}

#[test]
fn a_bad_place_leaves_the_frequency_where_it_is() {
    let mut bench = Bench::driving();
    let beside = |bench: &Bench| {
        let below = bench.window.get_by_label("Peak at").rect();
        (rect(bench, Role::TextInput, "Boundary frequency"), below, outside(bench))
    };
    let before = beside(&bench);
    let panel = rect(&bench, Role::Button, "Device").right();
    for (text, reason) in [
        ("1e30", "outside"),
        ("1 Hz", "cannot enter"),
        ("abcdefghijklmnopqrstuvwxyzabcdefghijklmnopqrstuvwxyz", "does not begin"),
    ] {
        type_into(&mut bench, "Boundary position", text);
        bench.wait(100);
        let field = rect(&bench, Role::TextInput, "Boundary position");
        let reason = bench.window.get_by_label_contains(reason).rect();
        assert!(reason.left() >= field.left() && reason.right() <= panel, "{text}: {reason}");
        assert!(reason.top() >= field.bottom() && reason.bottom() <= before.1.top(), "{text}: {reason}");
        assert_eq!(beside(&bench), before, "{text}");
    }
    type_into(&mut bench, "Boundary position", "abc");
    let told = bench.window.get_by_label_contains("does not begin");
    let told = told.accesskit_node().value().or(told.accesskit_node().label()).unwrap();
    assert!(told.ends_with("Type 80 to 280 mm, or 86.8 Hz to 218.8 Hz."), "{told}");
}

#[test]
fn a_bad_place_of_a_tone_leaves_its_row_and_the_plate_as_they_are() {
    let mut bench = Bench::driving();
    bench.window.get_by_label("Tones").click();
    bench.wait(100);
    let remove = |bench: &Bench| rect(bench, Role::Button, "Remove tone 1");
    let before = (remove(&bench).x_range(), outside(&bench));
    type_into(&mut bench, "Position of tone 1", "abc");
    bench.wait(100);
    assert!(bench.window.query_by_label_contains("does not begin").is_some());
    assert_eq!((remove(&bench).x_range(), outside(&bench)), before);
}

#[test]
fn a_bad_number_of_the_plate_leaves_the_panel_as_wide_as_it_is() {
    let mut bench = Bench::driving();
    bench.window.get_by_label("Plate").click();
    bench.wait(100);
    let before = outside(&bench);
    for name in ["Wave speed", "Loss factor"] {
        type_into(&mut bench, name, "1e300");
        bench.wait(100);
        assert_eq!(outside(&bench), before, "{name}");
    }
}

#[test]
fn a_refused_value_goes_when_undo_changes_what_it_was_typed_over() {
    let mut bench = Bench::driving();
    let value = |bench: &Bench| {
        bench.window.get_by_role_and_label(Role::TextInput, "Boundary position").value().unwrap()
    };
    type_into(&mut bench, "Boundary position", "120 mm");
    type_into(&mut bench, "Boundary position", "900 mm");
    assert_eq!(value(&bench), "900 mm");
    assert!(bench.window.query_by_label_contains("outside 80").is_some());
    bench.window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    bench.wait(100);
    assert_eq!(value(&bench), "180.0 mm");
    assert!(bench.window.query_by_label_contains("outside 80").is_none());
}

#[test]
fn a_bad_number_of_the_plate_is_told_in_the_words_of_the_panel() {
    let mut bench = Bench::driving();
    bench.window.get_by_label("Plate").click();
    bench.wait(100);
    for (field, bad, reason) in [
        ("Length", "11 m", "Length 11000 mm: must be 5 to 10000 mm"),
        ("Span to", "1 m", "Span to 1000 mm: must be 80.32 to 320 mm"),
        ("Wave speed", "0,01 m/s", "Wave speed 0.01 m/s: must be 0.1 to 20000 m/s"),
        ("Loss factor", "7", "Loss factor 7: must be 0 to 0.5"),
        ("At full scale", "1 m", "At full scale 1000 mm: must be 0.000001 to 100 mm"),
    ] {
        type_into(&mut bench, field, bad);
        bench.wait(100);
        assert!(bench.window.query_by_label(reason).is_some(), "{field}: {reason}");
    }
}
