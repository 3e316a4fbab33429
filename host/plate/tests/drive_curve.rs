//! Drives given by curves (a measured actuator, the correction of a calibration) in the time domain, against
//! `respond` times `drive_response`: on the line, on the sheet and in the responses of a sensor.

use slipline_plate::calibrate::{SensorKind, band_hz};
use slipline_plate::truth::Random;
use slipline_plate::{
    Actuator, Calibration, Complex64, DriveEnd, Equation, LineError, Model, Plate, PlateSpec, Resonator,
    ResponseCurve, SensedPlate, Sheet, SheetError, SheetGrid, TimeDomainLine, preset, presets,
    quantity::decibels, respond,
};
use std::f64::consts::{PI, TAU};

/// Frequencies over the band, with both ends.
const FREQUENCIES: u32 = 6;
const DECIBELS: f64 = 0.05;

/// The gain of an actuator that the plate file does not state, and the ripple of an unmatched source, as a
/// calibration measures them: at 60 frequencies of a scalar plate and 150 of one in bending, without a phase.
fn correction(plate: &Plate, random: &mut Random) -> ResponseCurve {
    let (low_hz, high_hz) = band_hz(plate);
    let count = if plate.spec().model.bending().is_some() { 150 } else { 60 };
    let resonance_hz = 0.5 * (low_hz + high_hz) * random.factor(0.5, 2.0);
    let resonator = Resonator { resonance_hz, quality: random.factor(0.7, 5.0), travel: None };
    let (ripple_db, periods, phase) =
        (random.within(0.3, 1.5), random.within(2.0, 6.0), random.within(0.0, TAU));
    let point = |i: usize| {
        let share = i as f64 / (count - 1) as f64;
        let hz = low_hz * (high_hz / low_hz).powf(share);
        let ripple = ripple_db * (TAU * periods * share + phase).cos();
        [hz, decibels(resonator.response(hz).norm()) + ripple, 0.0]
    };
    ResponseCurve { points: (0..count).map(point).collect() }
}

fn calibrated(plate: &Plate, correction: ResponseCurve) -> Plate {
    let calibration = Calibration {
        chi2_per_n: 1.0,
        half_width_tolerance: 0.003,
        taper_tolerance: 0.004,
        level_tolerance_db: Some(0.3),
        source_tolerance: None,
        correction: Some(correction),
    };
    Plate::new(PlateSpec { calibration: Some(calibration), ..plate.spec().clone() }).expect("a valid plate")
}

fn with_actuator(plate: &Plate, curve: ResponseCurve) -> Plate {
    let actuator = Some(Actuator::Measured(curve));
    Plate::new(PlateSpec { actuator, ..plate.spec().clone() }).expect("a valid plate")
}

/// The curve of an actuator with a resonance in the middle of the band, as an analyser measures it, and a curve of
/// few points.
fn actuators(plate: &Plate) -> [ResponseCurve; 2] {
    let (low_hz, high_hz) = plate.band_hz();
    let middle_hz = (low_hz * high_hz).sqrt();
    let resonator = Resonator { resonance_hz: middle_hz, quality: 8.0, travel: None };
    let point = |i: u32| {
        let hz = 0.5 * low_hz * (4.0 * high_hz / low_hz).powf(f64::from(i) / 200.0);
        let response = resonator.response(hz);
        [hz, decibels(response.norm()), -response.arg().to_degrees()]
    };
    let few = vec![[0.7 * low_hz, -3.0, -20.0], [middle_hz, 4.0, -80.0], [1.1 * high_hz, -1.0, -250.0]];
    [ResponseCurve { points: (0..=200).map(point).collect() }, ResponseCurve { points: few }]
}

