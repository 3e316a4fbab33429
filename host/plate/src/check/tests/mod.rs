//! The lights on the presets, a file for each group of lights; this file has the checks common to all.

mod actuator;
mod calibrated;
mod drive;
mod felt_edge;
mod linear_output;
mod sensitivity;
mod shape;
mod sound;
mod stretches;
mod thickness;
mod touch;
mod wave;
mod work;

use super::*;
use crate::{Progress, preset, presets};

fn report(name: &str, boundary_m: f64) -> Report {
    let plate = preset(name).expect("a preset");
    Checker::new(&plate, Conditions::default()).expect("checks").at(boundary_m).expect("on the plate")
}

fn light<'a>(report: &'a Report, name: &str) -> &'a Light {
    report.light(name).unwrap_or_else(|| panic!("no light {name}"))
}

fn value(report: &Report, name: &str) -> f64 {
    light(report, name).value.unwrap_or(f64::NAN)
}

#[test]
fn every_preset_has_every_light_in_one_order_each_with_a_sentence() {
    let mut order: Option<Vec<&str>> = None;
    for preset in presets() {
        let plate = preset.plate().expect("a preset");
        let report = Checker::new(&plate, Conditions::default())
            .expect("checks")
            .over_span(&mut Progress::unwatched())
            .expect("span");
        let names: Vec<&str> = report.lights.iter().map(|light| light.name).collect();
        assert_eq!(names.len(), 22);
        assert_eq!(*order.get_or_insert(names.clone()), names);
        // Over the span at level 1: who chooses it reads why.
        let red: Vec<&Light> = report.lights.iter().filter(|light| light.colour == Colour::Red).collect();
        let is_red = red.iter().any(|light| light.name != "sound level");
        assert_eq!(is_red, preset.description().contains(". Red light"), "{}: {red:#?}", preset.name);
        let loud = red.iter().find(|light| light.name == "sound level");
        if let Some(value) = loud.and_then(|light| light.value) {
            assert!(
                preset.description().contains(&format!("{value:.0} dB of sound")),
                "{}: {value}",
                preset.name
            );
        }
        for light in &report.lights {
            assert!(light.sentence.ends_with('.') && light.sentence.len() > 20, "{light:?}");
            assert!(light.value.is_none_or(f64::is_finite), "{light:?}");
        }
    }
}

#[test]
fn a_span_is_as_bad_as_its_worst_boundary() {
    let plate = preset("membrane").expect("preset");
    let checker = Checker::new(&plate, Conditions::default()).expect("checks");
    let (span, near) = (
        checker.over_span(&mut Progress::unwatched()).expect("span"),
        checker.at(plate.span_m().0).expect("on it"),
    );
    assert_eq!(value(&span, "edge width"), value(&near, "edge width"), "the softest edge is the nearest");
    assert_eq!(light(&span, "edge width").boundary_m, plate.span_m().0);
    for light in &near.lights {
        assert!(span.light(light.name).expect("same lights").colour >= light.colour, "{}", light.name);
    }
}

#[test]
fn boundaries_off_the_plate_and_absurd_conditions_are_refused_with_their_range() {
    let plate = preset("membrane").expect("preset");
    let checker = Checker::new(&plate, Conditions::default()).expect("checks");
    for boundary_m in [0.0, -0.1, 0.321, f64::NAN, f64::INFINITY] {
        let error = checker.at(boundary_m).expect_err("off the plate").to_string();
        assert!(error.contains("boundary =") && error.contains("0.32 m"), "{error}");
    }
    let refused = |conditions: Conditions| Checker::new(&plate, conditions).expect_err("absurd").to_string();
    assert!(
        refused(Conditions { level: 1.5, ..Conditions::default() }).contains("level = 1.5: must be 0 to 1")
    );
    assert!(refused(Conditions { sample_rate_hz: 100.0, ..Conditions::default() }).contains("sample rate"));
    let off = Conditions { other_boundaries_m: vec![9.0], ..Conditions::default() };
    assert!(refused(off).contains("other boundary = 9"));
}

#[test]
fn a_plate_whose_band_just_fits_the_rate_is_checked_to_its_very_end() {
    let plate = preset("membrane").expect("a preset");
    // For 1 % more wave speed the band would exceed the limit of the rate; the boundaries' own frequencies do not.
    let sample_rate_hz = 1.001 * crate::sample_rates(&plate).low;
    let checker = Checker::new(&plate, Conditions { sample_rate_hz, ..Conditions::default() }).expect("fits");
    assert!(checker.at(plate.span_m().1).is_ok());
    assert!(checker.over_span(&mut Progress::unwatched()).is_ok());
    let table = crate::DriveTable::build(&plate, sample_rate_hz, crate::KNOTS_MAX).expect("fits");
    assert!(crate::sensitivity_per_percent(&table, &plate, &mut Progress::unwatched()).is_ok());
}
