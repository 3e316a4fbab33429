//! A finger on the plate, against the two-dimensional solver and against conservation laws.

use slipline_plate::{
    Complex64, DriveEnd, EndSlope, Equation, Finger, LeadIn, Model, Plate, PlateSpec, RespondError, Response,
    Source, plane, preset, quantity::decibels, respond, respond_touched,
};

const POINTS: usize = 1601;

/// The default membrane with another tension, and so with another wave impedance.
fn membrane(tension_n_per_m: f64) -> Plate {
    let mut spec: PlateSpec = preset("membrane").unwrap().spec().clone();
    let Model::Membrane { wave_speed_m_per_s, .. } = spec.model else { panic!("a membrane") };
    spec.model = Model::Membrane { wave_speed_m_per_s, tension_n_per_m: Some(tension_n_per_m), film: None };
    Plate::new(spec).unwrap()
}

/// Aluminium in bending with a soft force and a damped lead-in.
fn led_in() -> Plate {
    let mut spec: PlateSpec = preset("al-bending").unwrap().spec().clone();
    spec.drive_end = DriveEnd::Source(Source {
        slope: Some(EndSlope::Free),
        lead_in: Some(LeadIn { length_m: 0.06, loss_factor: 0.2, end_resistance_n_s_per_m: 55.0 }),
        ..Source::soft(&spec.model, 28e3)
    });
    Plate::new(spec).unwrap()
}

/// The field with a finger: the largest mean amplitude over a fingertip anywhere, the mean at the finger's own place,
/// and the place of the edge, the last one with a quarter of the largest.
#[derive(Debug)]
struct Felt {
    largest: f64,
    under: f64,
    edge_m: f64,
}

impl Felt {
    fn of(response: &Response, finger_m: f64) -> Self {
        let step_m = response.position_m[1];
        let half = (0.005 / step_m).round() as usize;
        let level: Vec<f64> = response.amplitude.iter().map(|f| f.norm()).collect();
        let mean = |at: usize| {
            let around = &level[at.saturating_sub(half)..(at + half + 1).min(level.len())];
            around.iter().sum::<f64>() / around.len() as f64
        };
        let largest = (half..level.len()).map(mean).fold(0.0, f64::max);
        let edge = (0..level.len()).rev().find(|&at| level[at] >= 0.25 * largest).unwrap();
        Self { largest, under: mean((finger_m / step_m).round() as usize), edge_m: edge as f64 * step_m }
    }
}

/// The place of the peak without a finger.
fn peak_m(plate: &Plate, frequency_hz: f64) -> f64 {
    respond(plate, frequency_hz, POINTS, Equation::Corrected).unwrap().peak.unwrap().position_m
}

fn in_both(plate: &Plate, finger: &Finger, frequency_hz: f64) -> (Felt, Felt) {
    let line = respond_touched(plate, Some(finger), frequency_hz, POINTS, Equation::Corrected).unwrap();
    let setup = plane::Setup { finger: Some(*finger), ..plane::Setup::of(plate) };
    let sheet = plane::respond(plate, frequency_hz, POINTS, &setup).unwrap();
    (Felt::of(&line, finger.place_m), Felt::of(&sheet, finger.place_m))
}

#[test]
fn a_finger_at_the_peak_damps_the_line_as_it_damps_the_plate_in_two_dimensions() {
    let bending = led_in();
    for (plate, frequency_hz, fingers) in [
        (
            membrane(40.0),
            membrane(40.0).frequency_for_boundary_hz(0.16),
            [(0.1, 1e-5), (1.0, 1e-4), (2.0, 1e-3)].as_slice(),
        ),
        (membrane(400.0), membrane(400.0).frequency_for_boundary_hz(0.16), &[(1.0, 1e-4)]),
        (bending, 28e3, &[(1.0, 0.0), (1.0, 1e-3)]),
    ] {
        for &(resistance_n_s_per_m, mass_kg) in fingers {
            let place_m = peak_m(&plate, frequency_hz);
            let finger = Finger { resistance_n_s_per_m, mass_kg, ..Finger::light(place_m) };
            let (line, sheet) = in_both(&plate, &finger, frequency_hz);
            let case =
                format!("{}, {resistance_n_s_per_m} N s/m, {mass_kg} kg: {line:?}, {sheet:?}", plate.name());
            assert!(decibels(line.largest / sheet.largest).abs() < 0.1, "{case}");
            assert!(decibels(line.under / sheet.under).abs() < 1.0, "{case}");
            assert!((line.edge_m - sheet.edge_m).abs() < 2e-3, "{case}");
        }
    }
}

