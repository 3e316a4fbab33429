//! The air of the plate on the screen: chosen, typed, refused and undone.

use crate::background::open_page;
use crate::test_app::TestApp;
use crate::type_into;
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use slipline_plate::{Air, AirMounting, Faces, Gas, Plate, PlateSpec};

fn air(app: &TestApp) -> Option<Air> {
    app.window.state().setup().plate.spec().air
}

/// Chooses `entry` of the list that shows `list`.
fn choose(app: &mut TestApp, list: &str, entry: &str) {
    app.window.get_by_role_and_label(Role::ComboBox, list).click_accesskit();
    app.wait(200);
    app.click_button(entry, 200);
}

fn undo(app: &mut TestApp) {
    app.keys(Modifiers::COMMAND, Key::Z, 100);
}

#[test]
fn the_air_of_a_plate_is_chosen_typed_and_undone() {
    let mut app = TestApp::unplugged();
    open_page(&mut app, "This plate");
    let band_hz = app.window.state().setup().plate.band_hz();
    assert_eq!(air(&app), None);
    assert!(app.window.query_by_role_and_label(Role::TextInput, "Temperature").is_none());
    choose(&mut app, "Mounting: not stated", "bare frame");
    assert_eq!(air(&app), Some(Air::ROOM));
    assert!(app.window.state().setup().plate.band_hz().0 < 0.9 * band_hz.0, "air slows a light membrane");
    assert!(!app.has_part("Faces with air"), "a bare frame has both");
    type_into(&mut app, "Temperature", "35 °C");
    type_into(&mut app, "Height above sea", "1500");
    let gas = Gas::Atmosphere { temperature_c: 35.0, height_m: 1500.0 };
    assert_eq!(air(&app), Some(Air::Around { gas, mounting: AirMounting::BareFrame, gap_m: None }));
    choose(&mut app, "Mounting: bare frame", "baffle");
    choose(&mut app, "Faces with air: both", "one");
    assert_eq!(
        air(&app),
        Some(Air::Around { gas, mounting: AirMounting::Baffle { faces: Faces::One }, gap_m: None }),
        "the rest stays as it was stated"
    );
    choose(&mut app, "Air by: temperature", "density");
    let Some(Air::Around { gas: given, .. }) = air(&app) else { panic!("air") };
    assert_eq!(given.density_kg_per_m3(), gas.density_kg_per_m3());
    assert!(matches!(given, Gas::Given { .. }));
    type_into(&mut app, "Air density", "1.1 kg/m³");
    type_into(&mut app, "Speed of sound", "340");
    let gas = Gas::Given { density_kg_per_m3: 1.1, sound_speed_m_per_s: 340.0 };
    assert_eq!(
        air(&app),
        Some(Air::Around { gas, mounting: AirMounting::Baffle { faces: Faces::One }, gap_m: None })
    );
    choose(&mut app, "Mounting: baffle", "coefficient");
    type_into(&mut app, "Air coefficient", "1.6");
    let stated = AirMounting::Coefficient { alpha: 1.6, faces: Faces::One };
    assert_eq!(air(&app), Some(Air::Around { gas, mounting: stated, gap_m: None }));
    choose(&mut app, "Mounting: coefficient", "not known");
    assert_eq!(air(&app), Some(Air::Around { gas, mounting: AirMounting::Unknown, gap_m: None }));
    assert!(app.window.query_by_role_and_label(Role::TextInput, "Air coefficient").is_none());
    undo(&mut app);
    choose(&mut app, "Mounting: coefficient", "vacuum");
    assert_eq!(air(&app), Some(Air::Vacuum));
    assert_eq!(app.window.state().setup().plate.band_hz(), band_hz);
    undo(&mut app);
    assert_eq!(air(&app), Some(Air::Around { gas, mounting: stated, gap_m: None }));
    for _ in 0..10 {
        undo(&mut app);
    }
    assert_eq!(air(&app), None);
    assert_eq!(app.window.state().setup().plate.name(), "membrane");
}

#[test]
fn the_air_that_a_calibration_found_is_shown_and_can_be_changed() {
    let mut app = TestApp::unplugged();
    open_page(&mut app, "This plate");
    let found = AirMounting::Calibrated { alpha: 1.7, faces: Faces::Two, distant: 0.3 };
    let spec = app.window.state().setup().plate.spec().clone();
    let plate = PlateSpec { air: Some(Air::Around { gas: Gas::ROOM, mounting: found, gap_m: None }), ..spec };
    app.open("found.toml", Ok(Plate::new(plate).unwrap().to_toml()));
    app.wait(200);
    type_into(&mut app, "Distant share", "0.4");
    let changed = AirMounting::Calibrated { alpha: 1.7, faces: Faces::Two, distant: 0.4 };
    assert_eq!(air(&app), Some(Air::Around { gas: Gas::ROOM, mounting: changed, gap_m: None }));
    choose(&mut app, "Faces with air: both", "one");
    choose(&mut app, "Mounting: calibrated", "coefficient");
    let stated = AirMounting::Coefficient { alpha: 1.7, faces: Faces::One };
    assert_eq!(air(&app), Some(Air::Around { gas: Gas::ROOM, mounting: stated, gap_m: None }));
    assert!(app.window.query_by_role_and_label(Role::TextInput, "Distant share").is_none());
}

#[test]
fn a_number_of_the_air_that_cannot_be_is_refused_by_field_and_range() {
    let mut app = TestApp::unplugged();
    open_page(&mut app, "This plate");
    choose(&mut app, "Mounting: not stated", "coefficient");
    let before = air(&app);
    let refuses = |app: &mut TestApp, field: &str, bad: &str, reason: &str| {
        type_into(app, field, bad);
        app.wait(100);
        assert!(app.has(reason), "{field}: {reason}");
    };
    refuses(&mut app, "Air coefficient", "11", "Air coefficient 11: must be 0 to 10");
    refuses(&mut app, "Temperature", "300 °C", "Temperature 300 °C: must be -60 to 100 °C");
    refuses(&mut app, "Height above sea", "9001", "Height above sea 9001 m: must be -500 to 9000 m");
    assert_eq!(air(&app), before);
    choose(&mut app, "Air by: temperature", "density");
    refuses(&mut app, "Air density", "0.01", "Air density 0.01 kg/m³: must be 0.05 to 20 kg/m³");
    refuses(&mut app, "Speed of sound", "9000", "Speed of sound 9000 m/s: must be 100 to 2000 m/s");
}

#[test]
fn a_plate_that_carries_no_air_has_no_field_for_it_or_says_what_is_missing() {
    let mut app = TestApp::unplugged();
    let shear = slipline_plate::preset("al-sh").unwrap();
    app.open("shear.toml", Ok(shear.to_toml()));
    open_page(&mut app, "This plate");
    assert_eq!(app.window.state().setup().plate.name(), "al-sh");
    assert!(!app.has_part("Mounting"));
    let slack = slipline_plate::preset("membrane").unwrap().to_toml().replace("tension_n_per_m = 40.0\n", "");
    app.open("slack.toml", Ok(slack));
    app.wait(200);
    let reason = "Tension is missing: [air] needs it: the force per metre of width, in N/m";
    assert!(app.has(reason));
    app.window.get_by_role_and_label(Role::ComboBox, "Mounting: not stated").click_accesskit();
    app.wait(200);
    let bare = app.window.get_by_role_and_label(Role::Button, "bare frame");
    assert!(bare.accesskit_node().is_disabled());
}