/// Plates with drives of every kind.
fn driven(plate: &Plate, random: &mut Random) -> Vec<Plate> {
    let calibrations: Vec<ResponseCurve> = (0..2).map(|_| correction(plate, random)).collect();
    let mut plates: Vec<Plate> = calibrations.iter().map(|curve| calibrated(plate, curve.clone())).collect();
    plates.extend(actuators(plate).map(|curve| with_actuator(plate, curve)));
    let [resonant, _] = actuators(plate);
    plates.push(calibrated(&with_actuator(plate, resonant), calibrations[0].clone()));
    plates
}

fn frequencies_hz(plate: &Plate) -> impl Iterator<Item = f64> {
    let (low_hz, high_hz) = plate.band_hz();
    (0..FREQUENCIES).map(move |i| low_hz * (high_hz / low_hz).powf(f64::from(i) / f64::from(FREQUENCIES - 1)))
}

fn hold(hz: f64, rate_hz: f64) -> f64 {
    let turn = PI * hz / rate_hz;
    turn.sin() / turn
}

/// The field of the frequency domain per code of 1, metres.
fn exact_m(plate: &Plate, hz: f64, rate_hz: f64, points: usize) -> Vec<Complex64> {
    let drive = plate.drive_response(hz) * plate.spec().full_scale_m * hold(hz, rate_hz);
    let field = respond(plate, hz, points, Equation::Corrected).expect("in the band").amplitude;
    field.into_iter().map(|f| f * drive).collect()
}

/// The preset of `cargo test`; `.ci/run statistics` has the others.
const FIRST: &str = "membrane";

/// `al-bending` between clamped edges, held at its end; its time domain is a rational fit.
const CLAMPED: &str = "clamped";

fn nominal(name: &str) -> Plate {
    if name != CLAMPED {
        return preset(name).expect("a preset");
    }
    let spec = preset("al-bending").expect("a preset").spec().clone();
    let model = Model::BendingClamped(spec.model.bending().expect("bending").clone());
    let (span_start_m, span_end_m) = (0.12, 0.2);
    let spec = PlateSpec { model, drive_end: DriveEnd::Displacement, span_start_m, span_end_m, ..spec };
    Plate::new(spec).expect("a valid plate")
}

/// All presets but the first, and clamped edges.
fn others() -> Vec<&'static str> {
    let names = presets().iter().map(|entry| entry.name).filter(|name| *name != FIRST);
    names.chain([CLAMPED]).collect()
}

#[test]
fn a_settled_tone_on_a_line_has_the_whole_of_the_drive() {
    lines_have_the_drive(&[FIRST]);
}

#[test]
#[ignore = "the other presets: .ci/run statistics"]
fn a_settled_tone_on_a_line_has_the_whole_of_the_drive_on_every_preset() {
    lines_have_the_drive(&others());
}

fn lines_have_the_drive(names: &[&str]) {
    let mut random = Random::new(26);
    let (mut worst, mut left_out): (f64, f64) = (0.0, 0.0);
    for name in names {
        let nominal = nominal(name);
        let rate_hz = (nominal.band_hz().1 * 10.0).clamp(4e3, 400e3);
        for (number, plate) in driven(&nominal, &mut random).into_iter().enumerate() {
            let mut line = TimeDomainLine::new(&plate, rate_hz, 129).expect("a line");
            for hz in frequencies_hz(&plate) {
                line.rest();
                let (settle, measured) =
                    ((line.settle_time_s() * rate_hz) as usize, (20.0 * rate_hz / hz) as usize);
                let code = |n: usize| (TAU * (hz * n as f64 / rate_hz).fract()).cos() as f32;
                line.push(&(0..settle).map(code).collect::<Vec<f32>>());
                line.reset_envelope();
                line.push(&(settle..settle + measured).map(code).collect::<Vec<f32>>());
                let exact = exact_m(&plate, hz, rate_hz, 129);
                let top =
                    (0..129).max_by(|&a, &b| exact[a].norm().total_cmp(&exact[b].norm())).expect("some");
                let found = std::f64::consts::SQRT_2 * f64::from(line.envelope().rms_m()[top]);
                let error = decibels(found / exact[top].norm());
                let drive = decibels(plate.drive_response(hz).norm() / nominal.drive_response(hz).norm());
                (worst, left_out) = (worst.max(error.abs()), left_out.max(drive.abs()));
                assert!(error.abs() < DECIBELS, "{name} {number} {hz} Hz: {error} dB");
            }
        }
    }
    println!("line: {worst} dB at worst, {left_out} dB without the curves");
}

