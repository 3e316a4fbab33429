//! Plates whose edges give, by up to half a millimetre: delta is one more unknown of the calibration, and a plan counts it.
//!
//! Clamped plates are solved in two dimensions with edges that turn against springs of D/(c h) per length, which have no delta of
//! their own.

use super::rig::{Random, Rig, Solver};
use super::{calibrated, within};
use slipline_plate::calibrate::{
    CalibrateError, Calibrated, Measurement, Placing, Priors, SensorPlaces, from_checked_ratio, from_ratio,
};
use slipline_plate::{Plate, PlateSpec, preset};

/// Frequencies at which a plate is measured.
const POINTS: usize = 100;
/// Boundaries at which a plate is judged.
const FEW: usize = 9;
/// A standard deviation of delta that holds it, metres.
const HELD: f64 = 1e-9;

fn clamped() -> Plate {
    Plate::from_toml(include_str!("../edges/clamp_gives_nominal.toml")).expect("a plate")
}

const KINDS: [&str; 4] = ["membrane", "tungsten-membrane", "al-bending", "clamped"];

fn nominal(kind: &str) -> Plate {
    if kind == "clamped" { clamped() } else { preset(kind).expect("a preset") }
}

/// The same plate with other edges.
fn with_edges(plate: &Plate, give_m: Option<f64>, tolerance_m: Option<f64>) -> Plate {
    let spec = PlateSpec { edge_give_m: give_m, edge_give_tolerance_m: tolerance_m, ..plate.spec().clone() };
    Plate::new(spec).expect("a plate")
}

/// A truth near the nominal plate whose edges give by `give_m`.
fn rig(kind: &str, give_m: f64, random: &mut Random) -> Rig {
    let nominal = nominal(kind);
    let is_clamped = nominal.spec().model.is_clamped();
    let solver = if is_clamped { Solver::TwoDimensions } else { Solver::OneMode };
    let mut rig = Rig::of(nominal, solver, random);
    rig.boundaries = FEW;
    if is_clamped {
        rig.edge_compliance_m = give_m;
    } else {
        rig.truth = with_edges(&rig.truth, Some(give_m), None);
    }
    rig
}

fn planned(nominal: &Plate) -> SensorPlaces {
    SensorPlaces::of(nominal, &Placing { points: POINTS, ..Placing::default() }).expect("places")
}

/// What a sensor shows at these places, in the band that the calibration needs: edges that give by half a millimetre take it beyond
/// the one of the file, and the refusal says what to measure.
fn measured(rig: &mut Rig, places_m: [f64; 2], random: &mut Random) -> [Measurement; 2] {
    let sensors = rig.measure(places_m, POINTS, random);
    let Err(CalibrateError::NotCovered { measured_hz, needed_hz }) = calibrated(rig, &sensors) else {
        return sensors;
    };
    rig.measured_hz = (measured_hz.0.min(0.97 * needed_hz.0), measured_hz.1.max(1.03 * needed_hz.1));
    rig.measure(places_m, POINTS, random)
}

/// One secret plate: delta, the calibration, the error of its boundary, and the stated interval where delta is held; metres.
struct Outcome {
    give_m: f64,
    found: Result<Calibrated, CalibrateError>,
    boundary_m: f64,
    held_m: Option<f64>,
}

impl Outcome {
    fn of(kind: &str, number: u64) -> Self {
        let mut random = Random::new(7000 + number);
        let give_m = if number.is_multiple_of(5) { 0.0 } else { random.within(0.0, 5e-4) };
        // 0.5 mm of delta is c = 0.6 of the clamped plate.
        let mut rig = rig(kind, give_m, &mut random);
        let places_m = planned(&rig.nominal).best.places_m;
        let sensors = measured(&mut rig, places_m, &mut random);
        let found = calibrated(&rig, &sensors);
        let boundary_m = found.as_ref().map_or(f64::NAN, |found| rig.errors(&found.plate).0);
        let held = || {
            let priors = Priors { edge_give_m: Some(HELD), ..Priors::default() };
            let held = from_ratio(&rig.nominal, [&sensors[0], &sensors[1]], &priors);
            held.ok().map(|held| held.boundary_tolerance_m)
        };
        let held_m = if give_m == 0.0 { held() } else { None };
        let outcome = Self { give_m, found, boundary_m, held_m };
        println!("{kind} {number} at {places_m:.3?}: {}", outcome.words());
        outcome
    }

