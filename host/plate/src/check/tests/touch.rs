//! The lights of the finger: its room between the edges, and the reduction of the peak.

use super::{light, report, value};
use crate::check::lights::touch::touched_db;
use crate::check::thresholds::FINGER_DB;
use crate::check::{Checker, Colour, Conditions};
use crate::{
    DriveEnd, EndSlope, Equation, Finger, Impedance, Model, Plate, PlateSpec, Progress, Response, Source,
    airy, plane, preset, respond_touched,
};
use std::f64::consts::PI;

#[test]
fn a_plate_narrower_than_a_fingertip_is_not_green() {
    // 2 W = 100 mm e^(-4.62 x).
    let mut spec = preset("membrane").expect("preset").spec().clone();
    (spec.length_m, spec.span_end_m) = (0.7, 0.5);
    let plate = Plate::new(spec).expect("plate");
    let checker = Checker::new(&plate, Conditions::default()).expect("checks");
    for (millimetres, wanted) in [(10.1, Colour::Green), (9.9, Colour::Amber), (4.9, Colour::Red)] {
        let report = checker.at((100.0_f64 / millimetres).ln() / 4.62).expect("on it");
        assert_eq!(light(&report, "width").colour, wanted, "{millimetres}");
        assert!((value(&report, "width") - millimetres / 10.0).abs() < 1e-9);
    }
}

/// The estimate of PHYSICS.md: 1 + (P^2/4) |Z_f|/Z, with the peak P = 0.5357 2 sqrt(pi k0 W0/(kappa W)) of a single
/// passing wave.
fn estimate_db(plate: &Plate, frequency_hz: f64, load: f64) -> f64 {
    let mode = plate.width_mode(1);
    let k0 = mode.wavenumber_squared(0.0, frequency_hz).sqrt();
    let turning_width_m = plate.half_width_m(mode.turning_point_m(frequency_hz));
    let kappa = plate.kappa_per_m(frequency_hz).expect("enters");
    let quarter_square =
        PI * airy::PEAK_VALUE.powi(2) * k0 * plate.half_width_m(0.0) / (kappa * turning_width_m);
    20.0 * (1.0 + quarter_square * load).log10()
}

#[test]
fn a_light_touch_costs_what_the_finger_light_says_and_the_heavy_membrane_survives_it() {
    for (name, wanted) in [("membrane", Colour::Amber), ("membrane-heavy", Colour::Green)] {
        let plate = preset(name).expect("preset");
        let checker = Checker::new(&plate, Conditions::default()).expect("checks");
        let found = light(&checker.at(0.16).expect("on it"), "finger load").clone();
        assert_eq!(found.colour, wanted, "{found:?}");
        let sites = checker.sites(&[0.16]).expect("on it");
        let hz = sites[0].frequency_hz;
        let free = plane::respond(&plate, hz, 1025, &plane::Setup::of(&plate)).expect("free");
        let place_m = free.peak.expect("a peak").position_m;
        let said_db = touched_db(&sites[0], &Finger::light(place_m));
        for (finger, said_db) in [Finger::light(place_m), Finger::firm(place_m)].into_iter().zip(said_db) {
            let setup = plane::Setup { finger: Some(finger), ..plane::Setup::of(&plate) };
            let touched = plane::respond(&plate, hz, 1025, &setup).expect("touched");
            let at = |response: &Response| {
                let index = (place_m / plate.length_m() * 1024.0).round() as usize;
                response.amplitude[index].norm()
            };
            let truth_db = 20.0 * (at(&free) / at(&touched)).log10();
            assert!((said_db - truth_db).abs() < 1.5, "{name} {said_db} {truth_db}");
            let estimate_db = estimate_db(&plate, hz, finger.load(&plate, hz).expect("stated"));
            assert!((estimate_db - truth_db).abs() < 1.5, "{name} {estimate_db} {truth_db}");
        }
    }
    assert_eq!(light(&report("paper-as-printed", 0.3), "finger load").colour, Colour::Unchecked);
}

#[test]
fn a_light_touch_takes_much_from_a_resonance_that_is_heavy_for_a_wave() {
    let plate = preset("al-bending-displacement").expect("preset");
    let span = Checker::new(&plate, Conditions::default())
        .expect("checks")
        .over_span(&mut Progress::unwatched())
        .expect("span");
    let found = light(&span, "finger load");
    assert!(found.value.expect("a number") < 0.02, "{found:?}");
    assert_eq!(found.colour, Colour::Amber, "{found:?}");
    let matched = preset("al-bending").expect("preset");
    let span = Checker::new(&matched, Conditions::default())
        .expect("checks")
        .over_span(&mut Progress::unwatched())
        .expect("span");
    assert_eq!(light(&span, "finger load").colour, Colour::Green, "{:?}", light(&span, "finger load"));
}

