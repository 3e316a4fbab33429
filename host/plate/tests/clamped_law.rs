//! Clamped plates in bending: the one-mode equation with the strip's exact law against the plate in two dimensions.

use slipline_plate::{Complex64, DriveEnd, Equation, Model, Plate, PlateSpec, Taper, plane, preset, respond};

/// An aluminium plate of 2 mm between clamped edges, moved at x = 0.
fn plate(half_width_m: f64, rate_per_m: f64, loss_factor: f64) -> Plate {
    let length_m = 1.6 / rate_per_m;
    let supported = preset("al-bending-displacement").expect("a preset").spec().clone();
    Plate::new(PlateSpec {
        taper: Taper::Exponential { half_width_m, rate_per_m },
        length_m,
        model: Model::BendingClamped(supported.model.bending().expect("bending").clone()),
        loss_factor,
        span_start_m: 0.1 * length_m,
        span_end_m: 0.9 * length_m,
        ..supported
    })
    .expect("a valid plate")
}

/// Place and height of each maximum of |f| up to `end_m`.
fn antinodes(field: &[Complex64], step_m: f64, end_m: f64) -> Vec<(f64, f64)> {
    let value: Vec<f64> = field.iter().map(|f| f.norm()).collect();
    (1..value.len() - 1)
        .filter(|&i| (i as f64) * step_m < end_m && value[i] > value[i - 1] && value[i] >= value[i + 1])
        .map(|i| {
            let (before, here, after) = (value[i - 1], value[i], value[i + 1]);
            let offset = 0.5 * (before - after) / (before - 2.0 * here + after);
            ((i as f64 + offset) * step_m, here - 0.25 * (before - after) * offset)
        })
        .collect()
}

/// Place beyond `peak` where |f| has fallen to `share` of it.
fn fallen(field: &[Complex64], step_m: f64, peak: (f64, f64), share: f64) -> f64 {
    let wanted = share * peak.1;
    let from = (peak.0 / step_m).ceil() as usize;
    let i = (from..field.len() - 1).find(|&i| field[i + 1].norm() < wanted).expect("the tail reaches it");
    let (a, b) = (field[i].norm(), field[i + 1].norm());
    (i as f64 + (a - wanted) / (a - b)) * step_m
}

#[test]
fn antinodes_and_edge_are_where_the_plate_in_two_dimensions_has_them() {
    for (half_width_m, rate_per_m, loss) in
        [(0.02, 4.62, 0.002), (0.012, 8.0, 0.002), (0.02, 4.9, 0.03), (0.016, 6.0, 0.01)]
    {
        let plate = plate(half_width_m, rate_per_m, loss);
        for share in [0.35, 0.6, 0.85] {
            let boundary_m = share * plate.length_m();
            let frequency_hz = plate.frequency_for_boundary_hz(boundary_m);
            let points = 8001;
            let truth =
                plane::respond(&plate, frequency_hz, points, &plane::Setup::of(&plate)).expect("enters");
            let one = respond(&plate, frequency_hz, points, Equation::Corrected).expect("enters");
            let step_m = plate.length_m() / (points - 1) as f64;
            let end_m = plate.turning_point_m(frequency_hz).expect("enters");
            let found = antinodes(&one.amplitude, step_m, end_m);
            let wanted = antinodes(&truth.amplitude, step_m, end_m);
            // The near field of the end extends to W, and the third width mode to its own boundary.
            let from_m = half_width_m + plate.ghost_boundary_m(frequency_hz, 3).unwrap_or(0.0);
            let at = format!("W0 {half_width_m} d {rate_per_m} boundary {boundary_m}");
            let far = |all: &[(f64, f64)]| all.iter().filter(|it| it.0 > from_m).count();
            assert_eq!(far(&found), far(&wanted), "{at}: antinodes");
            let (peak, true_peak) = (found[found.len() - 1], wanted[wanted.len() - 1]);
            assert!((peak.0 - true_peak.0).abs() < 5e-4, "{at}: peak {} for {}", peak.0, true_peak.0);
            for (a, b) in found.iter().rev().zip(wanted.iter().rev()).take(far(&wanted)) {
                assert!((a.0 - b.0).abs() < 5e-4, "{at}: antinode at {} for {}", a.0, b.0);
                let level_db = 20.0 * (a.1 / peak.1 / (b.1 / true_peak.1)).log10();
                assert!(level_db.abs() < 0.5, "{at}: {level_db} dB at {}", a.0);
            }
            for share in [0.5, 0.25, 0.1] {
                let edge = fallen(&one.amplitude, step_m, peak, share);
                let true_edge = fallen(&truth.amplitude, step_m, true_peak, share);
                assert!((edge - true_edge).abs() < 8e-4, "{at}: {share} at {edge} for {true_edge}");
            }
        }
    }
}

#[test]
fn a_force_fixes_the_slope_of_the_whole_amplitude_with_its_weight() {
    let mut spec = plate(0.02, 4.62, 0.01).spec().clone();
    spec.drive_end = DriveEnd::Force { at_frequency_hz: 12e3 };
    let plate = Plate::new(spec).expect("a valid plate");
    // f'(0) is -k0 at 12 kHz, for every frequency.
    let slope = |frequency_hz: f64| {
        let points = 20_001;
        let f = respond(&plate, frequency_hz, points, Equation::Corrected).expect("enters").amplitude;
        let step_m = plate.length_m() / (points - 1) as f64;
        (-25.0 * f[0] + 48.0 * f[1] - 36.0 * f[2] + 16.0 * f[3] - 3.0 * f[4]) / (12.0 * step_m)
    };
    let wanted = slope(12e3);
    assert!(wanted.re < -100.0, "{wanted}");
    for frequency_hz in [8e3, 15e3, 24e3, 33e3] {
        let found = slope(frequency_hz);
        assert!((found - wanted).norm() < 1e-3 * wanted.norm(), "{frequency_hz}: {found} for {wanted}");
    }
}