    fn words(&self) -> String {
        let give_mm = 1e3 * self.give_m;
        match &self.found {
            Ok(found) => format!(
                "delta {give_mm:.3}, found {:.3} +- {:.3}; boundary {:.2} (stated {:.2}) mm, chi2/n {:.2}, held {:.2?}",
                1e3 * found.plate.spec().edge_give_m.unwrap_or(0.0),
                1e3 * found.plate.spec().edge_give_tolerance_m.unwrap_or(0.0),
                1e3 * self.boundary_m,
                1e3 * found.boundary_tolerance_m,
                found.chi2_per_n,
                self.held_m.map(|held_m| 1e3 * held_m),
            ),
            Err(error) => format!("delta {give_mm:.3}: {error}"),
        }
    }
}

#[test]
fn plates_whose_edges_give_are_calibrated_within_their_intervals() {
    // The others at night.
    for (number, kind) in (1..).zip(KINDS).skip(2).take(1) {
        let outcome = Outcome::of(kind, number);
        let found = outcome.found.as_ref().unwrap_or_else(|error| panic!("{kind}: {error}"));
        assert!(outcome.boundary_m < 1.2 * found.boundary_tolerance_m, "{kind}: {}", outcome.words());
        assert!(
            kind == "clamped" || within(found, "edge_give_m", outcome.give_m),
            "{kind}: {}",
            outcome.words()
        );
        let stated_m = found.plate.spec().edge_give_tolerance_m.expect("stated");
        assert!((1e-5..6.2e-4).contains(&stated_m), "{kind}: {stated_m}");
    }
}

/// Edges of unknown compliance widen the planned interval by a fifth at most, between clamped edges by 35 %.
#[test]
fn a_planned_interval_grows_by_a_fifth_at_most_with_edges_that_nobody_knows() {
    for (kind, most) in
        [("membrane", 1.2), ("tungsten-membrane", 1.2), ("al-bending", 1.2), ("clamped", 1.35)]
    {
        let nominal = nominal(kind);
        let places = planned(&nominal);
        let known = planned(&with_edges(&nominal, None, Some(0.0)));
        let held = known.reach(places.best.places_m).expect("reached");
        let share = places.best.boundary_tolerance_m / held.boundary_tolerance_m;
        println!("{kind}: {share:.3} times as wide at {:.3?}", places.best.places_m);
        assert!((1.0..most).contains(&share), "{kind}: {share}");
    }
}

/// The stated interval with delta open over that with delta held, of the same data, and the most that row 2 of issue 50 allows.
const LOST: [(&str, f64); 4] =
    [("membrane", 1.2), ("tungsten-membrane", 1.2), ("al-bending", 1.2), ("clamped", 1.35)];

/// That share of a plate near the nominal one whose edges do not give, behind the drive of its file.
fn lost_by_edges(kind: &str, number: u64) -> f64 {
    let mut random = Random::new(7300 + number);
    let mut rig = rig(kind, 0.0, &mut random).with_stated_drive();
    let places_m = planned(&rig.nominal).best.places_m;
    let sensors = measured(&mut rig, places_m, &mut random);
    let fitted = |edge_give_m: Option<f64>| {
        let priors = Priors { edge_give_m, ..Priors::default() };
        from_ratio(&rig.nominal, [&sensors[0], &sensors[1]], &priors)
            .unwrap_or_else(|error| panic!("{kind} {number}: {error}"))
    };
    let (open, held) = (fitted(None), fitted(Some(HELD)));
    let share = open.boundary_tolerance_m / held.boundary_tolerance_m;
    println!(
        "{kind} {number}: {:.3} over {:.3} mm is {share:.3}, chi2/n {:.2} and {:.2}",
        1e3 * open.boundary_tolerance_m,
        1e3 * held.boundary_tolerance_m,
        open.chi2_per_n,
        held.chi2_per_n
    );
    share
}

#[test]
fn edges_that_nobody_knows_take_a_fifth_of_the_interval_of_the_same_data_at_most() {
    let (kind, most) = LOST[0];
    let share = lost_by_edges(kind, 0);
    assert!((0.95..=most).contains(&share), "{kind}: {share}");
}

