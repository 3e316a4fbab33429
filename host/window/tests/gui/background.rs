//! The validity lights, the designer, the 2-D sheet, and cancelled work.

use crate::test_app::TestApp;
use crate::type_into;
use eframe::egui::{Key, Modifiers, accesskit::Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use slipline_link::Request;
use slipline_model::jobs::table;
use slipline_model::jobs::{JobQueue, Task};
use slipline_plate::Model;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// The text of the summary of the lights.
fn summary(app: &TestApp) -> String {
    let chip = app.window.get_by(|node| {
        node.role() == Role::Button && node.label().is_some_and(|label| label.starts_with("Validity: "))
    });
    chip.accesskit_node().label().unwrap()
}

pub(crate) fn open_plate(app: &mut TestApp, text: String) {
    app.open("plate.toml", Ok(text));
    app.wait(200);
}

fn open_preset(app: &mut TestApp, name: &str) {
    open_plate(app, slipline_plate::preset(name).unwrap().to_toml());
    app.wait(1500);
}

pub(crate) fn open_page(app: &mut TestApp, page: &str) {
    app.click_button("Plate", 50);
    app.click_button(page, 100);
}

#[test]
fn the_lights_follow_the_boundary_once_it_is_let_go() {
    let mut app = TestApp::driving();
    let chip = summary(&app);
    app.click(&chip, 100);
    assert!(app.has("Turning point 180.0 mm, 138.3 Hz"));
    let line = crate::line_rect(&app).center();
    app.grab(line, 0);
    app.hover(line + eframe::egui::vec2(80.0, 0.0), 100);
    assert!(app.has("Turning point 180.0 mm, 138.3 Hz"), "still on its way");
    app.release(line + eframe::egui::vec2(80.0, 0.0), 100);
    assert!(!app.has("Turning point 180.0 mm, 138.3 Hz"));
    let there = format!("Turning point {:.1} mm", crate::boundary_mm(&app));
    assert!(app.has_part(&there), "{there}");
}

#[test]
fn every_light_has_its_word_and_its_sentence_and_the_summary_counts_them() {
    let mut app = TestApp::driving();
    open_page(&mut app, "Validity");
    let words = |app: &TestApp, word: &str| app.window.query_all_by_label_contains(word).count();
    for name in ["edge slope", "loss", "peak", "drive match", "sensitivity", "actuator band", "beat"] {
        assert_eq!(words(&app, &format!("{name}: ")), 1, "{name}");
    }
    let notes = words(&app, ": note");
    assert!(notes >= 2);
    assert_eq!(words(&app, ": green") + notes + words(&app, ": unchecked"), 22);
    // No actuator is given: shown, but neither counted nor a warning.
    assert_eq!(words(&app, "actuator band: unchecked"), 1);
    assert_eq!(summary(&app), format!("Validity: {notes} notes"));
    assert!(app.has_part("has no actuator"));
}

#[test]
fn the_panel_has_what_the_thin_plate_light_asks_for() {
    let mut app = TestApp::driving();
    open_preset(&mut app, "al-bending");
    app.click(&summary(&app), 100);
    assert!(app.has("thin plate: note"));
    open_page(&mut app, "This plate");
    app.window.get_by_role_and_label(Role::CheckBox, "Thin plate").click_accesskit();
    app.wait(1500);
    let plate = Arc::clone(&app.window.state().setup().plate);
    let Model::BendingSupported(bending) = &plate.spec().model else { panic!("{:?}", plate.spec().model) };
    assert!(bending.thick_plate);
    assert_eq!(plate.name(), "al-bending (changed)");
    app.click_button("Validity", 100);
    assert!(app.has("thin plate: green"));
}

#[test]
fn a_plate_that_leaves_no_peak_gets_a_red_light() {
    let mut app = TestApp::driving();
    assert!(!summary(&app).contains("red"));
    let text = slipline_plate::preset("membrane").unwrap().to_toml();
    open_plate(&mut app, text.replace("loss_factor = 0.03", "loss_factor = 0.5"));
    app.wait(1500);
    assert!(app.window.state().setup().plate.spec().loss_factor == 0.5, "it was opened");
    assert!(summary(&app).contains("red"), "{}", summary(&app));
    open_page(&mut app, "Validity");
    assert!(app.has("peak: red"));
}

#[test]
fn the_designer_makes_a_plate_that_is_used_saved_and_taken_back() {
    let mut app = TestApp::driving();
    let before = app.window.state().setup().plate.name().to_owned();
    open_page(&mut app, "Designer");
    type_into(&mut app, "Length", "28 cm");
    type_into(&mut app, "Band to", "38 kHz");
    app.wait(100);
    app.window.get_by_label("Use this plate").click_accesskit();
    app.wait(1500);
    let plate = Arc::clone(&app.window.state().setup().plate);
    assert_eq!(plate.name(), "designed");
    let (low, high) = plate.band_hz();
    assert!((plate.length_m() - 0.28).abs() < 1e-12);
    assert!((low - 20e3).abs() < 1.0 && (high - 38e3).abs() < 1.0, "{low} {high}");
    assert_eq!(app.snapshot().table.upload_verified, Some(true), "its table is on the device");
    app.window.get_by_label_contains("Save plate (TOML)").click_accesskit();
    app.wait(100);
    app.window.get_by_label_contains("Save cut files").click_accesskit();
    app.wait(100);
    let saved = app.files.saved.borrow().clone();
    let names: Vec<&str> = saved.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["plate.toml", "plate.svg", "plate.dxf", "frame.svg", "frame.dxf"]);
    let read = slipline_plate::Plate::from_toml(std::str::from_utf8(&saved[0].1).unwrap()).unwrap();
    assert_eq!(read.spec(), plate.spec());
    app.keys(Modifiers::COMMAND, Key::Z, 200);
    assert_eq!(app.window.state().setup().plate.name(), before);
}

