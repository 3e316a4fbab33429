//! The output of the subcommands, as JSON and in files.

use super::{file, json, number, said, says, words};
use serde_json::Value;

#[test]
fn presets_are_named_and_described() {
    let presets = json(&["presets"]);
    let presets = presets["presets"].as_array().unwrap();
    assert!(presets.len() >= 5);
    for preset in presets {
        assert!(!preset["name"].as_str().unwrap().is_empty());
        assert!(preset["description"].as_str().unwrap().len() > 20);
    }
    assert_eq!(presets[0]["name"], "latex-membrane");
}

#[test]
fn the_simulated_plate_heads_the_ports() {
    let ports = json(&["ports"]);
    assert_eq!(ports["ports"][0]["port"], "sim");
    assert_eq!(ports["ports"][0]["is_ours"], true);
}

#[test]
fn info_identifies_the_simulated_device() {
    let info = json(&["info", "--port", "sim"]);
    assert_eq!(info["inputs"]["lost_blocks"], 0);
    assert_eq!(info["simulated"], true);
    assert_eq!(number(&info, "sample_rate_hz"), 400_000.0);
    assert_eq!(number(&info, "max_tones"), 16.0);
    assert_eq!(info["protocol"], "1.3");
}

#[test]
fn respond_gives_the_amplitude_over_x_and_the_turning_point() {
    // The rubber rig: x0 = 36.8 and 100.2 mm at 30 and 40 Hz along the arc, 39.5 and 101.7 mm straight across.
    for (frequency, mode, width, turning_point_m) in [
        ("30Hz", None, "arc", 0.03677),
        ("40Hz", None, "arc", 0.10022),
        ("30Hz", Some("--paper-mode"), "plain", 0.0395),
        ("40Hz", Some("--paper-mode"), "plain", 0.1017),
    ] {
        let arguments = ["respond", "--plate", "paper-rubber", "--freq", frequency, "--points", "500"];
        let response = json(&arguments.into_iter().chain(mode).collect::<Vec<_>>());
        assert_eq!(response["turning_width"], width);
        assert_eq!(response["position_m"].as_array().unwrap().len(), 500);
        let amplitude = response["amplitude"].as_array().unwrap();
        assert_eq!(amplitude.len(), 500);
        assert!((number(&response, "turning_point_m") - turning_point_m).abs() < 1e-4);
        assert!(number(&response, "edge_width_m") > 0.01);
        // Driven by displacement: the driven end follows the drive.
        assert!((number(&amplitude[0], "re").hypot(number(&amplitude[0], "im")) - 1.0).abs() < 1e-6);
    }
    let paper = json(&["respond", "--plate", "al-bending", "--freq", "40kHz", "--paper-mode"]);
    let ours = json(&["respond", "--plate", "al-bending", "--freq", "40kHz"]);
    assert_ne!(paper["amplitude"][100], ours["amplitude"][100]);
    assert!((number(&ours, "peak_position_m") - number(&ours, "turning_point_m")).abs() < 0.02);
}

#[test]
fn respond_in_two_dimensions_reports_where_the_one_mode_equation_differs() {
    let arguments = ["respond", "--plate", "membrane", "--freq", "138Hz", "--points", "801"];
    let one_mode = json(&arguments);
    let two = json(&[&arguments[..], &["--2d"]].concat());
    assert!(one_mode.get("two_dimensions").is_none());
    for (field, value) in one_mode.as_object().unwrap() {
        let found = &two[field];
        assert_eq!(std::mem::discriminant(found), std::mem::discriminant(value), "{field}: {found}");
    }
    let differs = &two["two_dimensions"];
    let shift_m = number(&two, "peak_position_m") - number(&one_mode, "peak_position_m");
    // With the width straight across it is more than ten times as much.
    assert!((-6e-5..-1e-5).contains(&shift_m), "{shift_m}");
    assert!((number(differs, "peak_shift_m") - shift_m).abs() < 1e-6);
    let ratio = number(&two, "peak_amplitude") / number(&one_mode, "peak_amplitude");
    assert!((number(differs, "level_db") - 20.0 * ratio.log10()).abs() < 0.01);
    assert_eq!((number(differs, "nodes"), number(differs, "one_mode_nodes")), (3.0, 3.0));
    assert!(number(differs, "reflection") < 0.01);

    let text = said(&["respond", "--plate", "al-bending", "--freq", "28kHz", "--2d"]);
    assert!(text.contains(" mm and ") && text.contains(" dB from that of the one-mode equation"), "{text}");
    // Its damped lead-in.
    assert!(text.contains("0.04 at the driven end (one mode: 0.04"), "{text}");
}

