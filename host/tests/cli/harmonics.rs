//! Harmonics of the drive on the command line: where they are felt, their cancellation, and what is refused.

use super::{file, json, number, refused, said, says};

const HARMONICS: &str = "\n[actuator]\nharmonic_level = 0.8\nharmonic_2_points = [[50.0, -40.0, 0.0], [500.0, -40.0, 0.0]]\n\
                         harmonic_3_points = [[50.0, -46.0, 0.0], [500.0, -46.0, 0.0]]\n";

/// The path of a membrane's file whose drive has 1 % of second and 0.5 % of third harmonic.
fn distorting(name: &str) -> String {
    let path = file(name);
    let text = slipline_plate::preset("membrane").unwrap().to_toml() + HARMONICS;
    std::fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn a_second_boundary_is_stated_by_check_drive_and_merit_and_cancelled_on_request() {
    let plate = distorting("second-boundary.toml");
    let check = ["check", "--plate", &plate, "--turning-point", "80mm", "--level", "0.8"];
    says(&said(&check), &["second boundary at 231 mm, +12 dB over the threshold; silent below 0.25 %"]);
    let drive =
        ["drive", "--port", "sim", "--plate", &plate, "--turning-point", "80mm:0.8", "--for", "100ms"];
    let tone = &json(&drive)["tones"][0];
    assert!((number(tone, "second_boundary_m") - 0.231).abs() < 2e-3, "{tone}");
    assert!((number(tone, "second_boundary_db") - 12.1).abs() < 1.0, "{tone}");
    assert!((number(tone, "second_boundary_felt_to_m") - 0.256).abs() < 2e-3, "{tone}");
    assert!(tone["felt"].as_str().unwrap().ends_with("second boundary at 231 mm, +12 dB over the threshold"));
    let cancelled = [&drive[..], &["--cancel-harmonics"]].concat();
    let alone = &json(&cancelled)["tones"][0];
    assert!(alone["second_boundary_m"].is_null() && alone["felt_edge_m"] == tone["felt_edge_m"], "{alone}");
    says(&said(&cancelled), &["Companions cancel the drive's harmonics."]);
    let merit = &json(&["merit", "--plate", &plate, "--turning-point", "180mm"])["turning_points"][0];
    assert!(number(merit, "felt_contrast_db") < number(merit, "contrast_db") - 20.0, "{merit}");
}

#[test]
fn harmonics_that_are_not_stated_and_files_of_another_kind_are_refused() {
    let drive =
        ["drive", "--port", "sim", "--plate", "membrane", "--turning-point", "120mm", "--cancel-harmonics"];
    refused(&drive, 2, &["states no harmonics", "slipline measure --harmonics"]);
    let plate = distorting("too-loud.toml");
    let loud = ["--turning-point", "120mm:100%", "--turning-point", "160mm:100%", "--cancel-harmonics"];
    refused(
        &[&["drive", "--port", "sim", "--plate", &plate], &loud[..]].concat(),
        2,
        &["lower the level by"],
    );
    let measure = ["measure", "--port", "sim", "--plate", "membrane", "--sensor", "32mm"];
    let more = |more: &[&'static str]| [&measure[..], more].concat();
    refused(&more(&["--harmonics", "--out", "a.csv"]), 2, &["a.csv", ".toml with --harmonics"]);
    refused(&more(&["--out", "a.toml"]), 2, &["a.toml", ".csv, .uff, .unv or .frd"]);
    refused(&more(&["--harmonics", "1"]), 2, &["2 to 64"]);
    refused(&more(&["--harmonics", "--input", "current"]), 2, &["--input current"]);
    refused(&more(&["--actual-coil", "1%"]), 2, &["such as 1%,0.5%"]);
    refused(&more(&["--actual-coil", "60%,0%"]), 2, &["coil.force_factor[0]", "-0.4 to 0.4"]);
}
