//! Actuator band, excursion and DAC resolution.

use super::{light, value};
use crate::check::{Checker, Colour, Conditions};
use crate::{Plate, Progress, preset, presets};

#[test]
fn the_actuator_light_follows_its_resonance() {
    let mut spec = preset("membrane").expect("preset").spec().clone();
    spec.actuator = Some(crate::Actuator::Resonator(crate::Resonator {
        resonance_hz: 200.0,
        quality: 0.7,
        travel: None,
    }));
    let plate = Plate::new(spec.clone()).expect("plate");
    let report = Checker::new(&plate, Conditions::default()).expect("checks").at(0.16).expect("on it");
    assert_eq!(light(&report, "actuator band").colour, Colour::Green);
    // Two and a half octaves above resonance: -12 dB per octave.
    spec.actuator =
        Some(crate::Actuator::Resonator(crate::Resonator { resonance_hz: 20.0, quality: 0.7, travel: None }));
    let plate = Plate::new(spec).expect("plate");
    let report = Checker::new(&plate, Conditions::default()).expect("checks").at(0.16).expect("on it");
    assert_eq!(light(&report, "actuator band").colour, Colour::Red);
    let expected = -40.0 * (125.62_f64 / 20.0).log10();
    assert!((value(&report, "actuator band") - expected).abs() < 0.3, "{}", value(&report, "actuator band"));
}

#[test]
fn a_measured_actuator_that_does_not_reach_the_frequency_is_amber() {
    let mut spec = preset("membrane").expect("preset").spec().clone();
    let points = vec![[20.0, 0.0, 0.0], [110.0, -3.0, -45.0]];
    spec.actuator = Some(crate::Actuator::Measured(crate::ResponseCurve { points }));
    let checker = Checker::new(&Plate::new(spec).expect("plate"), Conditions::default()).expect("checks");
    let found = |boundary_m: f64| {
        let report = checker.at(boundary_m).expect("on it");
        (light(&report, "actuator band").colour, light(&report, "actuator band").value)
    };
    let near_m = checker.plate().turning_point_m(100.0).expect("enters");
    assert_eq!(found(near_m).0, Colour::Green);
    assert_eq!(found(0.2), (Colour::Amber, None));
}

#[test]
fn a_band_that_nothing_is_known_of_is_unchecked_and_no_worry() {
    for preset in presets() {
        let plate = preset.plate().expect("a preset");
        let checker = Checker::new(&plate, Conditions::default()).expect("checks");
        for mut report in [
            checker.at(plate.span_m().0).expect("on it"),
            checker.over_span(&mut Progress::unwatched()).expect("span"),
        ] {
            let band = light(&report, "actuator band");
            assert_eq!((band.colour, band.value), (Colour::Unchecked, None));
            report.lights.retain(|light| light.colour <= Colour::Green);
            assert_eq!(report.worst(), Colour::Green, "{}", preset.name);
        }
    }
}

#[test]
fn the_excursion_light_reports_travel_and_what_the_limit_takes() {
    let checker = |static_m: Option<f64>| {
        let mut spec = preset("membrane").expect("preset").spec().clone();
        let travel = static_m.map(|static_m| crate::Travel { peak_m: 1e-4, static_m });
        spec.actuator =
            Some(crate::Actuator::Resonator(crate::Resonator { resonance_hz: 60.0, quality: 0.7, travel }));
        Checker::new(&Plate::new(spec).expect("plate"), Conditions::default()).expect("checks")
    };
    let excursion = |static_m: f64| {
        let report = checker(Some(static_m)).over_span(&mut Progress::unwatched()).expect("span");
        let found = light(&report, "excursion");
        (found.value.expect("a number"), found.colour)
    };
    let (small, colour) = excursion(1e-4);
    assert!(small > 1.0 && small < 20.0 && colour == Colour::Green, "{small} {colour:?}");
    let (large, colour) = excursion(5e-3);
    assert!((large / small - 50.0).abs() < 1e-9 && colour == Colour::Amber, "{large} {colour:?}");
    assert_eq!(excursion(50e-3).1, Colour::Red);
    // The other lights judge the level after the travel limit.
    let free_m = checker(None).peak_m();
    assert_eq!(checker(Some(1e-4)).peak_m(), free_m);
    let left = checker(Some(5e-3)).peak_m() / free_m;
    assert!((left / (0.998 * 100.0 / large) - 1.0).abs() < 0.02, "{left}");
    let unknown = checker(None).over_span(&mut Progress::unwatched()).expect("span");
    assert_eq!(light(&unknown, "excursion").colour, Colour::Unchecked);
    assert!(light(&unknown, "excursion").sentence.contains("not limited"));
}

#[test]
fn a_resonator_whose_table_needs_few_steps_of_the_dac_is_not_green() {
    // Without loss the resonances of a held plate are so high that the table's amplitude there is only a few steps.
    let mut spec = preset("al-bending-displacement").expect("preset").spec().clone();
    let mut steps = Vec::new();
    for loss_factor in [0.002, 0.0] {
        spec.loss_factor = loss_factor;
        let plate = Plate::new(spec.clone()).expect("plate");
        let checker = Checker::new(&plate, Conditions::default()).expect("checks");
        let report = checker.over_span(&mut Progress::unwatched()).expect("span");
        let found = light(&report, "DAC resolution").clone();
        let value = found.value.expect("a number");
        assert_eq!(found.colour == Colour::Green, value >= 16.0, "{found:?}");
        // The lowest gain of the table, whose knots are nearer to the resonances than the light's boundaries.
        let table = crate::DriveTable::build(&plate, 400e3, 257).expect("table");
        let lowest = table.knots().iter().map(|knot| knot.gain).fold(1.0, f64::min);
        steps.push((value, 2047.5 * lowest));
    }
    assert!(steps[0].0 > 16.0 && steps[1].0 < 16.0, "{steps:?}");
    assert!((steps[0].1 / steps[0].0).ln().abs() < 1.0, "{steps:?}");
}
