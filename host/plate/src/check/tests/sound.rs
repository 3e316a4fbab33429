//! Sound level and beat.

use super::{light, report, value};
use crate::check::lights::sound::{a_weighting_db, plane_wave_level_db};
use crate::check::{Checker, Colour, Conditions};
use crate::preset;

#[test]
fn one_micrometre_at_5_khz_can_reach_113_db_in_front_of_a_wide_plate() {
    assert!((plane_wave_level_db(5e3, 1e-6) - 113.2).abs() < 0.1, "{}", plane_wave_level_db(5e3, 1e-6));
    for (frequency_hz, db) in [(1e3, 0.0), (100.0, -19.1), (10e3, -2.5), (31.623, -39.4)] {
        assert!(
            (a_weighting_db(frequency_hz) - db).abs() < 0.1,
            "{frequency_hz}: {}",
            a_weighting_db(frequency_hz)
        );
    }
}

#[test]
fn sound_grows_by_20_db_for_ten_times_the_level_and_stays_below_the_plane_wave() {
    let plate = preset("al-bending").expect("preset");
    let at_level = |level: f64| {
        let checker = Checker::new(&plate, Conditions { level, ..Conditions::default() }).expect("checks");
        let report = checker.at(0.25).expect("on it");
        (value(&report, "sound level"), checker.peak_m(), report.frequency_hz.0)
    };
    let (full, peak_m, frequency_hz) = at_level(1.0);
    let (tenth, ..) = at_level(0.1);
    assert!((full - tenth - 20.0).abs() < 1e-9);
    assert!(full < plane_wave_level_db(frequency_hz, 3.0 * peak_m) && full > 60.0, "{full}");
    assert_eq!(at_level(0.0).0, 0.0);
    // The slow waves of the membrane hardly radiate: the level is far below the 120 dB and more of a plane wave.
    let membrane = report("membrane", 0.16);
    assert!(value(&membrane, "sound level") < 85.0, "{:?}", light(&membrane, "sound level"));
}

#[test]
fn two_ultrasonic_tones_closer_than_a_kilohertz_beat() {
    let plate = preset("al-bending").expect("preset");
    let near = plate.turning_point_m(30_500.0).expect("enters");
    let boundary = plate.turning_point_m(30_000.0).expect("enters");
    let far = plate.turning_point_m(35_000.0).expect("enters");
    let with = |other_boundaries_m: Vec<f64>| {
        let conditions = Conditions { other_boundaries_m, ..Conditions::default() };
        let report = Checker::new(&plate, conditions).expect("checks").at(boundary).expect("on it");
        (light(&report, "beat").value, light(&report, "beat").colour)
    };
    assert_eq!(with(vec![]), (None, Colour::Green));
    let (value, colour) = with(vec![far, near]);
    assert!((value.unwrap_or(0.0) - 500.0).abs() < 0.01);
    assert_eq!(colour, Colour::Amber);
    assert_eq!(with(vec![far]).1, Colour::Green);
    // Two tones of a membrane, 20 Hz apart, are not ultrasonic; a texture consists of such tones.
    assert_eq!(light(&report("membrane", 0.16), "beat").colour, Colour::Green);
}
