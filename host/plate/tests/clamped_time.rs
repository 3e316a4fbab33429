//! Plates between clamped edges in the time domain against `respond`: a settled tone on a line at its peak, and the
//! responses of a sensor, with every kind of driven end.

use crate::drive_curve::settled_phasor;
use slipline_plate::calibrate::SensorKind;
use slipline_plate::truth::Random;
use slipline_plate::{
    Bending, Complex64, DriveEnd, EndSlope, Equation, Impedance, LeadIn, Model, Plate, PlateSpec,
    SensedPlate, Source, Taper, TimeDomainLine, preset, quantity::decibels, respond,
};
use std::f64::consts::{PI, SQRT_2, TAU};

const PLATES: u64 = 20;
/// Boundaries over the span, with both ends.
const BOUNDARIES: u32 = 6;
const POINTS: usize = 257;
/// Largest errors: of the peak's height and place, and of a response.
const PEAK_DB: f64 = 0.1;
const PLACE_M: f64 = 1e-4;
const ANSWER_DB: f64 = 0.4;
/// A peak below this fraction of the largest amplitude has no definite place, because of damping.
const FAINT: f64 = 0.2;
/// Responses below this fraction of the largest one at their place are not compared.
const SILENT: f64 = 1e-4;

/// The kinds of driven ends.
const ENDS: [&str; 6] = ["displacement", "slope", "force", "resistance", "source", "lead-in"];

/// Aluminium or glass of 0.5 to 4 mm with |W'| from 0.05 to 0.3 at the drive.
fn bare(number: u64) -> Plate {
    let mut random = Random::new(1000 + number);
    let bending = Bending {
        youngs_modulus_pa: 70e9,
        poisson_ratio: random.within(0.2, 0.4),
        density_kg_per_m3: 2600.0,
        thickness_m: random.factor(5e-4, 4e-3),
        thick_plate: number % 3 == 2,
    };
    let (rate_per_m, exponents) = (random.within(3.0, 7.0), random.within(1.0, 1.6));
    let half_width_m = random.factor(0.05, 0.3) / rate_per_m;
    let length_m = exponents / rate_per_m;
    let taper = match number % 4 {
        0 | 1 => Taper::Exponential { half_width_m, rate_per_m },
        2 => Taper::Linear { half_width_m, end_half_width_m: half_width_m * (-exponents).exp() },
        _ => {
            let bend = random.within(-0.4, 0.4);
            let width = |part: f64| half_width_m * (-exponents * (part + bend * part * (1.0 - part))).exp();
            let parts = (0..=40).map(|i| f64::from(i) / 40.0);
            Taper::Sampled { points: parts.map(|part| [part * length_m, width(part)]).collect() }
        }
    };
    Plate::new(PlateSpec {
        name: format!("clamped {number}"),
        taper,
        length_m,
        model: Model::BendingClamped(bending),
        loss_factor: random.factor(0.002, 0.1),
        drive_end: DriveEnd::Displacement,
        actuator: None,
        harmonics: None,
        wave_speed_tolerance: 0.0,
        span_start_m: random.within(0.15, 0.5) * length_m,
        span_end_m: random.within(0.7, 0.95) * length_m,
        ..preset("al-bending").expect("a preset").spec().clone()
    })
    .expect("a valid plate")
}

fn with_end(plate: &Plate, end: &str) -> Plate {
    let mut random = Random::new(end.len() as u64);
    let at_frequency_hz = plate.frequency_for_boundary_hz(0.6 * plate.length_m());
    let impedance = plate.wave_impedance_n_s_per_m(at_frequency_hz).expect("enters");
    let soft = Source::soft(&plate.spec().model, at_frequency_hz);
    let drive_end = match end {
        "displacement" => DriveEnd::Displacement,
        "slope" => DriveEnd::DisplacementAndSlope { slope: EndSlope::Held },
        "force" => DriveEnd::Force { at_frequency_hz },
        "resistance" => DriveEnd::Resistance { ratio: random.factor(0.5, 2.0), at_frequency_hz },
        "source" => DriveEnd::Source(Source {
            impedance: Impedance {
                resistance_n_s_per_m: random.factor(0.2, 1.4) * impedance,
                mass_kg: random.within(0.0, 0.6) * impedance / (TAU * at_frequency_hz),
                stiffness_n_per_m: random.within(0.0, 0.6) * impedance * TAU * at_frequency_hz,
            },
            ..soft
        }),
        _ => DriveEnd::Source(Source {
            lead_in: Some(LeadIn {
                length_m: random.within(3.0, 6.0) * plate.half_width_m(0.0),
                loss_factor: random.within(0.2, 0.4),
                end_resistance_n_s_per_m: 0.37 * impedance,
            }),
            ..soft
        }),
    };
    Plate::new(PlateSpec { drive_end, ..plate.spec().clone() }).expect("a valid plate")
}

