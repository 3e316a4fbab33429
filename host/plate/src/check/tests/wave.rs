//! Loss and peak: the loss integral against its closed forms, and the agreement of the two lights.

use super::{light, value};
use crate::check::{Checker, Colour, Conditions, loss_integral, wavelengths};
use crate::{DriveEnd, Equation, Model, Plate, Source, TurningWidth, plane, preset, respond};

#[test]
fn wavelengths_and_loss_are_the_closed_forms_of_an_exponential_taper() {
    // Phi = nu acosh(nu/s0) - sqrt(nu^2 - s0^2), I = (eta/2) nu acosh(nu/s0); s0 = q/(W0 d), nu = s0 e^(d x0).
    for (name, half_width_m, eta) in
        [("membrane", 0.05, 0.03), ("al-bending", 0.02, 0.001), ("paper-rubber", 0.05, 0.1)]
    {
        let plate = preset(name).expect("preset").with_turning_width(TurningWidth::Plain);
        let s0 = std::f64::consts::FRAC_PI_2 / (half_width_m * 4.62);
        for x0 in [0.08, 0.15, 0.27] {
            let nu = s0 * (4.62_f64 * x0).exp();
            let phase = nu * (nu / s0).acosh() - (nu * nu - s0 * s0).sqrt();
            let turns = wavelengths(&plate, x0);
            assert!((turns / (phase / std::f64::consts::TAU) - 1.0).abs() < 1e-4, "{name} {x0}: {turns}");
            let loss = loss_integral(&plate, x0);
            let exact = 0.5 * eta * nu * (nu / s0).acosh();
            assert!((loss / exact - 1.0).abs() < 1e-4, "{name} {x0}: {loss} {exact}");
        }
    }
}

#[test]
fn loss_dims_the_peak_light_from_green_over_amber_to_red() {
    let mut spec = preset("al-bending").expect("preset").spec().clone();
    let mut seen = Vec::new();
    for loss_factor in [0.002, 0.12, 0.4] {
        spec.loss_factor = loss_factor;
        let plate = Plate::new(spec.clone()).expect("plate");
        let report = Checker::new(&plate, Conditions::default()).expect("checks").at(0.27).expect("on it");
        seen.push((value(&report, "loss"), light(&report, "loss").colour, light(&report, "peak").colour));
    }
    assert_eq!(seen[0].1, Colour::Green);
    assert!(seen[1].0 > 3.0 && seen[1].0 < 6.0, "{seen:?}");
    assert_eq!((seen[1].1, seen[1].2), (Colour::Amber, Colour::Amber), "{seen:?}");
    assert!(seen[2].0 > 6.0, "{seen:?}");
    assert_eq!((seen[2].1, seen[2].2), (Colour::Red, Colour::Red), "{seen:?}");
}

#[test]
fn the_loss_light_never_contradicts_the_peak_light() {
    let mut spec = preset("membrane").expect("preset").spec().clone();
    let mut seen = std::collections::BTreeSet::new();
    for loss_factor in [0.0, 0.02, 0.1, 0.2, 0.3, 0.5] {
        spec.loss_factor = loss_factor;
        let checker =
            Checker::new(&Plate::new(spec.clone()).expect("plate"), Conditions::default()).expect("checks");
        for boundary_m in [0.08, 0.15, 0.28] {
            let report = checker.at(boundary_m).expect("on it");
            let (loss, peak) = (light(&report, "loss"), light(&report, "peak"));
            if loss.value.expect("a number") > 1.0 {
                assert_eq!(loss.colour, peak.colour, "{loss:?} {peak:?}");
                seen.insert(loss.colour);
            } else {
                assert!(!loss.sentence.contains("peak"), "{loss:?}");
            }
        }
    }
    assert!(seen.len() >= 2, "{seen:?}");
}

