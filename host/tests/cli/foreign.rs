//! `slipline calibrate` from tables of other programs: what was read of them is reported, and `--columns` decides.

use super::{failure, json, number, slipline};
use std::path::Path;

/// The arguments of a calibration by a pair of files of the folder of cases.
fn arguments<'a>(paths: &'a [String; 2], more: &[&'a str]) -> Vec<&'a str> {
    let mut arguments = vec!["calibrate", "--plate", "membrane", "--kind", "displacement"];
    arguments.extend(paths.iter().flat_map(|path| ["--data", path.as_str()]));
    arguments.extend(["--sensor", "32mm", "--sensor", "176mm"]);
    arguments.extend(more);
    arguments
}

fn pair(name: &str) -> [String; 2] {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("plate/tests/cases");
    ["near", "far"].map(|which| folder.join(format!("{name}_{which}.txt")).to_str().unwrap().to_owned())
}

#[test]
fn what_was_read_of_a_table_is_printed_before_it_is_used_and_is_in_json() {
    let paths = pair("d01_displacement");
    let arguments = arguments(&paths, &[]);
    let output = slipline(&arguments);
    let message = String::from_utf8(output.stderr).unwrap();
    for path in &paths {
        let line = format!("slipline: {path}: 60 rows, ");
        assert!(message.contains(&line), "{message}");
    }
    let understood =
        "*Frequency (Hz)* as frequency, *Displacement (m)* as displacement, *Phase (deg)* as phase";
    assert!(output.status.success() && message.matches(understood).count() == 2, "{message}");
    let value = json(&arguments);
    let read = &value["read"][1];
    assert_eq!((&read["rows"], &read["rows_in_band"]), (&60.into(), &58.into()), "{value}");
    assert_eq!(read["columns"][1]["quantity"], "displacement", "{value}");
    assert_eq!(read["columns"][1]["unit"], "m", "{value}");
    assert!(read["file"].as_str().unwrap().ends_with("d01_displacement_far.txt"), "{value}");
    assert!((number(read, "low_hz") - 81.6231).abs() < 1e-9, "{value}");
}

#[test]
fn two_levels_are_refused_with_their_columns_until_the_option_decides() {
    let paths = pair("d31_two_levels");
    let message = failure(&arguments(&paths, &[]), 2);
    for part in [
        "d31_two_levels_near.txt: line 1: 2 columns may be the level: *Magnitude (dB) Ref*, *Magnitude (dB) Resp*",
        "Its columns: 1 *Frequency (Hz)*, 2 *Magnitude (dB) Ref*, 3 *Magnitude (dB) Resp*, 4 *Phase (deg)*",
        "say what they are with --columns, such as --columns frequency=1,level=2:dB,phase=3:deg",
    ] {
        assert!(message.contains(part), "{message}");
    }
    let value = json(&arguments(&paths, &["--columns", "frequency=1,level=3:dB,phase=4"]));
    assert_eq!(
        (&value["accepted"], &value["read"][0]["columns"][1]["quantity"]),
        (&true.into(), &().into()),
        "{value}"
    );
    let speed =
        value["parameters"].as_array().unwrap().iter().find(|it| it["name"] == "model.wave_speed_m_per_s");
    assert!((number(speed.unwrap(), "value") - 11.87).abs() < 0.02, "{value}");
    for (columns, words) in [
        ("frequency=1,pahse=4", "did you mean phase?"),
        ("frequency=1,level=9:dB", "there is no column 9"),
        ("frequency=1", "a frequency is needed, and either a level or magnitude"),
    ] {
        let message = failure(&arguments(&paths, &["--columns", columns]), 2);
        assert!(message.contains(words), "{columns}: {message}");
    }
}