/// The settled field at place `at` of a line of 65 points, at rest, over a tone with the line's stated delay.
pub(crate) fn settled_phasor(line: &TimeDomainLine, hz: f64, rate_hz: f64, at: usize) -> Complex64 {
    let mut line = line.clone();
    let wait = (line.settle_time_s() * rate_hz) as usize;
    let code = |n: usize| (TAU * (hz * n as f64 / rate_hz).fract()).cos() as f32;
    line.push(&(0..wait).map(code).collect::<Vec<f32>>());
    // Continue to the next field.
    let (fields, mut n) = (line.envelope().samples(), wait);
    while line.envelope().samples() == fields {
        line.push(&[code(n)]);
        n += 1;
    }
    let mut field = vec![Complex64::ZERO; 65];
    line.analytic_m(&mut field);
    field[at] * Complex64::cis(TAU * (hz * (n as f64 / rate_hz - line.latency_s())).fract())
}

#[test]
fn a_line_has_the_phase_of_the_drive_but_for_its_latency() {
    let nominal = preset("al-bending").expect("a preset");
    let line = |plate: &Plate| TimeDomainLine::new(plate, 400e3, 65).expect("a line");
    let of_nominal = line(&nominal);
    for plate in actuators(&nominal).map(|curve| with_actuator(&nominal, curve)) {
        let of_plate = line(&plate);
        for hz in [21e3, 27e3, 38e3] {
            let [plain, found] = [&of_nominal, &of_plate].map(|line| settled_phasor(line, hz, 400e3, 20));
            let drive = plate.drive_response(hz) / nominal.drive_response(hz);
            let ratio = found / (plain * drive);
            assert!((ratio - 1.0).norm() < 5e-3, "{hz} Hz: {ratio}");
        }
    }
}

/// Root 2 times the RMS of a settled tone on the centre line, metres, and the rate of the steps.
fn settled_m(plate: &Plate, rate_hz: f64, period: usize) -> (Vec<f64>, f64) {
    let mut sheet = Sheet::new(plate, rate_hz, SheetGrid::new(64, 10)).expect("a sheet");
    let line = TimeDomainLine::new(plate, rate_hz, 16).expect("a line");
    let wait = (line.settle_time_s() * rate_hz) as usize / period * period;
    let code = |n: usize| (TAU * (n % period) as f64 / period as f64).cos() as f32;
    sheet.push(&(0..wait).map(code).collect::<Vec<f32>>());
    sheet.reset_envelope();
    sheet.push(&(0..20 * period).map(code).collect::<Vec<f32>>());
    let rms_m = sheet.envelope().rms_m;
    let amplitude = |rms_m: &f32| std::f64::consts::SQRT_2 * f64::from(*rms_m);
    (rms_m.iter().map(amplitude).collect(), sheet.step_rate_hz())
}

#[test]
#[ignore = "eight seconds of one core: .ci/run statistics; the model's simulation keeps a case"]
fn a_settled_tone_on_a_sheet_has_the_whole_of_the_drive_at_both_ends() {
    sheets_have_the_drive("al-sh", 5);
    sheets_have_the_drive(FIRST, 5);
}

#[test]
fn a_settled_tone_on_a_sheet_has_the_whole_of_the_drive() {
    sheets_have_the_drive("al-sh", 1);
}

