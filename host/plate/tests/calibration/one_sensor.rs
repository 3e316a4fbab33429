//! Calibration by one sensor, with the full model of the source.

use super::misuse::good_or_refused;
use super::rig::{Random, Rig, Solver, middle_and_worst};
use super::{MANY, count, within};
use slipline_plate::calibrate::{CalibrateError, Calibrated, Measurement, Priors, from_one_sensor};
use slipline_plate::{Complex64, DriveEnd, Finger, Impedance, Model, Plate};

/// Place of the sensor over the length.
const PLACE: f64 = 0.1;

fn measured(name: &str, rig: &Rig, random: &mut Random) -> Measurement {
    let [sensor] = rig.measure([PLACE * rig.nominal.length_m()], count(name), random);
    sensor
}

fn calibrated(rig: &Rig, sensor: &Measurement) -> Result<Calibrated, CalibrateError> {
    from_one_sensor(&rig.nominal, sensor, &Priors::default())
}

fn impedance(plate: &Plate) -> Impedance {
    match plate.spec().drive_end {
        DriveEnd::Source(source) => source.impedance,
        ref other => panic!("no source: {other:?}"),
    }
}

#[test]
fn one_sensor_puts_the_first_plates_right() {
    one_sensor(2);
}

#[test]
#[ignore = "many plates: .ci/run statistics"]
fn one_sensor_puts_boundary_and_level_right_and_finds_the_source() {
    one_sensor(20);
}

/// Calibrates `number` truths of each preset.
fn one_sensor(number: u64) {
    for (name, boundary_mm, level_db) in
        [("membrane", [0.6, 1.2], [0.6, 2.0]), ("al-bending", [0.4, 0.8], [0.6, 2.5])]
    {
        let (mut judged, mut sources_stated) = (Vec::new(), 0_u64);
        for seed in 0..number {
            let mut random = Random::new(seed);
            let rig = Rig::new(name, Solver::OneMode, &mut random);
            let sensor = measured(name, &rig, &mut random);
            let found = calibrated(&rig, &sensor).unwrap_or_else(|error| panic!("{name} {seed}: {error}"));
            let plate = Plate::from_toml(&found.plate.to_toml()).expect("an ordinary plate file");
            assert_eq!(plate, found.plate);
            let after = rig.judge(&plate);
            assert!(after.boundary_m < 1.5 * found.boundary_tolerance_m, "{name} {seed}: {after:?}");
            assert!(after.level_db < 1.5 * found.level_tolerance_db.max(0.5), "{name} {seed}: {after:?}");
            let truth = impedance(&rig.truth);
            sources_stated += u64::from(
                within(&found, "drive.resistance_n_s_per_m", truth.resistance_n_s_per_m)
                    && within(&found, "drive.mass_kg", truth.mass_kg)
                    && within(&found, "delay_s", rig.delay_s),
            );
            judged.push(after);
        }
        let boundary = middle_and_worst(judged.iter().map(|it| 1e3 * it.boundary_m).collect());
        let level = middle_and_worst(judged.iter().map(|it| it.level_db).collect());
        println!(
            "{name}: {boundary:?} mm, {level:?} dB; the source is stated for {sources_stated} of {number}"
        );
        assert!(boundary.1 <= boundary_mm[1] && level.1 <= level_db[1], "{name}: {boundary:?} {level:?}");
        if number >= MANY {
            assert!(boundary.0 <= boundary_mm[0] && level.0 <= level_db[0], "{name}: {boundary:?} {level:?}");
        }
        assert!(20 * sources_stated >= 17 * number, "{name}: {sources_stated} of {number}");
    }
}

/// Plates that swing as membranes do.
const MEMBRANES: [&str; 4] = ["membrane", "latex-membrane", "membrane-heavy", "tungsten-membrane"];

/// A membrane near a preset with the sensor anywhere up to 60 % of the length, its mark off by what its tolerance says.
struct Anywhere {
    name: &'static str,
    place_m: f64,
    off_m: f64,
    found: Result<Calibrated, CalibrateError>,
    boundary_m: f64,
    level_db: f64,
}

impl Anywhere {
    fn of(seed: u64, solver: Solver) -> Self {
        let mut random = Random::new(5000 + seed);
        let name = MEMBRANES[seed as usize % MEMBRANES.len()];
        let rig = Rig::new(name, solver, &mut random);
        let place_m = random.factor(0.012, 0.5 * rig.nominal.length_m());
        let [mut sensor] = rig.measure([place_m], 100, &mut random);
        let off_m = sensor.place_tolerance_m * random.normal();
        sensor.place_m += off_m;
        let found = calibrated(&rig, &sensor);
        let judged = found.as_ref().map(|found| rig.judge(&found.plate)).ok();
        let (boundary_m, level_db) = judged.map_or((f64::NAN, f64::NAN), |it| (it.boundary_m, it.level_db));
        let it = Self { name, place_m, off_m, found, boundary_m, level_db };
        println!("{seed:3} {}", it.words());
        it
    }

