//! The calibration's pages, with answers from files: the boundary is right afterwards, and a refusal gives its reason.

use crate::measure::{measured, membrane, open_measure};
use crate::test_app::TestApp;
use crate::type_into;
use eframe::egui::{Key, Modifiers, accesskit::Role};
use egui_kittest::kittest::Queryable as _;
use slipline_instrument::calibration::CalibrationWizard;
use slipline_plate::calibrate::{Calipers, Measurement};
use slipline_plate::quantity::show_place;
use slipline_plate::{Model, Plate};
use std::path::PathBuf;

/// Where the sensor of the answers stood, whatever the pages propose.
const PLACES_M: [f64; 2] = [0.032, 0.176];

fn press(app: &mut TestApp, name: &str) {
    // In a small window it may lie below what is seen of the page.
    app.window.get_by_role_and_label(Role::Button, name).scroll_to_me();
    app.wait(400);
    app.click_button(name, 200);
}

/// The number of the open page.
pub(crate) fn page(app: &TestApp) -> Option<usize> {
    (1..=5).find(|number| app.has(&format!("{number} of 5")))
}

pub(crate) fn open_calibration(app: &mut TestApp) {
    open_measure(app);
    press(app, "Calibrate…");
}

fn open_answer(app: &mut TestApp, name: &str, measurement: &Measurement) {
    *app.files.contents.borrow_mut() = vec![(PathBuf::from(name), Ok(measurement.to_csv()))];
    press(app, "Open file…");
}

/// Goes through the pages with these two answers, to the result.
pub(crate) fn go_through(app: &mut TestApp, answers: &[Measurement; 2]) {
    open_calibration(app);
    press(app, "Next");
    press(app, "Next");
    open_answer(app, "near.csv", &answers[0]);
    press(app, "Next");
    open_answer(app, "far.csv", &answers[1]);
    press(app, "Next");
    assert_eq!(page(app), Some(5));
}

/// The answers at both places of a plate of this share of the wave speed.
pub(crate) fn answers(share: f64) -> [Measurement; 2] {
    PLACES_M.map(|place_m| measured(&membrane(share), place_m, 12.0))
}

fn wave_speed(plate: &Plate) -> f64 {
    match plate.spec().model {
        Model::Membrane { wave_speed_m_per_s, .. } => wave_speed_m_per_s,
        _ => panic!("a membrane"),
    }
}

#[test]
fn a_plate_that_is_four_per_cent_off_is_calibrated_used_and_taken_back() {
    let mut app = TestApp::driving();
    let before = app.window.state().setup().clone();
    go_through(&mut app, &answers(1.04));
    assert!(app.shows("Boundary off by") && app.shows("Wave speed") && app.shows("Sensor's place"));
    assert!(app.shows("Reduced chi-square is"));
    assert!(app.shows("1.0 mm from its mark moves the boundary by up to"), "what no measurement shows");
    press(&mut app, "Save plate file…");
    let (name, bytes) = app.files.saved.borrow().last().cloned().unwrap();
    let saved = Plate::from_toml(str::from_utf8(&bytes).unwrap()).unwrap();
    assert!(name == "plate.toml" && saved.spec().calibration.is_some());
    assert_eq!(app.window.state().setup(), &before, "nothing is used yet");
    press(&mut app, "Use this plate");
    app.wait(1500);
    let used = app.window.state().setup().plate.clone();
    assert_eq!(used.spec(), saved.spec());
    let off = wave_speed(&used) / wave_speed(&membrane(1.04)) - 1.0;
    assert!(off.abs() < 3e-3, "{off}");
    assert!(page(&app).is_none() && app.is_driving(), "its table is made and sent");
    // The stage is seen, with the calibrated plate's curve.
    assert!(app.window.query_by_role_and_label(Role::Slider, "Boundary").is_some());
    // The measurement that was opened last is of this plate now.
    open_measure(&mut app);
    assert!(app.shows("The plate's model fits"));
    app.keys(Modifiers::COMMAND, Key::Z, 500);
    assert_eq!(app.window.state().setup(), &before);
    assert!(app.shows("Measured differs"));
}

#[test]
fn a_third_place_checks_the_result_and_may_be_left_out() {
    let mut app = TestApp::driving();
    go_through(&mut app, &answers(1.04));
    assert!(app.shows("A third measurement, at") && !app.shows("Checked by"));
    press(&mut app, "Check at a third place…");
    assert!(
        app.shows("Calibrate: a third place, as a check") && app.is_enabled("Next"),
        "it may be left out"
    );
    let third_m = CalibrationWizard::of(&app.window.state().setup().plate).places_m()[2];
    assert!(app.shows(&format!("The sensor's place: {}", show_place(third_m))));
    open_answer(&mut app, "third.csv", &measured(&membrane(1.04), third_m, 12.0));
    press(&mut app, "Next");
    assert!(app.shows(&format!("Checked by a third measurement, at {}", show_place(third_m))));
    // One of another plate refuses what two places accepted.
    press(&mut app, "Check at a third place again…");
    open_answer(&mut app, "other.csv", &measured(&membrane(1.02), third_m, 12.0));
    press(&mut app, "Next");
    assert!(app.shows("No plate file was made"));
    press(&mut app, "Leave the check out");
    assert!(app.shows("Boundary off by") && app.shows("A third measurement, at"));
}

