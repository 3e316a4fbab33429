//! A secret plate under the simulated rig, measured through the protocol and the device application, and calibrated.

use slipline_instrument::measure::Measured;
use slipline_instrument::rig::RigFault;
use slipline_link::Request;
use slipline_plate::Complex64;
use slipline_plate::calibrate::{CalibrateError, Priors, from_ratio};
use slipline_plate::check::Colour;
use slipline_tests::bench::{MeasuringBench, predicted};
use slipline_tests::truths::{self, Noise};

#[test]
fn the_responses_match_the_frequency_domain_in_level_and_phase() {
    for name in ["al-bending", "membrane"] {
        let mut bench = MeasuringBench::near(name, 3, 32);
        let place_m = bench.places_m()[0];
        let measured = bench.measure(place_m, |_, _, _, _| ()).unwrap();
        assert_eq!(measured.light(), Colour::Green, "{name}: {} dB", measured.headroom_db);
        assert!((measured.noise_codes - 0.76).abs() < 0.15, "{name}: {} codes", measured.noise_codes);
        let points = &measured.measurement.points;
        let frequencies: Vec<f64> = points.iter().map(|point| point.frequency_hz).collect();
        let predicted = predicted(&bench.truth, place_m, &frequencies);
        // One factor, that of the sensor.
        let product: Complex64 = points.iter().zip(&predicted).map(|(it, p)| it.response * p.conj()).sum();
        let factor = product / predicted.iter().map(Complex64::norm_sqr).sum::<f64>();
        assert!(factor.arg().abs() < 0.01, "{name}: {factor}");
        let loudest = predicted.iter().map(|p| p.norm()).fold(0.0, f64::max);
        for (point, p) in points.iter().zip(&predicted) {
            let error = (point.response / factor - p).norm();
            let allowed = 0.01 * (p.norm() + 0.1 * loudest) + 4.0 * point.noise / factor.norm();
            assert!(error < allowed, "{name} at {} Hz: {error} of {p}", point.frequency_hz);
        }
    }
}

#[test]
fn a_secret_plate_is_calibrated_from_two_places() {
    calibrates([("al-bending", 0..1), ("membrane", 0..1)]);
}

/// All twenty of each preset are a program for a nightly run: `src/bin/truths.rs`.
#[test]
#[ignore = "statistics: .ci/run statistics"]
fn secret_plates_are_calibrated_from_two_places() {
    calibrates([("al-bending", 0..2), ("membrane", 0..2)]);
}

/// Between clamped edges the simulated device has a fit of the answers that the calibration computes.
#[test]
#[ignore = "statistics: .ci/run statistics"]
fn a_secret_clamped_plate_is_calibrated_from_two_places() {
    calibrates([(truths::CLAMPED, 0..1)]);
}

mod night {
    use super::{calibrates, truths};

    #[test]
    #[ignore = "seven rigs on clamped plates, minutes of one core: .ci/run statistics"]
    fn seven_secret_clamped_plates_are_calibrated_from_two_places() {
        calibrates([(truths::CLAMPED, 0..7)]);
    }
}

#[test]
#[ignore = "a rig on a clamped plate takes seconds to put together: .ci/run statistics"]
fn a_clamped_plate_is_not_refused_by_its_own_simulation() {
    let judged = truths::calibrate_itself(truths::CLAMPED, Noise::Input).expect("accepted");
    println!("{}", judged.line());
    assert!(judged.found.chi2_per_n < 4.0, "{}", judged.line());
    assert!(judged.after.boundary_m < 5e-4 && judged.after.level_db < 1.0, "{}", judged.line());
}

fn calibrates<const N: usize>(presets: [(&str, std::ops::Range<u64>); N]) {
    for (name, seeds) in presets {
        for seed in seeds {
            let judged = truths::calibrate(name, seed, Noise::Input)
                .unwrap_or_else(|error| panic!("{name} {seed}: {error}"));
            println!("{name} {}", judged.line());
            let (before, after) = (judged.before, judged.after);
            assert!(after.boundary_m < 1e-3 && after.level_db < 2.0, "{name} {seed}: {after:?}");
            assert!(after.boundary_m < 0.5 * before.boundary_m && after.level_db < 0.5 * before.level_db);
        }
    }
}

#[test]
fn a_failed_measurement_is_reported_and_leaves_the_plate_still() {
    let mut bench = MeasuringBench::near("al-bending", 1, 48);
    let place_m = bench.places_m()[0];
    // Lost samples are measured again. They are lost often enough that a window cannot miss them.
    let mut windows = 0;
    let measured = bench.measure(place_m, |loopback, _, step, asked| {
        if step < 400 && step % 30 == 0 {
            loopback.inject_overrun(1);
        }
        windows += usize::from(matches!(asked, Some(Request::Listen(_))));
    });
    assert!(measured.is_ok() && windows > 4, "{windows} windows: {measured:?}");
    bench.ends_early(|bench| bench.measuring(place_m).unwrap(), |step, _| step == 400);
}

#[test]
fn an_unplugged_and_a_clipped_sensor_are_reported() {
    let mut bench = MeasuringBench::near("al-bending", 1, 32);
    let place_m = bench.places_m()[0];
    let good = bench.measure(place_m, |_, _, _, _| ()).unwrap();
    bench.hand.set_fault(Some(RigFault::Unplugged)).unwrap();
    let unplugged = bench.measure(place_m, |_, _, _, _| ()).unwrap();
    let loud = |it: &Measured| it.measurement.points.iter().map(|p| p.response.norm()).fold(0.0, f64::max);
    assert!(loud(&unplugged) < 1e-2 * loud(&good), "{}", loud(&unplugged));
    assert!(!unplugged.warnings.is_empty());
    let refused = from_ratio(&bench.nominal, [&unplugged.measurement, &good.measurement], &Priors::default());
    assert!(matches!(refused, Err(CalibrateError::NoSignal { .. })), "{refused:?}");
    bench.hand.set_fault(Some(RigFault::Clipped)).unwrap();
    let clipped = bench.measure(place_m, |_, _, _, _| ()).unwrap();
    assert_eq!(clipped.light(), Colour::Red);
    let refused = from_ratio(&bench.nominal, [&clipped.measurement, &good.measurement], &Priors::default());
    assert!(matches!(refused, Err(CalibrateError::Clipped { .. })), "{refused:?}");
}