    fn words(&self) -> String {
        let Self { name, place_m, off_m, .. } = self;
        let at = format!("{name} at {:.1} mm, mark {:+.2} mm", 1e3 * place_m, 1e3 * off_m);
        match &self.found {
            Ok(found) => format!(
                "{at}: boundary {:.2} (stated {:.2}, {:.2}) mm, level {:.2} (stated {:.2}) dB, chi2/n {:.2}, place {:+.2} mm",
                1e3 * self.boundary_m,
                1e3 * found.boundary_tolerance_m,
                self.boundary_m / found.boundary_tolerance_m,
                self.level_db,
                found.level_tolerance_db,
                found.chi2_per_n,
                1e3 * (found
                    .parameters
                    .iter()
                    .find(|it| it.name == "place_m")
                    .map_or(f64::NAN, |it| it.value)
                    - self.place_m
                    - self.off_m)
            ),
            Err(error) => format!("{at}: {error}"),
        }
    }
}

#[test]
#[ignore = "many plates: .ci/run statistics"]
fn one_sensor_anywhere_on_a_membrane_is_within_its_interval_or_refused() {
    anywhere(0..17, Solver::OneMode);
}

#[test]
#[ignore = "many plates: .ci/run statistics"]
fn one_sensor_anywhere_on_a_membrane_in_two_dimensions_is_within_its_interval_or_refused() {
    // That in air takes a minute.
    anywhere((0..20).filter(|seed| seed % 4 != 1), Solver::TwoDimensions);
}

/// A bar moves the whole width of the end alike, and with it the third width mode by a third of the first.
#[test]
#[ignore = "many plates: .ci/run statistics"]
fn one_sensor_anywhere_on_a_membrane_that_a_bar_moves_is_within_its_interval_or_refused() {
    // Without air, and of an exponential taper.
    anywhere((0..14).map(|i| 2 * i), Solver::Bar);
}

/// Its actuator resonates at the lower end of the band, so that most of the upper half is noise: with that counted as a misfit no start of
/// the search was followed, and good data were refused.
#[test]
fn one_sensor_behind_an_actuator_that_resonates_below_the_band_is_accepted() {
    let it = Anywhere::of(10, Solver::OneMode);
    let found = it.found.as_ref().unwrap_or_else(|error| panic!("{error}"));
    assert!(it.boundary_m < found.boundary_tolerance_m && found.chi2_per_n < 1.5, "{}", it.words());
}

/// What the third width mode adds near the driven end is in the intervals: in two dimensions the level was 0.77 dB off at 25 mm where
/// 0.40 was stated, and 0.51 dB at 34 mm where 0.36 was.
#[test]
#[ignore = "many plates: .ci/run statistics"]
fn one_sensor_near_the_driven_end_in_two_dimensions_is_within_its_intervals() {
    near_the_end(&[(6, Solver::TwoDimensions), (18, Solver::TwoDimensions)]);
}

/// A bar moves the whole width of the end alike: the boundary was 1.20 mm off where 0.94 was stated, and with the third width mode as
/// noise alone the level was 1.5 and 1.4 dB off at 25 and 16 mm where 0.9 were.
#[test]
fn one_sensor_on_a_membrane_that_a_bar_moves_is_within_its_intervals() {
    near_the_end(&[(4, Solver::Bar)]);
}

#[test]
#[ignore = "two more membranes: .ci/run statistics"]
fn one_sensor_on_two_more_membranes_that_a_bar_moves_is_within_its_intervals() {
    near_the_end(&[(16, Solver::Bar), (26, Solver::Bar)]);
}

#[test]
fn a_refusal_beside_a_bar_says_where_to_put_the_sensor() {
    let error = Anywhere::of(22, Solver::Bar).found.expect_err("refused");
    let CalibrateError::UnlikeNearEnd { place_m, nearest_m, .. } = error else { panic!("{error}") };
    assert!(place_m < 0.024 && nearest_m > 0.08, "{error}");
    assert!(
        error.to_string().contains("the sensor at 23.2 mm") && error.to_string().contains("or beyond"),
        "{error}"
    );
}

fn near_the_end(plates: &[(u64, Solver)]) {
    for &(seed, solver) in plates {
        let it = Anywhere::of(seed, solver);
        let found = it.found.as_ref().unwrap_or_else(|error| panic!("{error}"));
        assert!(it.boundary_m < found.boundary_tolerance_m, "{solver:?} {}", it.words());
        assert!(it.level_db < found.level_tolerance_db, "{solver:?} {}", it.words());
    }
}

