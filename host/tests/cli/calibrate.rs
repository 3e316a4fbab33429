//! `slipline calibrate` from files of measurements and from felt edges.

use super::{failure, file, json, number, refused, said, says, slipline};
use serde_json::Value;
use slipline_plate::calibrate::{MeasuredPoint, Measurement, SensorKind, band_hz};
use slipline_plate::feeling::{Feeling, FeltTone};
use slipline_plate::{Complex64, DriveEnd, Equation, Peak, Plate, PlateSpec, preset, respond_batch};
use std::path::{Path, PathBuf};

const POINTS: usize = 801;

/// The preset with 3 % less wave speed: a boundary is 6 mm off.
fn actual() -> Plate {
    preset("membrane").unwrap().with_wave_speed(0.97).unwrap()
}

/// What a sensor on `plate` measures, with noise of -40 dB.
fn measured(plate: &Plate, place_m: f64) -> Measurement {
    let (low, high) = band_hz(&preset("membrane").unwrap());
    let frequencies: Vec<f64> = (0..60).map(|i| low * (high / low).powf(f64::from(i) / 59.0)).collect();
    let fields = respond_batch(plate, &frequencies, POINTS, Equation::Corrected).unwrap();
    let at = place_m / plate.length_m() * (POINTS - 1) as f64;
    // A sequence without a period in 60 points stands for noise.
    let mut phase = place_m;
    let points = frequencies.iter().zip(&fields).map(|(&frequency_hz, field)| {
        phase = (phase * 9301.0 + 0.617).fract();
        let (left, t) = (at as usize, at.fract());
        let here = field[left] * (1.0 - t) + field[left + 1] * t;
        let response = here + Complex64::from_polar(0.01, std::f64::consts::TAU * phase);
        MeasuredPoint { frequency_hz, response, noise: 0.01, headroom_db: Some(20.0) }
    });
    Measurement::at(place_m, SensorKind::Displacement, points.collect())
}

/// A file of a measurement.
fn data(name: &str, measurement: &Measurement) -> PathBuf {
    let path = file(name);
    std::fs::write(&path, measurement.to_csv()).unwrap();
    path
}

