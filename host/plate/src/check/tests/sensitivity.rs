//! The sensitivity to the loss, by its tolerance.

use super::light;
use crate::check::{Checker, Colour, Conditions, Light};
use crate::{DriveEnd, Impedance, Plate, PlateSpec, Progress, Source, preset};

/// The sensitivity light at each end of the span of the membrane with this loss tolerance.
fn sensitivity_of_membrane(tolerance: Option<f64>) -> [Light; 2] {
    let mut spec = preset("membrane").expect("preset").spec().clone();
    spec.loss_tolerance = tolerance;
    let checker = Checker::new(&Plate::new(spec).expect("plate"), Conditions::default()).expect("checks");
    [0.08, 0.28].map(|boundary_m| light(&checker.at(boundary_m).expect("on it"), "sensitivity").clone())
}

#[test]
fn a_loss_that_may_be_twice_as_high_is_no_green_sensitivity() {
    // By the 2-D solver, twice the loss changes the peak of the membrane by -1.1 to -6.0 dB.
    let [near, far] = sensitivity_of_membrane(None);
    for (light, wanted) in [(&near, 1.1), (&far, 6.0)] {
        assert!(light.colour > Colour::Green, "{light:?}");
        assert!(light.sentence.contains("halved or doubled") && light.sentence.contains("loss_tolerance"));
        assert!((light.value.expect("a number") - wanted).abs() < 0.2, "{light:?}");
    }
    let [_, known] = sensitivity_of_membrane(Some(0.05));
    assert_eq!(known.colour, Colour::Green, "{known:?}");
    assert!(known.sentence.contains("1.05 times"), "{known:?}");
    // The table is levelled for the stated tolerance: at the middle of the two peaks, so neither is farther off than
    // half of their distance.
    let [_, stated] = sensitivity_of_membrane(Some(1.0));
    let ratio = stated.value.expect("a number") / far.value.expect("a number");
    assert!((0.5..0.9).contains(&ratio), "{stated:?} {far:?}");
    let [_, wide] = sensitivity_of_membrane(Some(4.0));
    assert_eq!(wide.colour, Colour::Red, "{wide:?}");
}

#[test]
fn a_damper_at_an_end_in_bending_is_judged_with_the_near_field_that_its_file_leaves_out() {
    // PHYSICS.md: the 2-D plate with R = Z changes by 8.6 dB per 1 % of speed, that with the file's end by 0.1 dB.
    let mut spec = preset("al-bending-displacement").expect("preset").spec().clone();
    spec.drive_end = DriveEnd::Resistance { ratio: 1.0, at_frequency_hz: 28e3 };
    (spec.span_start_m, spec.loss_tolerance) = (0.2, Some(0.0));
    let checker = |spec: &PlateSpec| {
        Checker::new(&Plate::new(spec.clone()).expect("plate"), Conditions::default()).expect("checks")
    };
    let span = checker(&spec).over_span(&mut Progress::unwatched()).expect("span");
    let found = light(&span, "sensitivity");
    assert_eq!(found.colour, Colour::Red, "{found:?}");
    assert!((7.0..10.0).contains(&found.value.expect("a number")), "{found:?}");
    assert!(found.sentence.contains("near field"), "{found:?}");
    // Where the file states the near field, the wave speed dominates.
    let impedance = checker(&spec).plate().wave_impedance_n_s_per_m(28e3).expect("bending");
    spec.drive_end = DriveEnd::Source(Source {
        impedance: Impedance::damper(impedance),
        ..Source::soft(&spec.model, 28e3)
    });
    let span = checker(&spec).over_span(&mut Progress::unwatched()).expect("span");
    let stated = light(&span, "sensitivity");
    assert!((7.0..10.0).contains(&stated.value.expect("a number")), "{stated:?}");
    assert!(stated.sentence.contains("wave speed"), "{stated:?}");
}
