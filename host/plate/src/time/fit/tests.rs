use super::*;
use crate::definition::actuator::{Actuator, Resonator};
use crate::definition::plate::Plate;
use crate::definition::presets::{preset, presets};
use crate::frequency::equation::Equation;
use crate::frequency::respond::respond;
use std::f64::consts::PI;

const PLACES: usize = 129;

/// The filter of a line of this plate.
fn plan_of(plate: &Plate) -> BandPlan {
    let (low, high) = plate.band_hz();
    BandPlan::new((10.0 * high).clamp(4e3, 400e3), low, high)
}

fn fit_of(plate: &Plate) -> (Fit, BandPlan) {
    let plan = plan_of(plate);
    (exact(response(plate, None, PLACES, plan.stop_hz().1), &plan, PLACES), plan)
}

/// Largest difference, relative to the largest amplitude.
fn difference(exact: &[Complex64], found: &[Complex64]) -> f64 {
    let apart: Vec<Complex64> = exact.iter().zip(found).map(|(a, b)| a - b).collect();
    samples::largest(&apart) / samples::largest(exact)
}

/// Largest difference between a fit and `response` at 301 frequencies over the whole band of the filter and, with
/// `resonances`, near every pole in it.
fn worst(
    fit: &Fit,
    plan: &BandPlan,
    mut response: impl FnMut(&[f64]) -> Vec<Vec<Complex64>>,
    resonances: bool,
) -> f64 {
    let (low, high) = plan.stop_hz();
    let mut frequencies: Vec<f64> = (0..301).map(|i| low + (high - low) * f64::from(i) / 300.0).collect();
    if resonances {
        let beside =
            fit.bank.pole.iter().flat_map(|p| [-1.3, -0.6, 0.0, 0.7].map(|k| (p.re + k * p.im) / TAU));
        frequencies.extend(beside.filter(|f| *f > low && *f < high));
    }
    let rows = response(&frequencies);
    let pairs = frequencies.iter().zip(&rows);
    pairs.map(|(f, exact)| difference(exact, &fit.bank.steady(*f, plan.centre_hz))).fold(0.0, f64::max)
}

#[test]
fn the_fit_of_every_preset_answers_as_the_frequency_domain_solver_with_fewer_poles_than_the_plate_has() {
    for preset in presets() {
        let plate = preset.plate().expect("a preset");
        let (low, high) = plate.band_hz();
        let (fit, plan) = fit_of(&plate);
        assert!(
            fit.bank.pole.iter().all(|p| p.im < 0.0),
            "{}: an oscillation that does not decay",
            preset.name
        );
        for i in 0..=10 {
            let frequency = low + (high - low) * f64::from(i) / 10.0;
            let exact = respond(&plate, frequency, PLACES, Equation::Corrected).expect("in band");
            let error = difference(&exact.amplitude, &fit.bank.steady(frequency, plan.centre_hz));
            assert!(error < 1e-3, "{} {frequency} Hz: {error}", preset.name);
        }
        let error = worst(&fit, &plan, response(&plate, None, PLACES, plan.stop_hz().1), true);
        // With air the field is no sum of decaying resonances: the fit ends a little above its aim.
        let aim = if plate.carries_air() { 4e-4 } else { Accuracy::EXACT.field };
        assert!(error < 5e-4 && fit.error < aim, "{}: {error}, {}", preset.name, fit.error);
        // A plate has about one resonance for each half wavelength that fits before its turning point.
        let reach_hz = plan.centre_hz + REACH * plan.half_band_hz;
        let has = plate.width_mode(1).phase_to(f64::INFINITY, reach_hz) / PI;
        let few = fit.bank.pole.len();
        println!("{}: {few} poles of {has:.1}", preset.name);
        assert!((few as f64) < has, "{}: {few} poles, the plate has {has}", preset.name);
    }
}

#[test]
fn sharp_resonances_are_found_however_sharp() {
    for loss_factor in [0.002, 1e-4, 0.0] {
        let mut spec = preset("al-bending-displacement").expect("a preset").spec().clone();
        spec.loss_factor = loss_factor;
        let plate = Plate::new(spec).expect("a valid plate");
        let (fit, plan) = fit_of(&plate);
        let response = response(&plate, None, PLACES, plan.stop_hz().1);
        let error = worst(&fit, &plan, response, loss_factor > 0.0);
        assert!(error < 5e-4, "loss {loss_factor}: {error}");
        assert!(fit.bank.pole.iter().all(|p| p.im <= 0.0), "loss {loss_factor}");
    }
}

