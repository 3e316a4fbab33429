//! `slipline sweep`, and the refusals of its recordings by `slipline calibrate`. `tests/tests/recorded.rs` calibrates a plate by
//! recordings.

use super::{failure, file, json, number, refused};
use std::path::{Path, PathBuf};

const PLAYED: [&str; 7] = ["sweep", "--port", "sim", "--plate", "al-bending", "--time", "150ms"];

/// A recording of silence.
fn silence(name: &str, seconds: u32) -> PathBuf {
    let path = file(name);
    let spec = hound::WavSpec {
        channels: 2,
        sample_rate: 96_000,
        bits_per_sample: 16,
        sample_format: hound::SampleFormat::Int,
    };
    let mut writer = hound::WavWriter::create(&path, spec).unwrap();
    for _ in 0..2 * 96_000 * seconds {
        writer.write_sample(0_i16).unwrap();
    }
    writer.finalize().unwrap();
    path
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

#[test]
fn a_sweep_is_played_and_described_and_a_recording_needs_the_description_its_place_and_its_channel() {
    let out = file("sweep.toml");
    let value = json(&[&PLAYED[..], &["--level", "0.4", "--out", text(&out)]].concat());
    assert_eq!(value["levels"].as_array().unwrap().len(), 2);
    assert!((number(&value, "sweep_s") - 0.15).abs() < 1e-4, "{value}");
    assert!(number(&value, "apart_s") > 1.0 && number(&value, "played_s") < 4.0, "{value}");
    assert!(std::fs::read_to_string(&out).unwrap().contains("slipline_sweep = 1"));
    refused(&[&PLAYED[..], &["--out", text(&out)]].concat(), 2, &["--force"]);

    let (near, far) = (silence("near.wav", 5), silence("far.wav", 1));
    let data = ["calibrate", "--plate", "al-bending", "--data", text(&near), "--data", text(&far)];
    let read = |more: &[&str]| failure(&[&data[..], more].concat(), 2);
    let places = ["--sensor", "34mm", "--sensor", "187mm"];
    let played = ["--played", text(&out)];
    let all = [&places[..], &played, &["--kind", "velocity"]].concat();
    for (more, expected) in [
        (&places[..], "near.wav: a recording: name the description of its sweep with --played"),
        (&played, "near.wav: a recording: state its sensor's place with --sensor PLACE"),
        (
            &[&places[..], &played].concat(),
            "near.wav: it does not state what its sensor measures: add --kind",
        ),
        (
            &[&all[..], &["--channel", "3"]].concat(),
            "near.wav: channel 3: must be 1 to 2, the channels of the file",
        ),
        (&all, "near.wav: the recording is shorter than the sweep, or silent"),
        (
            &[&all[..], &played, &played].concat(),
            "3 --played: must be 1, or 2: one for each file that it describes",
        ),
        (
            &[&all[..], &["--channel", "1", "--channel", "2", "--channel", "1"]].concat(),
            "3 --channel: must be 1, or 2",
        ),
        (&[&places[..], &["--played", text(&near), "--kind", "velocity"]].concat(), "near.wav: "),
    ] {
        let message = read(more);
        assert!(message.contains(expected), "{expected}\n{message}");
    }
    let csv = file("no-recording.csv");
    std::fs::write(&csv, "100 -20\n").unwrap();
    refused(
        &["calibrate", "--plate", "al-bending", "--data", text(&csv), "--played", text(&out)],
        2,
        &["no file of --data is a recording"],
    );
    std::fs::write(&near, b"RIFF\x04\0\0\0WAVE").unwrap();
    assert!(read(&all).contains("near.wav: the WAV file cannot be read: "), "{}", read(&all));
}

#[test]
fn a_sweep_out_of_range_names_its_field_and_range() {
    let out = file("never.toml");
    let refused = |more: &[&str]| failure(&[&PLAYED[..5], more, &["--out", text(&out)]].concat(), 2);
    assert!(refused(&["--time", "11s"]).contains("10 ms to 10 s"), "{}", refused(&["--time", "11s"]));
    assert!(
        refused(&["--time", "10ms"]).contains("time = 10 ms: must be "),
        "{}",
        refused(&["--time", "10ms"])
    );
    assert!(!out.exists());
}
