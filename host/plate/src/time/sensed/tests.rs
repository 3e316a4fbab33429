use super::*;
use crate::calibrate::seen;
use crate::definition::presets::{preset, presets};
use crate::frequency::equation::Equation;
use crate::frequency::respond::respond;
use crate::{Air, AirMounting, Faces, Gas, Model, PlateSpec};

const RATE_HZ: f64 = 400e3;
/// Delay by the hold of the DAC.
const LAG_S: f64 = 1.25e-6;
/// Tolerances: 0.05 dB and 0.3 degrees.
const DECIBELS: f64 = 0.05;
const DEGREES: f64 = 0.3;

/// Points of a field of the solver.
const POINTS: usize = 2001;

/// The field of the solver per code, with the hold of the codes.
fn field(plate: &Plate, hz: f64) -> Vec<Complex64> {
    let field = respond(plate, hz, POINTS, Equation::Corrected).expect("in range").amplitude;
    let drive = plate.drive_response(hz) * plate.spec().full_scale_m * hold_droop(hz, RATE_HZ);
    field.into_iter().map(|f| f * drive).collect()
}

/// The signal of a sensor for such a field.
fn shown(plate: &Plate, field: &[Complex64], sensor: SensorKind, place_m: f64, hz: f64) -> Complex64 {
    let step_m = plate.length_m() / (POINTS - 1) as f64;
    let kind = match sensor {
        SensorKind::Displacement => Complex64::ONE,
        SensorKind::Velocity => Complex64::new(0.0, -TAU * hz),
        SensorKind::Acceleration => Complex64::from(-(TAU * hz).powi(2)),
        SensorKind::Strain => Complex64::from(0.5 * plate.spec().model.bending().expect("bends").thickness_m),
    };
    kind * seen(field, step_m, place_m, sensor)
}

/// The steady amplitude of the solver at a place, per code, in the sensor's unit.
fn exact(plate: &Plate, sensor: SensorKind, place_m: f64, hz: f64) -> Complex64 {
    shown(plate, &field(plate, hz), sensor, place_m, hz)
}

/// `floor` is the allowed error scale of a faint response.
fn assert_close(what: &str, found: Complex64, exact: Complex64, floor: f64) {
    // An error of 0.5 % is within both limits.
    if (found - exact).norm() < 5e-3 * floor {
        return;
    }
    let ratio = found / exact;
    let (decibels, degrees) = (20.0 * ratio.norm().log10(), ratio.arg().to_degrees());
    assert!(
        decibels.abs() < DECIBELS && degrees.abs() < DEGREES,
        "{what}: {decibels:.4} dB, {degrees:.3} degrees"
    );
}

#[test]
fn every_output_of_every_preset_matches_the_frequency_domain_over_the_whole_band() {
    for preset in presets() {
        let plate = preset.plate().expect("a preset");
        let sensed = SensedPlate::new(&plate, None, RATE_HZ).expect("a plate in time");
        let (low_hz, high_hz) = plate.band_hz();
        // Frequencies between those of the fit.
        let frequencies: Vec<f64> =
            (0..=30).map(|i| low_hz * (high_hz / low_hz).powf(f64::from(i) / 30.0)).collect();
        let fields: Vec<Vec<Complex64>> = frequencies.iter().map(|&hz| field(&plate, hz)).collect();
        for share in [0.0, 0.07, 0.1, 0.41, 0.55, 0.9] {
            let place_m = share * plate.length_m();
            for kind in SensorKind::ALL {
                if kind == SensorKind::Strain && (share == 0.0 || plate.spec().model.bending().is_none()) {
                    continue;
                }
                let what = format!("{} {share} {}", preset.name, kind.word());
                let output =
                    sensed.sensor(kind, place_m, 0.0).unwrap_or_else(|error| panic!("{what}: {error}"));
                let lag = |hz: f64| Complex64::cis(TAU * hz * LAG_S);
                let each = frequencies.iter().zip(&fields);
                let wanted: Vec<Complex64> =
                    each.map(|(&hz, field)| shown(&plate, field, kind, place_m, hz)).collect();
                // A hundred-thousandth of the largest is a fiftieth of a code of 12 bits.
                let floor = 1e-5 * wanted.iter().map(|it| it.norm()).fold(0.0, f64::max);
                for (&hz, &wanted) in frequencies.iter().zip(&wanted) {
                    let found = sensed.steady(&output, hz) / lag(hz);
                    assert_close(&format!("{what} {hz} Hz"), found, wanted, floor);
                }
                // Between the band and half of the sample rate, the gain is limited relative to the largest gain in
                // the band.
                let gain = |hz: f64| sensed.steady(&output, hz).norm();
                let inside = frequencies.iter().map(|&hz| gain(hz)).fold(0.0, f64::max);
                let above =
                    (0..400).map(|i| gain(high_hz * (0.5 * RATE_HZ / high_hz).powf(f64::from(i) / 399.0)));
                let above = above.fold(0.0, f64::max);
                // At the drive point the plate itself still responds above the band.
                let most = if share == 0.0 { 400.0 } else { 40.0 };
                // Beyond the span only waves from above the band arrive.
                assert!(
                    share > 0.6 || above < most * inside,
                    "{what}: {above} above the band, {inside} in it"
                );
            }
        }
    }
}