#[test]
fn an_actuator_of_any_quality_is_a_pair_of_poles_more_at_most() {
    let plate = preset("al-bending").expect("a preset");
    let (bare, _) = fit_of(&plate);
    for quality in [0.5, 12.0, 1000.0] {
        let mut spec = plate.spec().clone();
        spec.actuator = Some(Actuator::Resonator(Resonator { resonance_hz: 31e3, quality, travel: None }));
        let plate = Plate::new(spec).expect("a valid plate");
        let (fit, plan) = fit_of(&plate);
        let error = worst(&fit, &plan, response(&plate, None, PLACES, plan.stop_hz().1), true);
        assert!(error < 5e-4, "Q {quality}: {error}");
        let mut exact = respond(&plate, 30.9e3, PLACES, Equation::Corrected).expect("in band").amplitude;
        let gain = plate.spec().actuator.as_ref().expect("an actuator").response(30.9e3);
        exact.iter_mut().for_each(|f| *f *= gain);
        assert!(difference(&exact, &fit.bank.steady(30.9e3, plan.centre_hz)) < 5e-4, "Q {quality}");
        assert!(fit.bank.pole.len() <= bare.bank.pole.len() + 3, "Q {quality}: {}", fit.bank.pole.len());
    }
}

#[test]
fn a_wave_that_enters_only_in_the_upper_half_of_the_band_gets_no_spurious_poles() {
    let plate = preset("al-bending-displacement").expect("a preset");
    let cut_off_hz = plate.cut_off_hz();
    let plan = BandPlan::new(400e3, 0.2 * cut_off_hz, 1.4 * cut_off_hz);
    assert!(cut_off_hz > plan.centre_hz, "{cut_off_hz} of {}", plan.centre_hz);
    let fit = exact(response(&plate, None, PLACES, plan.stop_hz().1), &plan, PLACES);
    let error = worst(&fit, &plan, response(&plate, None, PLACES, plan.stop_hz().1), true);
    assert!(error < 5e-4, "{error}");
    assert!(fit.bank.pole.len() < 16, "{} poles", fit.bank.pole.len());
}

/// A membrane by finite differences with a resistive patch: f'' + (W'/W) f' + (k^2 + j omega r chi(x)) f = 0, with
/// f(0) = 1 or with a matched resistance there.
fn touched(
    plate: &Plate,
    touch: Complex64,
    place_m: f64,
    is_matched: bool,
) -> impl FnMut(&[f64]) -> Vec<Vec<Complex64>> {
    const STEPS: usize = 8;
    let points = (PLACES - 1) * STEPS + 1;
    let step = plate.length_m() / (points - 1) as f64;
    let mode = plate.width_mode(1);
    let k0 = mode.wavenumber_squared(0.0, 140.0).sqrt();
    move |frequencies| {
        let field = |frequency: &f64| {
            let axial = crate::frequency::axial::lossy_axial_squared(&mode, *frequency);
            // From the end, where f = 0, to the drive: f[i + 1] = ratio[i] f[i].
            let mut ratio = vec![Complex64::ZERO; points];
            let mut robin = Complex64::ZERO;
            for i in (0..points - 1).rev() {
                let x = (i as f64) * step;
                let slope = 0.5 * plate.narrowing_per_m(x) * step;
                let patch =
                    if (x - place_m).abs() <= 5e-3 { touch * (TAU * frequency) } else { Complex64::ZERO };
                let here = (axial - mode.width_term(x) + patch) * step * step - 2.0;
                let before = -(here + (1.0 + slope) * ratio[i]) / (1.0 - slope);
                if i > 0 {
                    ratio[i - 1] = before.inv();
                } else {
                    robin = (ratio[0] - before) / (2.0 * step);
                }
            }
            let mut value = Complex64::ONE;
            if is_matched {
                let a = Complex64::new(0.0, k0 * frequency / 140.0);
                value = 2.0 * a / (robin + a);
            }
            let mut row = Vec::with_capacity(PLACES);
            for (i, ratio) in ratio.iter().enumerate() {
                if i % STEPS == 0 {
                    row.push(value);
                }
                value *= ratio;
            }
            row
        };
        frequencies.iter().map(field).collect()
    }
}

#[test]
fn a_touch_of_the_plate_is_fitted_as_any_other_field() {
    let plate = preset("membrane").expect("a preset");
    let plan = plan_of(&plate);
    // A resistance, a mass, and both, per unit of tension and length of the patch.
    for touch in [Complex64::new(0.0, 30.0), Complex64::new(1.5, 0.0), Complex64::new(0.5, 4.0)] {
        for (place_m, is_matched) in [(0.12, false), (0.12, true), (0.2, true)] {
            let fit = exact(touched(&plate, touch, place_m, is_matched), &plan, PLACES);
            let error = worst(&fit, &plan, touched(&plate, touch, place_m, is_matched), true);
            assert!(error < 5e-4, "{touch} at {place_m}, matched {is_matched}: {error}");
            assert!(fit.bank.pole.iter().all(|p| p.im < 0.0), "{touch} at {place_m}");
            let mut free = touched(&plate, Complex64::ZERO, place_m, is_matched);
            let (free, now) = (&free(&[150.0])[0], fit.bank.steady(150.0, plan.centre_hz));
            assert!(difference(free, &now) > 0.1, "{touch} at {place_m}: the touch has an effect");
        }
    }
}

