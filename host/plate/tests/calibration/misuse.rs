//! Mistakes of a user in a measurement: each is refused by its name, or the table is good nevertheless.
//!
//! | what | here, with two places | one place (`one_sensor.rs`) | through the protocol (`tests/tests/measuring.rs`) |
//! |---|---|---|---|
//! | sensor 1 mm or 10 mm from its mark | `a_sensor_at_another_place..`, stated by `how_far_a_misplaced..` | `what_goes_wrong..` | |
//! | at a node, or beyond the last boundary | `a_sensor_at_a_node..`, `a_sensor_where_nothing..` | `what_goes_wrong..` | |
//! | unplugged, clipped | `an_unplugged..` | `what_goes_wrong..` | `an_unplugged..` |
//! | places swapped | `an_unplugged..` | | |
//! | 20 dB over the noise | `at_twenty_decibels..` | `what_goes_wrong..` | |
//! | plate file wrong by 20 % | `the_file_of_another_plate..` | `what_goes_wrong..` | |
//! | finger on the plate | `a_finger..` | `what_goes_wrong..` | |

use super::rig::{Random, Rig, Solver};
use super::{PLACES, calibrated, count, measured};
use slipline_plate::calibrate::{CalibrateError, Calibrated, Measurement};
use slipline_plate::{Complex64, Finger, Plate, PlateSpec, Taper, quantity::decibels};

/// The presets of `cargo test`, and of the second pass in the long tests.
const FIRST: &str = "membrane";
const SECOND: &str = "al-bending";

fn rig(name: &str, seed: u64) -> (Rig, Random) {
    let mut random = Random::new(seed);
    (Rig::new(name, Solver::OneMode, &mut random), random)
}

/// The refusal; `None` if the table is as good as stated. A bad table without a refusal fails the test. `moved_m` is
/// the distance of each sensor from its mark.
fn refused_or_good(
    rig: &Rig,
    sensors: &[Measurement; 2],
    moved_m: [f64; 2],
    what: &str,
) -> Option<CalibrateError> {
    good_or_refused(rig, calibrated(rig, sensors), &moved_m, what)
}

/// The same for the result of any calibration.
pub(crate) fn good_or_refused(
    rig: &Rig,
    found: Result<Calibrated, CalibrateError>,
    moved_m: &[f64],
    what: &str,
) -> Option<CalibrateError> {
    let found = match found {
        Ok(found) => found,
        Err(error) => return Some(error),
    };
    let untouched = Rig { finger: None, ..rig.clone() };
    let judged = untouched.judge(&found.plate);
    let by_places: f64 = found
        .boundary_per_place
        .iter()
        .zip(moved_m)
        .map(|(per_place, moved_m)| per_place * moved_m.abs())
        .sum();
    let allowed_m = 1e-3_f64.max(1.5 * found.boundary_tolerance_m) + by_places;
    assert!(judged.boundary_m < allowed_m, "{what}: {judged:?}, allowed {allowed_m}");
    let allowed_db = 2_f64.max(1.5 * found.level_tolerance_db);
    assert!(judged.level_db < allowed_db, "{what}: {judged:?}, allowed {allowed_db}");
    None
}

#[test]
fn a_finger_on_the_plate_is_noticed_where_it_matters() {
    finger(FIRST);
}

fn finger(name: &str) {
    let (mut rig, mut random) = rig(name, 30);
    let mut firm_seen = 0;
    for place_m in [0.12, 0.2] {
        let firm = Finger { resistance_n_s_per_m: 1.0, mass_kg: 1e-4, ..Finger::light(place_m) };
        for finger in [Finger::light(place_m), firm] {
            rig.finger = Some(finger);
            let places = PLACES.map(|share| share * rig.nominal.length_m());
            let sensors = rig.measure(places, 60, &mut random);
            let error = refused_or_good(&rig, &sensors, [0.0; 2], &format!("{name} {finger:?}"));
            let is_seen = matches!(error, Some(CalibrateError::Unlike { .. } | CalibrateError::NoFit));
            // The wave impedance of the aluminium is 1500 times that of a light touch.
            assert!(is_seen || name == "al-bending", "{name} {finger:?}: {error:?}");
            firm_seen += usize::from(is_seen && finger == firm);
        }
    }
    // On the aluminium one at 0.12 m passes for edges that give a little, and the result is good.
    assert!(firm_seen >= if name == "al-bending" { 1 } else { 2 }, "{name}: {firm_seen}");
}

#[test]
fn a_sensor_at_another_place_than_stated_is_noticed_where_it_matters() {
    another_place(FIRST);
}

