//! Setup files of the window: `simulate` and `record` play what `drive --setup` plays.

use super::{failure, file, json, number, said, says};
use serde_json::Value;
use slipline_link::simulator::loopback::Loopback;
use slipline_link::{Request, Sounding};
use slipline_model::field::simulation::{SAMPLE_RATE_HZ, table_for};
use slipline_model::setup::file::{Opened, read, write};
use slipline_model::setup::{Setup, ToneSetup, edit};
use slipline_model::texture::{chord_of, sounding};
use std::path::PathBuf;
use std::sync::Arc;

/// Two tones with phases, in slots that are not the first ones, at a lower master level.
fn two_tones(name: &str) -> (Setup, PathBuf) {
    let mut setup = Setup::new(Arc::new(slipline_plate::preset("membrane").unwrap()));
    let tone = |slot, position_m, level, phase_turns| ToneSetup { slot, position_m, level, phase_turns };
    setup.tones = vec![tone(3, 0.12, 0.5, 0.25), tone(1, 0.2, 0.3, 0.5)];
    setup.master_db = -6.0;
    setup.glide_s = 0.03;
    let path = file(name);
    std::fs::write(&path, write(&setup)).unwrap();
    (setup, path)
}

/// The samples of a recording as codes.
fn codes(wav: &[u8]) -> Vec<u16> {
    let samples = wav[44..].as_chunks::<2>().0;
    samples.iter().map(|bytes| (i32::from(i16::from_le_bytes(*bytes)) / 16 + 2048) as u16).collect()
}

/// The codes with which a device begins to play a setup.
fn played(setup: &Setup, count: usize) -> (Vec<u16>, Sounding) {
    let (_, table) = table_for(&setup.plate, SAMPLE_RATE_HZ).unwrap();
    let mut chain = Loopback::connect(SAMPLE_RATE_HZ).unwrap();
    let sounding = sounding(setup, chord_of(setup, &table), &table, chain.view()).unwrap();
    chain.use_table(table).unwrap();
    let begin = chain.samples();
    let mut codes = Vec::new();
    let play = Request::Play(sounding.clone());
    let at = chain.perform(play, |block| codes.extend_from_slice(block)).unwrap();
    chain.pass(count as u64, |block| codes.extend_from_slice(block));
    (codes[(at - begin) as usize..][..count].to_vec(), sounding)
}

fn recorded(setup: &str, more: &[&str]) -> (Value, Vec<u16>) {
    let wav = file("setup.wav");
    let path = wav.to_str().unwrap();
    let value = json(&[&["record", "--setup", setup, "--out", path, "--force"], more].concat());
    (value, codes(&std::fs::read(wav).unwrap()))
}

#[test]
fn a_setup_is_recorded_with_its_levels_phases_glide_and_master_level() {
    let (setup, path) = two_tones("two.toml");
    let path = path.to_str().unwrap();
    let (value, codes) = recorded(path, &["--for", "40ms"]);
    let (wanted, sounding) = played(&setup, 16_000);
    assert_eq!(sounding, Sounding::Drive(edit::drive(&setup)));
    assert!(codes == wanted, "not the codes of the setup");
    let levels: Vec<f64> = value["tones"].as_array().unwrap().iter().map(|it| number(it, "level")).collect();
    let master = 10f64.powf(-0.3);
    assert!((levels[0] - 0.5 * master).abs() < 1e-12 && (levels[1] - 0.3 * master).abs() < 1e-12);
    assert_eq!(value["feeling"]["from"], path);
    // The plate is the file's.
    let refused = failure(&["record", "--setup", path, "--plate", "membrane", "--out", "x.wav"], 2);
    assert!(refused.contains("cannot be used with"), "{refused}");
}

