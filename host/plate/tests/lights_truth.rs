//! The lights of random plates against the truth: the two-dimensional solver, and the plate with another speed or loss.

use slipline_plate::check::{Checker, Colour, Conditions, Report};
use slipline_plate::{
    Bending, DriveEnd, EndSlope, Equation, LeadIn, Model, Plate, PlateSpec, Source, Taper, plane, preset,
    respond,
};

/// How far the level may be off under green lights, dB.
const LEVEL_DB: f64 = 2.0;
/// How far the peak may be off under green lights, in widths of the edge.
const EDGE_SHARE: f64 = 0.25;
const PLATES: usize = 30;
const POINTS: usize = 257;

/// Uniform numbers of a linear congruential generator (Knuth's MMIX).
struct Random(u64);

impl Random {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn log_between(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }
}

fn model(random: &mut Random, number: usize) -> Model {
    let bending = |random: &mut Random| Bending {
        youngs_modulus_pa: 70e9,
        poisson_ratio: random.between(0.2, 0.4),
        density_kg_per_m3: 2700.0,
        thickness_m: random.between(5e-4, 1.5e-3),
        thick_plate: false,
    };
    match number % 4 {
        0 => Model::Membrane {
            wave_speed_m_per_s: random.between(8.0, 20.0),
            tension_n_per_m: Some(random.log_between(40.0, 4000.0)),
        },
        1 => Model::ShearHorizontal {
            shear_modulus_pa: random.log_between(2e5, 2e6),
            density_kg_per_m3: 1000.0,
            thickness_m: Some(2e-3),
        },
        2 => Model::BendingSupported(bending(random)),
        _ => Model::BendingClamped(bending(random)),
    }
}

/// A plate of some wavelengths, and a boundary on it.
fn plate(random: &mut Random, number: usize) -> Option<(Plate, f64)> {
    let rate_per_m = random.between(3.0, 7.0);
    let slope = random.log_between(0.05, 0.9);
    let model = model(random, number);
    let length_m = random.between(1.0, 1.6) / rate_per_m;
    let mut spec = PlateSpec {
        name: format!("plate {number}"),
        taper: Taper::Exponential { half_width_m: slope / rate_per_m, rate_per_m },
        length_m,
        loss_factor: random.log_between(0.002, 0.1),
        loss_tolerance: None,
        drive_end: DriveEnd::Displacement,
        actuator: None,
        span_start_m: 0.3 * length_m,
        span_end_m: 0.95 * length_m,
        model,
        ..preset("membrane").expect("preset").spec().clone()
    };
    let still = Plate::new(spec.clone()).ok()?;
    let at_frequency_hz = still.frequency_for_boundary_hz(0.6 * length_m);
    let impedance = still.wave_impedance_n_s_per_m(at_frequency_hz)?;
    let bends = number % 4 > 1;
    spec.drive_end = match (number / 4) % 4 {
        0 => DriveEnd::Displacement,
        1 => DriveEnd::Resistance { ratio: random.log_between(0.5, 2.0), at_frequency_hz },
        _ => DriveEnd::Source(Source {
            resistance_n_s_per_m: if bends { 0.0 } else { random.between(0.8, 1.25) * impedance },
            mass_kg: 0.0,
            stiffness_n_per_m: 0.0,
            at_frequency_hz,
            slope: bends.then_some(EndSlope::Free),
            lead_in: bends.then_some(LeadIn {
                length_m: 5.0 * still.half_width_m(0.0),
                loss_factor: 0.3,
                end_resistance_n_s_per_m: 0.37 * impedance,
            }),
        }),
    };
    let boundary_m = length_m * random.between(0.35, 0.9);
    Some((Plate::new(spec).ok()?, boundary_m))
}

/// Peak of the plate in two dimensions at `frequency_hz`: place in metres, level in dB.
fn truth(plate: &Plate, frequency_hz: f64) -> Option<(f64, f64)> {
    let response = plane::respond(plate, frequency_hz, POINTS, &plane::Setup::of(plate)).expect("solves");
    response.peak.map(|peak| (peak.position_m, 20.0 * peak.amplitude.log10()))
}

fn all_green(report: &Report, names: &[&str]) -> bool {
    names.iter().all(|name| report.light(name).expect("a light").colour <= Colour::Green)
}

#[test]
fn no_lights_are_green_where_the_plate_itself_is_two_decibels_or_a_quarter_of_the_edge_off() {
    let mut random = Random(11);
    let (mut found, mut judged, mut off) = (Vec::new(), 0, 0);
    let mut number = 0;
    while judged < PLATES {
        number += 1;
        let Some((plate, boundary_m)) = plate(&mut random, number) else { continue };
        judged += 1;
        let hz = plate.frequency_for_boundary_hz(boundary_m);
        let checker = Checker::new(&plate, Conditions { sample_rate_hz: 1e6, ..Conditions::default() })
            .expect("checks");
        let report = checker.at(boundary_m).expect("on it");
        let told = respond(&plate, hz, POINTS, Equation::Corrected).expect("responds");
        let place =
            ["edge slope", "edge curvature", "wavelengths", "thin plate", "loss", "peak", "drive match"];
        let level = ["edge slope", "edge curvature", "wavelengths", "peak", "drive match", "sensitivity"];
        let real = truth(&plate, hz);
        let wrong = match (told.peak, real) {
            (Some(told), Some((place_m, level_db))) => {
                let edge_m = plate.edge_width_m(hz).expect("enters");
                let misplaced = (place_m - told.position_m).abs() > EDGE_SHARE * edge_m;
                let loud_db = (level_db - 20.0 * told.amplitude.log10()).abs();
                off += usize::from(misplaced || loud_db > LEVEL_DB);
                (misplaced && all_green(&report, &place))
                    || (loud_db > LEVEL_DB && all_green(&report, &level))
            }
            (told, real) => told.is_some() != real.is_some() && all_green(&report, &["peak"]),
        };
        if wrong {
            found.push(format!("{number}: {:?} {real:?} {:?} {:?}", told.peak, plate.spec(), report.lights));
        }
        // The plate as it may be instead: the sensitivity light alone answers for it.
        let lossy = |factor: f64| {
            let mut spec = plate.spec().clone();
            spec.loss_factor *= factor;
            Plate::new(spec)
        };
        let others = [plate.with_wave_speed(0.99), plate.with_wave_speed(1.01), lossy(0.5), lossy(2.0)];
        for other in others.into_iter().flatten() {
            let Some(((_, real_db), (_, other_db))) = real.zip(truth(&other, hz)) else { continue };
            let change_db = (other_db - real_db).abs();
            off += usize::from(change_db > LEVEL_DB);
            if change_db > LEVEL_DB && all_green(&report, &["sensitivity", "drive match"]) {
                found.push(format!(
                    "{number}: {change_db} dB {:?} {:?}",
                    plate.spec(),
                    report.light("sensitivity")
                ));
            }
        }
    }
    assert!(off > 10, "only {off} plates and perturbations are off: they test nothing");
    assert!(found.is_empty(), "{} of {off}: {found:#?}", found.len());
}
