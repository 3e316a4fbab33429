//! The parts of the plate where a light fails, against places worked out by hand.

use super::{light, report};
use crate::check::{Checker, Colour, Conditions, Light, Limit, Stretch};
use crate::{Plate, Progress, Taper, preset, presets};

fn only(light: &Light) -> Stretch {
    let [stretch] = light.stretches[..] else { panic!("{light:?}") };
    stretch
}

fn near(light: &Light, from_m: f64, to_m: f64) {
    let found = only(light);
    assert!((found.from_m - from_m).abs() < 1e-6 && (found.to_m - to_m).abs() < 1e-6, "{light:?}");
}

#[test]
fn a_failing_light_has_a_place_on_the_plate_and_a_green_one_has_none() {
    // The steps of the DAC and the sound level have no place on the plate, and neither has a felt edge that does not exist.
    const NO_PLACE: [&str; 3] = ["DAC resolution", "sound level", "felt edge"];
    let mut seen = std::collections::BTreeSet::new();
    for preset in presets() {
        let plate = preset.plate().expect("a preset");
        let checker = Checker::new(&plate, Conditions::default()).expect("checks");
        let boundaries = [0.02, plate.span_m().0, plate.span_m().1].map(|x| checker.at(x).expect("on it"));
        for light in boundaries
            .iter()
            .chain([&checker.over_span(&mut Progress::unwatched()).expect("span")])
            .flat_map(|r| &r.lights)
        {
            let fails = light.colour > Colour::Green && !NO_PLACE.contains(&light.name);
            assert_eq!(!light.stretches.is_empty(), fails, "{light:?}");
            for stretch in &light.stretches {
                let (from_m, to_m) = (stretch.from_m, stretch.to_m);
                assert!(0.0 <= from_m && from_m <= to_m && to_m <= plate.length_m(), "{light:?}");
            }
            if fails {
                seen.insert(light.name);
            }
        }
    }
    assert!(seen.len() >= 10, "{seen:?}");
}

#[test]
fn the_drive_fails_at_the_driven_end_and_the_edge_beyond_the_peak() {
    let report = report("al-bending-displacement", 0.2);
    near(light(&report, "drive match"), 0.0, 0.0);
    let report = super::report("membrane", 0.18);
    let plate = preset("membrane").expect("a preset");
    let edge_m = plate.edge_width_m(report.frequency_hz.0).expect("an edge");
    let edge = only(light(&report, "edge width"));
    assert!(edge.from_m < 0.18 && (edge.to_m - edge.from_m - edge_m).abs() < 1e-9, "{edge:?}");
    near(light(&report, "finger load"), edge.from_m, edge.from_m);
    near(light(&report, "sensitivity"), edge.from_m, edge.from_m);
}

#[test]
fn curved_and_narrow_edges_fail_where_they_are_curved_and_narrow() {
    // W |W''| = d^2 W0^2 e^(-2 d x) is above 1/16 up to ln(16 d^2 W0^2)/(2 d), with d W0 = 0.462.
    let mut spec = preset("membrane").expect("preset").spec().clone();
    spec.taper = Taper::Exponential { half_width_m: 0.1, rate_per_m: 4.62 };
    spec.drive_end = crate::DriveEnd::Displacement;
    let plate = Plate::new(spec.clone()).expect("plate");
    let at = |plate: &Plate, x: f64| {
        Checker::new(plate, Conditions::default()).expect("checks").at(x).expect("on it")
    };
    let curved_to_m = (16.0 * 0.462_f64 * 0.462).ln() / 9.24;
    near(light(&at(&plate, 0.25), "edge curvature"), 0.0, curved_to_m);
    near(light(&at(&plate, 0.1), "edge curvature"), 0.0, 0.1);
    // 2 W = 10 mm at ln(2 W0/10 mm)/d = 149.8 mm.
    spec.taper = Taper::Exponential { half_width_m: 0.01, rate_per_m: 4.62 };
    let narrow = Plate::new(spec).expect("plate");
    near(light(&at(&narrow, 0.2), "width"), 2.0_f64.ln() / 4.62, 0.2);
    // The slope is judged at the turning point.
    let steep = preset("al-sh").expect("preset");
    near(light(&at(&steep, 0.1), "edge slope"), 0.1, 0.1);
}

#[test]
fn every_ghost_has_its_place_and_two_tones_beat_up_to_the_nearer_boundary() {
    let plate = preset("al-bending").expect("preset");
    let off = Conditions { off_centre: true, ..Conditions::default() };
    let report = Checker::new(&plate, off).expect("checks").at(0.27).expect("on it");
    let ghosts = &light(&report, "ghost boundaries").stretches;
    assert_eq!(ghosts.len(), 2, "{ghosts:?}");
    let frequency_hz = report.frequency_hz.0;
    for (ghost, mode) in ghosts.iter().zip([2, 3]) {
        let there_m = plate.ghost_boundary_m(frequency_hz, mode).expect("a ghost");
        assert_eq!((ghost.from_m, ghost.to_m), (there_m, there_m));
    }
    let chord = Conditions { other_boundaries_m: vec![0.268], ..Conditions::default() };
    let report = Checker::new(&plate, chord).expect("checks").at(0.27).expect("on it");
    near(light(&report, "beat"), 0.0, 0.268);
}

#[test]
fn a_light_reports_the_limits_that_made_its_colour() {
    for name in ["membrane", "al-bending", "al-sh"] {
        for light in &report(name, 0.2).lights {
            let (Some(limit), Some(value)) = (light.limit, light.value) else { continue };
            let by_limit = match limit {
                Limit::AtMost(limits) => super::super::grading::colour(value, limits),
                Limit::AtLeast(limits) => {
                    let minus =
                        crate::check::thresholds::Limits { green: -limits.green, amber: -limits.amber };
                    super::super::grading::colour(-value, minus)
                }
            };
            assert_eq!(by_limit, light.colour, "{name}: {light:?}");
        }
    }
    let report = report("membrane", 0.18);
    let words = |name: &str| light(&report, name).limit.expect("a limit").words(light(&report, name).unit);
    assert_eq!(words("edge width"), "green up to 4 fingertips, amber up to 15 fingertips");
    assert_eq!(words("wavelengths"), "green from 0.379, amber from 0.109");
}
