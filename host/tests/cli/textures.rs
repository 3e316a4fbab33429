//! `slipline texture` and the setup that it writes, and `slipline merit`.

use super::{file, json, number, refused, slipline};
use serde_json::Value;

fn texture(more: &[&str]) -> Value {
    json(&[&["texture", "--plate", "membrane"], more].concat())
}

#[test]
fn a_solid_area_has_its_tones_and_figures() {
    let value = texture(&["--solid", "280mm", "--tones", "8"]);
    let tones = value["tones"].as_array().unwrap();
    assert!((2..=8).contains(&tones.len()));
    for tone in tones {
        assert!((0.08..=0.26).contains(&number(tone, "turning_point_m")));
        assert!(
            (0.0..=1.0).contains(&number(tone, "level")) && (0.0..1.0).contains(&number(tone, "phase_turns"))
        );
    }
    assert!(number(&value, "ripple_db") < 1.0 && number(&value, "contrast_db") > 20.0);
    assert!(number(&value, "flutter_db") > 3.0 && (5.0..100.0).contains(&number(&value, "flutter_hz")));
    assert!(number(&value, "flutter_largest_db") > number(&value, "flutter_db") + 2.0);
    assert!((0.0..0.28).contains(&number(&value, "flutter_largest_m")));
    let by_person = &value["felt_edge_by_person_m"];
    assert!(by_person[0].as_f64() < Some(0.28) && by_person[1].as_f64() > Some(0.28), "{by_person}");
    assert!(number(&value, "rms_error") <= number(&value, "worst_rms_error"));
    assert!(number(&value["reach"], "rms_error") <= number(&value, "rms_error") + 1e-3);
    assert!((0.0..0.2).contains(&number(&value["reach"], "largest_square_error")));
}

#[test]
fn profiles_are_read_from_csv_and_from_images() {
    let csv = file("profile.csv");
    std::fs::write(&csv, "place_m,amplitude\n0.01,1\n0.24,0\n").unwrap();
    let ramp = texture(&["--profile", csv.to_str().unwrap()]);
    assert!(number(&ramp, "rms_error") < 0.1 && ramp["ripple_db"].is_null());

    std::fs::write(&csv, "0.01,1\n0.24,loud\n").unwrap();
    refused(
        &["texture", "--plate", "membrane", "--profile", csv.to_str().unwrap()],
        2,
        &["line 2", "PLACE,AMPLITUDE"],
    );
    std::fs::remove_file(&csv).unwrap();
    refused(&["texture", "--plate", "membrane", "--image", csv.to_str().unwrap()], 2, &["profile.csv"]);
}

#[test]
fn stripes_and_beats_name_their_tones() {
    let stripes = texture(&["--stripes", "50mm"]);
    assert!((number(&stripes, "stripes_m") - 0.05).abs() < 1e-6);
    assert!((number(&stripes, "stripes_felt_db") - 8.7).abs() < 0.1, "{}", stripes["stripes_felt_db"]);
    assert_eq!(stripes["tones"].as_array().unwrap().len(), 1);
    let beat = json(&["texture", "--plate", "al-sh", "--beat", "300mm:180Hz"]);
    let hz = |tone: usize| number(&beat["tones"][tone], "frequency_hz");
    assert!((hz(1) - hz(0) - 180.0).abs() < 0.01);
}

#[test]
fn the_setup_that_texture_writes_is_played() {
    let setup = file("texture.toml");
    let path = setup.to_str().unwrap();
    let value = texture(&["--solid", "280mm", "--tones", "4", "--out", path]);
    refused(&["texture", "--plate", "membrane", "--solid", "280mm", "--out", path], 2, &["--force"]);
    let driven = json(&["drive", "--port", "sim", "--setup", path, "--for", "50ms"]);
    let (wanted, tones) = (value["tones"].as_array().unwrap(), driven["tones"].as_array().unwrap());
    assert_eq!((tones.len(), number(&driven, "clipped_samples")), (wanted.len(), 0.0));
    for tone in tones {
        let found = wanted.iter().any(|wanted| {
            (number(wanted, "turning_point_m") - number(tone, "turning_point_m")).abs() < 1e-6
                && (number(wanted, "level") - number(tone, "level")).abs() < 1e-9
        });
        assert!(found, "{tone}");
    }
    let printed = slipline(&["drive", "--port", "sim", "--setup", path, "--for", "50ms"]).stdout;
    let printed = String::from_utf8(printed).unwrap();
    let levels: Vec<&str> =
        printed.lines().filter_map(|line| line.split_once("level ")).map(|(_, level)| level).collect();
    assert_eq!(levels.len(), wanted.len(), "{printed}");
    assert!(levels.iter().all(|level| level.len() == "0.123.".len()), "a level is read by people: {printed}");
    refused(&["drive", "--port", "sim", "--setup", path, "--boundary", "120mm"], 2, &["--boundary"]);
    std::fs::remove_file(&setup).unwrap();
    refused(&["drive", "--port", "sim", "--setup", path], 2, &["texture.toml"]);
}

