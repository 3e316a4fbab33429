//! Measuring with the connected device: the progress, what comes of it, and everything that ends it.

use crate::measure::open_measure;
use crate::test_app::TestApp;
use crate::type_into;
use eframe::egui::{Key, accesskit::Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use slipline_instrument::bench::Bench;
use slipline_instrument::calibration::CalibrationWizard;
use slipline_instrument::rig::secret;
use slipline_link::simulator::SimulatedInputs;
use slipline_link::{Request, Sounding};
use slipline_plate::calibrate::departure;
use slipline_plate::quantity::show_place;

/// A sensor that shows half of the drive, with noise of about a code.
pub(crate) struct Half(pub(crate) u64);

impl SimulatedInputs for Half {
    fn inputs(&self) -> usize {
        1
    }

    fn delay_ns(&self) -> i32 {
        0
    }

    fn sample(&mut self, codes: &[u16; 128], muted: bool, sensed: &mut [[u16; 128]; 2]) {
        for (sensed, &code) in sensed[0].iter_mut().zip(codes) {
            // Knuth's MMIX generator.
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let noise = (self.0 >> 62) as u16;
            let moved = if muted { 2048 } else { 1024 + code / 2 };
            *sensed = moved + noise - 1;
        }
    }
}

pub(crate) fn has(app: &TestApp, part: &str) -> bool {
    app.window.query_all_by_label_contains(part).next().is_some()
}

pub(crate) fn press(app: &mut TestApp, name: &str) {
    app.window.get_by_role_and_label(Role::Button, name).click();
    app.wait(200);
}

/// How much is measured, in words.
fn progress(app: &TestApp) -> Option<String> {
    let bars = app.window.query_all_by_role(Role::ProgressIndicator);
    let labels = bars.filter_map(|bar| bar.accesskit_node().label());
    labels.into_iter().find(|label| label.starts_with("Measured: "))
}

/// Waits until nothing is measured any more.
pub(crate) fn wait_for_the_end(app: &mut TestApp) {
    for _ in 0..400 {
        app.wait(100);
        if app.window.query_by_label("Cancel measuring").is_none() {
            return;
        }
    }
    panic!("it never ends: {:?}", app.snapshot().log);
}

fn begun() -> TestApp {
    let mut app = TestApp::sensed(Box::new(Half(1)), Bench::default());
    open_measure(&mut app);
    press(&mut app, "Measure now");
    assert!(has(&app, "Cancel measuring") && app.window.query_by_label("STOP").is_some());
    app
}

fn combs(sent: &[Request]) -> usize {
    sent.iter().filter(|request| matches!(request, Request::Play(Sounding::Comb(_)))).count()
}

#[test]
fn a_plate_is_measured_with_the_device_and_is_silent_afterwards() {
    let mut app = begun();
    app.take_sent();
    app.wait(1500);
    let share = progress(&app).unwrap();
    assert!(share != "Measured: 0 %" && share != "Measured: 100 %", "{share}");
    // Drive has to wait, and says so.
    app.window.key_press_modifiers(eframe::egui::Modifiers::COMMAND, Key::Enter);
    app.window.step();
    assert!(app.window.state().notice().is_some_and(|notice| notice.text.contains("is being measured")));
    wait_for_the_end(&mut app);
    let sent = app.take_sent();
    assert!(combs(&sent) >= 3 && matches!(sent.last(), Some(Request::Stop | Request::Note(..))), "{sent:?}");
    assert!(!sent.iter().any(|request| matches!(request, Request::Play(Sounding::Drive(_)))));
    app.wait(500);
    assert!(!app.is_driving());
    assert!(app.window.query_by_label("30.0 mm, run 1").is_some());
    assert!(has(&app, "60 from ") && has(&app, "acceleration") && has(&app, "Measured differs"));
}

#[test]
fn cancel_stop_and_another_plate_end_a_measurement_and_nothing_is_kept() {
    let ends: [fn(&mut TestApp); 3] = [
        |app| press(app, "Cancel measuring"),
        |app| {
            app.window.key_press(Key::Escape);
            app.wait(200);
        },
        |app| crate::background::open_plate(app, crate::measure::membrane(1.01).to_toml()),
    ];
    for end in ends {
        let mut app = begun();
        app.wait(700);
        app.take_sent();
        end(&mut app);
        app.wait(500);
        let sent = app.take_sent();
        assert!(sent.iter().any(|request| matches!(request, Request::Stop)), "{sent:?}");
        assert_eq!(combs(&sent), 0);
        open_measure(&mut app);
        assert!(!has(&app, "run 1") && !app.is_driving());
        assert!(app.window.query_by_label("Measure now").is_some());
    }
}

#[test]
fn a_device_that_goes_away_ends_it_with_a_reason() {
    let mut app = begun();
    app.wait(700);
    app.plug(false);
    app.wait(2000);
    assert!(app.window.query_by_label("Cancel measuring").is_none() && !has(&app, "run 1"));
    assert!(has(&app, "Not measured: the device went away."));
}

#[test]
fn what_a_device_or_a_typed_value_does_not_allow_is_told() {
    let mut app = TestApp::driving();
    open_measure(&mut app);
    press(&mut app, "Measure now");
    assert!(has(&app, "This device has no input for a sensor"));
    assert!(app.is_driving(), "nothing was stopped");
    type_into(&mut app, "Sensor at", "900 mm");
    assert!(has(&app, "320 mm"));
    type_into(&mut app, "Level", "2");
    assert!(has(&app, "level"));
    let level = app.window.get_by_role_and_label(Role::TextInput, "Level").value();
    assert_eq!(level.as_deref(), Some("2"), "it stays to be corrected");
}

#[test]
fn the_sensor_is_seen_while_it_is_put_in_its_place() {
    let mut app = TestApp::sensed(Box::new(Half(3)), Bench::default());
    crate::calibrate::open_calibration(&mut app);
    assert!(!has(&app, "The sensor now:"), "no sensor on the first page");
    press(&mut app, "Next");
    app.wait(1500);
    // Half of what is driven, and nothing else was asked of the device.
    assert!(
        has(&app, "The sensor now:") && has(&app, "dB of full scale. Tap on the plate"),
        "{:?}",
        app.snapshot().log
    );
    assert!(app.is_driving(), "looking stops nothing");
    app.take_sent();
    app.wait(1000);
    let looks = app.take_sent().iter().filter(|request| matches!(request, Request::Listen(_))).count();
    assert!((2..=10).contains(&looks), "{looks} in a second");
    app.window.key_press(Key::Escape);
    app.wait(1000);
    app.take_sent();
    app.wait(500);
    assert!(
        !app.take_sent().iter().any(|request| matches!(request, Request::Listen(_))),
        "the pages are closed"
    );
}

#[test]
fn the_calibrations_pages_measure_too() {
    let mut app = TestApp::sensed(Box::new(Half(2)), Bench::default());
    crate::calibrate::open_calibration(&mut app);
    press(&mut app, "Next");
    press(&mut app, "Next");
    let place = app.window.get_by_role_and_label(Role::TextInput, "Sensor at").value();
    let place = place.unwrap();
    let [proposed_m, _] = CalibrationWizard::of(&app.window.state().setup().plate).places_m();
    assert_eq!(place, show_place(proposed_m));
    press(&mut app, "Measure now");
    assert!(app.window.get_by_role_and_label(Role::Button, "Next").accesskit_node().is_disabled());
    wait_for_the_end(&mut app);
    assert!(!app.window.get_by_role_and_label(Role::Button, "Next").accesskit_node().is_disabled());
    assert!(has(&app, &format!("{place}, run 1 at {place}")));
}

/// The page of measurements, with a simulated plate that nobody knows.
pub(crate) fn on_a_secret_plate() -> TestApp {
    let bench = Bench::default();
    let mut app = TestApp::sensed(bench.inputs(), bench);
    open_measure(&mut app);
    app.window.get_by_label("A secret plate, a few per cent off").click();
    app.wait(200);
    app
}

/// The wizard from its first page to the result, with the simulated device.
fn calibrate_by_measuring(app: &mut TestApp) {
    press(app, "Calibrate…");
    press(app, "Next");
    press(app, "Next");
    for _ in 0..2 {
        press(app, "Measure now");
        wait_for_the_end(app);
        press(app, "Next");
    }
}

/// The whole way of somebody new, on a plate that nobody knows.
#[test]
fn a_plate_that_is_secretly_off_is_measured_calibrated_and_then_fits() {
    let mut app = on_a_secret_plate();
    press(&mut app, "Measure now");
    wait_for_the_end(&mut app);
    assert!(has(&app, "Measured differs"));
    calibrate_by_measuring(&mut app);
    assert_eq!(crate::calibrate::page(&app), Some(5));
    press(&mut app, "Use this plate");
    app.wait(1500);
    assert!(has(&app, "The plate's model fits"));
    let nominal = crate::measure::membrane(1.0);
    let truth = secret(&nominal, 1).unwrap();
    let used = app.window.state().setup().plate.clone();
    let off = |plate: &slipline_plate::Plate| 1e3 * departure(plate, &truth, 400e3).unwrap().boundary_m;
    assert!(off(&used) < 1.0 && off(&used) < 0.3 * off(&nominal), "{} {} mm", off(&nominal), off(&used));
}

/// The dB by which half of the answers are off the model, as the page says.
fn off_db(app: &TestApp) -> Option<f64> {
    let node = app.window.query_all_by_label_contains("half of the answers are").next()?;
    let text = node.accesskit_node().label().or_else(|| node.accesskit_node().value())?;
    let number = text.split("more than ").nth(1).or_else(|| text.split("within ").nth(1))?;
    number.split(' ').next()?.parse().ok()
}

#[test]
fn a_secret_plate_is_drawn_anew_with_every_other_plate() {
    let mut app = on_a_secret_plate();
    crate::background::open_plate(&mut app, crate::measure::membrane(1.5).to_toml());
    app.wait(1500);
    open_measure(&mut app);
    let switch = app.window.get_by_role_and_label(Role::CheckBox, "A secret plate, a few per cent off");
    assert_eq!(switch.accesskit_node().toggled(), Some(eframe::egui::accesskit::Toggled::True));
    press(&mut app, "Measure now");
    wait_for_the_end(&mut app);
    // A few per cent, and not the half by which the plates differ.
    let off = off_db(&app).unwrap();
    assert!((0.2..5.0).contains(&off), "{off} dB");
}

#[test]
fn a_measurement_that_ends_a_drive_says_so() {
    let mut app = begun();
    wait_for_the_end(&mut app);
    let notice = app.window.state().notice().cloned().unwrap();
    assert!(notice.text.ends_with("The drive was stopped for it: press Drive to go on."), "{notice:?}");
    press(&mut app, "Measure now");
    app.wait(500);
    press(&mut app, "Cancel measuring");
    app.wait(500);
    let notice = app.window.state().notice().cloned().unwrap();
    assert_eq!(notice.text, "The measurement was cancelled.", "nothing was driven");
}

#[test]
fn the_rig_rests_while_nobody_listens_and_has_settled_when_it_is_heard() {
    let bench = Bench::default();
    let mut app = TestApp::sensed(bench.inputs(), bench.clone());
    open_measure(&mut app);
    press(&mut app, "Measure now");
    wait_for_the_end(&mut app);
    app.window.get_by_label("Drive").click();
    app.wait(1000);
    assert!(app.is_driving());
    let mut sensed = [[0; 128]; 2];
    bench.inputs().sample(&[3000; 128], false, &mut sensed);
    assert_eq!(sensed, [[2048; 128]; 2], "it costs nothing");
    crate::calibrate::open_calibration(&mut app);
    press(&mut app, "Next");
    app.wait(1500);
    assert!(has(&app, "dB of full scale"), "it is heard");
}

#[test]
fn while_it_is_measured_nothing_moves_under_a_pointer_that_presses_twice() {
    let mut app = TestApp::sensed(Box::new(Half(2)), Bench::default());
    crate::calibrate::open_calibration(&mut app);
    press(&mut app, "Next");
    press(&mut app, "Next");
    press(&mut app, "Measure now");
    wait_for_the_end(&mut app);
    press(&mut app, "Next");
    let at = |app: &TestApp, name: &str| app.window.get_by_role_and_label(Role::Button, name).rect();
    let before = ["Measure now", "Open file…", "Next", "Back", "Cancel"].map(|name| at(&app, name));
    let level = app.window.get_by_role_and_label(Role::TextInput, "Level");
    assert!(level.accesskit_node().is_disabled(), "it stays as it was at the first place");
    press(&mut app, "Measure now");
    assert_eq!(["Measure now", "Open file…", "Next", "Back", "Cancel"].map(|name| at(&app, name)), before);
    for name in ["Measure now", "Next"] {
        let button = app.window.get_by_role_and_label(Role::Button, name);
        assert!(button.accesskit_node().is_disabled(), "{name}");
    }
    wait_for_the_end(&mut app);
}

#[test]
fn a_tap_on_the_simulated_plate_is_seen_by_its_sensor() {
    let bench = Bench::default();
    let mut app = TestApp::sensed(bench.inputs(), bench);
    app.window.key_press(Key::Space);
    app.wait(500);
    crate::calibrate::open_calibration(&mut app);
    press(&mut app, "Next");
    app.wait(2500);
    let level_db = |app: &TestApp| -> f64 {
        let node = app.window.query_all_by_label_contains("The sensor now:").next().unwrap();
        let text = node.accesskit_node().label().or_else(|| node.accesskit_node().value()).unwrap();
        let number = text.split(": ").nth(1).and_then(|rest| rest.split(' ').next());
        number.and_then(|number| number.replace('\u{2212}', "-").parse().ok()).unwrap_or(-99.0)
    };
    let quiet = level_db(&app);
    press(&mut app, "Tap on the simulated plate");
    app.wait(200);
    let tapped = level_db(&app);
    assert!(tapped > quiet + 10.0, "{quiet} {tapped}");
}

/// The whole way of somebody new, and what the simulated plate shows afterwards.
#[test]
fn after_a_calibration_the_rings_of_the_simulated_plate_lie_on_the_curve() {
    let mut app = on_a_secret_plate();
    calibrate_by_measuring(&mut app);
    press(&mut app, "Use this plate");
    app.wait(1500);
    app.window.get_by_role_and_label(Role::Button, "Boundary").click();
    app.wait(100);
    app.window.get_by_label("Drive").click();
    app.wait(2500);
    // The plate that nobody knew, by what a calibration leaves open of it.
    let left = crate::plate_there::rings_off(app.window.output()).unwrap();
    assert!(left < 0.04, "{left}");
    // The calibrated plate itself.
    open_measure(&mut app);
    app.window.get_by_label("A secret plate, a few per cent off").click();
    app.wait(200);
    app.window.get_by_role_and_label(Role::Button, "Boundary").click();
    app.wait(1500);
    // What the menu exports: the curve and the rings, in metres.
    app.window.get_by_label("File").click();
    app.wait(200);
    app.window.get_by_label_contains("Export envelope").click();
    app.wait(200);
    let (_, bytes) = app.files.saved.borrow().last().cloned().unwrap();
    let text = String::from_utf8(bytes).unwrap();
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column =
        |name: &str| head.iter().position(|head| *head == name).unwrap_or_else(|| panic!("{head:?}"));
    let rows: Vec<Vec<Option<f64>>> =
        lines.map(|line| line.split(',').map(|cell| cell.parse().ok()).collect()).collect();
    let of = |name: &str| -> Vec<(f64, f64)> {
        let (x, y) = (column("position_m"), column(name));
        rows.iter().filter_map(|row| Some((row[x]?, row[y]?))).collect()
    };
    let (curve, rings) = (of("predicted_maximum_m"), of("simulated_maximum_m"));
    let top_m = curve.iter().map(|(_, metres)| *metres).fold(0.0, f64::max);
    let mut places = 0;
    for (x_m, ring_m) in rings {
        let after = curve.partition_point(|(x, _)| *x < x_m).clamp(1, curve.len() - 1);
        let ((a, low_m), (b, high_m)) = (curve[after - 1], curve[after]);
        let curve_m = low_m + (high_m - low_m) * (x_m - a) / (b - a);
        if curve_m > 0.3 * top_m {
            places += 1;
            assert!((ring_m / curve_m - 1.0).abs() < 0.01, "{x_m}: {ring_m}, not {curve_m}");
        }
    }
    assert!(places >= 5, "{places}");
}
