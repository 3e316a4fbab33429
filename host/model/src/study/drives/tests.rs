use super::*;
use crate::study::{Draft, Study};
use slipline_plate::merit::Merit;
use slipline_plate::{Progress, preset};

fn study(plate: &str, lines: &str, places: &str, vary: &str) -> Study {
    let text = format!(
        "plate = {plate:?}\nseed = 7\ncount = 6\nturning_point_m = [{places}]\n{lines}\n[vary]\nloss_factor = {{ {vary} }}"
    );
    let spec = Draft::parse(&text).unwrap().finish(preset(plate)).unwrap();
    Study::new(spec, &mut Progress::unwatched()).unwrap()
}

/// A study whose plates are all the nominal one.
const SAME: &str = "uniform = 0.0";

#[test]
fn the_area_of_the_nominal_plate_has_the_figures_of_its_merit() {
    let places = "0.2, 0.26";
    let study = study("membrane", "results = [\"contrast_db\", \"ripple_db\"]", places, SAME);
    let chunk = study.run_range(0..1);
    let plate = preset("membrane").unwrap();
    let table = DriveTable::build(&plate, f64::from(SAMPLE_RATE_HZ), crate::jobs::table::KNOTS).unwrap();
    let palette = Palette::new(&plate, &table);
    for (place, place_m) in [0.2, 0.26].into_iter().enumerate() {
        let merit = Merit::of(&palette, place_m).unwrap();
        assert!((chunk.results[0][place] - merit.contrast_db).abs() < 1e-9);
        assert!((chunk.results[1][place] - merit.ripple_db).abs() < 1e-9);
    }
}

#[test]
fn a_lossier_plate_has_a_weaker_line_that_ends_earlier() {
    let lines = "results = [\"level_db\", \"peak_shift_m\", \"felt_edge_m\", \"contrast_db\", \"crest_db\"]";
    let nominal = study("membrane", lines, "0.2", SAME).run_range(0..1);
    let study = study("membrane", lines, "0.2", "log_normal = 0.3");
    let chunk = study.run_range(0..6);
    let [levels, shifts_m, edges_m, contrasts, crests] = &chunk.results[..] else { panic!("five results") };
    assert_eq!((nominal.results[0][0], nominal.results[1][0]), (0.0, 0.0));
    for plate in 0..6 {
        let is_lossier = chunk.varied[plate] > 0.03;
        assert_eq!(levels[plate] < 0.0, is_lossier);
        assert_eq!(
            edges_m[plate] < nominal.results[2][0],
            is_lossier,
            "the sensation ends where it is weaker"
        );
        assert!(contrasts[plate] != nominal.results[3][0] && contrasts[plate] > 6.0);
        assert_eq!(
            crests[plate] < nominal.results[4][0],
            is_lossier,
            "less of the peak is left than of the wave before it"
        );
        assert!(shifts_m[plate].abs() < 2e-3);
    }
    // The felt edge of a tone at 200 mm lies past its peak, and on the plate.
    assert!((0.19..0.32).contains(&nominal.results[2][0]), "{}", nominal.results[2][0]);
}

#[test]
fn the_felt_edge_is_that_of_the_tone_at_level_1() {
    use crate::field::felt::Felt;
    use crate::field::steady_field::{SteadyField, SteadyTone};
    for (name, place_m) in [("membrane", 0.2), ("al-bending", 0.25)] {
        let study = study(name, "results = [\"felt_edge_m\"]", &place_m.to_string(), SAME);
        let plate = preset(name).unwrap();
        let table = DriveTable::build(&plate, f64::from(SAMPLE_RATE_HZ), crate::jobs::table::KNOTS).unwrap();
        let tone =
            SteadyTone { slot: 0, frequency_hz: table.frequency_hz(place_m), peak_m: table.peak_m(place_m) };
        let felt = Felt::of(&plate, &Feeling::default(), &SteadyField::solve(&plate, &[tone]));
        let edge_m = study.run_range(0..1).results[0][0];
        assert!((edge_m - felt.edge.place_m().unwrap()).abs() < 2e-5, "{name}: {edge_m} {:?}", felt.edge);
    }
}

#[test]
fn a_plate_in_two_dimensions_matches_its_solver() {
    let lines = "kind = \"2d\"\nresults = [\"level_db\", \"peak_shift_m\", \"felt_edge_m\", \"crest_db\"]";
    let study = study("membrane", lines, "0.18", "log_normal = 0.3");
    let chunk = study.run_range(0..3);
    assert_eq!(chunk, study.run_range(0..3));
    let hertz = study.frequencies_hz()[0];
    let peak = |plate: &Plate| {
        let found = plane::respond(plate, hertz, PLANE_POINTS, &plane::Setup::of(plate)).unwrap();
        found.peak.unwrap()
    };
    let nominal = peak(study.nominal());
    for plate in 0..3 {
        assert_eq!(chunk.status[plate], Status::Done);
        let found = peak(&study.plate(plate as u64).unwrap());
        assert!((chunk.results[0][plate] - decibels(found.amplitude / nominal.amplitude)).abs() < 1e-9);
        assert!((chunk.results[1][plate] - (found.position_m - nominal.position_m)).abs() < 1e-12);
        assert!(chunk.results[2][plate] > found.position_m && chunk.results[3][plate] > 0.0);
    }
    // One mode and two dimensions differ, but not by much on this plate.
    let one_mode =
        self::study("membrane", "results = [\"felt_edge_m\"]", "0.18", "log_normal = 0.3").run_range(0..3);
    for (plane_m, one_mode_m) in chunk.results[2].iter().zip(&one_mode.results[0]) {
        assert!(plane_m != one_mode_m && (plane_m - one_mode_m).abs() < 5e-3, "{plane_m} {one_mode_m}");
    }
}

#[test]
fn what_the_nominal_plate_lacks_is_refused_with_its_place() {
    let text = "plate = \"membrane\"\nseed = 7\ncount = 6\nturning_point_m = [0.2, 0.08]\nresults = [\"ripple_db\"]\n\
                [vary]\nloss_factor = { uniform = 0.1 }";
    let spec = Draft::parse(text).unwrap().finish(preset("membrane")).unwrap();
    let error = Study::new(spec, &mut Progress::unwatched()).unwrap_err().to_string();
    assert!(error.starts_with("turning_point_m = 0.08: ") && error.contains("even area"), "{error}");
}
