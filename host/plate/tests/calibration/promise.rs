//! What a plan promises: plates near the nominal one, measured at the proposed places, are accepted with intervals near the planned
//! ones.

use super::calibrated;
use super::levels;
use super::rig::{Random, Rig, Solver};
use slipline_plate::calibrate::{Placing, SensorPlaces};
use slipline_plate::design::{Edge, Material, Request, Wave, design};
use slipline_plate::{Plate, Progress, preset, presets};
use std::f64::consts::TAU;

/// The stated intervals of boundary and level over the planned ones of one plate near `nominal`; `None` where it is refused.
fn stated_over_planned(name: &str, nominal: &Plate, seed: u64) -> Option<[f64; 2]> {
    let mut random = Random::new(seed);
    let points = levels::count(nominal);
    let mut rig = Rig::of(nominal.clone(), Solver::OneMode, &mut random);
    // Below its cut-off no wave enters the truth.
    rig.measured_hz.0 = rig.measured_hz.0.max(1.02 * rig.truth.cut_off_hz());
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
    planned_level(1);
}

#[test]
#[ignore = "a second pass, between clamped edges: .ci/run statistics"]
fn the_planned_level_between_clamped_edges_is_that_behind_a_drive_that_resonates() {
    planned_level(3);
}

fn planned_level(number: usize) {
    let (name, nominal) = &resonant()[number];
    let [boundary, level] = stated_over_planned(name, nominal, 4003).expect("accepted");
    assert!((0.8..1.5).contains(&boundary) && (0.4..1.7).contains(&level), "{name}: {boundary} {level}");
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
    /// The level is planned behind the worst actuator, which few plates have.
    const LEVEL: (f64, f64) = (0.1, 1.8);

    /// Every material of the designer that is a stiff sheet, between clamped edges, over an octave from where kb = 200 1/m on; and the
    /// clamped plate of issue 50.
    fn clamped() -> Vec<(String, Plate)> {
        let designed = |material: &str| {
            let sheet = Material::named(material).expect("known");
            let thickness_m = if sheet.youngs_modulus_pa < 1e10 { 3e-3 } else { 1.5e-3 };
            let stiff = 12.0 * sheet.density_kg_per_m3 * (1.0 - sheet.poisson_ratio.powi(2));
            let low_hz = 4e4 * (sheet.youngs_modulus_pa / stiff).sqrt() * thickness_m / TAU;
            let wave = Wave::Bending { edge: Edge::Clamped, thick_plate: true };
            let request = Request::new(material, sheet, thickness_m, wave, (low_hz, 2.0 * low_hz), 0.3);
            let designed = design(&request, &mut Progress::unwatched()).expect("possible");
            (format!("clamped {material}"), designed.plate)
        };
        let sheets =
            ["aluminium", "steel", "stainless-steel", "brass", "glass", "fr4", "acrylic", "polycarbonate"];
        let text = include_str!("../edges/clamp_gives_nominal.toml");
        let ours = ("clamped, issue 50".to_owned(), Plate::from_toml(text).expect("a plate"));
        sheets.into_iter().map(designed).chain([ours]).collect()
    }

    /// Secret plates near each: what is planned is reached within a factor of about two. Returns how many are accepted, and those that
    /// are refused of whose plan nothing is said.
    fn keep(plates: impl IntoIterator<Item = (String, Plate)>, seeds: u64) -> (usize, Vec<String>) {
        let (mut accepted, mut off, mut refused) = (0, Vec::new(), Vec::new());
        for (name, nominal) in plates {
            let placing = Placing { points: levels::count(&nominal), ..Placing::default() };
            let plan = match SensorPlaces::of(&nominal, &placing) {
                Ok(plan) => plan,
                Err(error) => {
                    println!("{name}: {error}");
                    continue;
                }
            };
            let caution = plan.caution();
            for seed in 0..seeds {
                match stated_over_planned(&name, &nominal, 4000 + seed) {
                    Some([boundary, level]) => {
                        accepted += 1;
                        let holds = (BOUNDARY.0..BOUNDARY.1).contains(&boundary)
                            && (LEVEL.0..LEVEL.1).contains(&level);
                        if !holds {
                            off.push(format!("{name} {seed}: {boundary:.2} {level:.2}"));
                        }
                    }
                    None if caution.is_some() => println!("{name} {seed} is refused, as its plan says"),
                    None => refused.push(format!("{name} {seed}")),
                }
            }
        }
        println!("{accepted} accepted, off: {off:?}, refused: {refused:?}");
        assert!(off.is_empty(), "{accepted} accepted, off: {off:?}");
        (accepted, refused)
    }

    #[test]
    #[ignore = "many plates: .ci/run statistics"]
    fn plates_keep_what_their_plans_promise() {
        let first = presets().iter().take(5);
        let (accepted, refused) =
            keep(first.map(|it| (it.name.to_owned(), it.plate().expect("a preset"))), 4);
        assert!(accepted >= 16 && refused.is_empty(), "{accepted}, refused: {refused:?}");
    }

    #[test]
    #[ignore = "many plates: .ci/run statistics"]
    fn clamped_plates_of_every_material_keep_what_their_plans_promise() {
        // One of acrylic, the lossiest, is refused, as its plan says.
        let (accepted, refused) = keep(clamped(), 3);
        assert!(accepted >= 26 && refused.is_empty(), "{accepted}, refused: {refused:?}");
    }
}