#[test]
fn a_plan_for_a_clamped_plate_has_places_that_see_whether_its_edges_give() {
    let nominal = clamped();
    let places = planned(&nominal);
    let with = |places_m: [f64; 2]| places.reach(places_m).expect("reached").boundary_tolerance_m;
    // The places that were planned as long as no edge gave, and a pair that sees it.
    let (blind_m, seeing_m) = (with([0.109, 0.139]), with([0.109, 0.185]));
    let best = places.best;
    println!("blind {blind_m}, seeing {seeing_m}, best {best:?}");
    assert!(blind_m > 1.4 * seeing_m, "{blind_m} {seeing_m}");
    let apart_m = best.places_m[1] - best.places_m[0];
    assert!(best.boundary_tolerance_m < 1.2 * seeing_m && apart_m > 0.07, "{best:?}");
    // Who knows the edges plans without them.
    let known = planned(&with_edges(&nominal, None, Some(0.0)));
    let known_m = known.reach([0.109, 0.139]).expect("reached").boundary_tolerance_m;
    println!("known {known_m}, best {:?}", known.best);
    assert!(known_m < 0.7 * blind_m, "{known_m} {blind_m}");
    assert!((known.best.places_m[1] - 0.139).abs() < 2e-3, "{:?}", known.best);
}

#[test]
#[ignore = "a quarter of a minute of one core: .ci/run statistics"]
fn a_third_place_shows_edges_that_give_which_two_places_do_not_see() {
    let mut random = Random::new(7101);
    let rig = rig("clamped", 0.5 * 8e-4, &mut random);
    let [near, far, check] = rig.measure([0.109, 0.139, 0.185], POINTS, &mut random);
    let checked = |plate: &Plate| from_checked_ratio(plate, [&near, &far], &check, &Priors::default());
    // Of a file that is sure of its edges, as every file was, the third place refuses, and the sentence says why.
    let sure = with_edges(&rig.nominal, None, Some(1e-4));
    let blind = from_ratio(&sure, [&near, &far], &Priors::default()).expect("accepted");
    let off_m = rig.errors(&blind.plate).0;
    assert!(off_m > 1.5 * blind.boundary_tolerance_m, "{off_m} {}", blind.boundary_tolerance_m);
    let error = checked(&sure).expect_err("refused").to_string();
    println!("blind {off_m} of {}, {error}", blind.boundary_tolerance_m);
    assert!(error.contains("the edges give by about"), "{error}");
    // Of a file that does not state them two places are refused, and the third takes the place of the nearer one.
    let two = from_ratio(&rig.nominal, [&near, &far], &Priors::default()).expect_err("open");
    assert!(matches!(two, CalibrateError::EdgesUnseen { .. }), "{two}");
    let found = checked(&rig.nominal).expect("accepted");
    let (off_m, stated_m) = (rig.errors(&found.plate).0, found.boundary_tolerance_m);
    println!("checked {off_m} of {stated_m}");
    assert!(off_m <= stated_m && stated_m < 1e-3, "{off_m} {stated_m}");
}

#[test]
#[ignore = "three calibrations; the instrument checks one by a third place: .ci/run statistics"]
fn a_third_place_widens_the_interval_of_a_plate_or_leaves_it() {
    let mut random = Random::new(7102);
    let rig = rig("al-bending", 2.5e-4, &mut random);
    let [first_m, second_m] = planned(&rig.nominal).best.places_m;
    let [near, far, check] =
        rig.measure([first_m, second_m, 0.5 * (first_m + second_m)], POINTS, &mut random);
    let two = from_ratio(&rig.nominal, [&near, &far], &Priors::default()).expect("accepted");
    let three =
        from_checked_ratio(&rig.nominal, [&near, &far], &check, &Priors::default()).expect("accepted");
    assert!(three.boundary_tolerance_m >= two.boundary_tolerance_m);
    assert!(rig.errors(&three.plate).0 <= three.boundary_tolerance_m);
    // A third sensor 10 mm from its mark shows another plate.
    let moved = Measurement { place_m: check.place_m + 0.01, ..check };
    let error =
        from_checked_ratio(&rig.nominal, [&near, &far], &moved, &Priors::default()).expect_err("refused");
    println!("{} {} {error}", two.boundary_tolerance_m, three.boundary_tolerance_m);
}

