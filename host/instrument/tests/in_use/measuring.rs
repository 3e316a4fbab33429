//! Measuring with the connected device: what is sent and kept, and everything that ends it.

use crate::sensors::Half;
use crate::session::{Session, drives, membrane};
use slipline_instrument::calibration::{CalibrationWizard, WizardPage};
use slipline_instrument::{CalibrateIntent, MeasureIntent};
use slipline_link::{Request, Sounding};
use slipline_model::field::steady_field::{POINTS, SteadyField};
use slipline_model::setup::edit::Edit;
use slipline_plate::calibrate::{Comparison, SensorKind};
use slipline_plate::quantity::show_place;

/// What is said after a measurement that has ended a drive.
const DRIVE_ENDED: &str = "The drive was stopped for it: press Drive to resume.";

fn begin(session: &mut Session) {
    session.instrument.perform_measure(MeasureIntent::Begin(None));
    session.pass(200);
}

/// A measurement under way, which has ended a drive.
fn begun() -> Session {
    let mut session = Session::sensed(Half(1));
    begin(&mut session);
    assert!(session.is_measuring());
    session
}

fn combs(sent: &[Request]) -> usize {
    sent.iter().filter(|request| matches!(request, Request::Play(Sounding::Comb(_)))).count()
}

/// How often the sensor is listened to.
fn looks(session: &Session) -> usize {
    session.take_requests().iter().filter(|request| matches!(request, Request::Listen(_))).count()
}

/// The names of the measurements.
fn names(session: &Session) -> Vec<String> {
    session.instrument.shown().measure.shelf.entries().iter().map(|entry| entry.name.clone()).collect()
}

fn compared(session: &Session) -> Comparison {
    session.instrument.shown().measure.comparison().unwrap().clone()
}

fn has_signal(session: &Session) -> bool {
    session.instrument.shown().measure.live.signal.is_some()
}

/// Opens the calibration on this page.
fn open_calibration(session: &mut Session, page: WizardPage) {
    session.instrument.perform_calibrate(CalibrateIntent::Open);
    session.open_wizard(page);
}

#[test]
fn a_plate_is_measured_with_the_device_and_is_silent_afterwards() {
    let mut session = begun();
    session.take_requests();
    session.pass(1500);
    let share = session.instrument.shown().measure.live.progress.unwrap().share;
    assert!(share > 0.0 && share < 1.0, "{share}");
    // Drive has to wait, and says so.
    session.instrument.start();
    session.turn();
    assert!(session.notice().contains("is being measured"), "{}", session.notice());
    session.end_of_measuring();
    let sent = session.take_requests();
    assert!(combs(&sent) >= 3 && matches!(sent.last(), Some(Request::Stop | Request::Note(..))), "{sent:?}");
    assert!(drives(&sent).is_empty());
    session.pass(500);
    assert!(!session.is_driving());
    assert_eq!(names(&session), ["30.0 mm, run 1"]);
    let measurement = session.instrument.shown().measure.shelf.chosen().unwrap().measurement.clone();
    assert_eq!((measurement.points.len(), measurement.sensor), (60, SensorKind::Acceleration));
    assert!(compared(&session).is_other_plate());
}

#[test]
fn while_the_plate_is_measured_the_setup_is_at_rest_and_its_lines_stay() {
    let mut session = begun();
    let line_mm = session.line_mm();
    // Within a comb and between two, for three seconds.
    for _ in 0..60 {
        session.pass(50);
        let shown = session.instrument.shown();
        assert!(shown.is_measured_now() && shown.sounding.is_none(), "a comb is no drive of the setup");
    }
    session.move_to(line_mm - 20.0);
    assert_eq!(session.line_mm(), line_mm);
    session.instrument.perform_measure(MeasureIntent::Cancel);
    session.pass(500);
    session.move_to(line_mm - 20.0);
    assert!((session.line_mm() - line_mm + 20.0).abs() < 0.1);
}

#[test]
fn the_time_left_of_a_measurement_is_the_time_that_it_takes() {
    let mut session = begun();
    let mut said = Vec::new();
    while let Some(progress) = session.instrument.shown().measure.live.progress {
        said.push((session.attention.now_s, progress));
        session.pass(250);
    }
    let words = said[0].1.to_string();
    assert!(words.contains(" %, ") && words.ends_with(" s left"), "{words}");
    let end_s = session.attention.now_s;
    for (now_s, progress) in said.into_iter().filter(|(_, progress)| progress.share > 0.3) {
        let (left_s, takes_s) = (progress.left_s.unwrap(), end_s - now_s);
        assert!((left_s - takes_s).abs() < 1.0 + 0.3 * takes_s, "{progress}: it takes {takes_s} s");
    }
}

