//! Tones by their felt edges, turning points and frequencies: `drive`, `simulate` and `record`.

use super::{failure, file, json, number, refused, said};
use serde_json::Value;
use slipline_link::protocol::frame::CRC;
use slipline_model::field::edge_reach::turning_point_of;
use slipline_model::field::line::{Holds, Line};
use slipline_model::field::simulation::{SAMPLE_RATE_HZ, table_for};
use slipline_model::setup::file::feeling;
use slipline_model::setup::{Setup, ToneSetup};
use slipline_plate::DriveTable;
use slipline_plate::feeling::Feeling;
use std::sync::Arc;

/// The default level.
const LEVEL: f64 = 0.8;

/// The arguments of each command for a short run.
fn commands(wav: &str) -> [Vec<&str>; 3] {
    [
        vec!["drive", "--port", "sim", "--for", "1ms"],
        vec!["simulate", "--seconds", "20ms"],
        vec!["record", "--seconds", "1ms", "--force", "--wav", wav],
    ]
}

/// The first tone of a command's JSON.
fn tone(value: &Value) -> &Value {
    value.get("tones").map_or(value, |tones| &tones[0])
}

/// Where the window's line of the tone at this turning point is, if it holds the felt edge.
fn line_m(setup: &Setup, table: &DriveTable, position_m: f64) -> Option<f64> {
    let tone = ToneSetup { slot: 0, position_m, level: LEVEL, phase_turns: 0.0 };
    let line = Line::of(setup, &tone, Some(table));
    (line.holds == Holds::FeltEdge).then_some(line.place_m)
}

/// Each command puts the felt edge that is asked for where the window's line is, within 0.01 mm, or refuses it.
fn compare(preset: &str) {
    let plate = Arc::new(slipline_plate::preset(preset).unwrap());
    let (table, _) = table_for(&plate, SAMPLE_RATE_HZ).unwrap();
    let setup = Setup::new(plate);
    let refusal = turning_point_of(&setup, LEVEL, &table, f64::NAN).unwrap_err();
    let wav = file(&format!("edge-{preset}.wav"));
    for command in commands(wav.to_str().unwrap()) {
        let command = [&command[..], &["--plate", preset]].concat();
        let with = |option, text: &str| json(&[&command[..], &[option, text]].concat());
        if let Some((low_m, high_m)) = refusal.reach_m.first() {
            let asked_mm = (1e4 * (0.4 * low_m + 0.6 * high_m)).round() / 10.0;
            let value = with("--felt-edge", &format!("{asked_mm}mm"));
            let (felt_m, turning_m) =
                (number(tone(&value), "felt_edge_m"), number(tone(&value), "turning_point_m"));
            let line_m = line_m(&setup, &table, turning_m).expect("a felt edge");
            assert!((felt_m - 1e-3 * asked_mm).abs() < 1e-5, "{command:?}: {felt_m}");
            assert!((line_m - felt_m).abs() < 1e-5, "{command:?}: {line_m} {felt_m}");
            assert!(turning_m < felt_m, "{command:?}: {turning_m} {felt_m}");
            let by_person = &tone(&value)["felt_edge_by_person_m"];
            assert!(by_person[0].as_f64() < Some(felt_m), "{by_person}");
            assert_eq!(value["feeling"]["from"], "default");
        }
        let message = failure(&[&command[..], &["--felt-edge", "1mm"]].concat(), 2);
        let wanted = refusal.sentence("invalid value '1mm' for '--felt-edge'");
        assert!(message.contains(&wanted), "{message}");
    }
}

#[test]
fn a_felt_edge_is_the_windows_line_or_refused() {
    for preset in ["membrane", "al-bending"] {
        compare(preset);
    }
}

#[test]
#[ignore = "all presets, three commands each: .ci/run statistics"]
fn a_felt_edge_is_the_windows_line_or_refused_on_every_preset() {
    slipline_plate::presets().iter().for_each(|preset| compare(preset.name));
}

/// The CRC-32 of the recording of a preset's tones.
fn codes(arguments: &str) -> String {
    let wav = file("codes.wav");
    let more = ["--seconds", "10ms", "--force", "--wav", wav.to_str().unwrap()];
    let arguments: Vec<&str> = ["record", "--plate"].into_iter().chain(arguments.split(' ')).collect();
    json(&[&arguments[..], &more].concat());
    format!("{:08x}", CRC.checksum(&std::fs::read(wav).unwrap()))
}

