//! An exponential sweep through the protocol, the device application and the rig: the responses of a secret plate, and the
//! current of its drive.

use slipline_instrument::measure::{Measured, Sensor, SweepPlan, Sweeping, Warning};
use slipline_instrument::rig::RigFault;
use slipline_link::protocol::command::Apply;
use slipline_link::{CaptureRequest, Request, Sounding};
use slipline_plate::Complex64;
use slipline_plate::calibrate::{MeasuredPoint, SensorKind};
use slipline_plate::check::Colour;
use slipline_tests::bench::{MeasuringBench, RATE_HZ, predicted};
use std::f64::consts::PI;

/// The shunt is the second input.
const CURRENT: Sensor = Sensor { place_m: 0.0, kind: SensorKind::Displacement, input: 1, body: None };

fn sensor(bench: &MeasuringBench) -> Sensor {
    Sensor { place_m: bench.places_m()[0], kind: SensorKind::Displacement, input: 0, body: None }
}

fn sweeping(bench: &MeasuringBench, sensor: Sensor) -> Sweeping {
    let plan = SweepPlan::new(&bench.nominal, &bench.table, &bench.wanted, RATE_HZ).unwrap();
    Sweeping::new(plan, bench.table.clone(), sensor, &bench.inputs()).unwrap()
}

fn sweep(bench: &mut MeasuringBench, sensor: Sensor) -> Measured {
    let sweeping = sweeping(bench, sensor);
    bench.run(sweeping, |_, _, _, _| ()).unwrap()
}

/// Distance of responses from others, each over its own noise and 0.4 % of its size (the rest of a ring after 6 time
/// constants): the root of the mean square, and the largest relative error.
fn departure(measured: &Measured, truth: &[Complex64]) -> (f64, f64) {
    let points = &measured.measurement.points;
    let errors = || points.iter().zip(truth).map(|(point, p)| (point, (point.response - p).norm(), p.norm()));
    let of_noise = |(point, error, size): (&MeasuredPoint, f64, f64)| {
        error.powi(2) / (2.0 * point.noise.powi(2) + (4e-3 * size).powi(2))
    };
    let square = errors().map(of_noise).sum::<f64>() / points.len() as f64;
    (square.sqrt(), errors().map(|(_, error, size)| error / size).fold(0.0, f64::max))
}

fn frequencies(measured: &Measured) -> Vec<f64> {
    measured.measurement.points.iter().map(|point| point.frequency_hz).collect()
}

#[test]
fn the_responses_match_the_frequency_domain_and_the_stepped_comb() {
    let mut bench = MeasuringBench::near("al-bending", 3, 48);
    let sensor = sensor(&bench);
    let swept = sweep(&mut bench, sensor);
    assert_eq!(swept.light(), Colour::Green, "{} dB", swept.headroom_db);
    assert!((swept.noise_codes - 0.76).abs() < 0.05, "{} codes", swept.noise_codes);
    let full_scale = bench.rig.sensor_full_scale();
    let plate = bench.truth.clone();
    let truth = |frequencies: &[f64]| -> Vec<Complex64> {
        let all = predicted(&plate, sensor.place_m, frequencies);
        all.iter().map(|p| p / full_scale).collect()
    };
    let (noises, worst) = departure(&swept, &truth(&frequencies(&swept)));
    println!("sweep: {noises} noises, {worst} at worst");
    // The reported noise is the true noise.
    assert!((0.7..1.2).contains(&noises), "{noises}");
    let combed = bench.measure(sensor.place_m, |_, _, _, _| ()).unwrap();
    let (noises, worst) = departure(&combed, &truth(&frequencies(&combed)));
    println!("comb: {noises} noises, {worst} at worst");
    assert!((0.7..1.2).contains(&noises), "{noises}");
    // The device has its own table again, and the link knows it.
    assert_eq!(bench.loopback.view().table.confirmed.as_deref(), Some(&*bench.table));
}