fn another_place(name: &str) {
    for (a_mm, b_mm) in [(1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (10.0, 0.0), (0.0, 10.0), (0.0, -10.0)] {
        let (rig, mut random) = rig(name, 31);
        let stated = PLACES.map(|share| share * rig.nominal.length_m());
        let places = [stated[0] + 1e-3 * a_mm, stated[1] + 1e-3 * b_mm];
        let mut sensors = rig.measure(places, count(name), &mut random);
        (sensors[0].place_m, sensors[1].place_m) = (stated[0], stated[1]);
        let moved_m = [1e-3 * a_mm, 1e-3 * b_mm];
        let error = refused_or_good(&rig, &sensors, moved_m, &format!("{name} {a_mm} {b_mm} mm"));
        let is_far = f64::abs(a_mm) + f64::abs(b_mm) > 5.0;
        assert_eq!(error.is_some(), is_far, "{name} {a_mm} {b_mm} mm: {error:?}");
    }
}

#[test]
fn how_far_a_misplaced_sensor_shifts_the_boundary_is_stated_in_a_sentence() {
    let (rig, mut random) = rig("membrane", 31);
    let sensors = measured("membrane", &rig, &mut random);
    let found = calibrated(&rig, &sensors).expect("accepted");
    let most_mm = found.boundary_per_place.iter().copied().fold(0.0, f64::max);
    assert!((0.5..2.0).contains(&most_mm), "{most_mm}");
    let sentence = found.caution().expect("two sensors");
    let wanted = format!("moves the boundary by up to {most_mm:.1} mm, and this fit cannot tell");
    assert!(sentence.contains(&wanted), "{sentence} for {wanted}");
}

#[test]
fn a_sensor_where_nothing_is_to_be_seen_is_noticed() {
    nothing_to_be_seen(FIRST);
}

fn nothing_to_be_seen(name: &str) {
    for (shares, is_refused) in [([0.1, 0.9], false), ([0.93, 0.98], true), ([0.1, 1.0], false)] {
        let (rig, mut random) = rig(name, 32);
        let places = shares.map(|share| share * rig.nominal.length_m());
        let sensors = rig.measure(places, count(name), &mut random);
        let error = refused_or_good(&rig, &sensors, [0.0; 2], &format!("{name} {shares:?}"));
        let not_carried = matches!(error, Some(CalibrateError::NotCarried { .. }));
        assert_eq!(not_carried, is_refused, "{name} {shares:?}: {error:?}");
    }
}

/// Places at which the true plate hardly moves at a frequency, beyond the near field of the driven end, metres.
fn nodes_m(rig: &Rig, frequency_hz: f64) -> Vec<f64> {
    let field: Vec<f64> = rig.fields(&[frequency_hz])[0].iter().map(|f| f.norm()).collect();
    let turning_m = rig.truth.turning_point_m(frequency_hz).expect("enters");
    let place_m = |i: usize| i as f64 * rig.truth.length_m() / (field.len() - 1) as f64;
    (field.len() / 16..field.len() - 1)
        .filter(|&i| field[i] < field[i - 1] && field[i] <= field[i + 1] && place_m(i) < turning_m)
        .map(place_m)
        .collect()
}

#[test]
fn a_sensor_at_a_node_is_refused_or_the_other_frequencies_carry_it() {
    node(FIRST);
}

fn node(name: &str) {
    let (rig, mut random) = rig(name, 35);
    let (low_hz, high_hz) = rig.nominal.band_hz();
    let mut refused = 0;
    for frequency_hz in [0.7, 0.9].map(|share| low_hz + share * (high_hz - low_hz)) {
        let nodes = nodes_m(&rig, frequency_hz);
        let (first, last) = (nodes[0], nodes[nodes.len() - 1]);
        assert!(last - first > 0.02, "{name}: {nodes:?}");
        let far_m = PLACES[1] * rig.nominal.length_m();
        for places in [[first, last], [first, far_m], [PLACES[0] * rig.nominal.length_m(), last]] {
            let sensors = rig.measure(places, count(name), &mut random);
            let error = refused_or_good(&rig, &sensors, [0.0; 2], &format!("{name} {places:?} m"));
            let is_allowed = matches!(error, None | Some(CalibrateError::NotCarried { .. }));
            assert!(is_allowed, "{name} {places:?}: {error:?}");
            refused += usize::from(error.is_some());
        }
    }
    println!("{name}: {refused} of 6 with a sensor at a node are refused");
    assert!(refused < 6, "{name}: a node at one frequency is none at the others");
}

#[test]
fn an_unplugged_a_clipped_and_an_exchanged_sensor_are_refused_by_name() {
    signals(FIRST);
}

fn signals(name: &str) {
    let (rig, mut random) = rig(name, 33);
    let sensors = measured(name, &rig, &mut random);

    let mut unplugged = sensors.clone();
    for point in &mut unplugged[1].points {
        point.response = Complex64::new(random.normal(), random.normal()) * point.noise;
    }
    let error = calibrated(&rig, &unplugged).expect_err("unplugged");
    assert!(matches!(error, CalibrateError::NoSignal { .. }), "{error}");

    let mut clipped = sensors.clone();
    let largest = clipped[0].points.iter().map(|point| point.response.norm()).fold(0.0, f64::max);
    for point in &mut clipped[0].points {
        let over = point.response.norm() / (0.4 * largest);
        point.response /= over.max(1.0);
        point.headroom_db = point.headroom_db.map(|_| -decibels(over));
    }
    let error = calibrated(&rig, &clipped).expect_err("clipped");
    assert!(matches!(error, CalibrateError::Clipped { .. }), "{error}");
    // A file by another program states no headroom.
    clipped[0].points.iter_mut().for_each(|point| point.headroom_db = None);
    let error = calibrated(&rig, &clipped).expect_err("clipped");
    assert!(matches!(error, CalibrateError::Unlike { .. }), "{error}");

    let [mut a, mut b] = sensors;
    std::mem::swap(&mut a.place_m, &mut b.place_m);
    let error = calibrated(&rig, &[a, b]).expect_err("exchanged");
    assert!(matches!(error, CalibrateError::Swapped { .. }), "{error}");
}

#[test]
fn the_file_of_another_plate_is_refused() {
    another_file(FIRST);
}

fn another_file(name: &str) {
    let other = |change: &dyn Fn(&mut PlateSpec)| {
        let (mut rig, mut random) = rig(name, 34);
        let sensors = measured(name, &rig, &mut random);
        let mut spec = rig.nominal.spec().clone();
        change(&mut spec);
        rig.nominal = Plate::new(spec).expect("valid");
        calibrated(&rig, &sensors).expect_err("another plate")
    };
    for factor in [0.8, 1.2] {
        let wider = other(&|spec| {
            if let Taper::Exponential { half_width_m, .. } = &mut spec.taper {
                *half_width_m *= factor;
            }
        });
        let steeper = other(&|spec| {
            if let Taper::Exponential { rate_per_m, .. } = &mut spec.taper {
                *rate_per_m *= factor;
            }
        });
        let faster = other(&|spec| {
            let plate = Plate::new(spec.clone()).expect("valid");
            *spec = plate.with_wave_speed(factor).expect("valid").spec().clone();
        });
        for error in [wider, steeper] {
            // A file 20 % wider than the plate looks like edges that give inward by millimetres.
            let is_seen = matches!(
                error,
                CalibrateError::Unlike { .. } | CalibrateError::NoFit | CalibrateError::EdgesGive { .. }
            );
            assert!(
                is_seen && !matches!(error, CalibrateError::EdgesGive { by_m } if by_m.abs() < 1e-3),
                "{name} {factor}: {error}"
            );
        }
        let CalibrateError::AnotherPlate { what: "wave speed", share } = faster else {
            panic!("{name} {factor}: {faster}")
        };
        assert!((share * factor - 1.0).abs() < 0.06, "{name} {factor}: {share}");
    }
}

#[test]
fn at_twenty_decibels_over_the_noise_the_stated_interval_is_wider_and_holds() {
    twenty_decibels(FIRST);
}

fn twenty_decibels(name: &str) {
    let mut accepted = 0;
    for seed in 40..44 {
        let (mut rig, mut random) = rig(name, seed);
        rig.snr_db = 20.0;
        let sensors = measured(name, &rig, &mut random);
        let error = refused_or_good(&rig, &sensors, [0.0; 2], &format!("{name} {seed} 20 dB"));
        let is_allowed = matches!(error, None | Some(CalibrateError::NotCarried { .. }));
        assert!(is_allowed, "{name} {seed}: {error:?}");
        accepted += usize::from(error.is_none());
    }
    assert!(accepted > 0, "{name}: all refused");
}

#[test]
#[ignore = "a second pass, on another preset: .ci/run statistics"]
fn mistakes_with_two_places_are_refused_or_reported_on_aluminium_too() {
    finger(SECOND);
    another_place(SECOND);
    nothing_to_be_seen(SECOND);
    node(SECOND);
    signals(SECOND);
    another_file(SECOND);
    twenty_decibels(SECOND);
}