fn frequencies_hz(plate: &Plate) -> impl Iterator<Item = f64> {
    let (start_m, end_m) = plate.span_m();
    (0..BOUNDARIES)
        .map(move |i| start_m + (end_m - start_m) * f64::from(i) / f64::from(BOUNDARIES - 1))
        .map(|x| plate.frequency_for_boundary_hz(x))
}

fn hold(hz: f64, rate_hz: f64) -> f64 {
    let turn = PI * hz / rate_hz;
    turn.sin() / turn
}

/// Largest errors of a plate in time.
#[derive(Debug, Clone, Copy, Default)]
struct Errors {
    /// Error of the peak on a line, or of the largest amplitude where there is no peak, dB.
    peak_db: f64,
    /// Error of the peak's place, metres.
    place_m: f64,
    /// Error of a sensor's response at two places, dB.
    answer_db: f64,
}

impl Errors {
    fn worst(self, other: Self) -> Self {
        Self {
            peak_db: self.peak_db.max(other.peak_db),
            place_m: self.place_m.max(other.place_m),
            answer_db: self.answer_db.max(other.answer_db),
        }
    }

    fn assert_small(self, what: &str) {
        let Self { peak_db, place_m, answer_db } = self;
        println!(
            "{what}: {peak_db:.3} dB and {:.3} mm on a line, {answer_db:.3} dB in an answer",
            1e3 * place_m
        );
        assert!(peak_db < PEAK_DB && place_m < PLACE_M && answer_db < ANSWER_DB, "{what}: {self:?}");
    }
}

/// Settles a tone of full scale; afterwards the line's envelope is that of the settled tone.
fn settle(line: &mut TimeDomainLine, hz: f64, rate_hz: f64) {
    let (wait, measured) = ((line.settle_time_s() * rate_hz) as usize, (20.0 * rate_hz / hz) as usize);
    let code = |n: usize| (TAU * (hz * n as f64 / rate_hz).fract()).cos() as f32;
    line.rest();
    line.push(&(0..wait).map(code).collect::<Vec<f32>>());
    line.reset_envelope();
    line.push(&(wait..wait + measured).map(code).collect::<Vec<f32>>());
}

/// Errors of settled tones on a line.
fn of_a_line(plate: &Plate) -> Errors {
    let rate_hz = 10.0 * plate.band_hz().1;
    let mut line = TimeDomainLine::new(plate, rate_hz, POINTS).expect("a line");
    let mut errors = Errors::default();
    for hz in frequencies_hz(plate) {
        let exact = respond(plate, hz, POINTS, Equation::Corrected).expect("enters");
        settle(&mut line, hz, rate_hz);
        let level = plate.spec().full_scale_m * hold(hz, rate_hz);
        let amplitude = |i: &usize| exact.amplitude[*i].norm();
        let top = (0..POINTS).max_by(|a, b| amplitude(a).total_cmp(&amplitude(b))).expect("some");
        let (found, wanted) = match (line.envelope().peak(plate, hz), exact.peak) {
            (Some(found), Some(wanted)) => {
                if wanted.amplitude > FAINT * amplitude(&top) {
                    errors.place_m = errors.place_m.max((found.position_m - wanted.position_m).abs());
                }
                (found.amplitude, wanted.amplitude)
            }
            _ => (SQRT_2 * f64::from(line.envelope().rms_m()[top]), amplitude(&top)),
        };
        errors.peak_db = errors.peak_db.max(decibels(found / (level * wanted)).abs());
    }
    errors
}

