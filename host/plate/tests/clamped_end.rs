//! The driven end of a clamped plate in bending, with all waves of its strip: properties of an end without loss and
//! of a lead-in that hold for all parameters, and comparison with the plate in two dimensions.

use slipline_plate::{
    Complex64, DriveEnd, EndSlope, Equation, Impedance, LeadIn, Model, Plate, PlateSpec, Source,
    TurningWidth, plane, preset, quantity::decibels, reflection, respond,
};

/// From just above the cut-off to where the next symmetric width mode could carry power away from the end.
const FREQUENCIES_HZ: [f64; 4] = [8e3, 15e3, 28e3, 36e3];

/// The aluminium plate of 2 mm between clamped edges.
fn plate(drive_end: DriveEnd, loss_factor: f64) -> Plate {
    let supported = preset("al-bending-displacement").expect("a preset").spec().clone();
    let model = Model::BendingClamped(supported.model.bending().expect("bending").clone());
    // The straight strip at the end has the plate's half-width.
    let turning_width = TurningWidth::Plain;
    let (span_start_m, span_end_m) = (0.05, 0.25);
    let spec =
        PlateSpec { model, loss_factor, turning_width, drive_end, span_start_m, span_end_m, ..supported };
    Plate::new(spec).expect("a valid plate")
}

/// A source of `resistance` times Z at 28 kHz, with a free slope.
fn source(resistance: f64, lead_in: Option<LeadIn>) -> Source {
    let plain = plate(DriveEnd::Displacement, 0.0);
    let impedance = plain.wave_impedance_n_s_per_m(28e3).expect("bending");
    let soft = Source::soft(&plain.spec().model, 28e3);
    Source { impedance: Impedance::damper(resistance * impedance), lead_in, ..soft }
}

fn reflected(source: Source, frequency_hz: f64) -> Complex64 {
    reflection(&plate(DriveEnd::Source(source), 0.0), frequency_hz).expect("enters")
}

#[test]
fn an_end_that_takes_no_power_reflects_all_of_it() {
    let impedance = Impedance { resistance_n_s_per_m: 0.0, mass_kg: 1e-3, stiffness_n_per_m: 3e6 };
    let loaded = Source { impedance, ..source(0.0, None) };
    let ends = [
        DriveEnd::DisplacementAndSlope { slope: EndSlope::Free },
        DriveEnd::DisplacementAndSlope { slope: EndSlope::Held },
        DriveEnd::Source(source(0.0, None)),
        DriveEnd::Source(Source { slope: Some(EndSlope::Held), ..source(0.0, None) }),
        DriveEnd::Source(loaded),
    ];
    let mut seen: Vec<Complex64> = Vec::new();
    for end in ends {
        for frequency_hz in FREQUENCIES_HZ {
            let r = reflection(&plate(end, 0.0), frequency_hz).expect("enters");
            assert!((r.norm() - 1.0).abs() < 1e-4, "{end:?} {frequency_hz}: {r}");
        }
        let phase = reflection(&plate(end, 0.0), 28e3).expect("enters");
        assert!(seen.iter().all(|other| (other - phase).norm() > 0.02), "{end:?} is like another end");
        seen.push(phase);
    }
}

#[test]
fn a_damper_of_the_waves_impedance_reflects_half_of_the_amplitude_and_a_weaker_one_less() {
    let dampers = [0.1, 0.37, 1.0, 3.0];
    let norms: Vec<f64> = dampers.iter().map(|&it| reflected(source(it, None), 28e3).norm()).collect();
    assert!(norms.iter().all(|norm| *norm < 1.0), "{norms:?}");
    // A real end reflects most of the power that a damper of its own Z would absorb in the one-mode equation.
    assert!(norms[2] > 0.4 && norms[2] < 0.7, "{norms:?}");
    assert!(norms[1] < norms[0] && norms[1] < norms[2] && norms[2] < norms[3], "{norms:?}");
}