#[test]
fn each_answer_is_shown_as_it_comes_and_lies_on_the_curve_of_the_simulated_plate() {
    let (mut session, _) = Session::at_bench();
    begin(&mut session);
    let (mut counts, mut worst_db) = (Vec::new(), 0.0_f64);
    let is_computed = |session: &Session| {
        session.instrument.shown().measure.live.so_far.is_some_and(|so_far| !so_far.predicted.is_empty())
    };
    session.until("the model's curve is computed", is_computed);
    while let Some(so_far) = session.instrument.shown().measure.live.so_far {
        let levels = so_far.levels_db();
        assert_eq!((levels.model.len(), so_far.planned.len()), (60, 60));
        for [hertz, level_db] in &levels.measured {
            let [_, model_db] =
                levels.model.iter().find(|at| (at[0] - hertz).abs() < 1e-6).expect("it was planned");
            worst_db = worst_db.max((level_db - model_db).abs());
        }
        counts.push(levels.measured.len());
        session.pass(100);
    }
    counts.dedup();
    assert!(counts.len() > 3 && counts.is_sorted() && counts[0] == 0, "{counts:?}");
    assert!(counts.contains(&60) && worst_db < 1.0, "{counts:?}, {worst_db} dB");
    assert!(!compared(&session).is_other_plate());
}

#[test]
fn measurements_belong_to_their_plate() {
    let mut session = begun();
    session.instrument.perform_measure(MeasureIntent::Cancel);
    session.pass(500);
    session.measure(None);
    let run_1 = ["30.0 mm, run 1"];
    assert_eq!(names(&session), run_1, "a cancelled run has no number");
    session.change_plate(slipline_plate::preset("al-bending").unwrap());
    session.pass(500);
    let shown = session.instrument.shown().measure;
    assert!(shown.shelf.entries().is_empty() && shown.compared.is_none(), "a fresh plate has none");
    session.instrument.undo();
    session.pass(500);
    assert_eq!(names(&session), run_1);
    session.change_plate(membrane(1.01));
    session.pass(500);
    assert_eq!(names(&session), run_1, "the same plate with another number");
}

#[test]
fn lines_keep_their_places_when_the_calibrated_plate_is_used() {
    let mut session = Session::felt_at_bench();
    let tone = &session.instrument.desk.setup().tones[0];
    let quiet = Edit::Level { slot: tone.slot, level: 0.05 };
    session.edit(&quiet);
    session.pass(500);
    session.instrument.perform_measure(MeasureIntent::Secret(true));
    let (before_mm, full_m) = (session.line_mm(), session.instrument.shown().full_peak_m.unwrap());
    session.calibrate_by_measuring();
    let now_m = session.instrument.shown().full_peak_m.unwrap();
    assert!(now_m < 0.8 * full_m, "the unknown plate is lossier: {full_m} {now_m}");
    assert!((session.line_mm() - before_mm).abs() < 0.1, "{before_mm} {}", session.line_mm());
    let notices: Vec<&str> = session.instrument.out.notices().map(|it| it.text.as_str()).collect();
    let said = notices.iter().find(|text| text.contains("At level 1 the calibrated plate moves by"));
    assert!(said.is_some(), "{notices:?}");
    // One step of undo takes the plate and the tone's place back.
    let calibrated_m = session.instrument.desk.setup().tones[0].position_m;
    session.instrument.undo();
    session.pass(500);
    assert_ne!(session.instrument.desk.setup().tones[0].position_m, calibrated_m);
    assert!((session.line_mm() - before_mm).abs() < 0.1);
}

#[test]
fn cancel_stop_and_another_plate_end_a_measurement_and_nothing_is_kept() {
    let ends: [fn(&mut Session); 3] = [
        |session| session.instrument.perform_measure(MeasureIntent::Cancel),
        |session| session.instrument.press_stop(),
        |session| session.change_plate(membrane(1.01)),
    ];
    for end in ends {
        let mut session = begun();
        session.pass(700);
        session.take_requests();
        end(&mut session);
        session.pass(700);
        let sent = session.take_requests();
        assert!(sent.iter().any(|request| matches!(request, Request::Stop)), "{sent:?}");
        assert_eq!(combs(&sent), 0);
        assert!(names(&session).is_empty() && !session.is_driving() && !session.is_measuring());
    }
}