#[test]
fn each_page_leads_on_back_and_out_and_waits_for_its_answer() {
    let mut app = TestApp::driving();
    let both = answers(1.02);
    let proposed = CalibrationWizard::of(&app.window.state().setup().plate).places_m().map(show_place);
    open_calibration(&mut app);
    assert!(page(&app) == Some(1) && !app.is_enabled("Back") && app.is_enabled("Next"));
    press(&mut app, "Next");
    let first = format!("The sensor's place: {} from the driven end, on the centre line", proposed[0]);
    assert!(app.shows(&first));
    press(&mut app, "Next");
    assert!(page(&app) == Some(3) && !app.is_enabled("Next"));
    open_answer(&mut app, "near.csv", &both[0]);
    assert!(app.is_enabled("Next") && app.shows("Headroom: 12.0 dB left"));
    press(&mut app, "Next");
    assert!(app.shows(&format!("The sensor's place: {}", proposed[1])) && !app.is_enabled("Next"));
    let stood = show_place(both[0].place_m);
    assert!(stood != proposed[0] && app.shows(&format!("; it stood at {stood}")));
    // A file of something else is no answer, and says so.
    *app.files.contents.borrow_mut() = vec![(PathBuf::from("bad.csv"), Ok("# place_m = 1\n".to_owned()))];
    press(&mut app, "Open file…");
    assert!(
        app.window.state().notice().is_some_and(|notice| notice.is_error && notice.text.contains("bad.csv"))
    );
    assert!(!app.is_enabled("Next"));
    press(&mut app, "Back");
    press(&mut app, "Back");
    assert_eq!(page(&app), Some(2));
    // Esc closes the pages and keeps what is known, Cancel gives it up.
    app.key(Key::Escape, 300);
    assert_eq!(page(&app), None);
    press(&mut app, "Calibrate…");
    assert_eq!(page(&app), Some(2));
    press(&mut app, "Next");
    assert!(app.is_enabled("Next"), "the answer is kept");
    press(&mut app, "Cancel");
    assert_eq!(page(&app), None);
    press(&mut app, "Calibrate…");
    assert_eq!(page(&app), Some(1));
    press(&mut app, "Next");
    press(&mut app, "Next");
    assert!(!app.is_enabled("Next"));
    // A measurement of the list can be chosen.
    press(&mut app, "near.csv at 32.0 mm");
    assert!(app.is_enabled("Next"));
}

#[test]
fn the_plate_stays_in_sight_beside_the_pages_and_a_press_on_it_ends_nothing() {
    let mut app = TestApp::driving();
    open_calibration(&mut app);
    press(&mut app, "Next");
    let sensor = app.window.get_by_label_contains("Sensor at ").rect();
    let title = app.window.get_by_label_contains("Calibrate: ").rect();
    let stage = crate::line_rect(&app);
    assert!(stage.right() < title.left() && sensor.right() < title.left(), "{stage} {sensor} {title}");
    assert!(app.window.get_by_label("2 of 5").rect().right() <= 1280.0);
    app.grab(sensor.center(), 50);
    app.release(sensor.center(), 200);
    assert_eq!(page(&app), Some(2));
    assert!(app.is_driving());
    // Put away, it leaves no sensor on other pages.
    press(&mut app, "Cancel");
    app.keys(Modifiers::COMMAND, Key::Num1, 200);
    assert!(!app.has_part("Sensor at "));
}

#[test]
fn exchanged_or_foreign_responses_are_refused_with_a_remedy() {
    let mut app = TestApp::driving();
    let [near, far] = answers(1.03);
    // Each file states the other's place.
    let wrong =
        [Measurement { place_m: far.place_m, ..near.clone() }, Measurement { place_m: near.place_m, ..far }];
    go_through(&mut app, &wrong);
    assert!(app.shows("No plate file was made") && app.shows("seem to be exchanged"));
    assert!(!app.has("Use this plate"));
    press(&mut app, "Cancel");
    for name in ["near.csv", "far.csv"] {
        press(&mut app, &format!("Remove {name}"));
    }
    go_through(&mut app, &answers(1.25));
    assert!(app.shows("No plate file was made"), "a quarter faster");
    press(&mut app, "Back to page 1");
    assert_eq!(page(&app), Some(1));
}