#[test]
fn a_turning_point_gives_the_codes_that_a_boundary_gave() {
    // Recorded with `--boundary 120mm --tone 200mm:0.1` and `--boundary 105Hz --level 0.5` by the version before.
    assert_eq!(codes("membrane --turning-point 120mm --turning-point 200mm:0.1"), "dffea6b4");
    for option in ["--turning-point", "--felt-edge"] {
        // A frequency is neither place.
        assert_eq!(codes(&format!("membrane {option} 105Hz --level 0.5")), "6ed51933");
    }
}

#[test]
fn an_edge_that_no_tone_has_is_refused_before_a_device_is_asked() {
    // There is no device: the refusal comes first.
    let drive = ["drive", "--port", "unix:/no/such/device", "--plate", "membrane", "--felt-edge"];
    for (text, turns) in [
        // The span begins beyond.
        ("120mm", "; --turning-point 120mm plays 105.1 Hz, whose wave turns there"),
        ("120mm:0.5", "; --turning-point 120mm:0.5 plays 105.1 Hz"),
        // Felt to the end.
        ("320mm", "; --turning-point takes 80 to 280 mm"),
        ("nan", "; --turning-point takes"),
    ] {
        let message = failure(&[&drive[..], &[text]].concat(), 2);
        let wanted = format!("invalid value '{text}' for '--felt-edge': must be ");
        assert!(message.contains(&wanted) && message.contains(turns), "{message}");
    }
    refused(
        &[&drive[..], &["5kHz"]].concat(),
        2,
        &["'5kHz' for '--felt-edge': must be 87.57 to 219 Hz, on the plate"],
    );
    let no_table = ["simulate", "--plate", "membrane", "--felt-edge", "250mm", "--no-table"];
    assert!(failure(&no_table, 2).contains("with --no-table name a --turning-point"));
    let both = [&drive[..], &["250mm", "--turning-point", "120mm"]].concat();
    assert!(failure(&both, 2).contains("cannot be used with"));
}

#[test]
fn the_words_with_two_meanings_are_refused_with_the_words_in_their_place() {
    let wav = file("gone.wav");
    let commands = commands(wav.to_str().unwrap());
    let others = [vec!["check"], vec!["merit"]];
    for command in commands.iter().chain(&others) {
        for (option, text) in [("--boundary", "120mm"), ("--tone", "200mm:0.3")] {
            let message = failure(&[&command[..], &["--plate", "membrane", option, text]].concat(), 2);
            for part in [option, &format!("write --turning-point {text} for what it did"), "--felt-edge"] {
                assert!(message.contains(part), "{command:?}: {message}");
            }
        }
    }
    assert!(!wav.exists());
}

#[test]
fn the_feeling_comes_from_the_file_and_is_named() {
    let path = file("finger.toml");
    std::fs::write(&path, feeling::write(&Feeling { threshold: 4.0, ..Feeling::default() })).unwrap();
    let name = path.to_str().unwrap();
    let wav = file("finger.wav");
    let at = ["record", "--plate", "membrane", "--turning-point", "120mm", "--seconds", "1ms", "--force"];
    let at = [&at[..], &["--wav", wav.to_str().unwrap()]].concat();
    let (usual, dull) = (json(&at), json(&[&at[..], &["--feeling", name]].concat()));
    let felt_m = |value: &Value| number(tone(value), "felt_edge_m");
    // 12 dB of threshold.
    assert!((10e-3..40e-3).contains(&(felt_m(&usual) - felt_m(&dull))), "{usual} {dull}");
    assert_eq!((&dull["feeling"]["from"], &dull["feeling"]["threshold"]), (&name.into(), &4.0.into()));
    assert!(said(&at).contains("Felt edges are those of a usual finger (illustrative)."));
    let named = said(&[&at[..], &["--feeling", name]].concat());
    assert!(
        named.contains("finger.toml\" (illustrative).") && named.contains(" mm depending on the person;"),
        "{named}"
    );
    std::fs::write(&path, "[feeling]\nthreshold = 0.0\n").unwrap();
    refused(&[&at[..], &["--feeling", name]].concat(), 2, &["finger.toml: feeling.threshold"]);
    let setup = ["drive", "--port", "sim", "--setup", "x.toml", "--feeling", name];
    assert!(failure(&setup, 2).contains("cannot be used with"));
}
