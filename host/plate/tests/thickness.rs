//! A thickness that changes along the plate: against closed forms, an independent equation and a plate in two
//! dimensions; and the plates that refuse it.

use crate::time_line::assert_answers_tones;
use slipline_plate::calibrate::{
    MeasuredPoint, Measurement, Priors, SensorKind, band_hz, from_one_sensor, from_ratio,
};
use slipline_plate::check::{Checker, Conditions};
use slipline_plate::{
    Complex64, DriveEnd, DriveTable, Equation, Model, Plate, PlateSpec, Thickness, TurningWidth, plane,
    preset, quantity::decibels, respond, respond_batch,
};
use std::f64::consts::{FRAC_PI_2, TAU};

/// The specification of the preset `al-bending` with a prescribed displacement and the plain turning width.
fn spec(thickness: Option<Thickness>, loss_factor: f64) -> PlateSpec {
    PlateSpec {
        drive_end: DriveEnd::Displacement,
        turning_width: TurningWidth::Plain,
        thickness,
        loss_factor,
        ..preset("al-bending").expect("a preset").spec().clone()
    }
}

fn plate(thickness: Option<Thickness>) -> Plate {
    Plate::new(spec(thickness, 0.01)).expect("a plate")
}

fn exponential(rate_per_m: f64) -> Option<Thickness> {
    Some(Thickness::Exponential { rate_per_m })
}

/// Measured points: thinner, then thicker, then thinner again.
fn sampled() -> Option<Thickness> {
    let points = [[0.0, 2e-3], [0.06, 1.9e-3], [0.13, 1.97e-3], [0.2, 1.8e-3], [0.34, 1.75e-3]];
    Some(Thickness::Sampled { points: points.to_vec() })
}

#[test]
fn on_exponentials_the_boundary_is_the_logarithm_over_2_d_less_g() {
    for rate in [-3.0, -0.5, 1.0, 2.0, 4.0] {
        let graded = plate(exponential(rate));
        assert!((graded.thickness_m(0.1).expect("bending") - 2e-3 * (-0.1 * rate).exp()).abs() < 1e-15);
        for hz in [20e3, 30e3, 40e3] {
            let x0 = (hz / graded.cut_off_hz()).ln() / (2.0 * 4.62 - rate);
            let found = graded.turning_point_m(hz).expect("enters");
            assert!((found - x0).abs() < 1e-9, "{rate} {hz}: {found} {x0}");
            assert!((graded.frequency_for_boundary_hz(x0) / hz - 1.0).abs() < 1e-9);
        }
        // kappa^3 = -d(k^2)/dx at x0 = (2 d - g) (pi/2W)^2.
        let (x0, hz) = (0.2, graded.frequency_for_boundary_hz(0.2));
        let kappa = ((2.0 * 4.62 - rate) * (FRAC_PI_2 / graded.half_width_m(x0)).powi(2)).cbrt();
        assert!((graded.kappa_per_m(hz).expect("enters") / kappa - 1.0).abs() < 1e-9);
    }
    // A thickness larger by 1 % moves a boundary by 1.08 mm.
    let mut thicker = spec(None, 0.01);
    let Model::BendingSupported(bending) = &mut thicker.model else { panic!("bending") };
    bending.thickness_m *= 1.01;
    let moved = plate(None).turning_point_m(30e3).expect("enters")
        - Plate::new(thicker).expect("a plate").turning_point_m(30e3).expect("enters");
    assert!((1e3 * moved - 1.08).abs() < 0.005, "{moved}");
}

#[test]
fn a_law_of_no_change_is_the_plate_without_one() {
    let even = plate(None);
    for thickness in [exponential(0.0), Some(Thickness::Linear { end_thickness_m: 2e-3 })] {
        let graded = plate(thickness);
        assert!(graded.is_graded() && graded.with_uniform_thickness() == even);
        for hz in [20e3, 35e3] {
            let of = |plate: &Plate| respond(plate, hz, 257, Equation::Corrected).expect("enters").amplitude;
            for (a, b) in of(&graded).iter().zip(of(&even)) {
                assert!((a - b).norm() < 1e-7 * b.norm().max(1.0), "{hz}: {a} {b}");
            }
        }
    }
    let paper = |plate: &Plate| respond(plate, 30e3, 129, Equation::Paper).expect("enters");
    assert_eq!(paper(&plate(exponential(2.0))), paper(&even));
}