#[test]
fn the_loss_of_a_clamped_plate_is_the_decay_of_its_wave() {
    let mut spec = preset("al-bending-displacement").expect("a preset").spec().clone();
    spec.model = Model::BendingClamped(spec.model.bending().expect("bending").clone());
    (spec.span_start_m, spec.span_end_m) = (0.1, 0.24);
    let plate = Plate::new(spec).expect("a valid plate");
    let boundary_m = 0.2;
    let frequency_hz = plate.frequency_for_boundary_hz(boundary_m);
    let steps = 20_000;
    let decay: f64 = (0..steps)
        .map(|i| {
            let u = (f64::from(i) + 0.5) / f64::from(steps);
            let x = boundary_m * (1.0 - u * u);
            let k = plate.width_mode(1).lossy_wavenumber_squared(x, frequency_hz).sqrt();
            2.0 * u * boundary_m * k.im / f64::from(steps)
        })
        .sum();
    let found = loss_integral(&plate, boundary_m);
    assert!((found / decay - 1.0).abs() < 0.03, "{found} for {decay}");
}

#[test]
fn a_peak_that_stands_near_the_drive_is_not_green() {
    let checker = Checker::new(&preset("membrane").expect("preset"), Conditions::default()).expect("checks");
    for (boundary_m, wanted) in [(0.07, Colour::Amber), (0.09, Colour::Green)] {
        let report = checker.at(boundary_m).expect("on it");
        let peak = light(&report, "peak");
        assert_eq!(peak.colour, wanted, "{} {peak:?}", value(&report, "wavelengths"));
        assert_eq!(peak.sentence.contains("near the drive"), wanted == Colour::Amber, "{peak:?}");
    }
}

#[test]
fn a_peak_is_green_only_if_it_is_the_largest_at_other_speeds_too() {
    // Under a prescribed force the near field of the end does not follow the resonances: between two of them it
    // exceeds a peak that has lost enough on its way.
    let mut spec = preset("al-bending-displacement").expect("preset").spec().clone();
    spec.drive_end = DriveEnd::Source(Source::soft(&spec.model, 28e3));
    let mut seen = [0; 3];
    for loss_factor in [0.03, 0.06] {
        spec.loss_factor = loss_factor;
        let plate = Plate::new(spec.clone()).expect("plate");
        let checker = Checker::new(&plate, Conditions::default()).expect("checks");
        for i in 0..50 {
            let boundary_m = 0.12 + 0.003 * f64::from(i);
            let hz = plate.frequency_for_boundary_hz(boundary_m);
            let is_largest = |factor: f64| {
                let actual = plate.with_wave_speed(factor).expect("in range");
                let found = respond(&actual, hz, 513, Equation::Corrected).expect("responds");
                found.peak.is_some_and(|peak| peak.is_largest)
            };
            let here = is_largest(1.0);
            let stays = here && [0.99, 0.995, 1.005, 1.01].map(is_largest) == [true; 4];
            let green = light(&checker.at(boundary_m).expect("on it"), "peak").colour == Colour::Green;
            assert_eq!(green, stays, "{boundary_m}: {here} {stays}");
            seen[usize::from(here) + usize::from(stays)] += 1;
        }
    }
    assert!(seen.iter().all(|&count| count > 0), "{seen:?}");
}

#[test]
fn a_peak_that_the_near_field_halves_is_not_green() {
    // A hinged moved end puts half of its motion into the near field, which the file leaves out: a stated peak of 1.5
    // times the drive is in fact smaller than the drive.
    let mut spec = preset("al-bending-displacement").expect("preset").spec().clone();
    spec.loss_factor = 0.1;
    let plate = Plate::new(spec).expect("plate");
    let checker = Checker::new(&plate, Conditions::default()).expect("checks");
    let mut seen = 0;
    for i in 0..40 {
        let boundary_m = 0.12 + 0.003 * f64::from(i);
        let hz = plate.frequency_for_boundary_hz(boundary_m);
        let stated = respond(&plate, hz, 513, Equation::Corrected).expect("responds").peak;
        let truth = plane::respond(&plate, hz, 513, &plane::Setup::of(&plate)).expect("solves").peak;
        let report = checker.at(boundary_m).expect("on it");
        if stated.is_some_and(|peak| peak.is_largest) && truth.is_none_or(|peak| peak.amplitude < 0.9) {
            seen += 1;
            assert_eq!(light(&report, "peak").colour, Colour::Amber, "{boundary_m}: {stated:?} {truth:?}");
        }
    }
    assert!(seen > 3, "{seen}");
}