/// The first `count` drives of every kind on a preset.
fn sheets_have_the_drive(name: &str, count: usize) {
    let mut random = Random::new(27);
    let mut worst: f64 = 0.0;
    let nominal = preset(name).expect("a preset");
    let (low_hz, high_hz) = nominal.band_hz();
    for (number, plate) in driven(&nominal, &mut random).into_iter().take(count).enumerate() {
        for (hz, period) in [(1.1 * low_hz, 40), (0.95 * high_hz, 40)] {
            let rate_hz = hz * period as f64;
            // The sheet's own response with its file without the curves.
            let (plain, step_hz) = settled_m(&nominal, rate_hz, period);
            let (found, _) = settled_m(&plate, rate_hz, period);
            // Without curves a step takes the mean of its codes, or a code is held for its steps.
            let droop = hold(hz, rate_hz.max(step_hz)) / hold(hz, rate_hz.min(step_hz)) * hold(hz, rate_hz);
            let top = (0..plain.len()).max_by(|&a, &b| plain[a].total_cmp(&plain[b])).expect("some");
            let drive = plate.drive_response(hz).norm() / nominal.drive_response(hz).norm();
            let error = decibels(found[top] / (plain[top] * drive * droop));
            worst = worst.max(error.abs());
            assert!(error.abs() < DECIBELS, "{name} {number} {hz} Hz: {error} dB");
        }
    }
    println!("sheet: {worst} dB at worst");
}

#[test]
fn a_sensors_answer_has_the_whole_of_the_drive() {
    answers_have_the_drive(&[FIRST]);
}

#[test]
#[ignore = "the other presets: .ci/run statistics"]
fn a_sensors_answer_has_the_whole_of_the_drive_on_every_preset() {
    answers_have_the_drive(&others());
}

fn answers_have_the_drive(names: &[&str]) {
    let mut random = Random::new(28);
    let mut worst: f64 = 0.0;
    for name in names {
        let nominal = nominal(name);
        for (number, plate) in driven(&nominal, &mut random).into_iter().enumerate() {
            let what = format!("{name} {number}");
            let sensed = SensedPlate::new(&plate, None, 400e3).expect("a plate in time");
            let place_m = 0.3 * plate.length_m();
            let output = sensed
                .sensor(SensorKind::Displacement, place_m, 0.0)
                .unwrap_or_else(|error| panic!("{what}: {error}"));
            sensed.with_drive_point(|_, velocity| velocity).unwrap_or_else(|error| panic!("{what}: {error}"));
            let mut fields: Vec<(f64, f64)> = Vec::new();
            for hz in frequencies_hz(&plate) {
                let exact = exact_m(&plate, hz, 400e3, 2001)[600].norm();
                fields.push((sensed.steady(&output, hz).norm(), exact));
            }
            let floor = 1e-5 * fields.iter().map(|it| it.1).fold(0.0, f64::max);
            for (found, exact) in fields {
                let error = decibels(found / exact);
                if exact > floor {
                    worst = worst.max(error.abs());
                    assert!(error.abs() < DECIBELS, "{what}: {error} dB");
                }
            }
        }
    }
    println!("sensor: {worst} dB at worst");
}

#[test]
fn a_calibration_with_noise_has_a_line_and_an_answer_near_its_curve() {
    let mut random = Random::new(29);
    for name in ["membrane", "al-bending"] {
        let nominal = preset(name).expect("a preset");
        let mut noisy = correction(&nominal, &mut random);
        noisy.points.iter_mut().for_each(|point| point[1] += 0.1 * random.normal());
        let plate = calibrated(&nominal, noisy);
        TimeDomainLine::new(&plate, 400e3, 65).expect("a line");
        let sensed = SensedPlate::new(&plate, None, 400e3).expect("a plate in time");
        let output = sensed.sensor(SensorKind::Displacement, 0.3 * plate.length_m(), 0.0).expect("an answer");
        assert!(output.error() < 0.03, "{name}: {}", output.error());
    }
}