/// (S f')' + S k^2 f = 0 with S = W h^2 and k^2 = K0^2 h0/h (1 + j eta) - (pi/2W)^2, by the Runge-Kutta method in f and
/// S f' from the plate's end to the driven end; the result is at every 16th step, with f(0) = 1. `log` is ln(h/h0).
fn integrated(plate: &Plate, log: impl Fn(f64) -> f64, hz: f64, steps: usize) -> Vec<Complex64> {
    let bending = plate.spec().model.bending().expect("bending");
    let axial = TAU * hz / bending.spread_m2_per_s() * Complex64::new(1.0, plate.wave_loss());
    let step = plate.length_m() / steps as f64;
    let slope_of = |x: f64, [f, flux]: [Complex64; 2]| {
        let (width, v) = (plate.half_width_m(x), log(x));
        let weight = width / plate.half_width_m(0.0) * (2.0 * v).exp();
        [flux / weight, -weight * (axial * (-v).exp() - (FRAC_PI_2 / width).powi(2)) * f]
    };
    let end = plate.length_m();
    let [_, pull] = slope_of(end, [Complex64::ONE, Complex64::ZERO]);
    let weight = plate.half_width_m(end) / plate.half_width_m(0.0) * (2.0 * log(end)).exp();
    let mut state = [Complex64::from(1e-30), -(pull * weight).sqrt() * 1e-30];
    let mut field = vec![state[0]];
    for i in (1..=steps).rev() {
        let x = i as f64 * step;
        let at = |slope: [Complex64; 2], h: f64| [state[0] - h * slope[0], state[1] - h * slope[1]];
        let first = slope_of(x, state);
        let second = slope_of(x - 0.5 * step, at(first, 0.5 * step));
        let third = slope_of(x - 0.5 * step, at(second, 0.5 * step));
        let fourth = slope_of(x - step, at(third, step));
        for (n, value) in state.iter_mut().enumerate() {
            *value -= step / 6.0 * (first[n] + 2.0 * second[n] + 2.0 * third[n] + fourth[n]);
        }
        field.push(state[0]);
    }
    field.iter().rev().step_by(16).map(|f| f / state[0]).collect()
}

#[test]
fn the_response_matches_the_conservative_equation() {
    let linear = |x: f64| (1.0 - 0.4 * x / 0.34).ln();
    for (thickness, log, allowed) in [
        (exponential(2.5), &(|x: f64| -2.5 * x) as &dyn Fn(f64) -> f64, 3e-8),
        (exponential(-2.0), &|x: f64| 2.0 * x, 3e-8),
        (Some(Thickness::Linear { end_thickness_m: 1.2e-3 }), &linear, 3e-8),
    ] {
        let graded = plate(thickness.clone());
        for x in [0.15, 0.22] {
            let hz = graded.frequency_for_boundary_hz(x);
            let wanted = integrated(&graded, log, hz, 6400);
            let found = respond(&graded, hz, 401, Equation::Corrected).expect("enters").amplitude;
            let batch = respond_batch(&graded, &[hz], 401, Equation::Corrected).expect("enters").remove(0);
            let largest = wanted.iter().map(|f| f.norm()).fold(0.0, f64::max);
            let off = |found: &[Complex64]| {
                let pairs = found.iter().zip(&wanted).take(340);
                pairs.map(|(a, b)| (a - b).norm() / largest).fold(0.0, f64::max)
            };
            assert!(off(&found) < allowed, "{thickness:?} {x}: {:e}", off(&found));
            assert!(off(&batch) < 1e-4, "{thickness:?} {x}: {:e}", off(&batch));
        }
    }
    // Sampled thickness: that of the plate itself, whose curve goes through the given points.
    let graded = plate(sampled());
    let log = |x: f64| (graded.thickness_m(x).expect("bending") / 2e-3).ln();
    for [x, thickness_m] in [[0.06, 1.9e-3], [0.13, 1.97e-3], [0.2, 1.8e-3]] {
        assert!((graded.thickness_m(x).expect("bending") / thickness_m - 1.0).abs() < 1e-12);
    }
    let hz = graded.frequency_for_boundary_hz(0.22);
    let wanted = integrated(&graded, log, hz, 6400);
    let found = respond(&graded, hz, 401, Equation::Corrected).expect("enters").amplitude;
    let largest = wanted.iter().map(|f| f.norm()).fold(0.0, f64::max);
    let off = found.iter().zip(&wanted).take(340).map(|(a, b)| (a - b).norm() / largest).fold(0.0, f64::max);
    // h'' is discontinuous at the points.
    assert!(off < 3e-5, "{off:e}");
}