#[test]
fn a_setup_is_simulated_with_its_master_level() {
    let (_, path) = two_tones("two-simulated.toml");
    let value = json(&["simulate", "--setup", path.to_str().unwrap()]);
    for (tone, (place_m, level)) in value["tones"].as_array().unwrap().iter().zip([(0.12, 0.5), (0.2, 0.3)]) {
        assert!((number(tone, "turning_point_m") - place_m).abs() < 1e-12);
        assert!((number(tone, "level") - level * 10f64.powf(-0.3)).abs() < 1e-12);
        let measured = number(tone, "measured_peak_amplitude_m");
        assert!((measured / number(tone, "peak_amplitude_m") - 1.0).abs() < 0.02, "{measured}");
        // Its level is that of the plate's peak.
        let peak_m = number(tone, "level") * number(&value, "peak_at_full_scale_m");
        assert!((measured / peak_m - 1.0).abs() < 0.03, "{measured} {peak_m}");
    }
}

#[test]
fn a_chord_is_recorded_and_simulated_as_it_is_played() {
    let path = file("setup-chord.toml");
    let path = path.to_str().unwrap();
    let texture =
        json(&["texture", "--plate", "al-bending", "--solid", "250mm", "--tones", "4", "--out", path]);
    assert_eq!(texture["chord"]["is_used"], true, "{}", texture["chord"]);
    let Opened::Setup(setup) = read(&std::fs::read_to_string(path).unwrap()).unwrap() else { panic!() };
    let (value, codes) = recorded(path, &["--for", "50ms"]);
    let (wanted, sounding) = played(&setup, 20_000);
    assert!(matches!(sounding, Sounding::Chord(_)));
    assert!(codes == wanted, "not the codes of the chord");
    assert!(
        (number(&value, "chord_gain_db") - setup.chord_gain_db.unwrap()).abs() < 1e-9,
        "{value} {:?}",
        setup.chord_gain_db
    );
    let value = json(&["simulate", "--setup", path, "--for", "100ms"]);
    assert!(
        (number(&value, "chord_gain_db") - setup.chord_gain_db.unwrap()).abs() < 1e-9,
        "{value} {:?}",
        setup.chord_gain_db
    );
    let base_hz = 400e3 / 16_384.0;
    for (tone, of_setup) in value["tones"].as_array().unwrap().iter().zip(&setup.tones) {
        let multiple = number(tone, "frequency_hz") / base_hz;
        assert!((multiple - multiple.round()).abs() < 1e-9, "{multiple}");
        assert!((number(tone, "turning_point_m") - of_setup.position_m).abs() < 1e-12);
        let measured = number(tone, "measured_peak_amplitude_m");
        assert!((measured / number(tone, "peak_amplitude_m") - 1.0).abs() < 0.05, "{measured}");
    }
    let refused = failure(&["simulate", "--setup", path, "--no-table"], 2);
    assert!(refused.contains("cannot be used with"), "{refused}");
    let refused = failure(&["drive", "--port", "sim", "--setup", path, "--stdin"], 2);
    assert!(refused.contains("the setup is a chord"), "{refused}");
}

#[test]
fn a_plate_near_the_files_is_simulated() {
    let simulate = ["simulate", "--plate", "membrane", "--turning-point", "120mm", "--for", "50ms"];
    let with = |actual: &str| json(&[&simulate[..], &["--actual-plate", actual]].concat());
    let (one, other) = (with("secret:2"), with("secret:3"));
    assert!(number(&one, "sensitivity_db") > 0.0, "{one}");
    assert_ne!(one["actual_turning_point_m"], other["actual_turning_point_m"]);
    assert_eq!(one["measured_peak_position_m"], with("secret:2")["measured_peak_position_m"]);
    let refused = failure(&[&simulate[..], &["--actual-plate", "secret:x"]].concat(), 2);
    assert!(refused.contains("'secret:x' for '--actual-plate'"), "{refused}");
}

#[test]
fn the_text_of_a_setups_simulation_names_its_tones_and_feeling() {
    let (_, path) = two_tones("two-text.toml");
    let text = said(&["simulate", "--setup", path.to_str().unwrap(), "--for", "50ms"]);
    says(&text, &["Tone 4: ", "Tone 2: ", "two-text.toml\" (illustrative)", "level 0.251"]);
}