fn calibrate<'a>(data: &[&'a Path], more: &[&'a str]) -> Vec<&'a str> {
    let mut arguments = vec!["calibrate", "--plate", "membrane"];
    arguments.extend(data.iter().flat_map(|path| ["--data", path.to_str().unwrap()]));
    arguments.extend(more);
    arguments
}

#[test]
fn two_places_correct_a_plate_file_that_every_other_command_takes() {
    let plate = actual();
    let near = data("near.csv", &measured(&plate, 0.032));
    let far = data("far.csv", &measured(&plate, 0.176));
    let out = file("fitted.toml");
    let arguments = calibrate(&[&near, &far], &["--out", out.to_str().unwrap()]);
    let value = json(&arguments);
    assert_eq!(value["accepted"], true);
    assert!(number(&value, "chi2_per_n") < 2.0 && number(&value, "misfit") < 0.03, "{value}");
    let parameter = |name: &str| {
        let all = value["parameters"].as_array().unwrap();
        all.iter().find(|it| it["name"] == name).unwrap_or_else(|| panic!("no {name}: {value}"))
    };
    let speed = parameter("model.wave_speed_m_per_s");
    let slipline_plate::Model::Membrane { wave_speed_m_per_s, .. } = plate.spec().model else { panic!() };
    assert!((number(speed, "value") / wave_speed_m_per_s - 1.0).abs() < 0.01, "{speed}");
    assert!(number(speed, "low") < number(speed, "value") && number(speed, "value") < number(speed, "high"));
    assert!((number(parameter("place_m"), "value") - 0.032).abs() < 1e-3);
    let before = &value["before"];
    assert!((number(before, "turning_point_error_m") - 6e-3).abs() < 1.5e-3, "{before}");
    assert!(number(&value, "turning_point_tolerance_m") < 1e-3 && number(&value, "level_tolerance_db") < 1.0);
    assert!(number(before, "level_error_db") > 0.0);
    let caution = value["caution"].as_str().expect("what no measurement shows");
    assert!(caution.contains("1.0 mm from its mark moves the boundary by up to"), "{caution}");

    let fitted = Plate::from_toml(&std::fs::read_to_string(&out).unwrap()).unwrap();
    let turning = |plate: &Plate| plate.turning_point_m(150.0).unwrap();
    assert!((turning(&fitted) - turning(&plate)).abs() < 0.5e-3);
    let table = json(&["table", "--plate", out.to_str().unwrap()]);
    assert_eq!(table["knots"].as_array().unwrap().len(), 1025);

    // The lights use how well it is known; at the levels that were measured.
    let check = ["check", "--plate", out.to_str().unwrap(), "--turning-point", "160mm"];
    let checked = said(&[&check[..], &["--json"]].concat());
    let checked: Value = serde_json::from_str(&checked).unwrap();
    let known_m = number(&checked, "turning_point_tolerance_m");
    assert!(known_m > 0.0 && known_m <= 1.5 * number(&value, "turning_point_tolerance_m"), "{checked}");
    assert!((number(&checked, "level_tolerance_db") - number(&value, "level_tolerance_db")).abs() < 1e-9);
    let width = checked["lights"].as_array().unwrap().iter().find(|it| it["name"] == "width").unwrap();
    assert!(number(width, "low") < number(width, "value") && number(width, "value") < number(width, "high"));
    let text = said(&check);
    assert!(text.starts_with("By its calibration the turning point is known to ±"), "{text}");
    assert!(text.contains("It holds over the calibrated interval"), "{text}");

    refused(&arguments, 2, &["fitted.toml", "--force"]);
    let text = said(&[&arguments[..], &["--force"]].concat());
    says(
        &text,
        &["model.wave_speed_m_per_s", "Before", "After", "mm off over the span", "Written to", caution],
    );
}

#[test]
fn a_third_place_is_a_check() {
    let plate = actual();
    let [near, far, check] = [("check-a.csv", 0.032), ("check-b.csv", 0.12), ("check-c.csv", 0.176)]
        .map(|(name, place_m)| data(name, &measured(&plate, place_m)));
    let two = json(&calibrate(&[&near, &far], &[]));
    let three = json(&calibrate(&[&near, &far, &check], &[]));
    assert_eq!((&two["by"], &three["by"]), (&"two places".into(), &"two places and a check".into()));
    let known_m = |value| number(value, "turning_point_tolerance_m");
    assert!(three["accepted"] == true && known_m(&three) >= known_m(&two), "{two} {three}");
    // The third one of another plate.
    let other = data("check-d.csv", &measured(&actual().with_wave_speed(1.02).unwrap(), 0.176));
    refused(&calibrate(&[&near, &far, &other], &[]), 1, &[]);
}

#[test]
fn a_plan_proposes_two_places_and_says_what_others_would_reach() {
    let planned = |more: &[&str]| json(&[&["calibrate", "--plan", "--plate", "membrane"][..], more].concat());
    let value = planned(&[]);
    let best = &value["best"];
    let place_mm = |i: usize| 1e3 * best["places_m"][i].as_f64().unwrap();
    assert!(
        place_mm(0) >= 1e3 * number(&value, "nearest_place_m") && place_mm(1) > place_mm(0) + 20.0,
        "{value}"
    );
    assert!((place_mm(0) - place_mm(0).round()).abs() < 1e-6, "whole millimetres: {value}");
    assert_eq!((&value["nearest_by"], &value["asked"]), (&Value::from("width mode 3"), &Value::Null));
    assert!(value["pairs"].as_array().unwrap().len() > 50, "{value}");
    let (check, check_mm) = (&value["check"], 1e3 * number(&value["check"], "place_m"));
    assert!((check_mm - place_mm(0)).abs() > 15.0 && (check_mm - place_mm(1)).abs() > 15.0, "{value}");
    let known_m = |pair: &Value| number(pair, "turning_point_tolerance_m");
    assert!(number(check, "refuses_m") > 1.5 * known_m(best).max(known_m(check)), "{value}");

    let asked = planned(&["--sensor", "32mm", "--sensor", "310mm"])["asked"].clone();
    let warnings = asked["warnings"].as_array().unwrap();
    assert!(warnings[0].as_str().unwrap().contains("width mode 3"), "{asked}");
    assert!(warnings[1].as_str().unwrap().contains("cannot see"), "{asked}");
    let level_db = |value: &Value| number(value, "level_tolerance_db");
    assert!(level_db(&asked["pair"]) > level_db(best), "{asked} {best}");
    let off_centre = planned(&["--off-centre"]);
    assert_eq!(off_centre["nearest_by"], "width mode 2");

    let text = said(&["calibrate", "--plan", "--plate", "membrane", "--sensor", "32mm", "--sensor", "176mm"]);
    says(
        &text,
        &[
            "Sensor at",
            "Would reach",
            "Nearest place",
            "Check",
            "Requested places",
            "Warning",
            "Second place",
        ],
    );
    refused(
        &["calibrate", "--plan", "--plate", "membrane", "--sensor", "32mm"],
        2,
        &["1 --sensor with --plan"],
    );
    refused(&["calibrate", "--plan", "--plate", "membrane", "--kind", "strain"], 2, &["strain"]);
}

#[test]
fn files_of_other_programs_calibrate_as_well_as_the_own_form() {
    let plate = actual();
    let (near, far) = (measured(&plate, 0.032), measured(&plate, 0.176));
    let (own_near, own_far) = (data("own-near.csv", &near), data("own-far.csv", &far));
    let half_widths = |value: &Value| number(&value["parameters"][3], "value");
    let own = json(&calibrate(&[&own_near, &own_far], &[]));
    let [uff_near, uff_far, frd_near, frd_far] = ["near.uff", "far.uff", "near.frd", "far.frd"].map(file);
    std::fs::write(&uff_near, near.to_uff58()).unwrap();
    std::fs::write(&uff_far, far.to_uff58()).unwrap();
    std::fs::write(&frd_near, near.to_frd()).unwrap();
    std::fs::write(&frd_far, far.to_frd()).unwrap();
    let places = ["--sensor", "32mm", "--sensor", "176mm"];
    let displacement = [&places[..], &["--kind", "displacement"]].concat();
    for (files, more) in [([&uff_near, &uff_far], &places[..]), ([&frd_near, &frd_far], &displacement)] {
        let value = json(&calibrate(&files.map(|it| it.as_path()), more));
        assert!((half_widths(&value) / half_widths(&own) - 1.0).abs() < 1e-3, "{value} {own}");
        let noisy = json(&calibrate(&files.map(|it| it.as_path()), &[more, &["--snr", "30dB"]].concat()));
        let level_db = |value: &Value| number(value, "level_tolerance_db");
        // Both include the model's error, which is most of the level's interval here.
        assert!(level_db(&noisy) > level_db(&value), "{noisy} {value}");
        let loss = |value: &Value| {
            let loss = &value["parameters"][1];
            number(loss, "high") - number(loss, "low")
        };
        assert!(loss(&noisy) > 1.5 * loss(&value), "{noisy} {value}");
    }
    for (files, more, expected) in [
        (
            [&frd_near, &frd_far],
            &["--kind", "displacement", "--sensor", "32mm"][..],
            "far.frd: by another program: state its sensor's place",
        ),
        (
            [&frd_near, &frd_far],
            &places[..],
            "near.frd: it does not state what its sensor measures: add --kind",
        ),
        ([&own_near, &own_far], &places[..], "2 --sensor: must be 0"),
        ([&uff_near, &own_far], &places[..], "2 --sensor: must be 1"),
        (
            [&frd_near, &frd_far],
            &["--sensor", "1m", "--sensor", "2mm"],
            "'1m' for '--sensor': must be 0 m to 320 mm",
        ),
        ([&frd_near, &frd_far], &["--kind", "speed"], "displacement, velocity, acceleration, strain"),
        ([&frd_near, &frd_far], &["--snr", "200"], "0 to 140 dB"),
    ] {
        refused(&calibrate(&files.map(|it| it.as_path()), more), 2, &[expected]);
    }
    std::fs::write(&frd_near, "100 20\n200 30\n").unwrap();
    refused(
        &calibrate(&[&frd_near, &frd_far], &displacement),
        2,
        &["near.frd: line 1: no line names the columns, and nothing shows whether the second is in dB"],
    );
}

#[test]
fn calipers_state_the_widths_beforehand() {
    let plate = actual();
    let (near, far) = (measured(&plate, 0.032), measured(&plate, 0.176));
    let (near, far) = (data("caliper-near.csv", &near), data("caliper-far.csv", &far));
    let lengths = [plate.half_width_m(0.0), plate.half_width_m(plate.length_m()), plate.length_m()]
        .map(|metres| format!("{:.3}mm", 1e3 * metres));
    let [half_width, end, length] = lengths.each_ref().map(String::as_str);
    let calipers = ["--half-width", half_width, "--end-half-width", end, "--length", length];
    let width = |more: &[&str]| {
        let value = json(&calibrate(&[&near, &far], more));
        let all = value["parameters"].as_array().unwrap();
        let it = all.iter().find(|it| it["name"] == "taper.half_width_m").unwrap();
        number(it, "high") - number(it, "low")
    };
    let fine = [&calipers[..], &["--calipers-tolerance", "5um"]].concat();
    assert!(width(&fine) < 0.5 * width(&[]), "calipers narrow the interval");
    refused(&calibrate(&[&near, &far], &calipers[..2]), 2, &["--end-half-width", "--length"]);
    let wide = ["--half-width", "30mm", "--end-half-width", "40mm", "--length", length];
    refused(&calibrate(&[&near, &far], &wide), 2, &["by calipers: end_half_width_m = 0.04: must be"]);
}

/// Where a finger feels the edge of a tone with this peak, metres.
fn felt_edge_m(plate: &Plate, frequency_hz: f64, peak_m: f64) -> f64 {
    let spec = PlateSpec { drive_end: DriveEnd::Displacement, ..plate.spec().clone() };
    let plate = Plate::new(spec).unwrap();
    let field = &respond_batch(&plate, &[frequency_hz], POINTS, Equation::Corrected).unwrap()[0];
    let scale = peak_m / Peak::of(field, &plate, frequency_hz).unwrap().amplitude;
    let squares: Vec<f64> = field.iter().map(|f| 0.5 * (f * scale).norm_sqr()).collect();
    let tone = FeltTone { frequency_hz, squares: &squares };
    Feeling::edge(&plate, &Feeling::default().strength(&plate, &[tone])).place_m().unwrap()
}

#[test]
fn two_touches_give_places_and_no_levels() {
    let plate = preset("membrane").unwrap();
    let table = json(&["table", "--plate", "membrane"]);
    let peak_m = 0.03 * number(&table, "peak_at_full_scale_m");
    // Where a finger feels the edge on the actual plate, for the frequency of the requested boundary.
    let touch = |asked_m: f64| {
        let knots = table["knots"].as_array().unwrap();
        let knot = knots.iter().find(|knot| number(knot, "position_m") >= asked_m).unwrap();
        let edge_m = felt_edge_m(&actual(), number(knot, "frequency_hz"), peak_m);
        format!("{}Hz:{:.2}mm", number(knot, "frequency_hz"), 1e3 * edge_m)
    };
    let touches = [touch(0.12), touch(0.25)];
    let out = file("touched.toml");
    let arguments = [
        &["calibrate", "--plate", "membrane", "--level", "0.03", "--out", out.to_str().unwrap()][..],
        &["--touch-tolerance", "0.2mm", "--touch", &touches[0], "--touch", &touches[1]],
        &["--touched-drive", "as-told"],
    ]
    .concat();
    let value = json(&arguments);
    assert_eq!((&value["accepted"], &value["level_tolerance_db"]), (&Value::Bool(true), &Value::Null));
    // Two marks do not separate loss, speed and edges that give (0.3 mm are 1 to 2 % of speed), and the interval shows it.
    let [low, high] = ["low", "high"].map(|end| number(&value["parameters"][0], end));
    let slipline_plate::Model::Membrane { wave_speed_m_per_s, .. } = plate.spec().model else { panic!() };
    assert!((low..high).contains(&(0.97 * wave_speed_m_per_s)) && high < 1.16 * low, "{value}");
    // The touches above were computed with the peak of this level.
    let finger = &value["parameters"][1];
    assert_eq!(finger["name"], "feeling.threshold");
    assert!((0.8..1.25).contains(&number(finger, "value")), "{value}");
    assert!(value["before"]["level_error_db"].is_null() && value["caution"].is_null());
    assert!(Plate::from_toml(&std::fs::read_to_string(&out).unwrap()).is_ok());
    says(&said(&[&arguments[..], &["--force"]].concat()), &["Levels", "of a known drive"]);
    // With an unknown drive the same touches leave wider intervals.
    let unknown = [&arguments[..5], &arguments[7..13]].concat();
    let open = json(&unknown);
    let edge_m = |value: &Value| number(value, "felt_edge_tolerance_m");
    assert!(edge_m(&open) > 3.0 * edge_m(&value) && edge_m(&value) < 2e-3, "{open} {value}");
    says(&said(&unknown), &["of an unknown drive", "Felt edge"]);
}

#[test]
fn data_that_carry_no_calibration_end_with_1_and_the_reason() {
    let plate = actual();
    let near = data("refused-near.csv", &measured(&plate, 0.032));
    let far = data("refused-far.csv", &measured(&plate, 0.176));
    let silent = Measurement {
        points: measured(&plate, 0.176)
            .points
            .into_iter()
            .map(|mut point| {
                point.response = Complex64::new(0.005, 0.0);
                point
            })
            .collect(),
        ..measured(&plate, 0.176)
    };
    let silent = data("silent.csv", &silent);
    let out = file("refused.toml");
    for (files, reason) in [
        ([&near, &silent], "nothing but noise"),
        ([&near, &near], "both measurements are of the place 32.0 mm"),
    ] {
        let arguments = calibrate(&files.map(|it| it.as_path()), &["--out", out.to_str().unwrap()]);
        refused(&arguments, 1, &[reason]);
        let output = slipline(&[&arguments[..], &["--json"]].concat());
        assert_eq!(output.status.code(), Some(1));
        let value: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(value["accepted"], false);
        assert!(value["reason"].as_str().unwrap().contains(reason), "{value}");
        assert!(!out.exists(), "nothing is written");
    }
    let other = calibrate(&[&near, &far], &[]);
    let other: Vec<&str> =
        other.iter().map(|word| if *word == "membrane" { "al-bending" } else { word }).collect();
    assert!(failure(&other, 1).contains("frequencies are of use"), "of another plate");
}

#[test]
fn bad_files_and_options_are_named_with_what_is_allowed() {
    let bad = file("bad.csv");
    std::fs::write(&bad, "# place_m = 0.03\n# sensor = speed\n").unwrap();
    let path = bad.to_str().unwrap();
    let two = ["--data", path, "--data", path];
    for (more, expected) in [
        (&two[..], "bad.csv: line 2: sensor: must be one of displacement"),
        (&[&two[..], &two[..]].concat()[..], "4 files of --data: must be 1 to 3"),
        (&["--data", "no-such.csv", "--data", path], "no-such.csv"),
        (&[], "--data"),
        (&["--touch", "120mm"], "ASKED:FELT"),
        (&["--touch", "20mm:118mm", "--touch", "250mm:240mm"], "the felt edges of tones of level 0.8"),
        (&["--touch", "20Hz:118mm", "--touch", "200Hz:190mm"], "87.57 to 219 Hz"),
        (&["--touch", "250mm:1m", "--touch", "280mm:270mm"], "0 m to 320 mm, on the plate"),
        (&["--touch", "120mm:118mm", "--touch-tolerance", "1m"], "10 µm to 50 mm"),
        (&["--touch", "120mm:118mm", "--data", path], "--data"),
        (&["--data", path, "--data", path, "--half-width", "0"], "10 µm to 10 m"),
    ] {
        refused(&[&["calibrate", "--plate", "membrane"], more].concat(), 2, &[expected]);
    }
    refused(
        &["calibrate", "--plate", "membrane", "--touch", "110Hz:218mm", "--touch", "112Hz:222mm"],
        1,
        &["felt edges up to"],
    );
}