/// One dimension against two, along the arc: the difference of the peak's place, mm, and that of its level, dB, which
/// is compared with the difference on the plate of uniform thickness.
#[test]
fn graded_plates_peak_where_two_dimensions_have_them() {
    let misses = |plate: &Plate, x: f64| {
        let hz = plate.frequency_for_boundary_hz(x);
        let one = respond(plate, hz, 2001, Equation::Corrected).expect("enters").peak.expect("a peak");
        let setup = plane::Setup::of(plate);
        let two = plane::respond(plate, hz, 2001, &setup).expect("solves").peak.expect("a peak");
        (1e3 * (one.position_m - two.position_m), decibels(one.amplitude / two.amplitude))
    };
    let of = |thickness| {
        let spec = PlateSpec { turning_width: TurningWidth::Arc, ..spec(thickness, 0.1) };
        Plate::new(spec).expect("a plate")
    };
    for x in [0.1, 0.18, 0.25] {
        let (_, even_db) = misses(&of(None), x);
        for thickness in
            [exponential(2.0), exponential(-2.0), Some(Thickness::Linear { end_thickness_m: 1.2e-3 })]
        {
            let (mm, db) = misses(&of(thickness.clone()), x);
            assert!(mm.abs() < 0.1 && (db - even_db).abs() < 0.4, "{thickness:?} {x}: {mm} {db} {even_db}");
        }
    }
}

#[test]
fn the_line_in_time_a_table_and_the_lights_have_the_thickness() {
    let graded = plate(exponential(2.0));
    assert_answers_tones(&graded, 400_000.0, &[18e3], 5e-3);
    // The table of a prescribed displacement moves the tones between resonances; with a damper there are no resonances.
    let end = DriveEnd::Resistance { ratio: 1.0, at_frequency_hz: 18e3 };
    let spec = PlateSpec { drive_end: end, ..spec(exponential(2.0), 0.01) };
    let damped = Plate::new(spec).expect("a plate");
    let table = DriveTable::build(&damped, 400e3, 257).expect("a table");
    for x in [0.205, 0.24, 0.275] {
        let hz = table.frequency_hz(x);
        assert!((hz / damped.frequency_for_boundary_hz(x) - 1.0).abs() < 1e-4, "{x}: {hz}");
        let peak = respond(&damped, hz, 801, Equation::Corrected).expect("enters").peak.expect("a peak");
        let level = table.gain(x) * peak.amplitude * damped.spec().full_scale_m;
        assert!((level / table.peak_m(x) - 1.0).abs() < 0.01, "{x}: {level}");
    }
    let light = |plate: &Plate, x: f64| {
        let report = Checker::new(plate, Conditions::default()).expect("checks").at(x).expect("on it");
        report.light("thin plate").expect("a light").value.expect("a number")
    };
    // The error of the thin plate is proportional to K h, so to the root of the largest thickness on the way, at the
    // same frequency.
    let (x, hz) = (0.2, plate(exponential(-2.0)).frequency_for_boundary_hz(0.2));
    let even = plate(None);
    let there = even.turning_point_m(hz).expect("enters");
    let ratio = light(&plate(exponential(-2.0)), x) / light(&even, there);
    assert!((ratio / (0.4_f64).exp() - 1.0).abs() < 0.05, "{ratio}");
}

