//! The lights of the finger: its room between the edges, and what it takes from the peak.

use super::{light, report, value};
use crate::check::lights::touch::touched_db;
use crate::check::{Checker, Colour, Conditions};
use crate::{Finger, Plate, Response, plane, preset};

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

#[test]
fn a_light_touch_costs_what_the_finger_light_says_and_the_heavy_membrane_survives_it() {
    for (name, wanted) in [("membrane", Colour::Amber), ("membrane-heavy", Colour::Green)] {
        let plate = preset(name).expect("preset");
        let report = report(name, 0.16);
        let found = light(&report, "finger load");
        assert_eq!(found.colour, wanted, "{found:?}");
        let hz = report.frequency_hz.0;
        let free = plane::respond(&plate, hz, 257, &plane::Setup::of(&plate)).expect("free");
        let place_m = free.peak.expect("a peak").position_m;
        for finger in [Finger::light(place_m), Finger::firm(place_m)] {
            let setup = plane::Setup { finger: Some(finger), ..plane::Setup::of(&plate) };
            let touched = plane::respond(&plate, hz, 257, &setup).expect("touched");
            let at = |response: &Response| {
                let index = (place_m / plate.length_m() * 256.0).round() as usize;
                response.amplitude[index].norm()
            };
            let truth_db = 20.0 * (at(&free) / at(&touched)).log10();
            let load = finger.load(&plate, hz).expect("told");
            let said_db = touched_db(&plate, hz, load);
            assert!((said_db - truth_db).abs() < 1.5, "{name} {said_db} {truth_db}");
        }
    }
    assert_eq!(light(&report("paper-as-printed", 0.3), "finger load").colour, Colour::Unchecked);
}