/// `al-bending` whose edges give by a quarter and by half a millimetre was refused ("is it the right file?"), as was `membrane` with
/// one millimetre.
#[test]
#[ignore = "six calibrations far from their files: .ci/run statistics"]
fn edges_that_give_far_are_found_and_those_that_give_by_millimetres_are_refused_by_how_far() {
    for (kind, give_m) in [("al-bending", 2.5e-4), ("al-bending", 5e-4), ("membrane", 1e-3)] {
        let mut random = Random::new(7200);
        let mut rig = rig(kind, give_m, &mut random);
        let places_m = planned(&rig.nominal).best.places_m;
        let sensors = measured(&mut rig, places_m, &mut random);
        let found = calibrated(&rig, &sensors).unwrap_or_else(|error| panic!("{kind} {give_m}: {error}"));
        let (off_m, stated_m) = (rig.errors(&found.plate).0, found.boundary_tolerance_m);
        println!("{kind} {give_m}: {off_m} of {stated_m}, chi2 {:.2}", found.chi2_per_n);
        assert!(off_m < stated_m && within(&found, "edge_give_m", give_m), "{kind}: {:?}", found.parameters);
    }
    // From edges that do not give no valley leads to this one.
    let narrow = Outcome::of("al-bending", 8);
    assert!(narrow.give_m > 4.5e-4 && narrow.found.is_ok(), "{}", narrow.words());
    let mut random = Random::new(7200);
    let rig = rig("membrane", 3e-3, &mut random);
    let sensors = rig.measure(planned(&rig.nominal).best.places_m, POINTS, &mut random);
    let error = calibrated(&rig, &sensors).expect_err("too far");
    let CalibrateError::EdgesGive { by_m } = error else { panic!("{error}") };
    assert!((by_m / 3e-3 - 1.0).abs() < 0.2, "{by_m}");
    assert!(error.to_string().starts_with("the edges give by about "), "{error}");
    // Stated in the file, the same data are accepted.
    let stated = Rig { nominal: with_edges(&rig.nominal, Some(by_m), None), ..rig.clone() };
    let found = calibrated(&stated, &sensors).expect("accepted");
    let off_m = rig.errors(&found.plate).0;
    assert!(off_m < 1.2 * found.boundary_tolerance_m, "{off_m} {}", found.boundary_tolerance_m);
}

/// The largest distance of the boundaries of two plates at one frequency, metres.
fn apart_m(plate: &Plate, other: &Plate) -> f64 {
    let off = |place_m: f64| {
        let frequency_hz = plate.frequency_for_boundary_hz(place_m);
        (other.turning_point_m(frequency_hz).expect("enters") - place_m).abs()
    };
    (0..FEW).map(|i| off(0.1 + 0.11 * i as f64 / (FEW - 1) as f64)).fold(0.0, f64::max)
}

/// What the two files of a clamped plate whose edges give by its thickness show of this plate.
fn fitted_unseen(plate: &Plate) -> Result<Calibrated, CalibrateError> {
    let read = |text: &str| Measurement::from_csv(text).expect("a measurement");
    let near = read(include_str!("../edges/clamp_gives_1h_a.csv"));
    let far = read(include_str!("../edges/clamp_gives_1h_b.csv"));
    from_ratio(plate, [&near, &far], &Priors::default())
}

/// A clamped plate of 0.8 mm with edges of c = 1, solved by other hands, at the two places that were planned before a plan
/// counted edges that give: it was accepted with 0.59 mm stated, 4.7 mm off.
#[test]
fn a_clamped_plate_whose_two_places_do_not_see_its_edges_is_refused() {
    let error = fitted_unseen(&clamped()).expect_err("open");
    println!("{error}");
    let CalibrateError::EdgesUnseen { low_m, high_m, boundary_m } = error else { panic!("{error}") };
    assert!(low_m > 1e-4 && high_m < 8e-4 && boundary_m > 1e-3, "{error}");
}

/// The same, of a file that holds its edges for firm, as every file did, and of one that knows how far they give.
#[test]
#[ignore = "two more fits between clamped edges: .ci/run statistics"]
fn the_same_plate_is_accepted_whether_its_file_knows_its_clamp_or_is_wrong_about_it() {
    let sure = fitted_unseen(&with_edges(&clamped(), None, Some(0.0))).expect("accepted");
    let known = fitted_unseen(&with_edges(&clamped(), Some(8e-4), Some(4e-5))).expect("accepted");
    let off_m = apart_m(&known.plate, &sure.plate);
    println!("{off_m}, {} and {} stated", sure.boundary_tolerance_m, known.boundary_tolerance_m);
    assert!((off_m - 4.7e-3).abs() < 7e-4 && sure.boundary_tolerance_m < 6.5e-4, "{off_m}");
    assert!(known.chi2_per_n < 1.0 && known.boundary_tolerance_m < 8e-4, "{known:?}");
}