#[test]
fn a_value_that_no_plate_can_have_is_named_at_its_field() {
    let mut app = TestApp::driving();
    let before = Arc::clone(&app.window.state().setup().plate);
    open_page(&mut app, "Designer");
    app.click("More", 300);
    let is_offered = |app: &TestApp| app.has("Use this plate");
    assert!(is_offered(&app));
    for (field, bad, reason, good) in [
        ("Thickness", "5 m", "Thickness 5000 mm: must be 0.001 to 100 mm", "2 mm"),
        ("Band to", "20 kHz", "Band to 20 kHz: must be 21 to 10000 kHz", "40 kHz"),
        ("Length", "10 mm", "Length 10 mm: must be", "300 mm"),
        ("Loss factor", "0,7", "Loss factor 0.7: must be 0 to 0.5", "auto"),
    ] {
        type_into(&mut app, field, bad);
        app.wait(100);
        let refusal = app.window.get_by_label_contains(reason).rect();
        let at = app.window.get_by_role_and_label(Role::TextInput, field).rect();
        assert!(
            refusal.top() >= at.bottom() - 1.0 && refusal.top() < at.bottom() + 20.0,
            "{field}: {refusal} {at}"
        );
        assert!(!is_offered(&app), "{field}");
        type_into(&mut app, field, good);
        app.wait(100);
        assert!(!app.has_part(reason) && is_offered(&app), "{field}");
    }
    type_into(&mut app, "Thickness", "2 bananas");
    assert!(app.has_part("is no unit that fits here"));
    assert!(Arc::ptr_eq(&app.window.state().setup().plate, &before));
}

#[test]
fn the_wave_is_the_sheet_where_it_runs_live_and_the_modal_lines_elsewhere() {
    let mut app = TestApp::driving_with_sheet();
    app.wait(200);
    assert!(app.has("2-D sheet, 1/200 speed"));
    open_preset(&mut app, "al-bending");
    assert!(app.is_driving());
    assert!(app.has_part("modal lines, 1/"));
    assert!(!app.has_part("2-D sheet, 1/"));
    open_preset(&mut app, "paper-rubber");
    assert!(app.has_part("2-D sheet, 1/"));
    // The same plate under another name has the same table: nothing is sent to the device, but the field is solved
    // again.
    let text = slipline_plate::preset("paper-rubber").unwrap().to_toml();
    open_plate(&mut app, text.replace("name = \"paper-rubber\"", "name = \"mine\""));
    app.wait(500);
    assert_eq!(app.window.state().setup().plate.name(), "mine");
    assert!(app.has_part("2-D sheet, 1/"));
    // The user may prefer the lines.
    app.click("View", 200);
    app.click("Wave: modal lines", 200);
    assert!(app.has_part("modal lines, 1/"));
    app.key(Key::Space, 400);
    assert!(app.has("at rest"));
}

