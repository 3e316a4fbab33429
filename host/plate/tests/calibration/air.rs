//! Light membranes in air whose mounting nobody knows: the air's coefficient is one more unknown of the calibration.

use super::calibrated;
use super::rig::{BOUNDARIES, Random, Rig, Solver};
use slipline_plate::calibrate::{
    CalibrateError, Calibrated, MeasuredPoint, Measurement, Placing, SensorKind, SensorPlaces,
};
use slipline_plate::{Air, AirMounting, Complex64, Faces, Gas, Plate, PlateSpec, preset};

/// Frequencies at which a plate is measured.
const POINTS: usize = 60;
/// Boundaries at which a plate in two dimensions is judged: each takes a tenth of a second.
const FEW: usize = 5;

fn with_air(plate: &Plate, air: Option<Air>) -> Plate {
    Plate::new(PlateSpec { air, ..plate.spec().clone() }).expect("a valid plate")
}

fn around(mounting: AirMounting) -> Option<Air> {
    Some(Air::Around { gas: Gas::ROOM, mounting, gap_m: None })
}

/// What a plate is solved with, the noise below its responses, dB, and whether tones whose answers are not clear are
/// measured for longer.
type Case = (Solver, f64, bool);
const USUAL: Case = (Solver::OneMode, 40.0, true);

/// A light membrane near the preset in air: in two dimensions in a baffle or in a bare frame, else by the law with some coefficient.
fn rig(number: u64, (solver, snr_db, averages): Case, random: &mut Random) -> Rig {
    let nominal = with_air(&preset("membrane").expect("a preset"), around(AirMounting::Unknown));
    let mut rig = Rig::of(nominal, solver, random);
    let alpha = random.factor(1.2, 2.2);
    let mounting = match solver {
        Solver::OneMode => AirMounting::Coefficient { alpha, faces: Faces::Two },
        Solver::TwoDimensions | Solver::Bar if number.is_multiple_of(2) => baffle(),
        Solver::TwoDimensions | Solver::Bar => AirMounting::BareFrame,
    };
    rig.truth = with_air(&rig.truth, around(mounting));
    (rig.snr_db, rig.averages) = (snr_db, averages);
    rig.boundaries = if solver == Solver::OneMode { BOUNDARIES } else { FEW };
    rig
}

fn measured(rig: &Rig, random: &mut Random) -> [Measurement; 2] {
    let placing = Placing { points: POINTS, ..Placing::default() };
    let places = SensorPlaces::of(&rig.nominal, &placing).expect("places");
    rig.measure(places.best.places_m, POINTS, random)
}

/// What became of one plate: the calibration, the error of the boundary in metres, the evenness of the level in dB.
fn judged(number: u64, case: Case) -> Result<(Calibrated, f64, f64), CalibrateError> {
    let mut random = Random::new(3000 + number);
    let rig = rig(number, case, &mut random);
    let found = calibrated(&rig, &measured(&rig, &mut random))?;
    let boundary_m = rig.errors(&found.plate).0;
    let level_db = rig.judge(&found.plate).level_db;
    let mounting = |plate: &Plate| plate.spec().air.and_then(|air| air.mounting());
    println!(
        "{number:2} boundary {:.2} (stated {:.2}) mm, level {level_db:.2} (stated {:.2}) dB, chi2/n {:.2}, misfit {:.3}: {:?} for {:?}",
        1e3 * boundary_m,
        1e3 * found.boundary_tolerance_m,
        found.level_tolerance_db,
        found.chi2_per_n,
        found.misfit,
        mounting(&found.plate),
        mounting(&rig.truth),
    );
    Ok((found, boundary_m, level_db))
}

/// Whether the stated intervals hold boundary and level.
fn holds((found, boundary_m, level_db): &(Calibrated, f64, f64)) -> bool {
    *boundary_m <= found.boundary_tolerance_m && *level_db <= found.level_tolerance_db
}