#[test]
fn a_known_rational_field_gives_its_poles_and_a_growing_one_is_turned_to_decay() {
    let plan = BandPlan::new(400e3, 10e3, 40e3);
    let wanted = [Complex64::new(1.5e5, -900.0), Complex64::new(1.8e5, -40.0), Complex64::new(2.1e5, -3e4)];
    let rational = |pole: [Complex64; 3]| {
        move |frequencies: &[f64]| -> Vec<Vec<Complex64>> {
            let value = |f: &f64, x: usize| {
                let parts = pole
                    .iter()
                    .enumerate()
                    .map(|(i, p)| (PI * x as f64 * (i as f64 + 1.0) / 31.0).sin() / (p - TAU * f));
                0.3e-4 + parts.sum::<Complex64>()
            };
            frequencies.iter().map(|f| (0..32).map(|x| value(f, x)).collect()).collect()
        }
    };
    let fit = exact(rational(wanted), &plan, 32);
    for wanted in wanted {
        let nearest = fit.bank.pole.iter().map(|p| (p - wanted).norm()).fold(f64::INFINITY, f64::min);
        assert!(nearest < 1e-3 * -wanted.im, "{wanted}: {nearest}");
    }
    let growing = exact(rational([wanted[0], wanted[1].conj(), wanted[2]]), &plan, 32);
    assert!(growing.bank.pole.iter().all(|p| p.im <= 0.0));
    assert!(growing.error > Accuracy::EXACT.field, "it cannot be fitted, and the fit says so");
}

#[test]
fn a_resonance_a_thousand_times_sharper_than_the_distance_of_the_samples_is_right_at_its_peak() {
    let plan = BandPlan::new(400e3, 10e3, 40e3);
    for width in [1.0, 1.5, 5.0, 100.0] {
        // A broad resonance, and a sharp one with half its peak.
        let pole = [Complex64::new(1.5e5, -4e4), Complex64::new(1.7e5, -width)];
        let response = |frequencies: &[f64]| -> Vec<Vec<Complex64>> {
            let value = |f: &f64, x: usize| {
                let share = [4e4 * (0.2 + x as f64 / 31.0), 0.5 * width * (0.1 * x as f64).cos()];
                pole.iter().zip(share).map(|(p, share)| share / (p - TAU * f)).sum::<Complex64>()
            };
            frequencies.iter().map(|f| (0..32).map(|x| value(f, x)).collect()).collect()
        };
        let fit = exact(response, &plan, 32);
        for k in [-2.0, -0.5, 0.0, 1.0] {
            let frequency = (pole[1].re + k * width) / TAU;
            let error = difference(&response(&[frequency])[0], &fit.bank.steady(frequency, plan.centre_hz));
            assert!(error < 5e-4, "width {width}, {k} beside: {error}");
        }
    }
}

#[test]
fn a_field_that_is_zero_or_not_finite_leaves_the_plate_at_rest() {
    let plan = BandPlan::new(400e3, 10e3, 40e3);
    for value in [0.0, f64::NAN, f64::INFINITY] {
        let fit = exact(|f: &[f64]| vec![vec![Complex64::from(value); 20]; f.len()], &plan, 20);
        assert_eq!((fit.bank.shape.shape(), fit.bank.quasi_static.shape()), ((20, 0), (20, 3)));
        assert!(fit.bank.quasi_static.iter().all(|value| *value == Complex64::ZERO));
    }
    // One bad place excludes a frequency.
    for value in [f64::NAN, f64::INFINITY] {
        let one_bad = |f: &[f64]| {
            let row = |f: &f64| -> Vec<Complex64> {
                (0..20).map(|x| Complex64::from(if x == 3 && *f > 30e3 { value } else { 1.0 })).collect()
            };
            f.iter().map(row).collect::<Vec<_>>()
        };
        let fit = exact(one_bad, &plan, 20);
        assert!(difference(&[Complex64::ONE; 20], &fit.bank.steady(20e3, plan.centre_hz)) < 1e-4, "{value}");
    }
    // A field without poles: the quasi-static terms alone represent it.
    let fit = exact(|f: &[f64]| vec![vec![Complex64::new(0.5, 2.0); 20]; f.len()], &plan, 20);
    assert!(fit.error < 1e-5 && fit.bank.pole.len() <= 1, "{} {}", fit.error, fit.bank.pole.len());
}
