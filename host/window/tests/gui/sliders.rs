//! Typing beside a slider: a value with its unit is accepted; everything else is refused with a reason, and the
//! value does not change.

use crate::test_app::TestApp;
use crate::{add_tone, type_into};
use eframe::egui::{Key, Modifiers, accesskit::Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use slipline_link::{Request, Sounding};
use slipline_model::setup::Setup;
use slipline_window::settings::ThemeChoice;

/// Level, master in dB and glide in seconds, as they are set.
fn set(app: &TestApp) -> (f64, f64, f64) {
    let setup = app.window.state().setup();
    (setup.tones[0].level, setup.master_db, setup.glide_s)
}

#[test]
fn a_value_is_typed_with_its_unit_and_comma() {
    let mut app = TestApp::driving();
    for (field, text, wanted, shown) in [
        ("Level", "50%", (0.5, 0.0, 0.02), "0.50"),
        ("Level", "80 %", (0.8, 0.0, 0.02), "0.80"),
        ("Level", "-20 dB", (0.1, 0.0, 0.02), "0.10"),
        ("Level", "0,25", (0.25, 0.0, 0.02), "0.25"),
        ("Level", "0", (0.0, 0.0, 0.02), "0.00"),
        ("Level", "1", (1.0, 0.0, 0.02), "1.00"),
        ("Master", "-6,5", (1.0, -6.5, 0.02), "-6.5 dB"),
        ("Master", "\u{2212}12,5 dB", (1.0, -12.5, 0.02), "-12.5 dB"),
        ("Master", "10 %", (1.0, -20.0, 0.02), "-20.0 dB"),
        ("Master", "-96", (1.0, -96.0, 0.02), "-96.0 dB"),
        ("Glide", "3 s", (1.0, -96.0, 3.0), "3000 ms"),
        ("Glide", "0,5s", (1.0, -96.0, 0.5), "500 ms"),
        ("Glide", "30", (1.0, -96.0, 0.03), "30 ms"),
        ("Glide", "10 s", (1.0, -96.0, 10.0), "10000 ms"),
    ] {
        type_into(&mut app, field, text);
        let (level, master, glide) = set(&app);
        let errors = [level - wanted.0, master - wanted.1, glide - wanted.2];
        assert!(errors.iter().all(|error| error.abs() < 1e-9), "{field} {text}: {errors:?}");
        let value = app.window.get_by_role_and_label(Role::TextInput, field).value();
        assert_eq!(value.as_deref(), Some(shown), "{field} {text}");
    }
}

#[test]
fn a_bad_value_changes_nothing_and_is_reported_with_the_range() {
    let mut app = TestApp::driving();
    let (levels, masters, glides) =
        ("must be 0 to 1, or 0 to 100 %", "must be -96 to 0 dB", "must be 5 ms to 10 s");
    for (field, text, reason, allowed) in [
        ("Level", "7", "Level 7: ", levels),
        ("Level", "80", "Level 80: ", levels),
        ("Level", "120 %", "Level 120 %: ", levels),
        ("Level", "-0,1", "Level -0,1: ", levels),
        ("Level", "3 dB", "Level 3 dB: ", levels),
        ("Level", "8 Hz", "Level: \"Hz\" is no unit that fits here: use % or dB; ", levels),
        ("Level", "loud", "Level: \"loud\" does not begin with a number; ", levels),
        ("Level", " ", "Level: \"\" does not begin with a number; ", levels),
        ("Level", "1e999", "Level: \"1e999\" is too large a number; ", levels),
        ("Master", "6,5", "Master 6,5: ", masters),
        ("Master", "-97 dB", "Master -97 dB: ", masters),
        ("Master", "0 %", "Master 0 %: ", masters),
        ("Master", "3 s", "Master: \"s\" is no unit that fits here: use dB or %; ", masters),
        ("Glide", "3", "Glide 3: ", glides),
        ("Glide", "11 s", "Glide 11 s: ", glides),
        ("Glide", "1 h", "Glide: \"h\" is no unit that fits here: use s, ms or min; ", glides),
    ] {
        let before = set(&app);
        app.take_sent();
        type_into(&mut app, field, text);
        app.wait(100);
        assert_eq!(set(&app), before, "{field} {text:?}");
        let sent = app.take_sent();
        assert!(
            !sent.iter().any(|request| matches!(request, Request::Play(Sounding::Drive(_)))),
            "{field} {text:?}: {sent:?}"
        );
        let told = format!("{reason}{allowed}");
        let reason = app.window.query_by_label(&told);
        assert!(reason.is_some(), "{told}");
        // The next attempt begins with the present value.
        app.window.get_by_role_and_label(Role::TextInput, field).focus();
        app.window.step();
        app.keys(Modifiers::COMMAND, Key::A, 0);
        type_into(&mut app, field, &shown(field, before));
        app.wait(100);
        assert!(!app.has(&told), "{told}");
        assert_eq!(set(&app), before, "{field}");
    }
}

/// A value as its field shows it.
fn shown(field: &str, (level, master, glide): (f64, f64, f64)) -> String {
    match field {
        "Level" => format!("{level:.2}"),
        "Master" => format!("{master:.1} dB"),
        _ => format!("{:.0} ms", glide * 1e3),
    }
}

#[test]
fn the_level_of_each_tone_has_its_own_field() {
    let mut app = TestApp::driving();
    add_tone(&mut app);
    type_into(&mut app, "Level of tone 2", "30%");
    type_into(&mut app, "Level of tone 1", "7");
    app.wait(100);
    let levels: Vec<f64> = app.window.state().setup().tones.iter().map(|tone| tone.level).collect();
    assert_eq!(levels, [0.8, 0.3]);
    let told = app.window.get_by_label_contains("Level of tone 1 7: must be 0 to 1");
    let field = app.window.get_by_role_and_label(Role::TextInput, "Level of tone 1");
    assert!(told.rect().top() >= field.rect().bottom(), "under its field");
    assert!(field.accesskit_node().value().is_some_and(|value| value == "7"), "it can be mended");
}

#[test]
fn the_box_of_the_volume_takes_units_and_a_comma_and_reports_its_range() {
    let mut app = TestApp::driving();
    crate::finger::choose(&mut app, "Light");
    for (text, wanted) in [("0,25", 0.25), ("80 %", 0.8), ("-20 dB", 0.1)] {
        type_into(&mut app, "Volume", text);
        let volume = app.window.state().settings().volume;
        assert!((volume - wanted).abs() < 1e-6, "{text}: {volume}");
    }
    for text in ["2", "7 Hz", "loud"] {
        type_into(&mut app, "Volume", text);
        assert!(app.has_part("0 to 1, or 0 to 100 %"), "{text}");
        assert!((app.window.state().settings().volume - 0.1).abs() < 1e-6, "{text}");
    }
}

#[test]
fn a_change_that_takes_longer_than_its_glide_says_how_long() {
    let plate = slipline_plate::preset("al-bending").unwrap();
    let builder = egui_kittest::HarnessBuilder::default()
        .with_size([1280.0, 800.0])
        .with_theme(eframe::egui::Theme::Light);
    let mut app = TestApp::driving_setup(Setup::new(plate.into()), ThemeChoice::Light, builder);
    let says =
        |app: &TestApp| app.window.query_all_by_label_contains("The last change takes").next().is_some();
    type_into(&mut app, "Glide", "5 ms");
    app.wait(300);
    assert!(!says(&app));
    for frequency in ["39 kHz", "22 kHz"] {
        type_into(&mut app, "Boundary frequency", frequency);
        app.wait(600);
    }
    assert!(says(&app), "{:?}", app.snapshot().drive.glide_until);
    type_into(&mut app, "Glide", "2 s");
    type_into(&mut app, "Boundary frequency", "39 kHz");
    app.wait(600);
    assert!(!says(&app));
}