#[test]
fn a_light_membrane_in_air_of_unknown_mounting_is_calibrated() {
    let judged = judged(3, USUAL).expect("accepted");
    let (found, boundary_m, level_db) = &judged;
    assert!(*boundary_m < 1e-3 && *level_db < 0.5 && holds(&judged), "{boundary_m} m {level_db} dB");
    // The file has the air that was found, and the interval holds the true one.
    let plate = Plate::from_toml(&found.plate.to_toml()).expect("an ordinary plate file");
    assert_eq!(plate, found.plate);
    let Some(AirMounting::Calibrated { alpha, distant, .. }) =
        plate.spec().air.and_then(|air| air.mounting())
    else {
        panic!("{:?}", plate.spec().air);
    };
    let stated = |name: &str| found.parameters.iter().find(|it| it.name == name).expect("stated");
    let coefficient = stated("air.coefficient");
    assert!((coefficient.low..coefficient.high).contains(&alpha) && coefficient.value == alpha);
    assert!(distant.abs() < 0.1 && stated("air.distant_share").value == distant, "{distant}");
    assert_eq!(found.parameters.len(), 9, "{:?}", found.parameters);
}

/// What a sensor of this noise shows at two places of a plate, without codes: of 12 bits no noise is below 70 dB.
fn sensed(rig: &Rig, places_m: [f64; 2], count: usize, random: &mut Random) -> [Measurement; 2] {
    let frequencies = rig.frequencies_hz(count);
    let fields = rig.fields(&frequencies);
    places_m.map(|place_m| {
        let at = |field: &Vec<Complex64>| {
            let place = place_m / rig.truth.length_m() * (field.len() - 1) as f64;
            let (left, t) = (place as usize, place.fract());
            field[left] * (1.0 - t) + field[left + 1] * t
        };
        let seen: Vec<Complex64> = fields.iter().map(at).collect();
        let mean = seen.iter().map(Complex64::norm_sqr).sum::<f64>() / seen.len() as f64;
        let noise = mean.sqrt() * 10_f64.powf(-rig.snr_db / 20.0);
        let points = frequencies.iter().zip(&seen).map(|(&frequency_hz, seen)| MeasuredPoint {
            frequency_hz,
            response: seen + Complex64::new(random.normal(), random.normal()) * noise,
            noise,
            headroom_db: None,
        });
        Measurement::at(place_m, SensorKind::Displacement, points.collect())
    })
}

/// With less noise the valley of the true coefficient is narrower: a fit that starts with a pressure at a distance which the air
/// does not have fits noisy data and refuses clean ones.
#[test]
fn an_unknown_mounting_is_found_without_noise() {
    unknown_mounting_is_found(&[(70.0, AirMounting::BareFrame), (90.0, baffle())], 16);
}

fn unknown_mounting_is_found(cases: &[(f64, AirMounting)], count: usize) {
    for (number, &(snr_db, mounting)) in cases.iter().enumerate() {
        let nominal = preset("latex-membrane").expect("a preset");
        let nominal = with_air(&nominal, around(AirMounting::Unknown));
        let mut random = Random::new(3200 + number as u64);
        let mut rig = Rig::of(nominal, Solver::OneMode, &mut random);
        (rig.truth, rig.snr_db) = (with_air(&rig.truth, around(mounting)), snr_db);
        let sensors = sensed(&rig, [0.094, 0.198], count, &mut random);
        let found = calibrated(&rig, &sensors).unwrap_or_else(|error| panic!("{snr_db} dB: {error}"));
        let (boundary_m, _) = rig.errors(&found.plate);
        let stated_m = found.boundary_tolerance_m;
        println!("{snr_db} dB: chi2/n {:.3}, {boundary_m} m, {stated_m} m stated", found.chi2_per_n);
        assert!(found.chi2_per_n < 2.0 && boundary_m <= stated_m, "{snr_db} dB: {boundary_m} {stated_m}");
    }
}

fn baffle() -> AirMounting {
    on(Faces::Two)
}

#[test]
fn a_file_without_the_air_that_the_plate_is_in_is_refused_with_a_sentence_on_it() {
    let mut random = Random::new(3003);
    let mut rig = rig(3, USUAL, &mut random);
    let sensors = measured(&rig, &mut random);
    rig.nominal = with_air(&rig.nominal, None);
    let error = calibrated(&rig, &sensors).expect_err("no air");
    let CalibrateError::NoAir { shift_m } = error else { panic!("{error}") };
    assert!((0.02..0.04).contains(&shift_m), "{shift_m}");
    let sentence = error.to_string();
    assert!(sentence.contains("add a section [air] with mounting = \"unknown\""), "{sentence}");
}

