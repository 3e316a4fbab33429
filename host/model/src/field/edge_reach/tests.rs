use super::*;
use std::sync::Arc;

fn setup(name: &str) -> (Setup, DriveTable) {
    let plate = slipline_plate::preset(name).unwrap();
    let table = DriveTable::build(&plate, 400e3, 65).unwrap();
    (Setup::new(Arc::new(plate)), table)
}

/// Where the line of the tone at this turning point is.
fn line(setup: &Setup, level: f64, table: &DriveTable, position_m: f64) -> Line {
    Line::of(setup, &ToneSetup { slot: 0, position_m, level, phase_turns: 0.0 }, Some(table))
}

/// The reach, by a place that no edge has.
fn refused(setup: &Setup, level: f64, table: &DriveTable) -> NoFeltEdge {
    turning_point_of(setup, level, table, f64::NAN).unwrap_err()
}

#[test]
fn every_place_of_the_reach_and_none_beyond_is_a_felt_edge() {
    for preset in slipline_plate::presets() {
        let (setup, table) = setup(preset.name);
        for level in [0.8, 0.1] {
            let refusal = refused(&setup, level, &table);
            for &(low_m, high_m) in &refusal.reach_m {
                assert!(low_m < high_m, "{} {level}: {:?}", preset.name, refusal.reach_m);
                for i in 0..=3 {
                    let place_m = low_m + (high_m - low_m) * f64::from(i) / 3.0;
                    let found_m = turning_point_of(&setup, level, &table, place_m);
                    let found_m =
                        found_m.unwrap_or_else(|refusal| panic!("{place_m}: {}", refusal.sentence(place_m)));
                    let line = line(&setup, level, &table, found_m);
                    assert!(
                        line.holds == Holds::FeltEdge && (line.place_m - place_m).abs() < 1e-5,
                        "{} {level} {place_m}: {line:?}",
                        preset.name
                    );
                }
            }
            for beyond_m in [1e-3, setup.plate.length_m()] {
                let again = turning_point_of(&setup, level, &table, beyond_m).unwrap_err();
                assert_eq!(again, refusal, "{} {beyond_m}", preset.name);
            }
            assert_eq!(refusal.not_felt.is_some(), refusal.reach_m.is_empty(), "{refusal:?}");
        }
    }
}

#[test]
fn a_refusal_names_the_reachable_edges_or_why_none_is() {
    let (membrane, table) = setup("membrane");
    let words = refused(&membrane, 0.8, &table).sentence("1 mm");
    assert!(
        words.starts_with("1 mm: must be ") && words.contains(" mm, the felt edges of tones of level 0.8"),
        "{words}"
    );
    let (silent, table) = setup("al-sh");
    assert_eq!(
        refused(&silent, 0.1, &table).sentence("1 mm"),
        "1 mm: no tone of level 0.1 is felt on the plate \"al-sh\": too weak"
    );
    let ends = NoFeltEdge { plate: "loud".to_owned(), level: 1.0, reach_m: Vec::new(), not_felt: None };
    assert!(ends.sentence("x").ends_with("is felt to its end"), "{}", ends.sentence("x"));
    let two = NoFeltEdge { reach_m: vec![(0.1, 0.12), (0.2, 0.25)], ..ends };
    assert!(two.sentence("x").starts_with("x: must be 100 to 120 mm or 200 to 250 mm, "));
}
