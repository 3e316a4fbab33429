//! Calibration by the current of the drive alone, without a sensor on the plate.

use super::misuse::good_or_refused;
use super::rig::{Random, Rig, Solver, middle_and_worst};
use super::{MANY, count};
use slipline_plate::calibrate::{CalibrateError, Calibrated, Measurement, Priors, Transducer, from_shunt};
use slipline_plate::{Complex64, DriveEnd, Finger, Plate};
use std::f64::consts::{PI, TAU};

/// A rig whose truth is driven by a voltage: the electrical side is part of the end's impedance, and the actuator is
/// the amplifier.
pub(crate) fn rig(name: &str, seed: u64) -> (Rig, Electrics, Random) {
    let mut random = Random::new(seed);
    let rig = Rig::new(name, Solver::OneMode, &mut random);
    let electrics = Electrics {
        transducer: if name == "membrane" { Transducer::Coil } else { Transducer::Piezo },
        share: random.within(0.4, 0.9),
        coupling: random.factor(0.1, 0.5),
    };
    (rig, electrics, random)
}

/// Unknowns of the drive.
pub(crate) struct Electrics {
    transducer: Transducer,
    /// Coil: the electrical fraction of the source's resistance, (Bl)^2/Re.
    share: f64,
    /// Piezo: motional over capacitive current with the plate's wave impedance as the load.
    coupling: f64,
}

/// The measured current over the code.
pub(crate) fn current(rig: &Rig, electrics: &Electrics, random: &mut Random) -> Measurement {
    let frequencies_hz = rig.frequencies_hz(count(rig.nominal.name()));
    let DriveEnd::Source(source) = rig.truth.spec().drive_end else { panic!("a source") };
    let z = rig.truth.wave_impedance_n_s_per_m(source.at_frequency_hz).expect("stated");
    let force = 2.0 * TAU * source.at_frequency_hz * z;
    let clean = |(field, &hz): (Vec<Complex64>, &f64)| {
        let rate = Complex64::new(0.0, -TAU * hz);
        // The velocity per force: 1/(Zs + Zp).
        let mobility = rate * field[0] / force;
        let current = match electrics.transducer {
            Transducer::Coil => 1.0 - electrics.share * source.impedance.resistance_n_s_per_m * mobility,
            Transducer::Piezo => rate / (TAU * source.at_frequency_hz) + electrics.coupling * z * mobility,
        };
        let turn = PI * hz / 400e3;
        current * rig.truth.drive_response(hz) * (turn.sin() / turn) * rig.gain
    };
    let clean: Vec<Complex64> =
        rig.fields(&frequencies_hz).into_iter().zip(&frequencies_hz).map(clean).collect();
    rig.sampled(0.0, &frequencies_hz, &clean, random)
}

pub(crate) fn calibrated(
    rig: &Rig,
    electrics: &Electrics,
    current: &Measurement,
) -> Result<Calibrated, CalibrateError> {
    from_shunt(&rig.nominal, current, electrics.transducer, &Priors::default())
}

#[test]
fn the_current_alone_puts_a_first_plate_right() {
    by_current([2, 1]);
}

#[test]
#[ignore = "many plates: .ci/run statistics"]
fn the_current_alone_puts_boundary_and_level_right_or_says_that_two_plates_fit() {
    by_current([20, 10]);
}