#[test]
fn codes_of_sixteen_tones_give_the_amplitudes_of_the_frequency_domain() {
    for name in ["membrane", "al-bending"] {
        let plate = preset(name).expect("a preset");
        let sensed = SensedPlate::new(&plate, None, RATE_HZ).expect("a plate in time");
        let place_m = 0.3 * plate.length_m();
        let delay_s = 1.1e-6;
        let sensor = sensed.sensor(SensorKind::Velocity, place_m, delay_s).expect("on the plate");
        let drive_point = sensed.with_drive_point(|_, velocity| velocity).expect("a drive point");
        let (low_hz, high_hz) = plate.band_hz();
        // Whole periods in the window, which begins when what the first code has set off has died out.
        let window = 200_000;
        let base_hz = RATE_HZ / f64::from(window);
        let first = (low_hz / base_hz).ceil();
        let apart = ((high_hz / base_hz).floor() - first) / 15.0;
        let tones: Vec<f64> = (0..16).map(|i| (first + f64::from(i) * apart).floor() * base_hz).collect();
        let code = |n: u32| {
            tones.iter().map(|hz| (TAU * (hz * f64::from(n) / RATE_HZ).fract()).cos()).sum::<f64>() / 16.0
        };
        let settled = if name == "membrane" { 400_000 } else { 40_000 };
        let mut resonators = sensed.at_rest();
        let mut sums = vec![[Complex64::ZERO; 2]; tones.len()];
        for n in 0..settled + window {
            let signals = resonators.step(code(n), [&sensor, &drive_point]);
            if n >= settled {
                for (sum, hz) in sums.iter_mut().zip(&tones) {
                    let turn = Complex64::cis(TAU * (hz * f64::from(n) / RATE_HZ).fract());
                    sum[0] += turn * signals[0];
                    sum[1] += turn * signals[1];
                }
            }
        }
        for (&hz, sum) in tones.iter().zip(&sums) {
            let delays_s = [LAG_S + delay_s, LAG_S];
            for ((sum, place_m), late_s) in sum.iter().zip([place_m, 0.0]).zip(delays_s) {
                let found = sum * (2.0 * 16.0 / f64::from(window)) / Complex64::cis(TAU * hz * late_s);
                let exact = exact(&plate, SensorKind::Velocity, place_m, hz);
                assert_close(&format!("{name} {hz} Hz at {place_m} m"), found, exact, 0.0);
            }
        }
        resonators.rest();
        assert_eq!(resonators.step(0.0, [&sensor, &drive_point]), [0.0; 2]);
    }
}

#[test]
fn a_sensor_is_moved_while_the_plate_rings() {
    let plate = preset("al-bending-displacement").expect("a preset");
    let sensed = SensedPlate::new(&plate, None, RATE_HZ).expect("a plate in time");
    let place = |share: f64| {
        sensed.sensor(SensorKind::Displacement, share * plate.length_m(), 0.0).expect("on the plate")
    };
    let (here, there) = (place(0.2), place(0.5));
    let mut resonators = sensed.at_rest();
    resonators.step(1.0, [&here, &there]);
    for _ in 0..5000 {
        resonators.step(0.0, [&here, &there]);
    }
    let mut other = resonators.clone();
    let [a, b] = resonators.step(0.0, [&here, &there]);
    assert!(a != 0.0 && b != 0.0 && a != b);
    assert_eq!(other.step(0.0, [&there, &here]), [b, a]);
}

