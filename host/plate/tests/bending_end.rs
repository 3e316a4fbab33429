//! The driven end of a plate in bending: its reflection with the near field, against numbers of independent
//! two-dimensional solvers (mapped Galerkin, Kirchhoff) and against closed forms.

use proptest::prelude::*;
use slipline_plate::{
    Complex64, DriveEnd, EndSlope, Equation, Impedance, LeadIn, Plate, PlateSpec, Source, preset,
    quantity::decibels, reflection, resistance_reflection, respond,
};
use std::f64::consts::{FRAC_PI_2, TAU};

/// The aluminium plate of 2 mm thickness and 20 mm half-width with this end.
fn aluminium(drive_end: DriveEnd) -> Plate {
    let spec = preset("al-bending-displacement").expect("a preset").spec().clone();
    Plate::new(PlateSpec { drive_end, ..spec }).expect("a valid end")
}

/// Z at 28 kHz, where resistances are stated in this file.
fn impedance() -> f64 {
    aluminium(DriveEnd::Displacement).wave_impedance_n_s_per_m(28e3).expect("bending")
}

/// A source of `resistance` times Z.
fn source(resistance: f64, slope: EndSlope) -> Source {
    let model = aluminium(DriveEnd::Displacement).spec().model.clone();
    Source {
        impedance: Impedance::damper(resistance * impedance()),
        slope: Some(slope),
        ..Source::soft(&model, 28e3)
    }
}

fn reflected(source: Source, frequency_hz: f64) -> f64 {
    reflection(&aluminium(DriveEnd::Source(source)), frequency_hz).expect("enters").norm()
}

#[test]
fn dampers_at_a_real_end_reflect_what_the_two_dimensional_solvers_say() {
    for (resistance, slope, wanted) in [
        (1.0, EndSlope::Free, [0.56, 0.57, 0.59]),
        (0.37, EndSlope::Free, [0.34, 0.36, 0.38]),
        (0.74, EndSlope::Held, [0.37, 0.38, 0.39]),
    ] {
        for (frequency_hz, wanted) in [20e3, 28e3, 40e3].into_iter().zip(wanted) {
            // The damper is R times Z at each frequency.
            let plate = aluminium(DriveEnd::Displacement);
            let here = plate.wave_impedance_n_s_per_m(frequency_hz).expect("bending") / impedance();
            let found = reflected(source(resistance * here, slope), frequency_hz);
            assert!(
                (found - wanted).abs() < 0.006,
                "{resistance} {slope:?} {frequency_hz}: {found} {wanted}"
            );
        }
    }
}

fn largest(lead_in: LeadIn) -> f64 {
    let source = Source { lead_in: Some(lead_in), ..source(0.0, EndSlope::Free) };
    let plate = aluminium(DriveEnd::Source(source));
    (0..=206)
        .map(|i| reflection(&plate, 19.4e3 + 100.0 * f64::from(i)).expect("enters").norm())
        .fold(0.0, f64::max)
}

#[test]
fn a_damped_lead_in_matches_the_whole_band_as_the_two_dimensional_solvers_say() {
    for (loss_factor, row) in [
        (0.1, [(0.64, 0.23), (0.53, 0.19), (0.34, 0.12), (0.21, 0.07)]),
        (0.2, [(0.42, 0.16), (0.29, 0.11), (0.13, 0.05), (0.06, 0.03)]),
        (0.3, [(0.29, 0.12), (0.17, 0.08), (0.07, 0.04), (0.04, 0.04)]),
    ] {
        for (length_m, (free, damped)) in [0.04, 0.06, 0.1, 0.15].into_iter().zip(row) {
            for (resistance, wanted) in [(0.0, free), (0.37, damped)] {
                let end_resistance_n_s_per_m = resistance * impedance();
                let found = largest(LeadIn { length_m, loss_factor, end_resistance_n_s_per_m });
                assert!(
                    (found - wanted).abs() < 0.005,
                    "{loss_factor} {length_m} {resistance}: {found} {wanted}"
                );
            }
        }
    }
}