#[test]
fn table_gives_span_and_knots_and_writes_them() {
    let path = file("table.json");
    let arguments =
        ["table", "--plate", "membrane", "--sample-rate", "200kHz", "--out", path.to_str().unwrap()];
    let table = json(&arguments);
    assert_eq!(serde_json::from_slice::<Value>(&std::fs::read(&path).unwrap()).unwrap(), table);
    std::fs::remove_file(path).unwrap();
    assert!((number(&table, "span_start_m") - 0.08).abs() < 1e-9);
    assert!((number(&table, "span_end_m") - 0.28).abs() < 1e-9);
    let knots = table["knots"].as_array().unwrap();
    assert_eq!(knots.len(), 1025);
    let frequencies: Vec<f64> = knots.iter().map(|knot| number(knot, "frequency_hz")).collect();
    assert!(frequencies.windows(2).all(|pair| pair[1] > pair[0]));
    assert!(knots.iter().all(|knot| (0.0..=1.0).contains(&number(knot, "gain"))));
    assert!(number(&table, "sensitivity_db_per_percent") < 1.0);
}

#[test]
fn simulate_reports_what_was_commanded_and_what_was_measured() {
    let (csv, png) = (file("envelope.csv"), file("envelope.png"));
    let run = json(&[
        "simulate",
        "--plate",
        "membrane",
        "--turning-point",
        "120mm",
        "--csv",
        csv.to_str().unwrap(),
        "--png",
        png.to_str().unwrap(),
    ]);
    assert!((number(&run, "turning_point_m") - 0.12).abs() < 1e-9);
    assert!((number(&run, "actual_turning_point_m") - 0.12).abs() < 1e-4);
    assert!((number(&run, "frequency_hz") - 105.06).abs() < 0.1);
    assert_eq!(run["peak_present"], true);
    assert_eq!(number(&run, "clipped_samples"), 0.0);
    let off_m = number(&run, "measured_peak_position_m") - number(&run, "peak_position_m");
    assert!(off_m.abs() < number(&run, "edge_width_m") / 20.0);
    assert!(number(&run, "measured_peak_amplitude_m") > 1e-6);
    // The peak is 47 dB over the threshold of 105 Hz.
    let felt_m = number(&run, "measured_felt_edge_m");
    assert!(felt_m > 0.12 + number(&run, "edge_width_m") && felt_m < 0.24, "{felt_m}");
    let by_person = &run["measured_felt_edge_by_person_m"];
    let (near_m, far_m) = (by_person[0].as_f64().unwrap(), by_person[1].as_f64().unwrap());
    assert!(near_m < felt_m && felt_m < far_m && far_m - near_m < 0.03, "{by_person}");
    assert_eq!(run["tones"].as_array().unwrap().len(), 1);
    assert_eq!(run["tones"][0]["peak_position_m"], run["peak_position_m"]);
    let names = [&csv, &png].map(|path| path.to_str().unwrap());
    assert_eq!(run["files"], serde_json::json!(names));

    let text = std::fs::read_to_string(&csv).unwrap();
    assert_eq!(text.lines().next(), Some("position_m,predicted_rms_m,measured_rms_m,measured_maximum_m"));
    assert_eq!(text.lines().count(), 514);
    assert_eq!(&std::fs::read(&png).unwrap()[1..4], b"PNG");
    for path in [csv, png] {
        std::fs::remove_file(path).unwrap();
    }
}

#[test]
fn simulate_on_the_sheet_reports_where_the_one_mode_equation_differs() {
    let arguments = ["simulate", "--plate", "membrane", "--turning-point", "160mm"];
    let sheet = json(&[&arguments[..], &["--sheet"]].concat());
    let line = json(&arguments);
    assert!(line.get("two_dimensions").is_none());
    for (field, value) in line.as_object().unwrap() {
        let found = &sheet[field];
        assert_eq!(std::mem::discriminant(found), std::mem::discriminant(value), "{field}: {found}");
    }
    let differs = &sheet["two_dimensions"];
    let shift_m = number(&sheet, "measured_peak_position_m") - number(&sheet, "peak_position_m");
    assert!((number(differs, "peak_shift_m") - shift_m).abs() < 1e-5);
    let frequency = format!("{}Hz", number(&sheet, "frequency_hz"));
    let plane = json(&["respond", "--plate", "membrane", "--freq", &frequency, "--2d"]);
    let expected = &plane["two_dimensions"];
    for (field, tolerance) in
        [("peak_shift_m", 1e-4), ("level_db", 0.05), ("nodes", 0.0), ("one_mode_nodes", 0.0)]
    {
        let (found, wanted) = (number(differs, field), number(expected, field));
        assert!((found - wanted).abs() <= tolerance, "{field}: {found}, not {wanted}");
    }
    says(
        &said(&[&arguments[..], &["--sheet", "--seconds", "300ms"]].concat()),
        &["On the sheet, the peak for 160.0 mm: -0."],
    );
}

