//! `respond` against an integration of the amplitude equation, on random plates with exponential, linear and sampled
//! tapers.
//!
//! W'' of a sampled taper jumps at its points. With the solver's correction of its scheme there (`numerov/breaks.rs`) the largest
//! difference on tapers of 12 to 38 points is 1.2e-7 of the largest amplitude (4e-4 without it). Over all tapers the median
//! is 2e-10.

use slipline_plate::truth::Random;
use slipline_plate::{Complex64, DriveEnd, Equation, Plate, PlateSpec, Taper, TurningWidth, preset, respond};
use std::f64::consts::{FRAC_PI_2, TAU};

const POINTS: usize = 2001;
/// Steps of the integration from point to point: it is exact to 1e-12 where the taper is smooth.
const STEPS: usize = 4;

/// A membrane of this number near the preset, moved at its end. Its taper is exponential, linear or sampled.
fn plate(number: u64) -> Plate {
    let mut random = Random::new(8000 + number);
    let membrane = preset("membrane").expect("a preset");
    let (half_width_m, length_m) = (random.factor(0.02, 0.08), membrane.length_m());
    let end_m = half_width_m * random.factor(0.15, 0.35);
    let taper = match number % 3 {
        0 => Taper::Exponential { half_width_m, rate_per_m: (half_width_m / end_m).ln() / length_m },
        1 => Taper::Linear { half_width_m, end_half_width_m: end_m },
        _ => {
            // 12 to 38 points of a smooth curve, whose narrowing swings by up to 40 %; none lies on a grid point.
            let parts = [11, 23, 37][(number / 3 % 3) as usize];
            let (depth, phase) = (random.within(0.0, 0.4), random.within(0.0, TAU));
            let fall = |part: usize| 1.0 + depth * (TAU * part as f64 / parts as f64 + phase).sin();
            let falls: Vec<f64> = (0..parts).map(fall).collect();
            let whole: f64 = falls.iter().sum();
            let mut fallen = 0.0;
            let point = |part: usize| {
                let width_m = half_width_m * (end_m / half_width_m).powf(fallen / whole);
                fallen += falls.get(part).copied().unwrap_or(0.0);
                [length_m * part as f64 / parts as f64, width_m]
            };
            Taper::Sampled { points: (0..=parts).map(point).collect() }
        }
    };
    let spec = PlateSpec {
        taper,
        turning_width: TurningWidth::Plain,
        drive_end: DriveEnd::Displacement,
        loss_factor: random.factor(0.002, 0.05),
        span_end_m: 0.6 * length_m,
        ..membrane.spec().clone()
    };
    Plate::new(spec).expect("a valid plate")
}

/// (W f')' + W k^2 f = 0 with k^2 = K^2 (1 + j eta) - (pi/2W)^2 by the Runge-Kutta method in f and W f', from a tenth
/// of the length beyond the plate's end, where the wave has died out, to the driven end; f(0) = 1.
fn integrated(plate: &Plate, frequency_hz: f64) -> Vec<Complex64> {
    let step = plate.length_m() / (STEPS * (POINTS - 1)) as f64;
    let steps = STEPS * (POINTS - 1) * 11 / 10;
    let axial = plate.wavenumber_squared(frequency_hz) * Complex64::new(1.0, plate.wave_loss());
    let width: Vec<f64> = (0..=2 * steps).map(|i| plate.half_width_m(0.5 * step * i as f64)).collect();
    let squared = |i: usize| axial - (FRAC_PI_2 / width[i]).powi(2);
    let rise = |i: usize, [f, push]: [Complex64; 2]| [push / width[i], -width[i] * squared(i) * f];
    let decay = (-squared(2 * steps)).sqrt();
    let mut state = [Complex64::from(1e-60), -decay * width[2 * steps] * 1e-60];
    let mut field = vec![state[0]];
    for i in (1..=steps).rev() {
        let at = |slope: [Complex64; 2], h: f64| [state[0] - h * slope[0], state[1] - h * slope[1]];
        let first = rise(2 * i, state);
        let second = rise(2 * i - 1, at(first, 0.5 * step));
        let third = rise(2 * i - 1, at(second, 0.5 * step));
        let fourth = rise(2 * i - 2, at(third, step));
        for n in 0..2 {
            state[n] -= step / 6.0 * (first[n] + 2.0 * second[n] + 2.0 * third[n] + fourth[n]);
        }
        if (i - 1) % STEPS == 0 {
            field.push(state[0]);
        }
    }
    field.iter().rev().map(|f| f / state[0]).collect()
}

/// Largest differences over the largest amplitude, of each plate at three frequencies, sorted.
fn differences(numbers: impl Iterator<Item = u64>) -> Vec<f64> {
    let of_plate = |number: u64| {
        let plate = plate(number);
        let at = move |share: f64| {
            let frequency_hz = plate.frequency_for_boundary_hz(share * plate.length_m());
            let found = respond(&plate, frequency_hz, POINTS, Equation::Corrected).expect("enters").amplitude;
            let wanted = integrated(&plate, frequency_hz);
            let largest = wanted.iter().map(|f| f.norm()).fold(0.0, f64::max);
            let apart = found.iter().zip(&wanted).map(|(found, wanted)| (found - wanted).norm());
            apart.fold(0.0, f64::max) / largest
        };
        [0.15, 0.3, 0.45].map(at)
    };
    let mut all: Vec<f64> = numbers.flat_map(of_plate).collect();
    all.sort_by(f64::total_cmp);
    println!("median {:.1e}, worst {:.1e}", all[all.len() / 2], all[all.len() - 1]);
    all
}

#[test]
fn the_response_matches_the_integrated_equation_on_sixty_plates() {
    let all = differences(0..60);
    // On two thirds of the plates a formula gives the taper; the others sample it at points, which is less exact.
    assert!(all[all.len() / 2] < 1e-9 && all[all.len() - 1] < 1e-6, "{all:?}");
}
