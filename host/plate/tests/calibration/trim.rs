//! Trim of a calibrated plate whose wave speed has changed: one sensor measures the change.

use super::rig::{Random, Rig, Solver};
use super::{PLACES, calibrated, count, measured};
use slipline_plate::calibrate::{CalibrateError, MeasuredPoint, Measurement, SpeedTrim};
use slipline_plate::{Finger, Plate};

/// Step through the first frequencies to the tones of the later measurements: 15 of 60 and of 150.
fn every(name: &str) -> usize {
    count(name) / 15
}

/// A rig with a calibrated file.
fn rig(name: &str, seed: u64) -> (Rig, Random) {
    let mut random = Random::new(seed);
    let mut rig = Rig::new(name, Solver::OneMode, &mut random);
    let sensors = measured(name, &rig, &mut random);
    rig.nominal = calibrated(&rig, &sensors).expect("calibrated").plate;
    (rig, random)
}

/// The rig with its wave speed times `share`.
fn at_speed(rig: &Rig, share: f64) -> Rig {
    Rig { truth: rig.truth.with_wave_speed(share).expect("valid"), ..rig.clone() }
}

/// A measurement by a sensor that stands `off_m` from its mark at a tenth of the length.
fn first(name: &str, rig: &Rig, off_m: f64, random: &mut Random) -> Measurement {
    let place_m = PLACES[0] * rig.nominal.length_m();
    let [sensor] = rig.measure([place_m + off_m], count(name), random);
    Measurement { place_m, ..sensor }
}

/// The measurement at some of its tones.
fn short(name: &str, measurement: Measurement) -> Measurement {
    let points = measurement.points.iter().copied().skip(1).step_by(every(name)).collect();
    Measurement { points, ..measurement }
}

#[test]
fn the_speed_is_found_within_its_interval_at_first_and_later() {
    for name in ["membrane", "al-bending"] {
        let mut held = 0;
        for (seed, share, change) in
            [(0, 1.02, 0.985), (1, 0.995, 1.01), (2, 0.98, 1.02), (3, 1.01, 0.995), (4, 1.0, 1.0)]
        {
            let (rig, mut random) = rig(name, seed);
            let now = at_speed(&rig, share);
            let trim = SpeedTrim::new(&rig.nominal, &first(name, &now, 0.0, &mut random)).expect("a speed");
            let then = at_speed(&now, change);
            let later = trim.later(&short(name, first(name, &then, 0.0, &mut random))).expect("one change");
            for (it, at, wanted) in [(trim.begin(), &now, share), (&later, &then, share * change)] {
                let half = 0.5 * (it.high - it.low);
                let widths =
                    |plate: &Plate| plate.spec().calibration.as_ref().expect("one").half_width_tolerance;
                assert_eq!(widths(&it.plate), widths(&rig.nominal), "known as well as before");
                let before_m = at.boundary_by_table_m(&rig.nominal);
                let after_m = at.boundary_by_table_m(&it.plate);
                println!(
                    "{name} {seed}: {wanted:.4} found {:.5} +-{half:.5}, chi2/n {:.2}, {:.2} -> {:.2} mm",
                    it.share,
                    it.chi2_per_n,
                    1e3 * before_m,
                    1e3 * after_m
                );
                held += usize::from((it.low..=it.high).contains(&wanted));
                assert!((it.share - wanted).abs() < 1.5 * half && half < 4e-3, "{name} {seed}: {it:?}");
                assert!(after_m < 1.2e-3 && after_m < 0.6e-3 + 0.3 * before_m, "{name} {seed}: {after_m}");
            }
        }
        assert!(held >= 9, "{name}: {held} of 10");
    }
}

#[test]
fn what_one_speed_does_not_explain_is_noticed() {
    unexplained(&["membrane"]);
}

#[test]
#[ignore = "a second pass, on another preset: .ci/run statistics"]
fn what_one_speed_does_not_explain_is_noticed_on_aluminium_too() {
    unexplained(&["al-bending"]);
}

fn unexplained(presets: &[&str]) {
    for &name in presets {
        let (rig, mut random) = rig(name, 5);
        let good = first(name, &rig, 0.0, &mut random);
        let trim = SpeedTrim::new(&rig.nominal, &good).expect("a speed");

        for off_m in [1e-3_f64, -1e-3, 1e-2, -1e-2] {
            let wrong = first(name, &rig, off_m, &mut random);
            match SpeedTrim::new(&rig.nominal, &wrong) {
                Err(
                    CalibrateError::Misplaced { .. } | CalibrateError::Unlike { .. } | CalibrateError::NoFit,
                ) => {}
                Err(error) => panic!("{name} {off_m}: {error}"),
                Ok(trim) => {
                    let found_m = rig.boundary_by_table_m(&trim.begin().plate);
                    let allowed_m = 0.6e-3 + 1.5 * trim.boundary_per_place() * off_m.abs();
                    println!("{name} {off_m}: {found_m} of {allowed_m} m, speed {}", trim.begin().share);
                    assert!(
                        off_m.abs() < 5e-3 && found_m < allowed_m,
                        "{name} {off_m}: {found_m} {allowed_m}"
                    );
                    assert!(trim.caution().is_some());
                }
            }
            let later = trim.later(&short(name, wrong));
            let is_noticed = matches!(later, Err(CalibrateError::PhasesUnlike { .. }));
            println!("{name} {off_m}: {:?}", later.as_ref().map(|it| (it.share, it.chi2_per_n)));
            assert!(is_noticed || off_m.abs() < 5e-3, "{name} {off_m}: {later:?}");
        }
        let firm = Finger { resistance_n_s_per_m: 1.0, mass_kg: 1e-4, ..Finger::light(0.12) };
        let touched = Rig { finger: Some(firm), ..rig.clone() };
        let under_finger = trim.later(&short(name, first(name, &touched, 0.0, &mut random)));
        // The wave impedance of the aluminium is 200 times that of this finger.
        let is_noticed = matches!(under_finger, Err(CalibrateError::PhasesUnlike { .. }));
        assert!(is_noticed || name == "al-bending", "{name}: {under_finger:?}");

        let mut few = good.clone();
        few.points.truncate(7);
        let error = trim.later(&few).expect_err("seven tones").to_string();
        assert!(error.contains("7 points"), "{error}");
        let quiet = |it: &MeasuredPoint| MeasuredPoint { noise: it.response.norm(), ..*it };
        let noisy = Measurement { points: good.points.iter().map(quiet).collect(), ..good.clone() };
        let error = trim.later(&noisy).expect_err("noise");
        assert!(matches!(error, CalibrateError::NoSignal { .. }), "{error}");
        let elsewhere = Measurement { place_m: good.place_m + 1e-3, ..good.clone() };
        let error = trim.later(&elsewhere).expect_err("another place");
        assert!(matches!(error, CalibrateError::AnotherSensor { .. }), "{error}");
        let uncalibrated = slipline_plate::preset(name).expect("a preset");
        assert_eq!(SpeedTrim::new(&uncalibrated, &good).err(), Some(CalibrateError::NotCalibrated));
    }
}