#[test]
fn a_texture_on_multiples_is_played_as_a_chord_and_louder_than_its_sum() {
    let (csv, setup) = (file("chord.csv"), file("chord.toml"));
    std::fs::write(&csv, "0.01,1\n0.24,0.2\n").unwrap();
    let path = setup.to_str().unwrap();
    let profile = ["--profile", csv.to_str().unwrap()];
    let value = json(&[&["texture", "--plate", "al-bending", "--out", path], &profile[..]].concat());
    let chord = &value["chord"];
    assert_eq!(chord["is_used"], true);
    let (gain_db, base_hz) = (number(chord, "chord_gain_db"), number(chord, "base_frequency_hz"));
    assert!(gain_db > 0.3 && gain_db == number(chord, "headroom_db"), "{gain_db}");
    for (tone, harmonic) in
        value["tones"].as_array().unwrap().iter().zip(chord["harmonics"].as_array().unwrap())
    {
        assert!((number(tone, "frequency_hz") - harmonic.as_f64().unwrap() * base_hz).abs() < 1e-3);
    }
    let driven = json(&["drive", "--port", "sim", "--setup", path, "--for", "50ms"]);
    assert_eq!((number(&driven, "chord_gain_db"), number(&driven, "clipped_samples")), (gain_db, 0.0));
    let sum = |value: &Value| -> f64 {
        value["tones"].as_array().unwrap().iter().map(|tone| number(tone, "level")).sum()
    };
    assert!((sum(&driven) / sum(&value) - 10f64.powf(gain_db / 20.0)).abs() < 1e-6);
    // A tone that was moved is no multiple: the setup is played tone by tone.
    let text = std::fs::read_to_string(&setup).unwrap();
    let place = text.lines().find(|line| line.starts_with("position_m")).unwrap();
    std::fs::write(&setup, text.replacen(place, "position_m = 0.2501", 1)).unwrap();
    let driven = json(&["drive", "--port", "sim", "--setup", path, "--for", "50ms"]);
    assert!(driven["chord_gain_db"].is_null());
    // On the membrane 24 Hz are too coarse.
    let coarse = texture(&profile);
    assert_eq!(
        (&coarse["chord"]["is_used"], &coarse["chord"]["chord_gain_db"]),
        (&Value::from(false), &Value::Null)
    );
}

#[test]
fn what_is_out_of_reach_is_refused_with_its_range() {
    for (more, expected) in [
        (&["--solid", "20mm"][..], "--solid"),
        (&["--stripes", "1mm"], "--stripes"),
        (&["--beat", "120mm:0.1Hz"], "1 Hz to 1 kHz"),
        (&["--beat", "120mm"], "PLACE:FREQUENCY"),
        (&["--solid", "200mm", "--tones", "17"], "1 to 16"),
        (&["--solid", "200mm", "--stripes", "12mm"], "--stripes"),
        (&[], "--solid"),
    ] {
        refused(&[&["texture", "--plate", "membrane"], more].concat(), 2, &[expected]);
    }
}

#[test]
fn merit_has_the_figures_of_the_readmes_table() {
    let page = include_str!("../../plate/PERFORMANCE.md");
    let rows = page.lines().skip_while(|line| !line.starts_with("| preset | contrast"));
    let rows: Vec<&str> = rows.skip(2).take_while(|line| line.starts_with("| `")).collect();
    assert_eq!(rows.len(), 8);
    for row in rows {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        let name = cells[1].trim_matches('`');
        let (start_m, end_m) = slipline_plate::preset(name).unwrap().span_m();
        let boundary = format!("{}m", 0.5 * (start_m + end_m));
        let value = json(&["merit", "--plate", name, "--turning-point", &boundary]);
        let merit = &value["turning_points"][0];
        let shown = [
            format!("{:.0} dB", number(merit, "contrast_db")),
            format!("{:.1} dB", number(merit, "ripple_db")),
            format!("{:.0} mm", 1e3 * number(merit, "edge_width_m")),
            format!("{:.1} ms", 1e3 * number(merit, "switching_time_s")),
            format!("{:.0} mm", 1e3 * number(merit, "two_point_m")),
            format!("{:.0}", number(merit, "bits_per_s")),
        ];
        assert_eq!(&cells[2..8], &shown, "{name}");
    }
}

#[test]
fn merit_lists_each_boundary_that_has_room_before_it() {
    let value = json(&["merit", "--plate", "membrane"]);
    let boundaries = value["turning_points"].as_array().unwrap();
    // The first of five has none.
    assert_eq!(boundaries.len(), 4);
    for boundary in boundaries {
        assert!(number(boundary, "contrast_db") > 20.0 && number(boundary, "ripple_db") < 2.0, "{boundary}");
        assert!((0.005..0.1).contains(&number(boundary, "switching_time_s")), "{boundary}");
    }
    let one = json(&["merit", "--plate", "membrane", "--turning-point", "220mm"]);
    assert!((number(&one["turning_points"][0], "turning_point_m") - 0.22).abs() < 1e-12);
    refused(&["merit", "--plate", "membrane", "--turning-point", "85mm"], 2, &["even area"]);
}