fn anywhere(seeds: impl Iterator<Item = u64>, solver: Solver) {
    let all: Vec<Anywhere> = seeds.map(|seed| Anywhere::of(seed, solver)).collect();
    let accepted = all.iter().filter_map(|it| Some((it.boundary_m, it.found.as_ref().ok()?)));
    let shares: Vec<f64> = accepted.map(|(off_m, found)| off_m / found.boundary_tolerance_m).collect();
    let within = shares.iter().filter(|share| **share <= 1.0).count();
    let is_level =
        |it: &&Anywhere| it.found.as_ref().is_ok_and(|found| it.level_db <= found.level_tolerance_db);
    let levels = all.iter().filter(is_level).count();
    println!(
        "{solver:?}: {} of {} accepted, {within} within, the level of {levels}",
        shares.len(),
        all.len()
    );
    assert!(10 * shares.len() >= 9 * all.len() && 20 * within >= 19 * shares.len(), "{shares:.2?}");
    assert!(10 * levels >= 9 * shares.len(), "the level of {levels}");
}

#[test]
fn mistakes_with_one_sensor_are_refused_or_reported() {
    misuse(&["membrane"]);
}

#[test]
#[ignore = "a second pass, on another preset: .ci/run statistics"]
fn mistakes_with_one_sensor_are_refused_or_reported_on_aluminium_too() {
    misuse(&["al-bending"]);
}

fn misuse(presets: &[&str]) {
    for &name in presets {
        let mut random = Random::new(50);
        let rig = Rig::new(name, Solver::OneMode, &mut random);
        let sensor = measured(name, &rig, &mut random);
        let refusal = |rig: &Rig, sensor: &Measurement, moved_m: f64, what: &str| {
            good_or_refused(rig, calibrated(rig, sensor), &[moved_m], &format!("{name} {what}"))
        };
        assert_eq!(refusal(&rig, &sensor, 0.0, "as it should be"), None);
        for moved_m in [1e-3, -1e-3, 1e-2, -1e-2] {
            let [mut moved] = rig.measure([sensor.place_m + moved_m], count(name), &mut random);
            moved.place_m = sensor.place_m;
            let error = refusal(&rig, &moved, moved_m, "moved");
            assert_eq!(error.is_some(), f64::abs(moved_m) > 5e-3, "{name} {moved_m}: {error:?}");
        }
        let mut unplugged = sensor.clone();
        for point in &mut unplugged.points {
            point.response = Complex64::new(random.normal(), random.normal()) * point.noise;
        }
        let error = calibrated(&rig, &unplugged).expect_err("unplugged");
        assert!(matches!(error, CalibrateError::NoSignal { .. }), "{error}");
        let largest = sensor.points.iter().map(|point| point.response.norm()).fold(0.0, f64::max);
        let mut clipped = sensor.clone();
        for point in &mut clipped.points {
            let over = point.response.norm() / (0.4 * largest);
            point.response /= over.max(1.0);
            point.headroom_db = None;
        }
        let error = calibrated(&rig, &clipped).expect_err("clipped");
        // At a tenth of the length it is within reach of the third width mode, which may be the cause as well.
        assert!(matches!(error, CalibrateError::UnlikeNearEnd { .. } | CalibrateError::NoFit), "{error}");
        let mut another = rig.clone();
        another.nominal = rig.nominal.with_wave_speed(1.2).expect("valid");
        let error = calibrated(&another, &sensor).expect_err("another plate");
        assert!(matches!(error, CalibrateError::AnotherPlate { .. }), "{error}");
        let firm = Finger { resistance_n_s_per_m: 1.0, mass_kg: 1e-4, ..Finger::light(0.12) };
        let touched = Rig { finger: Some(firm), ..rig.clone() };
        let [under_finger] = touched.measure([sensor.place_m], 60, &mut random);
        let error = refusal(&touched, &under_finger, 0.0, "finger");
        assert!(error.is_some() || name == "al-bending", "a finger goes unnoticed on {name}");
    }
}

#[test]
fn a_membrane_without_a_tension_has_no_source_that_could_be_fitted() {
    let mut random = Random::new(1);
    let mut rig = Rig::new("membrane", Solver::OneMode, &mut random);
    let sensor = measured("membrane", &rig, &mut random);
    let mut spec = rig.nominal.spec().clone();
    if let Model::Membrane { tension_n_per_m, .. } = &mut spec.model {
        *tension_n_per_m = None;
    }
    rig.nominal = Plate::new(spec).expect("valid");
    let error = calibrated(&rig, &sensor).expect_err("no tension").to_string();
    assert!(error.contains("model.tension_n_per_m"), "{error}");
}
