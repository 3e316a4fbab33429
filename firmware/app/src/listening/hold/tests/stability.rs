//! The loop around a plate: how fast, how stable, and at its limits. Times in periods; the longer of the time constant and
//! the period is the unit of what is promised.

use super::super::{Limit, LoopState, Octaves};
use super::plant::{NOMINAL, Rig, SLOT, Truth};

const RATIOS: [f64; 15] = [0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 0.85, 1.0, 1.2, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0];
/// A finger takes half of the amplitude.
const FINGER: f64 = 0.5;
const HALF_DB: f64 = -6.02;

/// A rig that holds its amplitude, at a place within a window.
fn held(truth: Truth, slew: Octaves, room_db: f64, phase: f64) -> (Rig, f64) {
    let unit = truth.assumed_tau.max(1.0);
    let mut rig = Rig::new(truth, slew, room_db);
    rig.run((20.0 * unit).ceil() + phase, 1.0);
    assert!(rig.last().abs() < 0.3, "{truth:?}: {} dB", rig.last());
    rig.forget();
    (rig, unit)
}

/// Plates by their time constant, their gain, the delay, and where in a window the finger comes.
fn all(mut run: impl FnMut(Truth, f64)) {
    for assumed_tau in RATIOS {
        for (gain, lead) in [(0.5, 0.25), (1.0, 0.25), (2.0, 0.25), (1.0, 0.0)] {
            for phase in [0.0, 0.25, 0.5, 0.75] {
                run(Truth { assumed_tau, gain, lead, ..NOMINAL }, phase);
            }
        }
    }
}

#[test]
fn a_finger_is_taken_back_within_five_time_constants_without_overshoot() {
    all(|truth, phase| {
        // Just what the finger takes, and plenty.
        for room_db in [6.1, 20.0] {
            let room_db = room_db - 20.0 * truth.gain.log10();
            let (mut rig, unit) = held(truth, Octaves::ONE, room_db, phase);
            rig.run(15.0 * unit, FINGER);
            let settled = rig.settled_after(0.0);
            assert!(settled <= 4.8 * unit, "{truth:?} {phase}: {settled}");
            assert!(rig.highest() < 0.1, "{truth:?} {phase}: {}", rig.highest());
            assert!(rig.loudest <= 1.0, "{truth:?} {phase}: {}", rig.loudest);
            assert_eq!(rig.hold.state(SLOT), Some(LoopState::Held), "{truth:?}");
        }
    });
}

#[test]
fn the_loop_is_stable_at_half_and_twice_the_gain_and_at_a_wrong_time_constant() {
    for assumed_tau in RATIOS {
        for (power, tau) in [(0.5, 1.0), (2.0, 1.0), (1.0, 0.4), (1.0, 2.5)] {
            let truth = Truth { assumed_tau, power, tau, ..NOMINAL };
            let (mut rig, unit) = held(truth, Octaves::ONE, 20.0, 0.4);
            rig.run(30.0 * unit, FINGER);
            assert!(rig.last().abs() < 0.3, "{truth:?}: {}", rig.last());
            assert!(rig.highest() < 3.0, "{truth:?}: {}", rig.highest());
        }
    }
}

#[test]
fn a_tone_without_headroom_stays_at_the_limit_reports_it_and_does_not_wind_up() {
    all(|truth, phase| {
        // Where the plate is as the table says, 3 dB are left; where it is stronger or weaker, 3 dB from where it is held.
        let room_db = 3.0 - 20.0 * truth.gain.log10();
        let (mut rig, unit) = held(truth, Octaves::ONE, room_db, phase);
        rig.run(30.0 * unit, FINGER);
        assert!((rig.last() - (HALF_DB + 3.0)).abs() < 0.05, "{truth:?} {phase}: {}", rig.last());
        assert_eq!(rig.hold.state(SLOT), Some(LoopState::AtLimit(Limit::Headroom)), "{truth:?}");
        assert!(rig.loudest > 0.999 && rig.loudest <= 1.0, "{truth:?}: {}", rig.loudest);

        rig.forget();
        rig.run(15.0 * unit, 1.0);
        assert!(rig.highest() < 3.01, "{truth:?} {phase}: {}", rig.highest());
        let settled = rig.settled_after(0.0);
        assert!(settled <= 5.0 * unit, "{truth:?} {phase}: {settled}");
        let peak = rig.trace.iter().position(|db| *db == rig.highest()).expect("there is one");
        rig.trace.drain(..peak);
        assert!(rig.lowest() > -0.1, "{truth:?} {phase}: {}", rig.lowest());
    });
}

#[test]
fn no_period_brings_more_than_the_slew_and_a_slow_one_does_not_overshoot() {
    let slew = Octaves(1 << 13);
    for assumed_tau in RATIOS {
        let (mut rig, unit) = held(Truth { assumed_tau, ..NOMINAL }, slew, 20.0, 0.4);
        rig.run(30.0 * unit, FINGER);
        assert!(rig.steepest <= 0.125 + 1e-4, "{assumed_tau}: {}", rig.steepest);
        let (highest, last) = (rig.highest(), rig.last());
        assert!(highest < 0.3 && last.abs() < 0.3, "{assumed_tau}: {highest} {last}");
    }
}
