//! The check of the drive: coils and piezos of known parameters on plates below their cut-off, where the plate is a
//! spring.

use super::rig::{Random, Rig, Solver};
use slipline_plate::calibrate::{
    DriveCheck, DriveCircuit, DriveLoad, MeasuredPoint, Measurement, SensorKind, check_drive, drive_check_hz,
};
use slipline_plate::{Complex64, DriveEnd, Plate};
use std::f64::consts::TAU;

const VOLT: f64 = 2.0;

/// The current of a drive of this resistance (coil) or capacitance (piezo) on `truth`, ampere per code, with 0.02 mA
/// of noise. The end is held by its source and by a plate that is stiffer than its tension times half of pi.
fn current(nominal: &Plate, truth: &Plate, load: DriveLoad, random: &mut Random) -> Measurement {
    let DriveEnd::Source(source) = truth.spec().drive_end else { panic!("a source") };
    let at_hz = source.at_frequency_hz;
    let z = truth.wave_impedance_n_s_per_m(at_hz).expect("stated");
    let noise = 2e-5;
    let points = drive_check_hz(nominal, &load).into_iter().map(|hz| {
        // Far below the cut-off a plate is a spring, with about the stiffness omega Z at the cut-off.
        let spring = Complex64::new(0.0, z * truth.cut_off_hz() / hz);
        let motion = (source.impedance.at_n_s_per_m(hz) + spring).inv();
        let clean = match load {
            DriveLoad::Coil { resistance_ohm } => {
                let damping = 0.7 * source.impedance.resistance_n_s_per_m;
                VOLT / resistance_ohm * (1.0 - damping * motion)
            }
            DriveLoad::Piezo { capacitance_f } => {
                let rate = Complex64::new(0.0, -TAU * hz);
                VOLT * capacitance_f * (rate + 0.03 * TAU * at_hz * z * motion)
            }
        };
        let response = clean + Complex64::new(random.normal(), random.normal()) * noise;
        MeasuredPoint { frequency_hz: hz, response, noise, headroom_db: Some(20.0) }
    });
    Measurement::at(0.0, SensorKind::Displacement, points.collect())
}

#[test]
fn open_short_no_amplifier_and_wrong_drives_are_distinguished_on_every_truth() {
    let coil = |resistance_ohm: f64| DriveLoad::Coil { resistance_ohm };
    let piezo = |capacitance_f: f64| DriveLoad::Piezo { capacitance_f };
    for (name, load, others, other_kind) in [
        ("membrane", coil(4.0), [coil(1.6), coil(8.0)], piezo(3e-3)),
        ("al-bending", piezo(3e-6), [piezo(1e-6), piezo(8e-6)], coil(150.0)),
    ] {
        for seed in 0..20 {
            let mut random = Random::new(seed);
            let rig = Rig::new(name, Solver::OneMode, &mut random);
            let circuit = DriveCircuit { full_scale_v: VOLT, load, tolerance: 0.3 };
            let check =
                |measured: &Measurement| check_drive(&rig.nominal, &circuit, measured).expect("in range");
            let healthy = current(&rig.nominal, &rig.truth, load, &mut random);
            assert_eq!(check(&healthy), DriveCheck::On, "{name} {seed}");
            assert!(check(&healthy).is_on());
            let scaled = |factor: f64, random: &mut Random| {
                let mut measured = healthy.clone();
                for point in &mut measured.points {
                    let noise = Complex64::new(random.normal(), random.normal()) * point.noise;
                    point.response = point.response * factor + noise;
                }
                measured
            };
            assert_eq!(check(&scaled(0.0, &mut random)), DriveCheck::Open, "{name} {seed}");
            let feeble = check(&scaled(0.02, &mut random));
            assert!(matches!(feeble, DriveCheck::NoAmplifier { .. }), "{name} {seed}: {feeble:?}");
            let short = check(&scaled(50.0, &mut random));
            assert!(matches!(short, DriveCheck::Short { share } if share > 20.0), "{name} {seed}: {short:?}");
            let mut clipped = healthy.clone();
            clipped.points[3].headroom_db = Some(0.0);
            assert!(matches!(check(&clipped), DriveCheck::Short { .. }), "{name} {seed}");
            for other in others {
                let wrong = check(&current(&rig.nominal, &rig.truth, other, &mut random));
                let DriveCheck::WrongLoad { found, stated } = wrong else {
                    panic!("{name} {seed}: {wrong:?}")
                };
                let (DriveLoad::Coil { resistance_ohm: actual } | DriveLoad::Piezo { capacitance_f: actual }) =
                    other;
                assert!(
                    (found / actual - 1.0).abs() < 0.3 && stated == load,
                    "{name} {seed}: {found} {actual}"
                );
                assert!(!wrong.is_on());
            }
            let wrong = check(&current(&rig.nominal, &rig.truth, other_kind, &mut random));
            assert!(matches!(wrong, DriveCheck::WrongKind { .. }), "{name} {seed}: {wrong:?}");
            let mut quiet = healthy.clone();
            quiet.points.iter_mut().for_each(|point| point.noise *= 1e4);
            assert!(matches!(check(&quiet), DriveCheck::TooQuiet { .. }), "{name} {seed}");
        }
    }
}

#[test]
fn each_state_is_a_sentence_and_numbers_out_of_range_are_refused_by_name() {
    let stated = DriveLoad::Coil { resistance_ohm: 4.0 };
    for (state, wanted) in [
        (
            DriveCheck::Open,
            "No current flows: a wire of the drive is open, its plug is out, or the amplifier is off.",
        ),
        (
            DriveCheck::WrongLoad { found: 8.04, stated },
            "The coil has 8 ohm where 4 ohm are stated: it is another coil, or two of them.",
        ),
        (
            DriveCheck::TooQuiet { louder_db: 12.3 },
            "The tones are too quiet to show whether the drive is on: play them 12 dB louder.",
        ),
    ] {
        assert_eq!(state.to_string(), wanted);
    }
    let mut random = Random::new(1);
    let rig = Rig::new("membrane", Solver::OneMode, &mut random);
    let measured = current(&rig.nominal, &rig.truth, stated, &mut random);
    let good = DriveCircuit { full_scale_v: VOLT, load: stated, tolerance: 0.3 };
    for (circuit, wanted) in [
        (DriveCircuit { full_scale_v: 0.0, ..good }, "full_scale_v = 0"),
        (DriveCircuit { tolerance: f64::NAN, ..good }, "tolerance = NaN"),
        (DriveCircuit { load: DriveLoad::Coil { resistance_ohm: -4.0 }, ..good }, "resistance_ohm = -4"),
    ] {
        let error = check_drive(&rig.nominal, &circuit, &measured).expect_err(wanted).to_string();
        assert!(error.starts_with(wanted), "{error}");
    }
}
