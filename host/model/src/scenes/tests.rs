use super::*;
use crate::field::felt::{Felt, Zone};
use crate::field::line::{Holds, limits_m, lines};
use crate::field::steady_field::{SteadyField, steady_tones};
use crate::jobs::Task;
use slipline_plate::check::{Checker, Colour, Conditions};
use slipline_plate::{DriveTable, Progress};

/// Smallest strength before a scene's last edge over the strength one edge width beyond it, dB; and whether
/// all of it is clearly felt.
fn contrast_db(scene: &Scene) -> (f64, bool) {
    let setup = scene.setup().unwrap();
    let plate = &setup.plate;
    let table = DriveTable::build(plate, 400e3, 129).unwrap();
    let field = SteadyField::solve(plate, &steady_tones(&setup, Some(&table)));
    let felt = Felt::of(plate, &setup.feeling, &field);
    let line = lines(&setup, Some(&field))[0];
    assert_eq!(line.holds, Holds::FeltEdge, "{}", scene.name);
    let half_m = 0.5 * field.tone(0).unwrap().edge_width_m;
    assert!(line.place_m + half_m < plate.length_m(), "{}: room beyond the edge", scene.name);
    let before = (0..=200).map(|i| felt.at((line.place_m - half_m) * f64::from(i) / 200.0));
    let least = before.fold(f64::INFINITY, f64::min);
    let contrast_db = 20.0 * (least / felt.at(line.place_m + half_m)).log10();
    (contrast_db, Zone::of(least) == Zone::Clearly)
}

#[test]
fn every_scene_has_its_edge_on_the_plate_and_one_tone_has_a_crisp_one() {
    let alone = SCENES.iter().filter(|scene| scene.tones.len() == 1);
    let contrasts: Vec<(f64, bool)> = alone.map(contrast_db).collect();
    let (first_db, is_clear) = contrasts[0];
    assert!(first_db > 40.0 && is_clear, "{contrasts:?}");
    assert!(
        contrasts.iter().all(|(contrast_db, is_clear)| *contrast_db > 38.0 && *is_clear),
        "{contrasts:?}"
    );
}

/// Its line can be put on 27 to 94 % of its length.
#[test]
fn the_line_of_the_first_plate_reaches_most_of_its_length_with_every_light_green() {
    let setup = SCENES[0].setup().unwrap();
    let (plate, tone) = (&setup.plate, setup.tones[0]);
    for level in [tone.level, 1.0] {
        let conditions = Conditions { level, ..Conditions::default() };
        let report = Checker::new(plate, conditions).unwrap().over_span(&mut Progress::unwatched()).unwrap();
        let failed: Vec<_> = report.lights.iter().filter(|light| light.colour > Colour::Green).collect();
        assert!(failed.is_empty(), "{failed:#?}");
    }
    let table = DriveTable::build(plate, 400e3, 129).unwrap();
    let (near_m, far_m) = limits_m(&setup, &tone, Some(&table));
    let reach = (far_m - near_m) / plate.length_m();
    let ends = [near_m, far_m].map(|place_m| place_m / plate.length_m());
    assert!(reach >= 0.64 && ends[0] < 0.3 && (0.92..0.96).contains(&ends[1]), "{ends:?}");
}

#[test]
fn the_first_scene_needs_no_warning() {
    let setup = SCENES[0].setup().unwrap();
    let tone = setup.tones[0];
    let conditions = Conditions { level: tone.level, ..Conditions::default() };
    let report = Checker::new(&setup.plate, conditions).unwrap().at(tone.position_m).unwrap();
    assert!(report.worst() <= Colour::Green, "{:?}", report.lights);
}

#[test]
fn the_solid_area_is_even_where_one_tone_alone_has_nodes() {
    let mut setup = SCENES.iter().find(|scene| scene.name == "Solid area").unwrap().setup().unwrap();
    let ripple_db = |setup: &Setup| {
        let table = DriveTable::build(&setup.plate, 400e3, 129).unwrap();
        let field = SteadyField::solve(&setup.plate, &steady_tones(setup, Some(&table)));
        let last = field.tones.last().unwrap();
        // From 10 mm to where the edge begins.
        let inside = 0.01..last.turning_point_m - 1.3 * last.edge_width_m;
        let place_m = |i: usize| i as f64 / (field.rms_m.len() - 1) as f64 * field.length_m;
        let levels = field.rms_m.iter().enumerate().filter(|(i, _)| inside.contains(&place_m(*i)));
        let (least, most) =
            levels.fold((f64::INFINITY, 0.0_f64), |(least, most), (_, &rms)| (least.min(rms), most.max(rms)));
        20.0 * (most / least).log10()
    };
    assert!(ripple_db(&setup) < 1.0, "{}", ripple_db(&setup));
    setup.tones = setup.tones.split_off(3);
    assert!(ripple_db(&setup) > 6.0, "{}", ripple_db(&setup));
}

#[test]
fn every_scene_has_a_picture_and_fits_the_dac() {
    let drawn = thumbnails(&Task::default()).unwrap();
    assert_eq!(drawn.len(), SCENES.len());
    for (scene, picture) in SCENES.iter().zip(&drawn) {
        let setup = scene.setup().unwrap();
        assert!(setup.tones.iter().map(|tone| tone.level).sum::<f64>() <= 1.0, "{}", scene.name);
        let top = picture.height.iter().copied().fold(0.0, f32::max);
        assert!((0.9..=1.0).contains(&top) && picture.half_width[0] == 1.0, "{}", scene.name);
        assert!(picture.zones[4] != Zone::Not && picture.zones.last() == Some(&Zone::Not), "{}", scene.name);
    }
    // The beat is one that skin feels.
    let beat = SCENES.iter().find(|scene| scene.name.contains("beat")).unwrap().setup().unwrap();
    let hertz = |i: usize| beat.plate.frequency_for_boundary_hz(beat.tones[i].position_m);
    assert!(((hertz(0) - hertz(1)).abs() - 180.0).abs() < 40.0, "{}", hertz(0) - hertz(1));
}
