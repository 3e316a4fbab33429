//! Recordings as recorders write them, and files of other kinds: read, or called what they are.

use super::failure;
use std::path::Path;

#[test]
fn a_recording_with_any_header_is_read_and_another_file_is_refused_by_its_kind() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cli/recordings");
    let played = folder.join("sweep.toml");
    let mut count = 0;
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        let (words, refused) = match name.rsplit_once('.').unwrap().1 {
            // Their sound is that of `wav_ok.wav`, which is short.
            "wav" => ("shorter than the sweep, or silent", "cannot be read"),
            "flac" => ("the FLAC file cannot be read: it is empty or damaged", "WAV"),
            "m4a" => ("the M4A file cannot be read: it is empty or damaged", "WAV"),
            "xlsx" => ("it is a spreadsheet: save it as CSV", "pair"),
            _ => continue,
        };
        let command = ["calibrate", "--plate", "membrane", "--data", path.to_str().unwrap(), "--played"];
        let stated = [played.to_str().unwrap(), "--sensor", "32mm", "--kind", "acceleration"];
        let output = super::slipline(&[&command[..], &stated].concat());
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(message.contains(words) && !message.contains(refused), "{name}: {message}");
        count += 1;
    }
    assert_eq!(count, 10);
    let empty = super::file("empty.txt");
    std::fs::write(&empty, "").unwrap();
    let one = ["calibrate", "--plate", "membrane", "--sensor", "32mm", "--data", empty.to_str().unwrap()];
    assert!(failure(&one, 2).contains("the file is empty"));
}