#[test]
fn simulate_on_the_sheet_in_air_differs_from_one_mode_as_it_does_in_a_vacuum() {
    // The same boundary has the same wavenumber on both, at another frequency. Two tones in air share an error of K: 0.2 mm here.
    let sheet = |plate: &str| {
        json(&[
            "simulate",
            "--plate",
            plate,
            "--turning-point",
            "160mm",
            "--turning-point",
            "230mm:0.1",
            "--sheet",
        ])
    };
    let (air, vacuum) = (sheet("latex-membrane"), sheet("membrane"));
    assert!(number(&air, "frequency_hz") < 0.95 * number(&vacuum, "frequency_hz"));
    for tone in 0..2 {
        let of = |value: &Value, field| number(&value["tones"][tone]["two_dimensions"], field);
        for (field, tolerance) in [("peak_shift_m", 3e-4), ("level_db", 0.15), ("nodes", 0.0)] {
            let (found, wanted) = (of(&air, field), of(&vacuum, field));
            assert!((found - wanted).abs() <= tolerance, "{tone} {field}: {found}, not {wanted}");
        }
    }
}

#[test]
fn a_finger_takes_the_peak_down_in_every_solver() {
    let at = ["--plate", "membrane", "--finger"];
    let respond = |finger: &str, more: &[&str]| {
        json(&[&["respond", "--freq", "130Hz"], &at[..], &[finger], more].concat())
    };
    let free = number(&respond("150mm:none", &[]), "peak_amplitude");
    let light = respond("150mm:light", &[]);
    // The same by its numbers.
    for same in ["150mm:0.1Ns/m,1e-5kg,0.01m", "15cm:0.1Ns/m, 10mg, 10mm"] {
        assert!(
            (number(&respond(same, &[]), "peak_amplitude") / number(&light, "peak_amplitude") - 1.0).abs()
                < 1e-9
        );
    }
    let firm = number(&respond("150mm:firm", &[]), "peak_amplitude");
    let same = number(&respond("150mm:1 Ns/m,0.1g,1cm", &[]), "peak_amplitude");
    assert!((same / firm - 1.0).abs() < 1e-9 && firm < 0.5 * number(&light, "peak_amplitude"));
    let plane = respond("150mm:light", &["--2d"]);
    assert!(number(&light, "peak_amplitude") < 0.8 * free);
    assert!(number(&plane["two_dimensions"], "level_db").abs() < 1.0);
    let simulated = json(&[&["simulate", "--turning-point", "160mm"], &at[..], &["150mm:light"]].concat());
    let off_m = number(&simulated, "measured_peak_position_m") - number(&simulated, "peak_position_m");
    assert!(off_m.abs() < number(&simulated, "edge_width_m") / 20.0, "{off_m}");
    let untouched = json(&["simulate", "--turning-point", "160mm", "--plate", "membrane"]);
    let ratio =
        number(&simulated, "measured_peak_amplitude_m") / number(&untouched, "measured_peak_amplitude_m");
    assert!(ratio < 0.85, "{ratio}");
    let predicted = number(&simulated, "peak_amplitude_m") / number(&simulated, "measured_peak_amplitude_m");
    assert!((predicted - 1.0).abs() < 0.01, "{predicted}");
}

#[test]
fn a_finger_on_the_sheet_takes_what_it_takes_in_two_dimensions_in_the_frequency_domain() {
    // Both in the ratio to the untouched plate of the same solver, so that only the finger counts.
    let of = |value: &Value| (number(value, "peak_position_m"), number(value, "peak_amplitude"));
    let measured = |value: &Value| {
        (number(value, "measured_peak_position_m"), number(value, "measured_peak_amplitude_m"))
    };
    let sheet = |finger: &str| {
        json(&["simulate", "--plate", "membrane", "--turning-point", "160mm", "--sheet", "--finger", finger])
    };
    let free = sheet("90mm:none");
    let frequency = format!("{}Hz", number(&free, "frequency_hz"));
    let plane = |finger: &str| {
        of(&json(&["respond", "--plate", "membrane", "--freq", &frequency, "--2d", "--finger", finger]))
    };
    let free_on_plane = plane("90mm:none");
    let free = measured(&free);
    for finger in ["90mm:light", "120mm:light", "9cm:0.2Ns/m,0.1g,20mm"] {
        let touched = sheet(finger);
        assert!(number(&touched["two_dimensions"], "level_db").abs() < 1.0, "{finger}");
        let (found, expected) = (measured(&touched), plane(finger));
        let taken_db = |(touched, free): (f64, f64)| 20.0 * (touched / free).log10();
        let [found_db, expected_db] = [(found.1, free.1), (expected.1, free_on_plane.1)].map(taken_db);
        assert!(
            expected_db < -1.0 && (found_db - expected_db).abs() < 0.15,
            "{finger}: {found_db} {expected_db} dB"
        );
        assert!((found.0 - expected.0).abs() < 1e-3, "{finger}: {found:?} {expected:?}");
    }
}

