//! The drive match.

use super::{light, value};
use crate::check::{Checker, Colour, Conditions};
use crate::{DriveEnd, Plate, Progress, preset};

#[test]
fn a_matched_drive_is_green_and_a_held_displacement_is_red_for_match_and_sensitivity() {
    let mut spec = preset("membrane").expect("preset").spec().clone();
    spec.loss_tolerance = Some(0.0);
    let matched = Plate::new(spec).expect("plate");
    let matched_hz = matched.spec().drive_end.at_frequency_hz().expect("a resistance");
    let boundary_m = matched.turning_point_m(matched_hz).expect("enters");
    let report =
        Checker::new(&matched, Conditions::default()).expect("checks").at(boundary_m).expect("on it");
    let (fit, sensitivity) = (light(&report, "drive match"), light(&report, "sensitivity"));
    assert_eq!(fit.colour, Colour::Green, "{fit:?}");
    assert_eq!(sensitivity.colour, Colour::Green, "{sensitivity:?}");
    assert!(sensitivity.value.unwrap_or(9.0) < 0.15, "0.07 dB with r = 1: {sensitivity:?}");

    let held = preset("al-bending-displacement").expect("preset");
    let report = Checker::new(&held, Conditions::default())
        .expect("checks")
        .over_span(&mut Progress::unwatched())
        .expect("span");
    let sensitivity = light(&report, "sensitivity");
    assert_eq!(sensitivity.colour, Colour::Red);
    assert!((20.0..36.0).contains(&sensitivity.value.unwrap_or(0.0)), "about 25 dB: {sensitivity:?}");
    assert_eq!(light(&report, "drive match").colour, Colour::Red);
    assert!((value(&report, "drive match") - 1.0).abs() < 1e-9, "every wave comes back");
}

#[test]
fn a_bending_plate_with_a_damper_alone_is_amber_and_one_with_a_lead_in_behind_a_soft_force_green() {
    let still = preset("al-bending-displacement").expect("preset");
    let end = |drive_end: DriveEnd| {
        let spec = crate::PlateSpec { drive_end, ..still.spec().clone() };
        let plate = Plate::new(spec).expect("plate");
        let report = Checker::new(&plate, Conditions::default()).expect("checks").at(0.24).expect("on it");
        light(&report, "drive match").clone()
    };
    let damped = end(DriveEnd::Resistance { ratio: 1.0, at_frequency_hz: 28e3 });
    assert_eq!(damped.colour, Colour::Amber, "{damped:?}");
    assert!(
        (damped.value.expect("known") - 0.57).abs() < 0.01 && damped.sentence.contains("lead-in"),
        "{damped:?}"
    );
    let mut clamped = still.spec().clone();
    clamped.model = crate::Model::BendingClamped(clamped.model.bending().expect("bending").clone());
    clamped.drive_end = DriveEnd::Resistance { ratio: 1.0, at_frequency_hz: 28e3 };
    (clamped.span_start_m, clamped.span_end_m) = (0.1, 0.24);
    let plate = Plate::new(clamped).expect("plate");
    let hz = plate.frequency_for_boundary_hz(0.2);
    let truth =
        crate::plane::reflection(&plate, hz, &crate::plane::Setup::of(&plate)).expect("enters").norm();
    let report = Checker::new(&plate, Conditions::default()).expect("checks").at(0.2).expect("on it");
    assert!((value(&report, "drive match") - truth).abs() < 0.03, "{report:?} {truth}");
    assert_eq!(end(DriveEnd::Resistance { ratio: 9.0, at_frequency_hz: 28e3 }).colour, Colour::Red);

    let lead_in = crate::LeadIn { length_m: 0.06, loss_factor: 0.2, end_resistance_n_s_per_m: 55.0 };
    let source = crate::Source { lead_in: Some(lead_in), ..crate::Source::soft(&still.spec().model, 28e3) };
    let matched = end(DriveEnd::Source(source));
    assert_eq!(matched.colour, Colour::Green, "{matched:?}");
    let heavy = end(DriveEnd::Source(crate::Source {
        impedance: crate::Impedance { mass_kg: 5e-3, ..source.impedance },
        ..source
    }));
    assert!(heavy.colour == Colour::Red && heavy.sentence.contains("hide"), "{heavy:?}");
    let bare = end(DriveEnd::Source(crate::Source { lead_in: None, ..source }));
    assert!(bare.colour == Colour::Red && bare.sentence.contains("lead-in"), "{bare:?}");
}

#[test]
fn a_constant_resistance_drifts_off_the_wave_impedance_over_the_membranes_band() {
    // r = R/Z with Z = T W k0/omega: 1.26 at 87.6 Hz, 0.94 at 219 Hz (PHYSICS.md). |r| of the end is |1 - r|/(1 + r).
    let mut spec = preset("membrane").expect("preset").spec().clone();
    spec.loss_factor = 0.0;
    let checker = Checker::new(&Plate::new(spec).expect("plate"), Conditions::default()).expect("checks");
    for (frequency_hz, ratio) in [(87.6, 1.26), (219.0, 0.94)] {
        let boundary_m = checker.plate().turning_point_m(frequency_hz).expect("enters");
        let found = value(&checker.at(boundary_m).expect("on it"), "drive match");
        let wanted = (1.0_f64 - ratio).abs() / (1.0 + ratio);
        assert!((found - wanted).abs() < 0.005, "{frequency_hz}: {found} {wanted}");
    }
}
