//! A plate whose numbers are wrong by some per cent is measured and calibrated; the table of the calibrated plate
//! file drives the true plate.

mod air;
mod bar;
mod drive_check;
mod edges;
mod foreign;
mod levels;
mod misuse;
mod one_sensor;
mod promise;
pub(crate) mod rig;
mod shunt;
mod touches;
mod trim;
mod wave;
mod weight;

use rig::{Judgement, Random, Rig, Solver, middle_and_worst};
use slipline_plate::calibrate::{CalibrateError, Calibrated, Measurement, Priors, from_ratio};
use slipline_plate::{Film, Model, Plate, preset};

/// Shares of the length at which the sensor stands.
const PLACES: [f64; 2] = [0.1, 0.55];

/// Of this many plates the median is held to its limit, too; of fewer the worst alone.
const MANY: u64 = 10;

/// Frequencies that suffice.
fn count(name: &str) -> usize {
    if name == "membrane" { 60 } else { 150 }
}

fn measured(name: &str, rig: &Rig, random: &mut Random) -> [Measurement; 2] {
    rig.measure(PLACES.map(|share| share * rig.nominal.length_m()), count(name), random)
}

pub(crate) fn calibrated(rig: &Rig, sensors: &[Measurement; 2]) -> Result<Calibrated, CalibrateError> {
    from_ratio(&rig.nominal, [&sensors[0], &sensors[1]], &Priors::default())
}

/// Whether the stated interval of a parameter holds the true value.
pub(crate) fn within(found: &Calibrated, name: &str, value: f64) -> bool {
    let told = found.parameters.iter().find(|parameter| parameter.name == name).expect(name);
    (told.low..=told.high).contains(&value)
}

/// Calibrates truths of a preset; returns what the tables do before and after.
fn truths(name: &str, solver: Solver, number: u64) -> Vec<[Judgement; 2]> {
    let run = |seed: u64| {
        let mut random = Random::new(seed);
        let rig = Rig::new(name, solver, &mut random);
        let sensors = measured(name, &rig, &mut random);
        let found = calibrated(&rig, &sensors).unwrap_or_else(|error| panic!("{name} {seed}: {error}"));
        let file = found.plate.to_toml();
        let plate = Plate::from_toml(&file).expect("an ordinary plate file");
        assert_eq!(plate, found.plate);
        // The stated interval of the boundary must hold: 95 % of all truths, and none far beyond.
        let [before, after] = [&rig.nominal, &plate].map(|plate| rig.judge(plate));
        if solver == Solver::OneMode {
            assert!(after.boundary_m < 1.5 * found.boundary_tolerance_m, "{name} {seed}: {after:?}");
        }
        [before, after]
    };
    (0..number).map(run).collect()
}

fn figures(judged: &[[Judgement; 2]], which: usize) -> [(f64, f64); 2] {
    [
        middle_and_worst(judged.iter().map(|both| 1e3 * both[which].boundary_m).collect()),
        middle_and_worst(judged.iter().map(|both| both[which].level_db).collect()),
    ]
}

/// Calibrates `number` truths of both presets.
fn ratio(number: u64) {
    for name in ["membrane", "al-bending"] {
        let judged = truths(name, Solver::OneMode, number);
        let [before, after] = [0, 1].map(|which| figures(&judged, which));
        println!("{name}: mm and dB, median and worst: {before:?} -> {after:?}");
        let [(boundary_mm, worst_mm), (level_db, worst_db)] = after;
        assert!(worst_mm <= 1.0 && worst_db <= 2.0, "{name}: {after:?}");
        if number >= MANY {
            // 0.2 mm where how far the edges give is known.
            assert!(boundary_mm <= 0.3 && level_db <= 0.5, "{name}: {after:?}");
            assert!(before[0].0 > 1.0 && before[1].0 > 2.0, "{name}: {before:?}");
        }
    }
}

#[test]
fn the_ratio_of_two_places_puts_the_first_plates_right() {
    ratio(3);
}

#[test]
#[ignore = "many plates: .ci/run statistics"]
fn the_ratio_of_two_places_puts_boundary_and_level_right() {
    ratio(20);
}

#[test]
fn a_plate_in_two_dimensions_is_calibrated_by_the_one_mode_equation() {
    two_dimensions(&[("membrane", 1)]);
}

#[test]
fn plates_in_two_dimensions_are_calibrated_by_the_one_mode_equation() {
    two_dimensions(&[("membrane", 4), ("al-bending", 1)]);
}

/// Polyester of 50 um in place of the sheet of the preset `membrane`.
pub(crate) fn film() -> Plate {
    let mut spec = preset("membrane").expect("a preset").spec().clone();
    let film = Film { youngs_modulus_pa: 4.5e9, poisson_ratio: 0.38, thickness_m: 50e-6 };
    spec.model = Model::Membrane {
        wave_speed_m_per_s: 12.0,
        tension_n_per_m: Some(1390.0 * 50e-6 * 144.0),
        film: Some(film),
    };
    Plate::new(spec).expect("a plate")
}

/// Calibrates `number` truths near a film; the new file keeps the film and has another tension.
fn films(solver: Solver, number: u64) {
    for seed in 0..number {
        let mut random = Random::new(seed);
        let rig = Rig::of(film(), solver, &mut random);
        let found = calibrated(&rig, &measured("membrane", &rig, &mut random)).expect("a fit");
        let plate = Plate::from_toml(&found.plate.to_toml()).expect("an ordinary plate file");
        assert_eq!(plate.spec().model.film(), film().spec().model.film());
        let [before, after] = [&rig.nominal, &plate].map(|plate| rig.judge(plate));
        println!("{seed}: {before:?} -> {after:?}");
        assert!(after.boundary_m < 1e-3 && after.level_db < 1.0, "{seed}: {before:?} {after:?}");
    }
}

#[test]
fn a_film_is_calibrated_with_its_stiffness() {
    films(Solver::OneMode, 1);
}

#[test]
#[ignore = "many plates: .ci/run statistics"]
fn films_in_two_dimensions_are_calibrated_by_the_one_mode_equation() {
    films(Solver::TwoDimensions, 4);
}

fn two_dimensions(presets: &[(&str, u64)]) {
    for &(name, number) in presets {
        let judged = truths(name, Solver::TwoDimensions, number);
        let [(_, worst_mm), (_, worst_db)] = figures(&judged, 1);
        assert!(worst_mm <= 0.5 && worst_db <= 1.0, "{name}: {worst_mm} mm {worst_db} dB");
    }
}