#[test]
fn a_free_end_needs_a_damper_and_a_spring_to_take_a_wave_in() {
    // (0.29 + 0.24 j) Z: j s/omega is the spring's part.
    for frequency_hz in [20e3, 28e3, 40e3] {
        let plate = aluminium(DriveEnd::Displacement);
        let here = plate.wave_impedance_n_s_per_m(frequency_hz).expect("bending");
        let stiffness_n_per_m = 0.24 * here * TAU * frequency_hz;
        let impedance = Impedance { stiffness_n_per_m, ..Impedance::damper(0.29 * here) };
        let matched = Source { impedance, ..source(0.0, EndSlope::Free) };
        let found = reflected(matched, frequency_hz);
        assert!(found < 0.03, "{frequency_hz}: {found}");
    }
}

#[test]
fn ends_that_take_no_power_send_every_wave_back() {
    let still = aluminium(DriveEnd::Displacement);
    let lossless = |drive_end: DriveEnd| {
        Plate::new(PlateSpec { drive_end, loss_factor: 0.0, ..still.spec().clone() }).expect("valid")
    };
    let impedance = Impedance { resistance_n_s_per_m: 0.0, mass_kg: 2e-3, stiffness_n_per_m: 3e7 };
    let heavy = Source { impedance, ..source(0.0, EndSlope::Free) };
    let loose = LeadIn { length_m: 0.05, loss_factor: 0.0, end_resistance_n_s_per_m: 0.0 };
    for end in [
        DriveEnd::DisplacementAndSlope { slope: EndSlope::Free },
        DriveEnd::DisplacementAndSlope { slope: EndSlope::Held },
        DriveEnd::Source(heavy),
        DriveEnd::Source(Source { slope: Some(EndSlope::Held), ..heavy }),
        DriveEnd::Source(Source { lead_in: Some(loose), ..heavy }),
    ] {
        for frequency_hz in [8e3, 20e3, 40e3] {
            let found = reflection(&lossless(end), frequency_hz).expect("enters").norm();
            assert!((found - 1.0).abs() < 1e-9, "{end:?} {frequency_hz}: {found}");
        }
    }
    assert_eq!(reflection(&still, 3e3), None, "below the cut-off");
}

#[test]
fn a_stiff_actuator_hides_the_lead_in_and_a_soft_one_does_not() {
    let lead_in = LeadIn { length_m: 0.06, loss_factor: 0.2, end_resistance_n_s_per_m: 0.37 * impedance() };
    let soft = Source { lead_in: Some(lead_in), ..source(0.0, EndSlope::Free) };
    let impedance = Impedance { stiffness_n_per_m: 1e12, ..Impedance::default() };
    let stiff = Source { impedance, ..soft };
    let held = Source { slope: Some(EndSlope::Held), ..stiff };
    assert!(reflected(soft, 28e3) < 0.12 && reflected(stiff, 28e3) > 0.5, "{}", reflected(stiff, 28e3));
    assert!(reflected(held, 28e3) > 0.99, "{}", reflected(held, 28e3));
}

/// f(0) and the slope of f at 0 times h, by differences of fourth order.
fn start(plate: &Plate, frequency_hz: f64) -> (Complex64, Complex64) {
    let response = respond(plate, frequency_hz, 34_001, Equation::Corrected).expect("enters");
    let f = &response.amplitude;
    let slope = (-25.0 * f[0] + 48.0 * f[1] - 36.0 * f[2] + 16.0 * f[3] - 3.0 * f[4]) / 12.0;
    (f[0], slope / (plate.length_m() / 34_000.0))
}

