//! The lights of the finger: its room between the edges, and what it takes from the peak.

use super::{light, report, value};
use crate::check::lights::touch::touched_db;
use crate::check::{Checker, Colour, Conditions};
use crate::{Finger, Plate, Response, airy, plane, preset};
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

/// The estimate of PHYSICS.md: 1 + (P^2/4) |Z_f|/Z with the peak P = 0.5357 2 sqrt(pi k0 W0/(kappa W)) of a wave that
/// passes once.
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
        let free = plane::respond(&plate, hz, 257, &plane::Setup::of(&plate)).expect("free");
        let place_m = free.peak.expect("a peak").position_m;
        let said_db = touched_db(&sites[0], &Finger::light(place_m));
        for (finger, said_db) in [Finger::light(place_m), Finger::firm(place_m)].into_iter().zip(said_db) {
            let setup = plane::Setup { finger: Some(finger), ..plane::Setup::of(&plate) };
            let touched = plane::respond(&plate, hz, 257, &setup).expect("touched");
            let at = |response: &Response| {
                let index = (place_m / plate.length_m() * 256.0).round() as usize;
                response.amplitude[index].norm()
            };
            let truth_db = 20.0 * (at(&free) / at(&touched)).log10();
            assert!((said_db - truth_db).abs() < 1.5, "{name} {said_db} {truth_db}");
            let estimate_db = estimate_db(&plate, hz, finger.load(&plate, hz).expect("told"));
            assert!((estimate_db - truth_db).abs() < 1.5, "{name} {estimate_db} {truth_db}");
        }
    }
    assert_eq!(light(&report("paper-as-printed", 0.3), "finger load").colour, Colour::Unchecked);
}

#[test]
fn a_light_touch_takes_much_from_a_resonance_that_is_heavy_for_a_wave() {
    let plate = preset("al-bending-displacement").expect("preset");
    let span = Checker::new(&plate, Conditions::default()).expect("checks").over_span().expect("span");
    let found = light(&span, "finger load");
    assert!(found.value.expect("a number") < 0.02, "{found:?}");
    assert_eq!(found.colour, Colour::Amber, "{found:?}");
    let matched = preset("al-bending").expect("preset");
    let span = Checker::new(&matched, Conditions::default()).expect("checks").over_span().expect("span");
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