#[test]
fn where_no_peak_is_left_the_finger_light_judges_the_load_alone() {
    let found = report("membrane-heavy", 0.02);
    assert_eq!(light(&found, "peak").colour, Colour::Red);
    let found = light(&found, "finger load");
    assert_eq!(found.colour, Colour::Amber, "{found:?}");
    assert!(found.sentence.contains("no peak"), "{found:?}");
}

#[test]
fn a_finger_heavy_for_the_wave_is_not_green_even_where_it_takes_little() {
    // At 80 mm there is hardly one wavelength, so that even a heavy finger hardly lowers the low peak.
    let mut spec = preset("membrane-heavy").expect("preset").spec().clone();
    let Model::Membrane { tension_n_per_m, .. } = &mut spec.model else { panic!("a membrane") };
    *tension_n_per_m = tension_n_per_m.map(|tension| 0.8 * tension);
    let plate = Plate::new(spec).expect("plate");
    let checker = Checker::new(&plate, Conditions::default()).expect("checks");
    let sites = checker.sites(&[0.08]).expect("on it");
    let place_m = sites[0].response.peak.expect("a peak").position_m;
    let [light_db, _] = touched_db(&sites[0], &Finger::light(place_m));
    assert!(light_db < FINGER_DB.green, "{light_db}");
    let report = checker.at(0.08).expect("on it");
    let found = light(&report, "finger load");
    assert!((0.1..0.12).contains(&found.value.expect("a number")), "{found:?}");
    assert_eq!(found.colour, Colour::Amber, "{found:?}");
}

#[test]
fn beside_a_resonance_the_finger_light_counts_what_a_touch_takes_from_it() {
    let spec = preset("al-bending-displacement").expect("preset").spec().clone();
    let slope = EndSlope::Free;
    let plate =
        Plate::new(PlateSpec { drive_end: DriveEnd::DisplacementAndSlope { slope }, ..spec }).expect("plate");
    let checker = Checker::new(&plate, Conditions::default()).expect("checks");
    let boundaries_m: Vec<f64> = (0..40).map(|i| 0.2 + 0.001 * f64::from(i)).collect();
    let sites = checker.sites(&boundaries_m).expect("on it");
    let beside =
        sites.iter().max_by(|a, b| a.levels.rise_db.total_cmp(&b.levels.rise_db)).expect("one of forty");
    assert!(beside.levels.rise_db > 6.0, "{:?}", beside.levels);
    let finger = Finger::light(beside.response.peak.expect("a peak").position_m);
    let taken_db = |factor: f64| {
        let real = plate.with_wave_speed(factor).expect("in range");
        let free =
            respond_touched(&real, None, beside.frequency_hz, 601, Equation::Corrected).expect("responds");
        let touched = respond_touched(&real, Some(&finger), beside.frequency_hz, 601, Equation::Corrected);
        let index = (600.0 * finger.place_m / real.length_m()).round() as usize;
        let [free, touched] = [free, touched.expect("responds")].map(|it| it.amplitude[index].norm());
        20.0 * (free / touched).log10()
    };
    let most_db = [0.99, 0.995, 1.0, 1.005, 1.01].map(taken_db).into_iter().fold(0.0, f64::max);
    let [said_db, _] = touched_db(beside, &finger);
    assert!(said_db > 0.8 * most_db && most_db > 2.0 * taken_db(1.0), "{said_db} {most_db}");
}

#[test]
fn a_finger_is_put_on_the_plate_with_the_near_field_that_its_file_leaves_out() {
    let mut spec = preset("al-bending-displacement").expect("preset").spec().clone();
    spec.drive_end = DriveEnd::Resistance { ratio: 1.0, at_frequency_hz: 28e3 };
    let stated = Plate::new(spec.clone()).expect("plate");
    spec.drive_end = DriveEnd::Source(Source {
        impedance: Impedance::damper(stated.wave_impedance_n_s_per_m(28e3).expect("bending")),
        ..Source::soft(&spec.model, 28e3)
    });
    let [stated, whole] = [stated, Plate::new(spec).expect("plate")].map(|plate| {
        let checker = Checker::new(&plate, Conditions::default()).expect("checks");
        let sites = checker.sites(&[0.2087]).expect("on it");
        touched_db(&sites[0], &Finger::light(0.198))
    });
    assert!((stated[0] / whole[0] - 1.0).abs() < 1e-9 && stated[1] > 1.0, "{stated:?} {whole:?}");
}
