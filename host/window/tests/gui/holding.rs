//! The level hold: its switch, what it says, and everything that ends it.

use crate::exports::file_menu;
use crate::measure::{membrane, open_measure};
use crate::plots::words;
use crate::test_app::TestApp;
use crate::{line_rect, type_into};
use eframe::egui::{Key, Modifiers, accesskit::Role, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use slipline_instrument::bench::Bench;
use slipline_link::simulator::SimulatedInputs;
use slipline_link::{Request, Sounding};
use std::sync::Arc;
use std::sync::atomic::{AtomicU16, Ordering};

/// What the sensor shows of the drive, in percent.
const FREE: u16 = 50;
const TOUCHED: u16 = 25;
const UNPLUGGED: u16 = 0;

/// A sensor that shows a part of the drive, with a dither of a code.
struct Sensor {
    shows: Arc<AtomicU16>,
    samples: u32,
}

impl SimulatedInputs for Sensor {
    fn inputs(&self) -> usize {
        1
    }

    fn delay_ns(&self) -> i32 {
        0
    }

    fn sample(&mut self, codes: &[u16; 128], muted: bool, sensed: &mut [[u16; 128]; 2]) {
        let shows = i32::from(self.shows.load(Ordering::Relaxed));
        for (sensed, &code) in sensed[0].iter_mut().zip(codes) {
            self.samples = self.samples.wrapping_add(1);
            let driven = if muted { 0 } else { (i32::from(code) - 2048) * shows / 100 };
            let dither = if shows == 0 { 0 } else { (self.samples % 2) as i32 };
            *sensed = (2048 + driven + dither) as u16;
        }
    }
}

/// The app on a device with that sensor, driving.
pub(crate) fn sensed() -> (TestApp, Arc<AtomicU16>) {
    let shows = Arc::new(AtomicU16::new(FREE));
    let sensor = Box::new(Sensor { shows: shows.clone(), samples: 0 });
    (TestApp::sensed(sensor, Bench::default()), shows)
}

fn has(app: &TestApp, part: &str) -> bool {
    app.window.query_all_by_label_contains(part).next().is_some()
}

fn press_switch(app: &mut TestApp) {
    let switch = app.window.get_by_role_and_label(Role::CheckBox, "Hold the level");
    switch.scroll_to_me();
    app.wait(400);
    app.window.get_by_role_and_label(Role::CheckBox, "Hold the level").click();
    app.wait(100);
}

fn is_on(app: &TestApp) -> bool {
    let switch = app.window.get_by_role_and_label(Role::CheckBox, "Hold the level");
    switch.accesskit_node().toggled() == Some(eframe::egui::accesskit::Toggled::True)
}

fn wait_for(app: &mut TestApp, part: &str) {
    for _ in 0..80 {
        if has(app, part) {
            return;
        }
        app.wait(50);
    }
    panic!("never: {part}: {:?}", app.snapshot().log);
}

/// A level that is held, at a tone of full scale less 12 dB.
fn held() -> (TestApp, Arc<AtomicU16>) {
    let (mut app, shows) = sensed();
    type_into(&mut app, "Level", "0.2");
    app.wait(200);
    press_switch(&mut app);
    wait_for(&mut app, "Holding: the plate may be touched.");
    (app, shows)
}

fn notice(app: &TestApp) -> String {
    app.window.state().notice().map(|notice| notice.text.clone()).unwrap_or_default()
}

/// The orders of a hold, and their ends, since the last call.
fn orders(app: &TestApp) -> (usize, usize) {
    let holds: Vec<bool> = app
        .take_sent()
        .iter()
        .filter_map(
            |request| if let Request::Hold(hold) = request { Some(hold.tones.is_empty()) } else { None },
        )
        .collect();
    let ends = holds.iter().filter(|is_end| **is_end).count();
    (holds.len() - ends, ends)
}

#[test]
fn it_is_offered_by_a_device_that_can_listen() {
    let app = TestApp::driving();
    assert!(!has(&app, "Hold the level"));
    let (app, _) = sensed();
    assert!(has(&app, "Hold the level") && !is_on(&app));
    assert!(!has(&app, "Listening") && !has(&app, "Holding"));
}

#[test]
fn it_listens_holds_and_says_what_a_finger_takes() {
    let (mut app, shows) = sensed();
    type_into(&mut app, "Level", "0.2");
    press_switch(&mut app);
    wait_for(&mut app, "Listening for ");
    assert!(has(&app, "leave the plate untouched") && is_on(&app));
    wait_for(&mut app, "Holding: the plate may be touched.");
    shows.store(TOUCHED, Ordering::Relaxed);
    wait_for(&mut app, "Hz: +6.0 dB, held");
    // What the mirror does not know is not drawn, and not saved.
    assert!(words(app.window.output()).iter().any(|(text, _)| text == "not known while levels are held"));
    file_menu(&mut app, "Export drive (WAV)…");
    assert!(notice(&app).contains("its levels were held"), "{}", notice(&app));
    assert!(app.files.saved.borrow().is_empty());
    assert!(has(&app, "those of the drive's own levels"));
    orders(&app);
    press_switch(&mut app);
    app.wait(300);
    assert!(!is_on(&app) && !has(&app, "held.") && !has(&app, "Hz: +6.0 dB") && app.is_driving());
    assert_eq!(orders(&app), (0, 1));
    assert!(!app.snapshot().is_holding());
}

#[test]
fn a_drag_ends_it_and_where_the_line_rests_it_begins_anew() {
    let (mut app, _) = held();
    orders(&app);
    let line = line_rect(&app).center();
    app.window.drag_at(line);
    app.window.step();
    app.window.hover_at(line + vec2(30.0, 0.0));
    app.wait(700);
    assert!(has(&app, "Waiting until nothing is changed") && is_on(&app));
    assert_eq!(orders(&app), (0, 0));
    app.window.drop_at(line + vec2(30.0, 0.0));
    app.window.step();
    wait_for(&mut app, "Holding: the plate may be touched.");
    assert_eq!(orders(&app), (1, 0));
    assert!(!has(&app, "not held any more"), "the user has meant it");
}

#[test]
fn stop_ends_it_and_drive_does_not_bring_it_back() {
    let (mut app, _) = held();
    app.take_sent();
    app.window.key_press(Key::Escape);
    app.window.step();
    assert!(matches!(app.take_sent().first(), Some(Request::Stop)), "nothing comes before the stop");
    app.wait(300);
    assert!(!is_on(&app) && !app.is_driving() && has(&app, "Not held any more: the drive was stopped."));
    app.window.get_by_role_and_label(Role::Button, "Drive").click();
    app.wait(1000);
    assert!(app.is_driving() && !is_on(&app) && !app.snapshot().is_holding());
}

#[test]
fn a_sensor_or_a_device_that_is_unplugged_ends_it_with_the_reason() {
    let (mut app, shows) = held();
    shows.store(UNPLUGGED, Ordering::Relaxed);
    wait_for(&mut app, "Not held any more: every tone was lost");
    assert!(!is_on(&app) && app.is_driving() && notice(&app).contains("the sensor's input does not move"));
    // Nothing to hear from the beginning.
    press_switch(&mut app);
    wait_for(&mut app, "Not held any more: the sensor's input does not move");
    shows.store(FREE, Ordering::Relaxed);
    press_switch(&mut app);
    wait_for(&mut app, "Holding: the plate may be touched.");
    app.plug(false);
    app.wait(1500);
    app.plug(true);
    app.wait(2000);
    assert!(!is_on(&app) && has(&app, "Not held any more: the device went away."));
}

#[test]
fn a_measurement_ends_it_and_while_one_runs_it_is_refused() {
    let (mut app, _) = held();
    open_measure(&mut app);
    app.window.get_by_role_and_label(Role::Button, "Measure now").click();
    app.wait(100);
    let sent = app.take_sent();
    let place = |is_it: fn(&Request) -> bool| sent.iter().position(is_it);
    let end = place(|request| matches!(request, Request::Hold(hold) if hold.tones.is_empty()));
    assert!(end.is_some_and(|end| {
        place(|request| matches!(request, Request::Play(Sounding::Comb(_)))).is_none_or(|comb| end < comb)
    }));
    assert!(notice(&app).contains("the sensor is needed to measure the plate"), "{}", notice(&app));
    app.wait(500);
    assert!(has(&app, "Cancel measuring"));
    app.window.get_by_role_and_label(Role::Button, "Boundary").click();
    app.wait(100);
    press_switch(&mut app);
    assert!(!is_on(&app) && notice(&app).contains("The plate is being measured"), "{}", notice(&app));
    assert!(!app.take_sent().iter().any(|request| matches!(request, Request::Hold(_))));
}

#[test]
fn the_calibrations_look_at_the_sensor_ends_it() {
    let (mut app, _) = held();
    crate::calibrate::open_calibration(&mut app);
    assert!(app.snapshot().is_holding(), "the first page needs no sensor");
    app.window.get_by_role_and_label(Role::Button, "Next").click();
    app.wait(1500);
    assert!(!app.snapshot().is_holding() && app.is_driving() && has(&app, "The sensor now:"));
}

#[test]
fn another_plate_ends_it() {
    let (mut app, _) = held();
    crate::background::open_plate(&mut app, membrane(1.01).to_toml());
    app.wait(1500);
    app.window.get_by_role_and_label(Role::Button, "Boundary").click();
    app.wait(100);
    assert!(!is_on(&app) && has(&app, "Not held any more: the plate was changed."));
    app.window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    app.wait(1500);
    assert!(!is_on(&app));
}

#[test]
fn the_rise_is_a_limit_that_is_told_and_a_wrong_one_is_refused() {
    let (mut app, shows) = held();
    type_into(&mut app, "Rise", "61 dB");
    assert!(has(&app, "0 to 20 dB"));
    type_into(&mut app, "Rise", "3 dB");
    wait_for(&mut app, "Holding: the plate may be touched.");
    shows.store(TOUCHED, Ordering::Relaxed);
    wait_for(&mut app, "Holding, at a limit.");
    assert!(has(&app, "Hz: +3.0 dB, at the largest rise that is allowed"));
}

#[test]
fn the_finger_on_the_screen_touches_the_simulated_plate_while_the_level_is_held() {
    let bench = Bench::default();
    let mut app = TestApp::sensed(bench.inputs(), bench);
    type_into(&mut app, "Level", "0.2");
    app.wait(200);
    press_switch(&mut app);
    wait_for(&mut app, "Holding: the plate may be touched.");
    let correction_db = |app: &TestApp| {
        let held = app.snapshot().hold.expect("a hold");
        f64::from(held.tones[0].correction.0) / 100.0
    };
    assert!(correction_db(&app).abs() < 0.2);
    crate::finger::choose(&mut app, "Light");
    app.wait(2500);
    let touched_db = correction_db(&app);
    assert!(touched_db.abs() > 0.7, "{touched_db}");
    assert!(has(&app, "Holding: the plate may be touched."));
    // A drag: the finger is lifted while the plate is listened to, and comes back.
    app.window.key_press(Key::ArrowRight);
    wait_for(&mut app, "Waiting until nothing is changed");
    wait_for(&mut app, "Listening");
    wait_for(&mut app, "Holding: the plate may be touched.");
    app.wait(2500);
    assert!((correction_db(&app) - touched_db).abs() < 0.5, "{} {touched_db}", correction_db(&app));
    crate::finger::choose(&mut app, "None");
    app.wait(2500);
    assert!(correction_db(&app).abs() < 0.3, "{}", correction_db(&app));
}