#[test]
fn a_device_that_disconnects_ends_the_measurement_with_a_reason() {
    let mut session = begun();
    session.pass(700);
    session.plug(false, 2000);
    assert!(!session.is_measuring() && names(&session).is_empty());
    let failed = session.instrument.shown().measure.live.failed.unwrap().to_owned();
    assert!(failed.starts_with("Not measured: the device disconnected."), "{failed}");
}

#[test]
fn what_a_device_refuses_is_reported() {
    let mut session = Session::driving();
    begin(&mut session);
    assert!(session.notice().contains("This device has no input for a sensor"), "{}", session.notice());
    assert!(session.is_driving(), "nothing was stopped");
}

#[test]
fn the_sensor_is_seen_while_it_is_put_in_its_place() {
    let mut session = Session::sensed(Half(3));
    session.instrument.perform_calibrate(CalibrateIntent::Open);
    session.pass(500);
    assert!(!has_signal(&session), "no sensor on the first page");
    session.open_wizard(WizardPage::FirstPlace);
    session.pass(1500);
    // Half of what is driven, and nothing else was asked of the device.
    assert!(has_signal(&session) && session.is_driving(), "looking stops nothing");
    session.take_requests();
    session.pass(1000);
    let count = looks(&session);
    assert!((2..=10).contains(&count), "{count} in a second");
    (session.attention.has_page, session.attention.is_calibration_open) = (false, false);
    session.pass(1000);
    looks(&session);
    session.pass(500);
    assert_eq!(looks(&session), 0, "the pages are closed");
}

#[test]
fn the_calibrations_pages_measure_too() {
    let mut session = Session::sensed(Half(2));
    open_calibration(&mut session, WizardPage::FirstAnswer);
    let [proposed_m, ..] = CalibrationWizard::of(&session.instrument.desk.setup().plate).places_m();
    assert_eq!(session.instrument.shown().measure.live.draft.place_m, proposed_m);
    let answer = |session: &Session| {
        let calibration = session.instrument.shown().calibration.unwrap().calibration.clone();
        calibration.answer(0).map(|answer| answer.name.clone())
    };
    assert_eq!(answer(&session), None);
    session.measure(Some(0));
    assert_eq!(answer(&session), Some(format!("{}, run 1", show_place(proposed_m))));
}

#[test]
fn a_secret_plate_is_drawn_again_with_every_other_plate() {
    let mut session = Session::at_bench().0;
    session.instrument.perform_measure(MeasureIntent::Secret(true));
    session.change_plate(membrane(1.5));
    session.pass(1500);
    assert!(session.instrument.shown().measure.live.is_secret);
    session.measure(None);
    // A few per cent, and not the half by which the plates differ.
    let off_db = compared(&session).usual_db;
    assert!((0.2..5.0).contains(&off_db), "{off_db} dB");
}

#[test]
fn a_measurement_that_ends_a_drive_says_so() {
    let mut session = begun();
    session.end_of_measuring();
    assert!(session.notice().ends_with(DRIVE_ENDED), "{}", session.notice());
    begin(&mut session);
    session.pass(300);
    session.instrument.perform_measure(MeasureIntent::Cancel);
    session.pass(500);
    assert_eq!(session.notice(), "The measurement was cancelled.", "nothing was driven");
}

#[test]
fn the_rig_rests_without_a_listener_and_has_settled_when_it_is_sampled() {
    let (mut session, bench) = Session::at_bench();
    session.measure(None);
    session.instrument.start();
    session.pass(1000);
    assert!(session.is_driving());
    let mut sensed = [[0; 128]; 2];
    bench.inputs().sample(&[3000; 128], false, &mut sensed);
    assert_eq!(sensed, [[2048; 128]; 2], "it costs nothing");
    open_calibration(&mut session, WizardPage::FirstPlace);
    session.pass(1500);
    let level_db = session.instrument.shown().measure.live.signal.unwrap().level_db();
    assert!(level_db.is_finite(), "it is heard: {level_db}");
}