#[test]
fn a_thickness_is_read_and_written_and_refused_by_plates_without_one() {
    for thickness in [exponential(1.5), Some(Thickness::Linear { end_thickness_m: 1.5e-3 }), sampled()] {
        let graded = plate(thickness);
        assert_eq!(Plate::from_toml(&graded.to_toml()).expect("its own text"), graded);
    }
    let refused = |spec: PlateSpec| Plate::new(spec).expect_err("refused").to_string();
    let graded = || spec(exponential(2.0), 0.01);
    let mut membrane = preset("membrane").expect("a preset").spec().clone();
    membrane.thickness = exponential(2.0);
    assert_eq!(
        refused(membrane),
        "thickness does not belong here: only a plate in bending has a law of its thickness"
    );
    let mut thick = graded();
    let Model::BendingSupported(bending) = &mut thick.model else { panic!("bending") };
    bending.thick_plate = true;
    assert!(refused(thick).starts_with("model.thick_plate does not belong here"));
    let bending = graded().model.bending().expect("bending").clone();
    let clamped = PlateSpec { model: Model::BendingClamped(bending), ..graded() };
    assert!(refused(clamped).starts_with("thickness does not belong here: clamped edges"));
    let air = PlateSpec { air: Some(slipline_plate::Air::ROOM), ..graded() };
    assert!(refused(air).starts_with("air does not belong here"));
    let source =
        PlateSpec { drive_end: preset("al-bending").expect("a preset").spec().drive_end, ..graded() };
    assert!(
        refused(source).starts_with("drive.end does not belong here: the near field behind a \"source\"")
    );
    let growing = refused(spec(exponential(9.3), 0.01));
    assert!(growing.contains("narrows faster than the root of its thickness everywhere"), "{growing}");
    let far = refused(spec(exponential(100.0), 0.01));
    assert!(far.starts_with("thickness.rate_per_m = 100: must be -"), "{far}");
    let points = vec![[0.0, 2e-3], [0.2, 1.9e-3]];
    let short = refused(spec(Some(Thickness::Sampled { points }), 0.01));
    assert!(short.starts_with("thickness.points[1][0] = 0.2: must be 0.34 to 100 m"), "{short}");
    let points = vec![[0.0, 1e-3], [0.34, 1.9e-3]];
    let other = refused(spec(Some(Thickness::Sampled { points }), 0.01));
    assert!(other.starts_with("thickness.points[0][1] = 0.001: must be 0.002"), "{other}");
}

#[test]
fn two_places_calibrate_a_graded_plate_and_one_sensor_refuses_it() {
    let nominal = plate(exponential(2.0));
    let truth = nominal.with_wave_speed(1.02).expect("in range");
    let (low, high) = band_hz(&nominal);
    let frequencies: Vec<f64> = (0..150).map(|i| low * (high / low).powf(f64::from(i) / 149.0)).collect();
    let fields = respond_batch(&truth, &frequencies, 3401, Equation::Corrected).expect("in the band");
    let sensor = |point: usize| {
        let points = fields.iter().zip(&frequencies).map(|(field, &frequency_hz)| MeasuredPoint {
            frequency_hz,
            response: field[point],
            noise: 1e-3,
            headroom_db: None,
        });
        Measurement::at(point as f64 * 1e-4, SensorKind::Displacement, points.collect())
    };
    let (near, far) = (sensor(400), sensor(1800));
    let found = from_ratio(&nominal, [&near, &far], &Priors::default()).expect("a fit").plate;
    assert_eq!(found.spec().thickness, nominal.spec().thickness);
    for x in [0.1, 0.2, 0.27] {
        let hz = found.frequency_for_boundary_hz(x);
        let error_m = truth.turning_point_m(hz).expect("enters") - x;
        let before_m = truth.turning_point_m(nominal.frequency_for_boundary_hz(x)).expect("enters") - x;
        assert!(error_m.abs() < 3e-4 && before_m.abs() > 3e-3, "{x}: {error_m} {before_m}");
    }
    let error = from_one_sensor(&nominal, &near, &Priors::default()).expect_err("a source").to_string();
    assert!(error.contains("thickness does not belong here: a fit of the source"), "{error}");
}