#[test]
fn a_finger_takes_from_the_answer_what_the_frequency_domain_says() {
    use crate::frequency::respond::respond_touched;
    let plate = preset("membrane").expect("a preset");
    let finger = Finger::light(0.14);
    let sensed = SensedPlate::new(&plate, Some(&finger), RATE_HZ).expect("a plate in time");
    let place_m = 0.1;
    let output = sensed.sensor(SensorKind::Displacement, place_m, 0.0).expect("on the plate");
    for hz in [95.0, 130.0, 180.0] {
        let touched =
            respond_touched(&plate, Some(&finger), hz, 3201, Equation::Corrected).expect("in range");
        let droop = hold_droop(hz, RATE_HZ) * plate.spec().full_scale_m;
        let exact_touched = touched.amplitude[1000] * droop;
        let found = sensed.steady(&output, hz) / Complex64::cis(TAU * hz * LAG_S);
        assert_close(&format!("{hz} Hz"), found, exact_touched, 0.0);
        let free = exact(&plate, SensorKind::Displacement, place_m, hz);
        assert!((found / free - 1.0).norm() > 0.05, "{hz} Hz: the finger does something");
    }
}

#[test]
fn what_cannot_be_sensed_is_refused_by_name_and_range() {
    let plate = preset("membrane").expect("a preset");
    let sensed = SensedPlate::new(&plate, None, RATE_HZ).expect("a plate in time");
    let refused = |place_m: f64, delay_s: f64| {
        sensed.sensor(SensorKind::Velocity, place_m, delay_s).expect_err("refused").to_string()
    };
    for place_m in [-0.001, 0.3201, f64::NAN, f64::INFINITY] {
        let error = refused(place_m, 0.0);
        assert!(error.starts_with("sensor place = ") && error.contains("0 to 0.32 m"), "{error}");
    }
    assert!(refused(0.1, 3e-6).starts_with("sensor delay = "), "{}", refused(0.1, 3e-6));
    let strained = sensed.sensor(SensorKind::Strain, 0.1, 0.0);
    assert_eq!(strained.expect_err("refused"), SenseError::NoStrain);
    assert!(matches!(SensedPlate::new(&plate, None, 100.0), Err(LineError::SampleRate(_))));
    let beside = Finger::light(5.0);
    assert!(matches!(SensedPlate::new(&plate, Some(&beside), RATE_HZ), Err(LineError::Finger(_))));
}

#[test]
fn a_sensor_on_a_membrane_in_air_answers_as_the_frequency_domain() {
    let mounting = AirMounting::Baffle { faces: Faces::Two };
    let baffle = Air::Around { gas: Gas::ROOM, mounting, gap_m: None };
    // Latex of 0.2 kg/m^2, where the air's pressure at a distance counts most: above the span its field is no sum of resonances.
    let light = Model::Membrane { wave_speed_m_per_s: 12.0, tension_n_per_m: Some(28.8), film: None };
    for (name, model, air, places_m, most) in [
        ("membrane", None, Air::ROOM, [0.03, 0.18], 1e-2),
        ("latex-membrane", None, baffle, [0.094, 0.198], 1e-2),
        ("latex-membrane", Some(light), baffle, [0.094, 0.198], 3e-2),
    ] {
        let still = preset(name).expect("a preset");
        let model = model.unwrap_or_else(|| still.spec().model.clone());
        let plate = Plate::new(PlateSpec { air: Some(air), model, ..still.spec().clone() }).expect("a plate");
        let sensed = SensedPlate::new(&plate, None, RATE_HZ).expect("a plate in time");
        let (low_hz, high_hz) = plate.band_hz();
        let kind = SensorKind::Displacement;
        for place_m in places_m {
            let output = sensed.sensor(kind, place_m, 0.0).expect("on the plate");
            for i in 0..=10 {
                let hz = low_hz * (high_hz / low_hz).powf(f64::from(i) / 10.0);
                let wanted = shown(&plate, &field(&plate, hz), kind, place_m, hz);
                let found = sensed.steady(&output, hz) / Complex64::cis(TAU * hz * LAG_S);
                let of = format!("{name} {place_m} {hz} Hz");
                assert_close(&of, found, wanted, most * plate.spec().full_scale_m);
            }
        }
    }
}