/// Air on another number of faces, or round the edges, is not a coefficient of the file's air: such data are refused with the air
/// in which they fit, or the boundary is within the stated interval.
#[test]
fn data_of_other_air_than_the_files_are_refused_with_a_sentence_on_it() {
    other_air_is_refused(
        &[(on(Faces::One), on(Faces::Two), Some("faces = 1")), (on(Faces::Two), on(Faces::Two), None)],
        20,
    );
}

fn on(faces: Faces) -> AirMounting {
    AirMounting::Baffle { faces }
}

/// The actual mounting, that of the file, and what the refusal says; `None` where it is none.
type OtherAir = (AirMounting, AirMounting, Option<&'static str>);

fn other_air_is_refused(cases: &[OtherAir], count: usize) {
    for (number, &(truth, file, said)) in cases.iter().enumerate() {
        let nominal = with_air(&preset("membrane").expect("a preset"), around(file));
        let mut random = Random::new(3300 + number as u64);
        let mut rig = Rig::of(nominal, Solver::OneMode, &mut random);
        rig.truth = with_air(&rig.nominal.with_wave_speed(1.01).expect("valid"), around(truth));
        let sensors = sensed(&rig, [0.094, 0.198], count, &mut random);
        match (calibrated(&rig, &sensors), said) {
            (Ok(found), None) => assert!(rig.errors(&found.plate).0 <= found.boundary_tolerance_m),
            (Err(error), Some(said)) => {
                println!("{truth:?}, {file:?}: {error}");
                assert!(matches!(error, CalibrateError::OtherAir { .. }), "{error}");
                assert!(error.to_string().contains(said), "{error}");
            }
            (Ok(found), Some(_)) => panic!(
                "{truth:?}, {file:?}: {} m where {} m are stated, chi2/n {}, misfit {}",
                rig.errors(&found.plate).0,
                found.boundary_tolerance_m,
                found.chi2_per_n,
                found.misfit
            ),
            (Err(error), None) => panic!("{error}"),
        }
    }
}

/// Rubber 5 to 10 mm above a table, whose boundary that moves by 11 to 27 mm.
#[test]
fn a_membrane_above_a_table_is_calibrated_within_its_interval() {
    above_a_table(&[("latex-membrane", AirMounting::Unknown, 0.005)], 3401);
}

#[test]
#[ignore = "a second pass, of a frame that is known: .ci/run statistics"]
fn a_membrane_in_a_bare_frame_above_a_table_is_calibrated_within_its_interval() {
    above_a_table(&[("latex-membrane", AirMounting::BareFrame, 0.01)], 3400);
}

fn above_a_table(cases: &[(&str, AirMounting, f64)], first: u64) {
    for (number, &(name, mounting, gap_m)) in (first..).zip(cases) {
        let air = |gap_m: Option<f64>| Some(Air::Around { gas: Gas::ROOM, mounting, gap_m });
        let nominal = with_air(&preset(name).expect("a preset"), air(Some(gap_m)));
        let mut random = Random::new(number);
        let mut rig = Rig::of(nominal, Solver::OneMode, &mut random);
        let sensors = measured(&rig, &mut random);
        let found = calibrated(&rig, &sensors).unwrap_or_else(|error| panic!("{name} {gap_m}: {error}"));
        let (boundary_m, _) = rig.errors(&found.plate);
        println!(
            "{name} {mounting:?} {gap_m} m: boundary {:.2} (stated {:.2}) mm, chi2/n {:.2}",
            1e3 * boundary_m,
            1e3 * found.boundary_tolerance_m,
            found.chi2_per_n
        );
        assert!(boundary_m <= found.boundary_tolerance_m && boundary_m < 2e-3, "{name}: {boundary_m}");
        let Some(Air::Around { mounting: AirMounting::Calibrated { distant, .. }, gap_m: kept_m, .. }) =
            found.plate.spec().air
        else {
            panic!("{:?}", found.plate.spec().air);
        };
        assert_eq!((kept_m, distant), (Some(gap_m), 0.0));
        assert_eq!(Plate::from_toml(&found.plate.to_toml()).expect("an ordinary plate file"), found.plate);
        // A file that does not state the table: accepted it would be 3.3 mm off where 1.1 mm are stated.
        rig.nominal = with_air(&rig.nominal, air(None));
        let error = calibrated(&rig, &sensors).expect_err("a table");
        println!("{error}");
        assert!(matches!(error, CalibrateError::MoreAir { share } if share > 1.3), "{error}");
        assert!(error.to_string().contains("state its distance as gap_m in [air]"), "{error}");
    }
}

/// A plate that is faster than sound carries next to no air: its calibration is the same with an `[air]` and without.
#[test]
fn a_bending_plate_in_air_is_calibrated_as_without() {
    let mut random = Random::new(3100);
    let mut rig = Rig::new("al-bending", Solver::OneMode, &mut random);
    let sensors = super::measured("al-bending", &rig, &mut random);
    let without = calibrated(&rig, &sensors).expect("accepted");
    rig.nominal = with_air(&rig.nominal, Some(Air::ROOM));
    let with = calibrated(&rig, &sensors).expect("accepted");
    let (start, end) = rig.nominal.span_m();
    for i in 0..=8 {
        let place_m = start + (end - start) * f64::from(i) / 8.0;
        let frequency_hz = without.plate.frequency_for_boundary_hz(place_m);
        let there_m = with.plate.turning_point_m(frequency_hz).expect("enters");
        assert!((there_m - place_m).abs() < 2e-5, "{place_m} {there_m}");
    }
    assert!((with.level_tolerance_db - without.level_tolerance_db).abs() < 0.02);
    let level_db = |found: &Calibrated| rig.judge(&found.plate).level_db;
    assert!((level_db(&with) - level_db(&without)).abs() < 0.02);
}

#[test]
#[ignore = "a plate in two dimensions: .ci/run statistics"]
fn a_light_membrane_in_a_baffle_in_two_dimensions_is_calibrated() {
    let judged = judged(0, (Solver::TwoDimensions, 40.0, true)).expect("accepted");
    assert!(judged.1 < 1e-3 && judged.2 < 0.5 && holds(&judged), "{} m {} dB", judged.1, judged.2);
}

/// Every one of the twenty: statistics that take minutes.
mod night {
    use super::*;

    #[test]
    #[ignore = "four fits of ten seconds: .ci/run statistics"]
    fn an_unknown_mounting_is_found_with_any_noise() {
        let bare = AirMounting::BareFrame;
        unknown_mounting_is_found(&[(40.0, bare), (55.0, baffle()), (70.0, bare), (90.0, baffle())], 60);
    }

    #[test]
    #[ignore = "a fit of ten seconds: .ci/run statistics"]
    fn data_of_other_air_than_the_files_are_refused_in_every_mounting() {
        other_air_is_refused(
            &[
                (on(Faces::Two), on(Faces::One), Some("faces = 2")),
                (AirMounting::BareFrame, on(Faces::Two), Some("mounting = \"unknown\"")),
            ],
            40,
        );
    }

    /// How many of eight plates in two dimensions and twelve by the law are even within 0.5 dB.
    fn even_of_twenty((snr_db, averages): (f64, bool), within_db: f64) -> usize {
        let of =
            |solver: Solver, count: u64| (0..count).map(move |number| (number, (solver, snr_db, averages)));
        let all = of(Solver::TwoDimensions, 8).chain(of(Solver::OneMode, 12));
        let all: Vec<_> = all.map(|(number, case)| judged(number, case).expect("accepted")).collect();
        let worst = |of: fn(&(Calibrated, f64, f64)) -> f64| all.iter().map(of).fold(0.0, f64::max);
        let (boundary_m, level_db) = (worst(|it| it.1), worst(|it| it.2));
        assert!(boundary_m < 1e-3 && level_db < within_db, "{boundary_m} m {level_db} dB");
        let even = all.iter().filter(|it| it.2 < 0.5).count();
        let held = all.iter().filter(|it| holds(it)).count();
        println!("{even} even within 0.5 dB, {held} within the stated");
        assert!(held >= 19, "{held}");
        even
    }

    #[test]
    #[ignore = "twenty plates, eight in two dimensions: .ci/run statistics"]
    fn twenty_light_membranes_in_air_of_unknown_mounting_are_calibrated() {
        let even = even_of_twenty((40.0, true), 0.5);
        assert_eq!(even, 20);
    }

    #[test]
    #[ignore = "the same with one window and half of the noise: .ci/run statistics"]
    fn with_half_of_the_noise_eighteen_of_twenty_levels_are_even() {
        let even = even_of_twenty((46.0, false), 0.75);
        assert!(even >= 18, "{even}");
    }
}