#[test]
fn a_finger_that_weighs_nothing_changes_nothing_and_a_light_one_changes_in_proportion() {
    let plate = membrane(40.0);
    let frequency_hz = plate.frequency_for_boundary_hz(0.2);
    let free = respond(&plate, frequency_hz, POINTS, Equation::Corrected).unwrap();
    let change = |resistance_n_s_per_m: f64| -> Vec<Complex64> {
        let finger = Finger { resistance_n_s_per_m, mass_kg: 0.0, ..Finger::light(0.1) };
        let touched =
            respond_touched(&plate, Some(&finger), frequency_hz, POINTS, Equation::Corrected).unwrap();
        touched.amplitude.iter().zip(&free.amplitude).map(|(a, b)| a - b).collect()
    };
    assert!(change(0.0).iter().all(|change| change.norm() < 1e-12));
    for (one, two) in change(1e-6).iter().zip(&change(2e-6)) {
        assert!((two - 2.0 * one).norm() < 1e-4 * one.norm() + 1e-12);
    }
}

#[test]
fn the_drives_power_equals_that_of_damper_plate_and_finger() {
    // Without loss in the plate, the power of the source is dissipated in its own resistance and in the finger.
    let mut spec = membrane(40.0).spec().clone();
    spec.loss_factor = 0.0;
    let plate = Plate::new(spec).unwrap();
    let DriveEnd::Resistance { ratio, at_frequency_hz } = plate.spec().drive_end else { panic!("a damper") };
    let resistance = ratio * plate.wave_impedance_n_s_per_m(at_frequency_hz).unwrap();
    let frequency_hz = plate.frequency_for_boundary_hz(0.18);
    let omega = std::f64::consts::TAU * frequency_hz;
    for place_m in [0.03, 0.1, 0.15] {
        let finger = Finger { mass_kg: 2e-5, ..Finger::light(place_m) };
        let touched =
            respond_touched(&plate, Some(&finger), frequency_hz, 3201, Equation::Corrected).unwrap();
        // The far side of the damper moves by 2: its force on the plate is R (2 - f(0)) (-j omega).
        let end = touched.amplitude[0];
        let force = Complex64::new(0.0, -omega) * resistance * (Complex64::from(2.0) - end);
        let into_plate = 0.5 * (force * (Complex64::new(0.0, -omega) * end).conj()).re;
        // The mean motion under the finger from the first width mode alone; accurate to a few per cent.
        let step_m = touched.position_m[1];
        let under: Vec<usize> = (0..3201).filter(|&i| (i as f64 * step_m - place_m).abs() <= 0.005).collect();
        let across = |x: f64| {
            let q = std::f64::consts::FRAC_PI_2 / plate.half_width_m(x);
            (q * 0.005).sin() / (q * 0.005)
        };
        let mean: Complex64 =
            under.iter().map(|&i| touched.amplitude[i] * across(i as f64 * step_m)).sum::<Complex64>()
                / under.len() as f64;
        let into_finger = 0.5 * finger.resistance_n_s_per_m * (omega * mean.norm()).powi(2);
        assert!(
            (into_plate / into_finger - 1.0).abs() < 0.05,
            "{place_m}: {into_plate} W in, {into_finger} W taken"
        );
    }
}

#[test]
fn a_finger_off_the_plate_or_on_a_plate_of_unknown_weight_is_refused() {
    let plate = membrane(40.0);
    let refused = |plate: &Plate, finger: Finger| {
        respond_touched(plate, Some(&finger), 150.0, 257, Equation::Corrected)
            .expect_err("refused")
            .to_string()
    };
    assert!(refused(&plate, Finger::light(0.4)).starts_with("finger place = 0.4 m: must be 0 to 0.32 m"));
    assert!(refused(&plate, Finger { contact_m: 0.0, ..Finger::light(0.1) }).contains("finger contact"));
    assert!(refused(&plate, Finger { mass_kg: f64::NAN, ..Finger::light(0.1) }).contains("finger mass"));
    let mut spec = plate.spec().clone();
    spec.model = Model::Membrane { wave_speed_m_per_s: 12.0, tension_n_per_m: None, film: None };
    let unknown = Plate::new(spec).unwrap();
    let error = refused(&unknown, Finger::light(0.1));
    assert!(error.contains("model.tension_n_per_m") && error.contains("a finger needs it"), "{error}");
    assert!(matches!(Finger::light(0.1).load(&unknown, 150.0), Err(RespondError::Unstated(_))));
}