/// Errors of the responses of a sensor.
fn of_a_sensor(plate: &Plate) -> Errors {
    let rate_hz = 12.0 * plate.band_hz().1;
    let sensed = SensedPlate::new(plate, None, rate_hz).expect("a plate in time");
    let mut errors = Errors::default();
    for share in [0.15, 0.5] {
        let sensor = sensed.sensor(SensorKind::Displacement, share * plate.length_m(), 0.0);
        let sensor = sensor.unwrap_or_else(|error| panic!("{}: {error}", plate.name()));
        let mut answers: Vec<(f64, f64)> = Vec::new();
        for hz in frequencies_hz(plate) {
            let exact = respond(plate, hz, 2001, Equation::Corrected).expect("enters").amplitude;
            let exact =
                exact[(2000.0 * share) as usize].norm() * plate.spec().full_scale_m * hold(hz, rate_hz);
            answers.push((sensed.steady(&sensor, hz).norm(), exact));
        }
        // Far beyond the turning point there is no response.
        let floor = SILENT * answers.iter().map(|it| it.1).fold(0.0, f64::max);
        for (found, exact) in answers.into_iter().filter(|it| it.1 > floor) {
            errors.answer_db = errors.answer_db.max(decibels(found / exact).abs());
        }
    }
    errors
}

fn both(number: u64, end: &str) -> Errors {
    let plate = with_end(&bare(number), end);
    let errors = of_a_line(&plate).worst(of_a_sensor(&plate));
    errors.assert_small(&format!("plate {number}, {end}"));
    errors
}

#[test]
fn a_clamped_plate_in_time_matches_the_frequency_domain() {
    both(4, "displacement");
    both(4, "lead-in");
}

fn of_plates(numbers: std::ops::Range<u64>) {
    let cases = numbers.flat_map(|number| ENDS.map(|end| (number, end)));
    let worst = cases.map(|(number, end)| both(number, end)).reduce(Errors::worst);
    worst.expect("some").assert_small("all");
}

#[test]
#[ignore = "three plates of every end: .ci/run statistics"]
fn three_clamped_plates_in_time_match_the_frequency_domain() {
    of_plates(0..3);
}

mod night {
    #[test]
    #[ignore = "twenty plates of every end, minutes of one core: .ci/run statistics"]
    fn twenty_clamped_plates_in_time_match_the_frequency_domain() {
        super::of_plates(0..super::PLATES);
    }
}

/// The settled field at place `at` of 65 over the tone with the line's stated delay, per code, and that of `respond`.
fn phasors(plate: &Plate, hz: f64, at: usize) -> [Complex64; 2] {
    const RATE_HZ: f64 = 400e3;
    let line = TimeDomainLine::new(plate, RATE_HZ, 65).expect("a line");
    let found = settled_phasor(&line, hz, RATE_HZ, at);
    let exact = respond(plate, hz, 65, Equation::Corrected).expect("enters").amplitude[at];
    [found, exact * plate.spec().full_scale_m * hold(hz, RATE_HZ)]
}

#[test]
fn a_clamped_line_is_as_late_as_it_says() {
    let spec = preset("al-bending-displacement").expect("a preset").spec().clone();
    let model = Model::BendingClamped(spec.model.bending().expect("bending").clone());
    let (span_start_m, span_end_m, loss_factor) = (0.12, 0.18, 0.02);
    let plate =
        Plate::new(PlateSpec { model, span_start_m, span_end_m, loss_factor, ..spec }).expect("valid");
    // The phase over that of `respond` at two frequencies gives the remaining delay, which is below the drive's
    // filter steps.
    let (hz, apart_hz) = (24e3, 400.0);
    let [here, there] = [hz, hz + apart_hz].map(|hz| {
        let [found, exact] = phasors(&plate, hz, 11);
        found / exact
    });
    let left_s = (there / here).arg() / (TAU * apart_hz);
    assert!(left_s.abs() < 2e-5, "{left_s} s");
    assert!((here.norm() - 1.0).abs() < 1e-2, "{here}");
}