#[test]
fn a_lead_in_like_the_plate_moves_the_end_back_by_its_length() {
    // Without loss and without a damper the lead-in continues the strip of the plate, with a free end at its far
    // side.
    for frequency_hz in FREQUENCIES_HZ {
        let free = reflected(source(0.0, None), frequency_hz);
        let strip = plate(DriveEnd::Displacement, 0.0);
        let lengths = [0.06, 0.09];
        let behind = lengths.map(|length_m| {
            let lead_in = LeadIn { length_m, loss_factor: 0.0, end_resistance_n_s_per_m: 0.0 };
            reflected(source(0.0, Some(lead_in)), frequency_hz) / free
        });
        // k is not needed: the phase of 30 mm more of lead-in must repeat, three times.
        let step = behind[1] / behind[0];
        assert!((behind[0] - step * step).norm() < 2e-3, "{frequency_hz}: {behind:?} of {}", strip.name());
        assert!((step.norm() - 1.0).abs() < 1e-4, "{frequency_hz}: {step}");
    }
}

#[test]
fn a_damped_lead_in_matches_the_band() {
    let largest = |length_m: f64, loss_factor: f64, damper: f64| {
        let end_resistance_n_s_per_m = source(damper, None).impedance.resistance_n_s_per_m;
        let lead_in = LeadIn { length_m, loss_factor, end_resistance_n_s_per_m };
        (0..=20)
            .map(|i| reflected(source(0.0, Some(lead_in)), 19.4e3 + 1030.0 * f64::from(i)).norm())
            .fold(0.0, f64::max)
    };
    let (short, long, damped) = (largest(0.06, 0.2, 0.0), largest(0.15, 0.3, 0.0), largest(0.06, 0.2, 0.37));
    assert!(short < 0.45 && long < 0.12 && damped < 0.2 && damped < short, "{short} {long} {damped}");
}

#[test]
fn every_end_reflects_as_the_strip_in_two_dimensions() {
    let lead_in = LeadIn { length_m: 0.06, loss_factor: 0.2, end_resistance_n_s_per_m: 30.0 };
    let held = source(0.74, None);
    let impedance = Impedance { mass_kg: 2e-4, ..held.impedance };
    let ends = [
        DriveEnd::DisplacementAndSlope { slope: EndSlope::Free },
        DriveEnd::DisplacementAndSlope { slope: EndSlope::Held },
        DriveEnd::Source(source(0.37, None)),
        DriveEnd::Source(Source { slope: Some(EndSlope::Held), impedance, ..held }),
        DriveEnd::Source(source(0.0, Some(lead_in))),
    ];
    for end in ends {
        let plate = plate(end, 0.0);
        for frequency_hz in FREQUENCIES_HZ {
            let found = reflection(&plate, frequency_hz).expect("enters");
            let truth = plane::reflection(&plate, frequency_hz, &plane::Setup::of(&plate)).expect("enters");
            assert!((found - truth).norm() < 0.01, "{end:?} {frequency_hz}: {found} for {truth}");
        }
    }
}

#[test]
fn a_moved_end_gives_the_field_of_the_plate_in_two_dimensions() {
    for slope in [EndSlope::Free, EndSlope::Held] {
        let plate = plate(DriveEnd::DisplacementAndSlope { slope }, 0.05);
        for boundary_m in [0.1, 0.13, 0.16] {
            let frequency_hz = plate.frequency_for_boundary_hz(boundary_m);
            let points = 3401;
            let truth =
                plane::respond(&plate, frequency_hz, points, &plane::Setup::of(&plate)).expect("enters");
            let one = respond(&plate, frequency_hz, points, Equation::Corrected).expect("enters");
            let (peak, true_peak) = (one.peak.expect("a peak"), truth.peak.expect("a peak"));
            // The level is absolute: it depends on the fraction of the drive that becomes the wave.
            let level_db = decibels(peak.amplitude / true_peak.amplitude);
            assert!(level_db.abs() < 0.5, "{slope:?} {boundary_m}: {level_db} dB");
            assert!(
                (peak.position_m - true_peak.position_m).abs() < 5e-4,
                "{slope:?} {boundary_m}: {peak:?}"
            );
            // Within W of the drive, where the evanescent waves are as large as the propagating one.
            let scale = truth.amplitude.iter().take(200).map(|w| w.norm()).fold(0.0, f64::max);
            for (i, (f, w)) in one.amplitude.iter().zip(&truth.amplitude).enumerate().take(200) {
                assert!((f - w).norm() < 0.08 * scale, "{slope:?} {boundary_m} at {i}: {f} for {w}");
            }
        }
    }
}