mod night {
    use super::*;

    #[test]
    #[ignore = "many plates: .ci/run statistics"]
    fn sixty_plates_whose_edges_do_not_give_lose_a_fifth_of_their_interval_at_most() {
        for (kind, most) in LOST {
            let mut shares: Vec<f64> = (0..15).map(|number| lost_by_edges(kind, number)).collect();
            shares.sort_by(f64::total_cmp);
            println!("{kind}: {shares:.3?}");
            assert!(shares[14] <= most, "{kind}: {shares:.3?}");
        }
    }

    /// Row 2 of issue 50.
    #[test]
    #[ignore = "many plates: .ci/run statistics"]
    fn sixty_plates_whose_edges_give_are_accepted_and_within_their_intervals() {
        let (mut accepted, mut within, mut all) = (0, 0, 0);
        // The interval with delta over that with delta held: the median of plates whose edges do not give, behind their own drives.
        for (kind, most_mm, loss) in [
            ("membrane", 1.2, 1.5),
            ("tungsten-membrane", 1.6, 1.5),
            ("al-bending", 0.8, 1.25),
            ("clamped", f64::INFINITY, 1.35),
        ] {
            let outcomes: Vec<Outcome> = (0..15).map(|number| Outcome::of(kind, number)).collect();
            all += outcomes.len();
            let (mut stated_mm, mut shares) = (Vec::new(), Vec::new());
            for outcome in &outcomes {
                let Ok(found) = &outcome.found else { continue };
                accepted += 1;
                within += usize::from(outcome.boundary_m <= found.boundary_tolerance_m);
                stated_mm.push(1e3 * found.boundary_tolerance_m);
                shares.extend(outcome.held_m.map(|held_m| found.boundary_tolerance_m / held_m));
            }
            shares.sort_by(f64::total_cmp);
            println!("{kind}: with delta {shares:.2?} times as wide");
            assert!(shares[(shares.len() - 1) / 2] <= loss, "{kind}: {shares:?}");
            stated_mm.sort_by(f64::total_cmp);
            let median_mm = stated_mm[stated_mm.len() / 2];
            println!("{kind}: median stated {median_mm:.2} mm");
            assert!(median_mm <= most_mm, "{kind}: {median_mm} mm");
        }
        println!("{accepted} of {all} accepted, {within} within");
        assert!(
            10 * accepted >= 9 * all && 20 * within >= 19 * accepted,
            "{accepted} of {all}, {within} within"
        );
    }
}

/// A membrane that is pulled 3 % more across than along, measured for a file that does not know it: with the ratio's tolerance
/// stated the boundary is within the stated interval, which grows by it; the ratio itself hides in the half-width.
#[test]
fn a_tension_that_is_not_the_same_both_ways_is_in_the_stated_interval() {
    for (number, kind) in (1..).zip(["membrane", "tungsten-membrane"]) {
        let mut random = Random::new(8100 + number);
        let mut rig = rig(kind, 0.0, &mut random);
        let spec = PlateSpec { tension_ratio: Some(1.03), ..rig.truth.spec().clone() };
        rig.truth = Plate::new(spec).expect("a plate");
        let stated = PlateSpec { tension_ratio_tolerance: Some(0.06), ..rig.nominal.spec().clone() };
        rig.nominal = Plate::new(stated).expect("a plate");
        let places_m = planned(&rig.nominal).best.places_m;
        let sensors = measured(&mut rig, places_m, &mut random);
        let found = calibrated(&rig, &sensors).unwrap_or_else(|error| panic!("{kind}: {error}"));
        let boundary_m = rig.errors(&found.plate).0;
        let half_width = found.plate.spec().calibration.as_ref().expect("calibrated").half_width_tolerance;
        println!(
            "{kind}: boundary {:.2} (stated {:.2}) mm, chi2/n {:.2}, half-width +- {half_width:.4}",
            1e3 * boundary_m,
            1e3 * found.boundary_tolerance_m,
            found.chi2_per_n
        );
        assert!(boundary_m < 1.2 * found.boundary_tolerance_m, "{kind}: {boundary_m}");
        // 0.3 % by calipers alone would be 0.6 %.
        assert!((2e-3..3.2e-2).contains(&half_width), "{kind}: {half_width}");
    }
}