#[test]
fn the_field_with_its_near_part_meets_both_conditions_at_the_end() {
    let wavenumber = 250.0;
    let free = aluminium(DriveEnd::DisplacementAndSlope { slope: EndSlope::Free });
    let held = aluminium(DriveEnd::DisplacementAndSlope { slope: EndSlope::Held });
    for frequency_hz in [20e3, 33e3] {
        let ((value, slope), (same, turned)) = (start(&held, frequency_hz), start(&free, frequency_hz));
        assert!((value - 1.0).norm() < 1e-9 && (same - 1.0).norm() < 1e-9, "{value} {same}");
        assert!(slope.norm() < 1e-4 * wavenumber, "held: {slope}");
        assert!(turned.norm() > 0.1 * wavenumber, "free to turn: {turned}");
    }
}

#[test]
fn a_hinged_moved_end_puts_about_half_of_its_motion_into_the_near_field() {
    // No moment: (K^2 - (1 - nu) q^2) p = (K^2 + (1 - nu) q^2) e with q = pi/(2 s), s the turning half-width, and
    // p + e = 1.
    let hinged = aluminium(DriveEnd::DisplacementAndSlope { slope: EndSlope::Free });
    for frequency_hz in [20e3, 31e3, 40e3] {
        let peak = |plate: &Plate| {
            respond(plate, frequency_hz, 1001, Equation::Corrected)
                .expect("enters")
                .peak
                .expect("a peak")
                .amplitude
        };
        let model = &hinged.spec().model;
        let width_m = hinged.turning_half_width_m(0.0);
        let across = (FRAC_PI_2 / width_m).powi(2) / model.wavenumber_squared(TAU * frequency_hz);
        let share = 0.5 * (1.0 + (1.0 - 0.33) * across);
        let found = peak(&hinged) / peak(&aluminium(DriveEnd::Displacement));
        assert!((found / share - 1.0).abs() < 1e-6, "{frequency_hz}: {found} {share}");
        assert!((decibels(found) + 6.0).abs() < 0.9, "{frequency_hz}: {found}");
    }
}

#[test]
fn a_bending_plates_resistance_stands_for_a_free_end_that_reflects_more_than_half() {
    let end = DriveEnd::Resistance { ratio: 1.0, at_frequency_hz: 28e3 };
    let plate = aluminium(end);
    assert!(reflection(&plate, 28e3).expect("enters").norm() < 1e-2, "the one-mode law says matched");
    let real = resistance_reflection(&plate, 28e3).expect("a resistance").norm();
    assert!((real - 0.57).abs() < 0.006, "{real}");
    assert_eq!(resistance_reflection(&preset("membrane").expect("a preset"), 140.0), None);
}

#[test]
fn one_percent_of_wave_speed_costs_at_each_end_what_the_two_dimensional_solvers_say() {
    let lead_in = LeadIn { length_m: 0.07, loss_factor: 0.2, end_resistance_n_s_per_m: 56.0 };
    for (name, source, wanted_db) in [
        ("free, R = Z", source(1.0, EndSlope::Free), 8.6),
        ("free, R = 0.37 Z", source(0.37, EndSlope::Free), 6.0),
        ("slope held, R = 0.74 Z", source(0.74, EndSlope::Held), 6.0),
        ("lead-in of the preset", Source { lead_in: Some(lead_in), ..source(0.0, EndSlope::Free) }, 1.3),
    ] {
        let mut spec = aluminium(DriveEnd::Source(source)).spec().clone();
        (spec.span_start_m, spec.span_end_m) = (0.2, 0.278);
        let plate = Plate::new(spec).expect("valid");
        let peak = |plate: &Plate, frequency_hz: f64| {
            let response = respond(plate, frequency_hz, 257, Equation::Corrected).expect("enters");
            response.peak.expect("a peak").amplitude
        };
        let fast = plate.with_wave_speed(1.01).expect("in range");
        let worst_db = (0..=120)
            .map(|i| plate.frequency_for_boundary_hz(0.2 + 0.078 * f64::from(i) / 120.0))
            .map(|frequency_hz| decibels(peak(&fast, frequency_hz) / peak(&plate, frequency_hz)).abs())
            .fold(0.0, f64::max);
        assert!((worst_db - wanted_db).abs() < 0.35, "{name}: {worst_db}");
    }
}

