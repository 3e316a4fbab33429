//! The check in two dimensions, on the page of the lights.

use crate::background::open_page;
use crate::test_app::TestApp;
use crate::type_into;
use eframe::egui::{Key, Modifiers, accesskit::Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use slipline_plate::plane::{self, Comparison, PlaneError, Setup};
use slipline_plate::{Equation, Finger, respond_touched};

const BUTTON: &str = "Check in two dimensions";

fn press(app: &mut TestApp) {
    app.click(BUTTON, 100);
}

/// The page shows the solvers' results for the first tone with this finger.
fn shows_the_difference(app: &TestApp, finger: Option<Finger>) {
    let setup = app.window.state().setup();
    let (plate, hertz) = (&setup.plate, setup.plate.frequency_for_boundary_hz(setup.tones[0].position_m));
    let one_mode = respond_touched(plate, finger.as_ref(), hertz, 2049, Equation::Corrected).unwrap();
    let two_dimensions = plane::respond(plate, hertz, 2049, &Setup { finger, ..Setup::of(plate) }).unwrap();
    let differs = Comparison::of(&one_mode, &two_dimensions);
    let shift_mm = format!("{:.1} mm", 1e3 * differs.peak_shift_m.unwrap().abs());
    let level = format!("{:.1} dB", differs.level_db.unwrap().abs());
    let nodes = format!("{} node", differs.nodes[1]);
    for part in [shift_mm, level, nodes] {
        let words = app.window.get_by_label_contains("In two dimensions the peak");
        let words = words.accesskit_node().value().unwrap_or_default();
        assert!(words.contains(&part), "{part}: {words}");
    }
}

#[test]
fn the_button_takes_the_finger_with_it_until_that_moves() {
    let mut app = TestApp::driving();
    crate::finger::choose(&mut app, "Light");
    let finger_mm = crate::finger::finger_mm(&app);
    open_page(&mut app, "Validity");
    press(&mut app);
    shows_the_difference(&app, Some(Finger::light(1e-3 * finger_mm)));
    let where_it_is = format!("At 180.0 mm, with the finger at {finger_mm:.1} mm: In two dimensions");
    assert!(app.has_part(&where_it_is), "{where_it_is}");
    crate::finger::drag_by(&mut app, &[-20.0]);
    assert!(!app.has_part("In two dimensions the peak"), "it is obsolete");
}

#[test]
fn the_button_reports_where_two_dimensions_differ_until_the_boundary_moves() {
    let mut app = TestApp::driving();
    open_page(&mut app, "Validity");
    assert!(!app.has_part("In two dimensions the peak"));
    press(&mut app);
    shows_the_difference(&app, None);
    app.keys(Modifiers::COMMAND, Key::Num1, 100);
    type_into(&mut app, "Boundary position", "120 mm");
    open_page(&mut app, "Validity");
    assert!(!app.has_part("In two dimensions the peak"), "it is obsolete");
    press(&mut app);
    assert!(app.has_part("At 120.0 mm: In two dimensions"));
}

#[test]
fn a_refusal_gives_its_reason_and_the_button_waits_for_another_boundary() {
    let mut app = TestApp::driving();
    open_page(&mut app, "Validity");
    assert!(!app.window.get_by_label(BUTTON).accesskit_node().is_disabled());
    *app.plane_refusal.borrow_mut() = Some(PlaneError::TooFine { frequency_hz: 20e3, unknowns: 9, most: 8 });
    press(&mut app);
    let reason = "Not computed: unknowns of the two-dimensional field at 20000 Hz = 9: must be at most 8.";
    assert!(app.has(reason));
    assert!(app.window.get_by_label(BUTTON).accesskit_node().is_disabled(), "it would be refused again");
    app.plane_refusal.take();
    app.window.get_by_role_and_label(Role::Slider, "Boundary").focus();
    app.key(Key::ArrowRight, 100);
    press(&mut app);
    assert!(app.has_part("In two dimensions the peak"));
}