#[test]
fn the_current_matches_the_rig_within_what_a_ring_leaves() {
    for (name, points) in [("membrane", 24), ("al-bending", 24)] {
        let mut bench = MeasuringBench::near(name, 2, points);
        let swept = sweep(&mut bench, CURRENT);
        let full_scale_a = bench.rig.shunt_full_scale_a();
        let per_code = |hz: &f64| bench.rig.current(*hz) * Complex64::cis(-PI * hz / RATE_HZ) / full_scale_a;
        let truth: Vec<Complex64> = frequencies(&swept).iter().map(per_code).collect();
        let (_, worst) = departure(&swept, &truth);
        println!("{name}: {worst} at worst, {:?}", swept.warnings);
        assert!(worst < 5e-3, "{name}: {worst}");
    }
}

#[test]
fn lost_samples_and_a_slow_host_are_made_good_and_a_lower_level_is_kept() {
    let mut bench = MeasuringBench::near("al-bending", 3, 24);
    bench.wanted.level = 0.2;
    let sensor = sensor(&bench);
    let (mut captures, mut glides) = (0, 0);
    let mut loudest = 0;
    let sweeping = sweeping(&bench, sensor);
    let swept = bench.run(sweeping, |loopback, _, _, asked| match asked {
        Some(Request::Capture(_)) => {
            captures += 1;
            if captures == 3 {
                loopback.inject_overrun(1);
            }
        }
        Some(Request::Play(Sounding::Drive(drive))) if matches!(drive.apply, Apply::At(_)) => {
            glides += 1;
            // Half a second late, once.
            loopback.pass(if glides == 3 { 200_000 } else { 0 }, |_| ());
        }
        None => loopback.pass(1, |codes| {
            loudest = codes.iter().map(|code| code.abs_diff(2048)).max().unwrap_or(0).max(loudest);
        }),
        _ => {}
    });
    let swept = swept.unwrap();
    // The noise, one before the late glide, three of the sweep, and a lost one again; the first tone waits for its index, too.
    assert_eq!((captures, glides), (6, 7));
    assert!(loudest <= (0.2 * 2048.0) as u16 + 1, "{loudest}");
    let full_scale = bench.rig.sensor_full_scale();
    let truth = predicted(&bench.truth, sensor.place_m, &frequencies(&swept));
    let truth: Vec<Complex64> = truth.iter().map(|p| p / full_scale).collect();
    let (noises, _) = departure(&swept, &truth);
    assert!((0.7..1.3).contains(&noises), "{noises}");
}

#[test]
fn a_failed_sweep_is_reported_and_leaves_the_device_still_with_its_table() {
    let mut bench = MeasuringBench::near("al-bending", 1, 24);
    let sensor = sensor(&bench);
    let mut glides = 0;
    bench.ends_early(
        |bench| sweeping(bench, sensor),
        |_, asked| {
            let glides_now = matches!(asked, Some(Request::Capture(CaptureRequest { from: Some(_), .. })));
            glides += u32::from(glides_now);
            // The third of each run.
            glides_now && glides % 3 == 0
        },
    );
}

#[test]
fn an_unplugged_and_a_clipped_sensor_are_reported() {
    let mut bench = MeasuringBench::near("al-bending", 1, 24);
    let sensor = sensor(&bench);
    let loud = |it: &Measured| it.measurement.points.iter().map(|p| p.response.norm()).fold(0.0, f64::max);
    bench.hand.set_fault(Some(RigFault::Unplugged)).unwrap();
    let unplugged = sweep(&mut bench, sensor);
    assert!(loud(&unplugged) < 0.01, "{}", loud(&unplugged));
    assert!(unplugged.warnings.iter().any(|it| matches!(it, Warning::Weak { count: 24, of: 24 })));
    bench.hand.set_fault(Some(RigFault::Clipped)).unwrap();
    let clipped = sweep(&mut bench, sensor);
    assert_eq!(clipped.light(), Colour::Red);
    assert!(
        matches!(clipped.warnings[0], Warning::Clipped { count } if count > 12),
        "{:?}",
        clipped.warnings
    );
}