/// The default membrane behind a source of 40 N/m.
fn membrane(change: impl FnOnce(Source) -> Source) -> Plate {
    let mut spec = preset("membrane").expect("a preset").spec().clone();
    let matched_hz = spec.drive_end.at_frequency_hz().expect("a resistance");
    let bare = Plate::new(spec.clone()).expect("valid");
    let impedance = bare.wave_impedance_n_s_per_m(matched_hz).expect("a tension");
    assert!((impedance - 0.15).abs() < 0.002, "{impedance}");
    let source = Source { impedance: Impedance::damper(impedance), ..Source::soft(&spec.model, matched_hz) };
    spec.drive_end = DriveEnd::Source(change(source));
    Plate::new(spec).expect("valid")
}

/// Largest over smallest peak along the span, dB.
fn swing_db(plate: &Plate) -> f64 {
    let (start_m, end_m) = plate.span_m();
    let peaks: Vec<f64> = (0..=200)
        .filter_map(|i| {
            let x = start_m + (end_m - start_m) * f64::from(i) / 200.0;
            let frequency_hz = plate.frequency_for_boundary_hz(x);
            respond(plate, frequency_hz, 401, Equation::Corrected).ok()?.peak.map(|peak| peak.amplitude)
        })
        .collect();
    let largest = peaks.iter().copied().fold(0.0, f64::max);
    decibels(largest / peaks.iter().copied().fold(f64::INFINITY, f64::min))
}

#[test]
fn a_gram_of_coil_on_the_default_membrane_raises_the_swing_from_8_to_23_db() {
    let (bare, coil) = (
        swing_db(&membrane(|source| source)),
        swing_db(&membrane(|source| Source {
            impedance: Impedance { mass_kg: 1e-3, ..source.impedance },
            ..source
        })),
    );
    assert!((bare - 8.0).abs() < 0.6, "{bare}");
    assert!((coil - 23.0).abs() < 0.6, "{coil}");
}

#[test]
fn a_matched_source_launches_a_wave_of_amplitude_one_at_its_frequency() {
    let sourced = membrane(|source| source);
    let matched_hz = sourced.spec().drive_end.at_frequency_hz().expect("stated");
    let mut spec = sourced.spec().clone();
    spec.drive_end = DriveEnd::Resistance { ratio: 1.0, at_frequency_hz: matched_hz };
    let resisted = Plate::new(spec).expect("valid");
    let peak = |plate: &Plate| {
        respond(plate, matched_hz, 401, Equation::Corrected).expect("enters").peak.expect("a peak").amplitude
    };
    // The loss of 0.03 enters the line's tension and not the law of the resistance.
    assert!((peak(&sourced) / peak(&resisted) - 1.0).abs() < 1e-2, "{} {}", peak(&sourced), peak(&resisted));
    assert!(reflection(&sourced, matched_hz).expect("enters").norm() < 0.03);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn no_end_reflects_more_than_arrives(
        resistance in 0.0..5.0_f64, mass_g in 0.0..10.0_f64, stiffness in 0.0..1e8_f64, held in any::<bool>(),
        length_m in 0.002..0.4_f64, loss_factor in 0.0..1.5_f64, damped in 0.0..5.0_f64, frequency_hz in 5e3..80e3_f64,
    ) {
        let slope = if held { EndSlope::Held } else { EndSlope::Free };
        let end_resistance_n_s_per_m = damped * 150.0;
        let bare = source(resistance, slope);
        let source = Source {
            impedance: Impedance {
                mass_kg: mass_g * 1e-3,
                stiffness_n_per_m: stiffness,
                ..bare.impedance
            },
            lead_in: Some(LeadIn { length_m, loss_factor, end_resistance_n_s_per_m }),
            ..bare
        };
        // The strip's own loss of 0.002 makes power and |r| differ by about as much.
        prop_assert!(reflected(source, frequency_hz) <= 1.002);
    }
}