#[test]
fn a_table_that_takes_long_can_be_given_up_and_the_old_one_stays() {
    let is_held = Arc::new(AtomicBool::new(false));
    let held = Arc::clone(&is_held);
    let make = move |job, task: &Task| {
        while held.load(Ordering::Relaxed) {
            if !task.report(0.4) {
                return None;
            }
            std::thread::yield_now();
        }
        table::make(job, task)
    };
    let mut app = TestApp::with_tables(JobQueue::threaded("table", make, || ()).unwrap());
    app.until("driving", |app| app.is_driving());
    app.wait(400);
    let plate = Arc::clone(&app.window.state().setup().plate);
    let crc = app.snapshot().table.report.active.unwrap().crc;
    is_held.store(true, Ordering::Relaxed);
    app.take_sent();
    open_page(&mut app, "This plate");
    type_into(&mut app, "Wave speed", "13 m/s");
    assert!(!Arc::ptr_eq(&app.window.state().setup().plate, &plate));
    app.until("a bar", |app| app.has_part("table 40 %"));
    assert!(app.has("waits for its table"), "no wave of another plate");
    app.click("Cancel", 100);
    assert!(Arc::ptr_eq(&app.window.state().setup().plate, &plate), "the old plate is back");
    assert!(!app.has_part("table 40 %"));
    assert!(app.has_part("2-D sheet, 1/"));
    app.wait(500);
    assert_eq!(app.snapshot().table.report.active.unwrap().crc, crc);
    assert!(app.is_driving());
    assert!(!app.take_sent().iter().any(|request| matches!(request, Request::Upload(_))));
    // The old table is still active: the boundary can be moved with it.
    app.key(Key::Escape, 100);
    // Cancelled work can be started again.
    is_held.store(false, Ordering::Relaxed);
    app.window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    app.until("the new table", |app| {
        app.snapshot().table.report.active.is_some_and(|header| header.crc != crc)
    });
}

#[test]
fn at_rest_nothing_is_repainted_and_the_sheet_does_not_run() {
    let mut app = TestApp::driving_with_sheet();
    let delay = |app: &TestApp| {
        app.window.output().viewport_output.values().map(|viewport| viewport.repaint_delay).min().unwrap()
    };
    let before = app.sheet_jobs.get();
    app.wait(500);
    assert!(app.sheet_jobs.get() >= before + 5, "it moves while it is driven");
    assert!(delay(&app) <= Duration::from_millis(33));
    app.key(Key::Space, 3000);
    let asleep = app.sheet_jobs.get();
    app.wait(1000);
    assert_eq!(app.sheet_jobs.get(), asleep);
    assert!(delay(&app) > Duration::from_secs(1), "{:?}", delay(&app));
}

#[test]
fn the_designer_draws_its_plate_on_the_stage_while_one_types_and_loads_nothing() {
    let mut app = TestApp::driving();
    let before = app.setup_text();
    let shown = |app: &TestApp, length: &str| {
        let name = format!("Design, not loaded: designed, {length} long");
        app.has(&name)
    };
    let any = |app: &TestApp| app.has_part("Design, not loaded");
    assert!(!any(&app));
    open_page(&mut app, "Designer");
    app.wait(300);
    assert!(shown(&app, "300.0 mm"));
    // Typed, and not confirmed.
    app.window.get_by_role_and_label(Role::TextInput, "Length").focus();
    app.window.step();
    app.keys(Modifiers::COMMAND, Key::A, 0);
    app.window.get_by_role_and_label(Role::TextInput, "Length").type_text("25 cm");
    app.wait(300);
    assert!(shown(&app, "250.0 mm"));
    assert_eq!(app.setup_text(), before);
    assert!(app.is_driving());
    app.click_button("This plate", 100);
    assert!(!any(&app), "only while the designer is open");
    open_page(&mut app, "Designer");
    app.click("Use this plate", 300);
    assert!(!any(&app), "it is the plate now");
    assert_ne!(app.setup_text(), before);
}
