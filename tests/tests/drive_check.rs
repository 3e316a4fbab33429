//! "Is it on?" through the protocol, the device application and the rig: the report of each state of a drive, before anything
//! loud sounds.

use slipline_instrument::measure::{AfterCheck, CheckedDrive, DriveChecking, KnownDrive, MeasureError};
use slipline_instrument::rig::RigFault;
use slipline_link::{Request, Sounding};
use slipline_plate::calibrate::{DriveCheck, DriveCircuit, DriveLoad};
use slipline_tests::bench::{MeasuringBench, RATE_HZ};

fn checking(bench: &MeasuringBench, drive: KnownDrive) -> DriveChecking {
    DriveChecking::new(&bench.nominal, drive, bench.table.clone(), RATE_HZ, &bench.inputs()).unwrap()
}

fn check(bench: &mut MeasuringBench, drive: KnownDrive) -> CheckedDrive {
    let checking = checking(bench, drive);
    let before = bench.loopback.samples();
    let found = bench.run(checking, |_, _, _, _| ()).unwrap();
    let seconds = (bench.loopback.samples() - before) as f64 / RATE_HZ;
    println!("{:?} at {} in {seconds} s: {}", found.check, found.level, found.check);
    assert!(found.level <= 0.1, "{}", found.level);
    found
}

/// Breaks the drive in every way; `others` are the currents of other motors over that of the stated one.
fn every_state(name: &str, others: &[f64]) {
    let mut bench = MeasuringBench::near(name, 4, 32);
    let known = bench.rig.known_drive();
    assert_eq!(check(&mut bench, known).check, DriveCheck::On, "{name}");
    for (fault, wanted) in [
        (RigFault::OpenMotor, "No current flows: a wire of the drive is open"),
        // A fiftieth of a current may drown in the noise: then it is none.
        (RigFault::NoAmplifier, "amplifier"),
        (RigFault::ShortedMotor, "short-circuited. Switch the amplifier off."),
    ] {
        bench.hand.set_fault(Some(fault)).unwrap();
        let found = check(&mut bench, known).check;
        assert!(!found.is_on() && found.to_string().contains(wanted), "{name} {fault:?}: {found}");
    }
    for &times in others {
        bench.hand.set_fault(Some(RigFault::WrongMotor(times))).unwrap();
        let found = check(&mut bench, known).check;
        let DriveCheck::WrongLoad { found, stated } = found else { panic!("{name} {times}: {found:?}") };
        let actual = match stated {
            DriveLoad::Coil { resistance_ohm } => found * times / resistance_ohm,
            DriveLoad::Piezo { capacitance_f } => found / (times * capacitance_f),
        };
        assert!((actual - 1.0).abs() < 0.15, "{name} {times}: {actual}");
    }
}

#[test]
fn each_state_of_a_piezo_is_reported_in_its_sentence() {
    every_state("al-bending", &[0.3, 2.5]);
}

#[test]
fn each_state_of_a_coil_is_reported_in_its_sentence() {
    every_state("membrane", &[2.0]);
}

#[test]
fn a_drive_of_the_wrong_kind_and_one_that_is_too_quiet_are_reported() {
    let mut bench = MeasuringBench::near("al-bending", 4, 32);
    let known = bench.rig.known_drive();
    let DriveLoad::Piezo { capacitance_f } = known.circuit.load else { panic!("a piezo") };
    // A coil that takes 2.5 times the current of the piezo in the middle of the coil's own frequencies.
    let hz = 0.06 * bench.nominal.cut_off_hz();
    let load = DriveLoad::Coil { resistance_ohm: 0.4 / (std::f64::consts::TAU * hz * capacitance_f) };
    let coil = KnownDrive { circuit: DriveCircuit { load, ..known.circuit }, ..known };
    let found = check(&mut bench, coil).check;
    assert!(found.to_string().contains("this is no coil"), "{found}");
    let deaf = KnownDrive { full_scale_a: 1e3 * known.full_scale_a, ..known };
    let found = check(&mut bench, deaf);
    assert!(matches!(found.check, DriveCheck::TooQuiet { .. }) && found.level == 0.1, "{found:?}");
}

#[test]
fn a_check_that_is_given_up_or_stopped_says_why_and_ends_in_silence() {
    let mut bench = MeasuringBench::near("al-bending", 4, 32);
    let known = bench.rig.known_drive();
    bench.ends_early(|bench| checking(bench, known), |step, _| step == 200);
}

#[test]
fn a_measurement_begins_only_after_its_drive_was_found_on() {
    let mut bench = MeasuringBench::near("al-bending", 4, 32);
    let known = bench.rig.known_drive();
    let place_m = bench.places_m()[0];
    for (fault, is_on) in [(None, true), (Some(RigFault::OpenMotor), false)] {
        bench.hand.set_fault(fault).unwrap();
        let measuring = bench.measuring(place_m).unwrap();
        let after = AfterCheck::new(Some(checking(&bench, known)), measuring);
        let mut combs = [0, 0];
        let mut share = 0.0;
        let found = bench.run(after, |loopback, after, _, asked| {
            let is_checking = after.is_checking();
            combs[usize::from(!is_checking)] +=
                u32::from(matches!(asked, Some(Request::Play(Sounding::Comb(_)))));
            let now = after.progress(loopback.samples());
            // A check that needs more effort restarts.
            assert!(now >= share || is_checking, "{now} after {share}");
            share = now;
        });
        assert!(combs[0] > 0, "{combs:?}");
        if is_on {
            assert_eq!(found.unwrap().measurement.points.len(), 32);
            assert!(combs[1] > 2, "{combs:?}");
        } else {
            assert_eq!(found, Err(MeasureError::NotOn(DriveCheck::Open)));
            assert_eq!(combs[1], 0, "something was measured");
        }
    }
}