/// The correction of a plate whose source reflects the share `reflected` of what returns: a comb of resonances.
fn comb(plate: &Plate, reflected: f64, resonances: f64) -> ResponseCurve {
    let (low_hz, high_hz) = band_hz(plate);
    let point = |i: usize| {
        let share = i as f64 / 149.0;
        let turn = Complex64::cis(TAU * resonances * share);
        [low_hz * (high_hz / low_hz).powf(share), -decibels((1.0 - reflected * turn).norm()), 0.0]
    };
    ResponseCurve { points: (0..150).map(point).collect() }
}

#[test]
fn calibrations_of_resonant_plates_have_a_time_domain() {
    let file = include_str!("clamped_calibrated.toml");
    let clamped = Plate::from_toml(file).expect("a plate of glass, calibrated");
    let bending = preset("al-bending").expect("a preset");
    let held = nominal(CLAMPED);
    for (name, plate, most_db) in [
        ("glass", clamped, 0.3),
        ("al-bending", calibrated(&bending, comb(&bending, 0.3, 20.0)), 0.3),
        ("clamped", calibrated(&held, comb(&held, 0.3, 18.0)), 0.3),
    ] {
        let mut line =
            TimeDomainLine::new(&plate, 400e3, 129).unwrap_or_else(|error| panic!("{name}: {error}"));
        println!("{name}: settles in {} s, late by {} s", line.settle_time_s(), line.latency_s());
        for hz in frequencies_hz(&plate).skip(1).step_by(2) {
            line.rest();
            let (settle, measured) = ((line.settle_time_s() * 400e3) as usize, (20.0 * 400e3 / hz) as usize);
            let code = |n: usize| (TAU * (hz * n as f64 / 400e3).fract()).cos() as f32;
            line.push(&(0..settle).map(code).collect::<Vec<f32>>());
            line.reset_envelope();
            line.push(&(settle..settle + measured).map(code).collect::<Vec<f32>>());
            let exact = exact_m(&plate, hz, 400e3, 129);
            let top = (0..129).max_by(|&a, &b| exact[a].norm().total_cmp(&exact[b].norm())).expect("some");
            let found = std::f64::consts::SQRT_2 * f64::from(line.envelope().rms_m()[top]);
            let error = decibels(found / exact[top].norm());
            println!("{name} {hz} Hz: {error} dB");
            assert!(error.abs() < most_db, "{name} {hz} Hz: {error} dB");
        }
    }
}

#[test]
fn a_curve_that_no_filter_has_is_refused_by_its_field() {
    let nominal = preset("membrane").expect("a preset");
    // 20 dB up and down within 0.03 Hz.
    let zigzag = |i: u32| [80.0 + 0.015 * f64::from(i), if i.is_multiple_of(2) { 10.0 } else { -10.0 }, 0.0];
    let points = ResponseCurve { points: (0..10_000).map(zigzag).collect() };
    for (plate, field) in [
        (with_actuator(&nominal, points.clone()), "actuator.points"),
        (calibrated(&nominal, points), "calibration.points"),
    ] {
        let refused = TimeDomainLine::new(&plate, 400e3, 65).err().expect("refused");
        assert!(matches!(&refused, LineError::Drive(error) if error.field == field), "{refused}");
        assert!(refused.to_string().starts_with(field), "{refused}");
        let refused = Sheet::new(&plate, 400e3, SheetGrid::new(64, 10)).expect_err("refused");
        assert!(matches!(&refused, SheetError::Drive(error) if error.field == field), "{refused}");
    }
}

#[test]
fn a_sheet_with_a_curve_is_refused_a_rate_that_does_not_carry_the_band() {
    let nominal = preset("al-sh").expect("a preset");
    let plate = calibrated(&nominal, correction(&nominal, &mut Random::new(1)));
    let new = |plate: &Plate| Sheet::new(plate, 80e3, SheetGrid::new(64, 10));
    assert!(new(&nominal).is_ok(), "without a curve it goes");
    let refused = new(&plate).expect_err("refused");
    assert!(matches!(refused, SheetError::SampleRate(_)), "{refused}");
}