/// The predicted envelope at this place, in metres.
fn curve_m(field: &SteadyField, x_m: f64) -> f64 {
    let at = x_m / field.length_m * (POINTS - 1) as f64;
    let before = (at.max(0.0) as usize).min(POINTS - 2);
    let (low_m, high_m) = (field.bound_m[before], field.bound_m[before + 1]);
    low_m + (high_m - low_m) * (at - before as f64)
}

/// The whole way of somebody new, and what the simulated plate shows afterwards.
#[test]
fn after_a_calibration_the_simulated_plate_moves_as_is_predicted() {
    let mut session = Session::new();
    session.pass(2000);
    session.instrument.perform_measure(MeasureIntent::Secret(true));
    session.calibrate_by_measuring();
    session.instrument.start();
    session.pass(2500);
    // The envelope of the simulated plate beside the predicted one, and the largest of that.
    let both = |session: &Session| {
        let shown = session.instrument.shown();
        let rings = shown.measured.unwrap();
        assert!(rings.is_current);
        let points: Vec<(f64, f64)> =
            rings.field.points().map(|(x_m, m)| (m, curve_m(shown.predicted, x_m))).collect();
        let top_m = points.iter().map(|(_, curve_m)| *curve_m).fold(0.0, f64::max);
        (points, top_m)
    };
    // The plate that nobody knew, by what a calibration leaves open of it: the level, and a little of the shape.
    let (points, top_m) = both(&session);
    let highest_m = points.iter().map(|(m, _)| *m).fold(0.0, f64::max);
    let off = |&(m, curve_m): &(f64, f64)| (m / highest_m - curve_m / top_m).abs();
    let left = points.iter().map(off).fold(0.0, f64::max);
    assert!(left < 0.04, "{left}");
    // The calibrated plate itself.
    session.instrument.perform_measure(MeasureIntent::Secret(false));
    session.pass(1500);
    let (points, top_m) = both(&session);
    let high: Vec<f64> =
        points.iter().filter(|(_, curve_m)| *curve_m > 0.3 * top_m).map(|(m, curve_m)| m / curve_m).collect();
    assert!(high.len() >= 5 && high.iter().all(|share| (share - 1.0).abs() < 0.01), "{high:?}");
}

#[test]
fn the_harmonics_of_the_drive_are_measured_stated_by_the_plate_and_cancelled() {
    let (mut session, _) = Session::at_bench();
    session.instrument.cancel_harmonics();
    assert!(session.notice().starts_with("The plate file states no harmonics"), "{}", session.notice());
    session.instrument.perform_measure(MeasureIntent::Harmonics);
    assert!(session.is_measuring(), "{}", session.notice());
    session.end_of_measuring();
    session.turn();
    assert!(session.notice().starts_with("Second harmonic: "), "{}", session.notice());
    let plate = session.instrument.desk.setup().plate.clone();
    let harmonics = plate.spec().harmonics.clone().expect("measured");
    assert!(harmonics.curve(2).is_some_and(|curve| curve.points.len() == 8 && curve.points[0][1] < -60.0));
    session.instrument.cancel_harmonics();
    assert!(session.notice().starts_with("Press Drive first"), "{}", session.notice());
    session.instrument.start();
    session.until("it drives", Session::is_driving);
    session.take_requests();
    session.instrument.cancel_harmonics();
    session.pass(300);
    let sent = session.take_requests();
    let combs: Vec<_> = sent
        .iter()
        .filter_map(|request| match request {
            Request::Play(Sounding::Comb(comb)) => Some(comb),
            _ => None,
        })
        .collect();
    let [comb] = combs[..] else { panic!("{sent:?}") };
    let multiples: Vec<u16> = comb.tones.iter().map(|tone| tone.harmonic).collect();
    assert_eq!(multiples, [multiples[0], 2 * multiples[0], 3 * multiples[0]]);
    assert!(session.is_driving());
    // A change of the tone plays it alone.
    session.move_to(150.0);
    session.pass(100);
    let sent = session.take_requests();
    assert!(sent.iter().any(|request| matches!(request, Request::Play(Sounding::Drive(_)))), "{sent:?}");
    session.instrument.undo();
    session.instrument.undo();
    assert!(session.instrument.desk.setup().plate.spec().harmonics.is_none(), "Undo takes it back");
}
