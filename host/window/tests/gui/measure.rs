//! The page of measurements: opened from files, shown beside the plate's model, hidden, removed and saved.

use crate::plots::words;
use crate::test_app::TestApp;
use eframe::egui::{self, Key, Pos2, Rect, accesskit::Role, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use slipline_plate::calibrate::{MeasuredPoint, Measurement, SensorKind, band_hz, predicted};
use slipline_plate::{Complex64, Plate, quantity::decibels};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The plate of these tests, whose wave speed is this share of the preset's.
pub(crate) fn membrane(share: f64) -> Plate {
    slipline_plate::preset("membrane").unwrap().with_wave_speed(share).unwrap()
}

/// What an uncalibrated acceleration sensor measures of a plate: 40 dB over its noise, and so full at its loudest.
pub(crate) fn measured(truth: &Plate, place_m: f64, headroom_db: f64) -> Measurement {
    let (low, high) = band_hz(&membrane(1.0));
    let hertz = |i: u32| low * (high / low).powf(f64::from(i) / 59.0);
    let point = |i: u32| MeasuredPoint {
        frequency_hz: hertz(i),
        response: Complex64::ONE,
        noise: 1.0,
        headroom_db: Some(headroom_db),
    };
    let asked = Measurement::at(place_m, SensorKind::Acceleration, (0..60).map(point).collect());
    let mut sensor = Measurement { sample_rate_hz: Some(400e3), ..asked };
    let clean: Vec<Complex64> = predicted(truth, &sensor).unwrap().into_iter().flatten().collect();
    let loudest = clean.iter().map(|answer| answer.norm()).fold(0.0, f64::max);
    for (i, (point, answer)) in sensor.points.iter_mut().zip(clean).enumerate() {
        point.noise = 0.005 * loudest;
        // The angle of the squares is spread evenly.
        point.response = answer + Complex64::cis(2.4 * (i * i) as f64) * point.noise;
        point.headroom_db = Some(headroom_db + decibels(loudest / answer.norm()));
    }
    sensor
}

/// The first place of a calibration, on the plate that the window shows.
const NEAR_M: f64 = 0.032;

pub(crate) fn open_measure(app: &mut TestApp) {
    app.click_button("Plate", 100);
    app.click_button("Measure", 200);
}

pub(crate) fn open(app: &mut TestApp, name: &str, measurement: &Measurement) {
    app.open(name, Ok(measurement.to_csv()));
    app.wait(200);
}

/// The plot whose accessible name begins so.
fn plot(app: &TestApp, name: &str) -> Rect {
    let plots = app.window.query_all_by_role(Role::Image);
    let label = |node: &egui_kittest::Node<'_>| node.accesskit_node().label().unwrap_or_default();
    plots.into_iter().find(|node| label(node).starts_with(name)).unwrap().rect()
}

#[test]
fn a_measurement_of_another_plate_is_said_to_differ_and_one_of_this_plate_fits() {
    let mut app = TestApp::driving();
    open_measure(&mut app);
    assert!(!app.shows("Measured differs"));
    open(&mut app, "faster.csv", &measured(&membrane(1.04), NEAR_M, 12.0));
    assert!(app.shows("Measured differs: half of the answers are more than"), "four per cent faster");
    assert!(app.shows("The level is not compared"));
    open(&mut app, "same.csv", &measured(&membrane(1.0), NEAR_M, 12.0));
    assert!(app.shows("The plate's model fits: half of the answers are within 0.1 dB"));
    app.click_button("faster.csv", 200);
    assert!(app.shows("Measured differs"), "the chosen one is described");
    // The plate on the screen counts: the faster one fits.
    crate::background::open_plate(&mut app, membrane(1.04).to_toml());
    open_measure(&mut app);
    assert!(app.shows("The plate's model fits"));
    let beyond = measured(&membrane(1.0), 0.3, 12.0);
    open(&mut app, "beyond.csv", &Measurement { place_m: 0.5, ..beyond });
    assert!(app.shows("the sensor at 500.0 mm is beyond the plate's end at 320.0 mm"));
}

#[test]
fn measurements_are_overlaid_hidden_removed_and_saved() {
    let mut app = TestApp::driving();
    let both = [measured(&membrane(1.0), NEAR_M, 12.0), measured(&membrane(1.02), 0.05, 12.0)];
    open(&mut app, "first.csv", &both[0]);
    assert!(app.has("Measured response"), "its page opens");
    open(&mut app, "second.csv", &both[1]);
    assert!(app.shows("Level, dB of 2 measurements"));
    app.window.get_by_role_and_label(Role::CheckBox, "Show first.csv").click();
    app.wait(200);
    assert!(app.shows("Level, dB of 1 measurements"));
    app.window.get_by_role_and_label(Role::CheckBox, "Show second.csv").click();
    app.wait(200);
    assert!(!app.shows("Level, dB of"), "nothing is drawn");
    // The chosen measurements are drawn.
    app.click_button("first.csv", 200);
    assert!(app.shows("Level, dB of 1 measurements") && app.shows("32.0 mm"));
    app.window.get_by_label("Export CSV…").click_accesskit();
    app.wait(200);
    let (name, bytes) = app.files.saved.borrow().last().cloned().unwrap();
    assert_eq!(name, "first.csv");
    assert_eq!(Measurement::from_csv(str::from_utf8(&bytes).unwrap()), Ok(both[0].clone()));
    app.window.get_by_label("Remove first.csv").click_accesskit();
    app.wait(200);
    assert!(!app.has("first.csv") && app.shows("50.0 mm"));
    app.window.get_by_label("Remove second.csv").click_accesskit();
    app.wait(200);
    assert!(!app.has("Export CSV…"));
}

#[test]
fn the_headroom_light_is_red_below_6_db_and_green_to_40() {
    let mut app = TestApp::driving();
    for (headroom_db, light, words) in
        [(3.0, "red", "lower"), (12.0, "green", "dB left at"), (55.0, "amber", "raise")]
    {
        open(&mut app, "room.csv", &measured(&membrane(1.0), NEAR_M, headroom_db));
        assert!(app.has(&format!("Headroom: {light}")), "{headroom_db}");
        let is_shown = words_of(&app).into_iter().any(|text| text.contains(words));
        assert!(is_shown, "{headroom_db}: {words}");
    }
}

/// Every text that is painted.
fn words_of(app: &TestApp) -> Vec<String> {
    words(app.window.output()).into_iter().map(|(text, _)| text).collect()
}

/// A file that is dropped on the window.
#[derive(Debug)]
pub(crate) struct Dropped(pub(crate) PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        Err("the app reads files by itself".to_owned())
    }
}