#[test]
fn calipers_move_the_places_and_one_that_cannot_be_is_refused_at_its_field() {
    let mut app = TestApp::driving();
    let mut calibration = CalibrationWizard::of(&app.window.state().setup().plate);
    let of_file_m = calibration.places_m();
    let shorter = Calipers { length_m: 0.3, ..calibration.calipers_of_file() };
    calibration.take_calipers(Some(shorter)).unwrap();
    let [place_m, ..] = calibration.places_m();
    assert_ne!(place_m, of_file_m[0]);
    open_calibration(&mut app);
    app.click("I measured width and length with calipers", 200);
    type_into(&mut app, "Length", "300 mm");
    assert_eq!(app.window.get_by_role_and_label(Role::TextInput, "Length").value().unwrap(), "300 mm");
    type_into(&mut app, "Width, narrow end", "900 mm");
    assert!(app.shows("must be"));
    type_into(&mut app, "Widths known to", "5 m");
    assert!(app.window.query_all_by_label_contains("must be").count() >= 2);
    press(&mut app, "Next");
    assert!(app.shows(&format!("The sensor's place: {}", show_place(place_m))));
}

#[test]
fn where_paths_are_typed_the_pages_come_back() {
    let mut app = TestApp::driving();
    app.files.has_no_dialogs.set(true);
    open_calibration(&mut app);
    press(&mut app, "Next");
    press(&mut app, "Next");
    press(&mut app, "Open file…");
    assert!(page(&app).is_none() && app.shows("Open a measurement"));
    press(&mut app, "Cancel");
    assert_eq!(page(&app), Some(3));
    let path = std::env::temp_dir().join("near.csv");
    *app.files.contents.borrow_mut() = vec![(path.clone(), Ok(answers(1.0)[0].to_csv()))];
    press(&mut app, "Open file…");
    type_into(&mut app, "File path", &path.display().to_string());
    app.wait(200);
    assert!(page(&app) == Some(3) && app.is_enabled("Next"));
}

/// The buttons that lead on, back and out.
fn places(app: &TestApp) -> Vec<(String, eframe::egui::Rect)> {
    let named =
        |name: &str| Some((name.to_owned(), app.window.query_by_role_and_label(Role::Button, name)?.rect()));
    ["Cancel", "Back", "Next"].into_iter().filter_map(named).collect()
}

#[test]
fn the_calibrations_buttons_keep_their_places_from_page_to_page() {
    for size in [[1280.0, 800.0], [640.0, 480.0]] {
        let mut app = TestApp::driving();
        app.resize(size.into(), 100);
        for (name, answer) in ["near.csv", "far.csv"].into_iter().zip(&answers(1.02)) {
            app.open(name, Ok(answer.to_csv()));
            app.wait(200);
        }
        open_calibration(&mut app);
        let first = places(&app);
        for number in 2..=5 {
            if number == 4 {
                press(&mut app, "near.csv at 32.0 mm");
            } else if number == 5 {
                press(&mut app, "far.csv at 176.0 mm");
            }
            press(&mut app, "Next");
            assert_eq!(page(&app), Some(number), "{size:?}");
            let title = app.window.get_by_label(&format!("{number} of 5")).rect();
            assert!(
                (55.0..200.0).contains(&title.top()),
                "{size:?}: page {number} begins at its top: {title}"
            );
            let here = places(&app);
            assert_eq!(here, first[..here.len()], "{size:?}: page {number}");
            assert_eq!(here.len(), if number == 5 { 2 } else { 3 });
        }
        // A second press at the place of Next does nothing.
        let next = first[2].1;
        for name in ["Use this plate", "Save plate file…"] {
            let button = app.window.get_by_role_and_label(Role::Button, name).rect();
            assert!(!button.intersects(next), "{size:?}: {name} {button} {next}");
        }
    }
}

#[test]
fn a_calibrated_plate_has_its_own_name() {
    let mut app = TestApp::driving();
    go_through(&mut app, &answers(1.04));
    press(&mut app, "Save plate file…");
    let (_, bytes) = app.files.saved.borrow().last().cloned().unwrap();
    let saved = Plate::from_toml(str::from_utf8(&bytes).unwrap()).unwrap();
    assert_eq!(saved.name(), "membrane, calibrated");
    press(&mut app, "Use this plate");
    app.wait(1500);
    assert_eq!(app.window.state().setup().plate.name(), "membrane, calibrated");
    app.click_button("Boundary", 200);
    assert!(crate::plots::words(app.window.output()).iter().any(|(word, _)| word == "membrane, calibrated"));
    // Calibrated once more, it is still called so.
    assert_eq!(slipline_instrument::calibration::named_calibrated(&saved).name(), saved.name());
}
