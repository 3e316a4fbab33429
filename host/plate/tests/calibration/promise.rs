//! What a plan promises: plates near the nominal one, measured at the proposed places, are accepted with intervals near the planned
//! ones.

use super::calibrated;
use super::levels;
use super::rig::{Random, Rig, Solver};
use slipline_plate::calibrate::{Placing, SensorPlaces};
use slipline_plate::{Plate, preset, presets};

/// The stated intervals of boundary and level over the planned ones of one plate near `nominal`; `None` where it is refused.
fn stated_over_planned(name: &str, nominal: &Plate, seed: u64) -> Option<[f64; 2]> {
    let mut random = Random::new(seed);
    let points = levels::count(nominal);
    let rig = Rig::of(nominal.clone(), Solver::OneMode, &mut random);
    let planned = match SensorPlaces::of(nominal, &Placing { points, ..Placing::default() }) {
        Ok(places) => places.best,
        Err(error) => {
            println!("{name} {seed}: no plan: {error}");
            return None;
        }
    };
    let sensors = rig.measure(planned.places_m, points, &mut random);
    match calibrated(&rig, &sensors) {
        Ok(found) => {
            let ratios = [
                found.boundary_tolerance_m / planned.boundary_tolerance_m,
                found.level_tolerance_db / planned.level_tolerance_db,
            ];
            println!(
                "{name} {seed}: {ratios:.2?} of {:.3} mm, {:.3} dB planned at {:.4?}, chi2/n {:.2}, misfit {:.3}",
                1e3 * planned.boundary_tolerance_m,
                planned.level_tolerance_db,
                planned.places_m,
                found.chi2_per_n,
                found.misfit
            );
            Some(ratios)
        }
        Err(error) => {
            println!("{name} {seed}: refused, {planned:?}: {error}");
            None
        }
    }
}

/// Plates that resonate: moved by their end, or clamped with a source that does not match.
fn resonant() -> Vec<(String, Plate)> {
    let preset = |name: &str| (name.to_owned(), preset(name).expect("a preset"));
    let clamped = [4, 5, 10, 11, 16, 17].map(|number| {
        let plate = levels::nominal(number, &mut Random::new(900 + number as u64));
        (format!("clamped {number}"), plate)
    });
    [preset("al-bending-displacement"), preset("al-bending"), preset("tungsten-membrane")]
        .into_iter()
        .chain(clamped)
        .collect()
}

/// A drive that resonates takes the signal from the rest of the band, which the plan counts: of these two the level would be known 2.9
/// and 3.5 times less well than behind the drive of the file.
#[test]
fn the_planned_level_is_that_behind_a_drive_that_resonates() {
    for number in [1, 3] {
        let (name, nominal) = &resonant()[number];
        let [boundary, level] = stated_over_planned(name, nominal, 4003).expect("accepted");
        assert!((0.8..1.5).contains(&boundary) && (0.4..1.7).contains(&level), "{name}: {boundary} {level}");
    }
}

/// A plate whose end is moved is refused at its planned places, with less noise, too: the plan says so, and what calibrates it.
#[test]
fn a_plan_of_a_plate_that_two_places_do_not_calibrate_says_so() {
    let caution = |nominal: &Plate| {
        let placing = Placing { points: levels::count(nominal), ..Placing::default() };
        SensorPlaces::of(nominal, &placing).expect("a plan").caution()
    };
    let plates = resonant();
    let (_, moved) = &plates[0];
    let words = caution(moved).expect("it resonates");
    assert!(words.starts_with("two places do not calibrate this plate: it resonates"), "{words}");
    assert!(words.contains("Give its end a resistance") && words.contains("--touch"), "{words}");
    assert!(stated_over_planned("al-bending-displacement", moved, 4000).is_none());
    assert_eq!(caution(&plates[1].1), None);
}

mod night {
    use super::*;

    /// Stated over planned interval of the boundary and of the level that are allowed.
    const BOUNDARY: (f64, f64) = (0.8, 2.2);
    const LEVEL: (f64, f64) = (0.2, 1.8);

    /// The first five presets, four secret plates of each: what is planned is reached within a factor of about two, and
    /// refused is no plate of whose plan nothing is said.
    #[test]
    #[ignore = "many plates: .ci/run statistics"]
    fn plates_keep_what_their_plans_promise() {
        let all = presets().iter().take(5).map(|it| (it.name, it.plate().expect("a preset")));
        let (mut accepted, mut off) = (0, Vec::new());
        for (name, nominal) in all {
            let placing = Placing { points: levels::count(&nominal), ..Placing::default() };
            let Ok(plan) = SensorPlaces::of(&nominal, &placing) else { continue };
            let caution = plan.caution();
            for seed in 0..4 {
                match stated_over_planned(name, &nominal, 4000 + seed) {
                    Some([boundary, level]) => {
                        accepted += 1;
                        let holds = (BOUNDARY.0..BOUNDARY.1).contains(&boundary)
                            && (LEVEL.0..LEVEL.1).contains(&level);
                        if !holds {
                            off.push(format!("{name} {seed}: {boundary:.2} {level:.2}"));
                        }
                    }
                    None if caution.is_some() => println!("{name} {seed} is refused, as its plan says"),
                    None => off.push(format!("{name} {seed} is refused")),
                }
            }
        }
        println!("{accepted} accepted, off: {off:?}");
        assert!(off.is_empty() && accepted >= 16, "{accepted} accepted, off: {off:?}");
    }
}