#[test]
fn a_file_is_dropped_on_the_window_and_a_bad_one_changes_nothing() {
    let mut app = TestApp::driving();
    let text = measured(&membrane(1.0), NEAR_M, 12.0).to_csv();
    let path = PathBuf::from("dropped.csv");
    *app.files.profiles.borrow_mut() = vec![(path.clone(), Ok(text.clone().into_bytes()))];
    app.window.input_mut().dropped_files.push(Arc::new(Dropped(path)));
    app.wait(200);
    assert!(app.has("dropped.csv"));
    for (bad, reason) in [
        (text.replace("# sensor = acceleration\n", ""), "Sensor is missing"),
        (text.replace("place_m = 0.032", "place_m = nan"), "place_m = NaN m"),
        (text.lines().take(8).collect::<Vec<_>>().join("\n"), "points"),
    ] {
        app.open("bad.csv", Ok(bad));
        let notice = app.window.state().notice().cloned().unwrap();
        assert!(notice.is_error && notice.text.contains(reason), "{notice:?}");
        assert!(!app.has("bad.csv"));
    }
    assert!(app.is_driving());
}

#[test]
fn the_plots_show_the_values_under_the_pointer_and_are_zoomed_together() {
    let mut app = TestApp::driving();
    open(&mut app, "near.csv", &measured(&membrane(1.01), NEAR_M, 12.0));
    let check = |app: &mut TestApp, name: &str, wanted: [&str; 3]| {
        let at = plot(app, name).center();
        app.hover(at, 200);
        let read_out = words_of(app).into_iter().find(|text| wanted.iter().all(|part| text.contains(part)));
        assert!(read_out.is_some(), "{name}: {wanted:?} in {:?}", words_of(app));
    };
    check(&mut app, "Level", ["measured", "model", "headroom"]);
    check(&mut app, "Phase", [" Hz", "measured", "°"]);
    check(&mut app, "Measured over model", ["off by", "noise ±", " Hz"]);
    check(&mut app, "Nyquist", ["Hz", "Re", "Im"]);

    let frequencies = |app: &TestApp| -> Vec<String> {
        let strip = plot(app, "Measured over model");
        let labels = words(app.window.output()).into_iter();
        let under =
            labels.filter(|(_, at)| at.top() > strip.bottom() - 30.0 && at.bottom() < strip.bottom() + 30.0);
        under.map(|(text, _)| text).filter(|text| text.ends_with(" Hz")).collect()
    };
    let away: Pos2 = plot(&app, "Level").right_top() - vec2(-20.0, 40.0);
    app.hover(away, 200);
    let whole = frequencies(&app);
    assert!(whole.len() >= 2, "{whole:?}");
    app.turn_wheel(plot(&app, "Level").center(), 200.0);
    app.hover(away, 200);
    assert_ne!(frequencies(&app), whole, "the strip below follows");
    app.click("More: Measured response", 200);
    app.click("Fit Measured response", 200);
    app.key(Key::Escape, 200);
    assert_eq!(frequencies(&app), whole, "all again");
}

#[test]
fn the_boundary_that_is_out_of_sight_is_not_moved_by_the_arrow_keys() {
    let mut app = TestApp::driving();
    open(&mut app, "near.csv", &measured(&membrane(1.0), NEAR_M, 12.0));
    let before = crate::boundary_mm(&app);
    app.key(Key::ArrowRight, 200);
    assert_eq!(crate::boundary_mm(&app), before);
    app.click_button("Boundary", 200);
    app.key(Key::ArrowRight, 200);
    assert!(crate::boundary_mm(&app) > before);
}