#[test]
fn simulate_lists_several_tones_and_runs_on_another_plate() {
    let run = json(&words(
        "simulate --plate membrane --turning-point 100mm:0,3 --turning-point 220mm:0.3 --turning-point 160mm:0.2",
    ));
    let tones = run["tones"].as_array().unwrap();
    assert_eq!(tones.len(), 3);
    assert_eq!(tones[0]["frequency_hz"], run["frequency_hz"]);
    for (tone, boundary_m) in tones.iter().zip([0.1, 0.22, 0.16]) {
        assert!((number(tone, "turning_point_m") - boundary_m).abs() < 1e-9);
        assert!((number(tone, "actual_turning_point_m") - boundary_m).abs() < 1e-4);
        let off_m = number(tone, "measured_peak_position_m") - number(tone, "peak_position_m");
        assert!(off_m.abs() < number(tone, "edge_width_m") / 20.0);
    }

    // A membrane under 10 % more tension than the table assumes.
    let toml = slipline_plate::preset("membrane").unwrap().with_wave_speed(1.05).unwrap().to_toml();
    let path = file("tense.toml");
    std::fs::write(&path, toml).unwrap();
    let tense = path.to_str().unwrap();
    let run = json(&["simulate", "--plate", "membrane", "--actual-plate", tense, "--turning-point", "160mm"]);
    std::fs::remove_file(&path).unwrap();
    assert!((number(&run, "turning_point_m") - 0.16).abs() < 1e-9);
    // ln(1.05) / d = 10.6 mm nearer.
    assert!((number(&run, "actual_turning_point_m") - 0.1494).abs() < 1e-4);
    assert!(number(&run, "sensitivity_db") > 0.1);
}

#[test]
fn no_table_leaves_the_gains_out() {
    let with = json(&["simulate", "--plate", "al-bending", "--turning-point", "250mm"]);
    let without = json(&["simulate", "--plate", "al-bending", "--turning-point", "250mm", "--no-table"]);
    assert!(number(&without, "measured_peak_amplitude_m") > number(&with, "measured_peak_amplitude_m"));
}

#[test]
fn drive_and_verify_work_on_the_simulated_device() {
    let driven = json(&words("drive --port sim --plate membrane --turning-point 126Hz --for 200ms"));
    assert!((number(&driven["tones"][0], "frequency_hz") - 126.0).abs() < 0.1);
    assert!(number(&driven, "stopped_at_samples") > number(&driven, "at_samples"));
    let verified = json(&["verify", "--port", "sim", "--window", "30ms"]);
    assert_eq!(verified["equal"], true);
    assert_eq!(verified["windows"].as_array().unwrap().len(), 4);
}

#[test]
fn record_writes_the_codes_of_the_drive() {
    let path = file("drive.wav");
    let wav = path.to_str().unwrap();
    json(&["record", "--plate", "membrane", "--turning-point", "120mm", "--seconds", "100ms", "--wav", wav]);
    let mut reader = hound::WavReader::open(&path).unwrap();
    assert_eq!(reader.spec().sample_rate, 400_000);
    let samples: Vec<i16> = reader.samples().map(Result::unwrap).collect();
    std::fs::remove_file(path).unwrap();
    assert_eq!(samples.len(), 40_000);
    // 105.1 Hz for 0.1 s: ten periods, so about twenty passages through zero.
    let passages = samples.windows(2).filter(|pair| (pair[0] < 0) != (pair[1] < 0)).count();
    assert!((19..=23).contains(&passages), "{passages}");
    assert!(samples.iter().any(|sample| sample.abs() > 1000));
}

#[test]
fn simulate_says_which_tones_beat_more_slowly_than_was_measured() {
    // 120 and 120.3 mm are 0.14 Hz apart.
    let tones =
        ["simulate", "--plate", "membrane", "--turning-point", "120mm:0.3", "--turning-point", "120.3mm:0.3"];
    let long = [&tones[..], &["--seconds", "0.4s"]].concat();
    let beat_hz = number(&json(&long), "slow_beat_hz");
    assert!((0.1..0.2).contains(&beat_hz), "{beat_hz}");
    says(&said(&long), &["Two tones beat once in 6.", "the RMS is that of"]);
    let apart =
        ["simulate", "--plate", "membrane", "--turning-point", "120mm:0.3", "--turning-point", "200mm:0.3"];
    assert!(json(&apart)["slow_beat_hz"].is_null());
    let help = said(&["simulate", "--help"]);
    assert!(help.contains("where its wave turns") && !help.contains("where it peaks"), "{help}");
}