/// Calibrates this many truths of each preset.
fn by_current([membranes, plates]: [u64; 2]) {
    for (name, number, boundary_mm, level_db) in
        [("membrane", membranes, [0.7, 1.4], [0.3, 0.8]), ("al-bending", plates, [0.5, 1.2], [0.4, 1.2])]
    {
        let mut judged = Vec::new();
        for seed in 0..number {
            let (rig, electrics, mut random) = rig(name, seed);
            let measured = current(&rig, &electrics, &mut random);
            let found = match calibrated(&rig, &electrics, &measured) {
                Ok(found) => found,
                Err(CalibrateError::Ambiguous { .. }) => continue,
                Err(error) => panic!("{name} {seed}: {error}"),
            };
            let plate = Plate::from_toml(&found.plate.to_toml()).expect("an ordinary plate file");
            let after = rig.judge(&plate);
            assert!(after.boundary_m < 1.5 * found.boundary_tolerance_m, "{name} {seed}: {after:?}");
            assert!(after.level_db < 1.5 * found.level_tolerance_db.max(0.3), "{name} {seed}: {after:?}");
            judged.push(after);
        }
        let boundary = middle_and_worst(judged.iter().map(|it| 1e3 * it.boundary_m).collect());
        let level = middle_and_worst(judged.iter().map(|it| it.level_db).collect());
        println!("{name}: {} accepted, {boundary:?} mm, {level:?} dB", judged.len());
        assert!(judged.len() as u64 * 10 >= number * 9, "{name}: {}", judged.len());
        assert!(boundary.1 <= boundary_mm[1] && level.1 <= level_db[1], "{name}: {boundary:?} {level:?}");
        if number >= MANY {
            assert!(boundary.0 <= boundary_mm[0] && level.0 <= level_db[0], "{name}: {boundary:?} {level:?}");
        }
    }
}

#[test]
fn mistakes_with_the_current_are_refused_or_reported() {
    misuse(&["membrane"]);
}

#[test]
#[ignore = "a second pass, on another preset: .ci/run statistics"]
fn mistakes_with_the_current_are_refused_or_reported_on_aluminium_too() {
    misuse(&["al-bending"]);
}

fn misuse(presets: &[&str]) {
    for &name in presets {
        let (rig, electrics, mut random) = rig(name, 1);
        let measured = current(&rig, &electrics, &mut random);
        let refusal = |rig: &Rig, measured: &Measurement, what: &str| {
            good_or_refused(rig, calibrated(rig, &electrics, measured), &[], &format!("{name} {what}"))
        };
        assert_eq!(refusal(&rig, &measured, "as it should be"), None);
        let mut open = measured.clone();
        for point in &mut open.points {
            point.response = Complex64::new(random.normal(), random.normal()) * point.noise;
        }
        let error = calibrated(&rig, &electrics, &open).expect_err("open");
        assert!(matches!(error, CalibrateError::NoSignal { .. }), "{error}");
        let mut clipped = measured.clone();
        clipped.points[5].headroom_db = Some(0.0);
        let error = calibrated(&rig, &electrics, &clipped).expect_err("clipped");
        assert!(matches!(error, CalibrateError::Clipped { .. }), "{error}");
        // A blocked drive: its current carries no information on the plate.
        let mut blocked = measured.clone();
        for point in &mut blocked.points {
            let rate = match electrics.transducer {
                Transducer::Coil => Complex64::ONE,
                Transducer::Piezo => Complex64::new(0.0, -point.frequency_hz / 2e4),
            };
            let noise = Complex64::new(random.normal(), random.normal()) * 1e-3;
            (point.response, point.noise) = (rate + noise, 1e-3);
        }
        let error = calibrated(&rig, &electrics, &blocked).expect_err("blocked");
        let is_refused =
            matches!(error, CalibrateError::NotCarriedByCurrent { .. } | CalibrateError::Ambiguous { .. });
        assert!(is_refused, "{name}, blocked: {error}");
        let another = Rig { nominal: rig.nominal.with_wave_speed(1.2).expect("valid"), ..rig.clone() };
        let error = calibrated(&another, &electrics, &measured).expect_err("another plate");
        assert!(matches!(error, CalibrateError::AnotherPlate { .. }), "{name}, another plate: {error}");
        let firm = Finger { resistance_n_s_per_m: 1.0, mass_kg: 1e-4, ..Finger::light(0.12) };
        let touched = Rig { finger: Some(firm), ..rig.clone() };
        let under_finger = current(&touched, &electrics, &mut random);
        let error = refusal(&touched, &under_finger, "finger");
        assert!(error.is_some() || name == "al-bending", "a finger goes unnoticed on {name}");
    }
}
