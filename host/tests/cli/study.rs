//! Studies: the same numbers by any number of threads, and what is refused.

use super::{failure, file, json, number, refused, slipline};
use slipline_model::study::{Draft, Study, StudyResult, csv};
use slipline_plate::{Progress, preset};
use std::path::Path;

const EXAMPLE: &str = include_str!("../../assets/study.toml");

fn written(name: &str, text: &str) -> String {
    let path = file(name);
    std::fs::write(&path, text).unwrap();
    path.into_os_string().into_string().unwrap()
}

fn taken(path: impl AsRef<Path>) -> String {
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::remove_file(path).unwrap();
    text
}

#[test]
fn a_study_has_the_same_bytes_by_one_thread_and_by_two_and_matches_the_library() {
    let text = EXAMPLE.replace("count = 1000", "count = 200");
    let spec = written("study.toml", &text);
    let outs = ["1", "2"].map(|threads| {
        let out = file(&format!("study-{threads}.csv"));
        let value = json(&["study", &spec, "--threads", threads, "--out", out.to_str().unwrap()]);
        (taken(&out), value)
    });
    assert_eq!(outs[0].0, outs[1].0);
    assert_eq!(outs[0].1["turning_points"], outs[1].1["turning_points"]);
    let study = Draft::parse(&text).unwrap().finish(preset("membrane")).unwrap();
    let study = Study::new(study, &mut Progress::unwatched()).unwrap();
    let whole = study.run_range(0..200);
    assert_eq!(outs[0].0, csv::head(&study) + &csv::rows(&study, &whole));

    // The printed numbers match the file.
    let value = &outs[0].1;
    assert_eq!(value["plates"][0]["status"], "done");
    assert_eq!(value["plates"][0]["count"], 200);
    assert_eq!(value["plates"].as_array().unwrap().len(), 1);
    for (place, of_place) in value["turning_points"].as_array().unwrap().iter().enumerate() {
        let mean = |all: &[f64]| all.iter().skip(place).step_by(3).sum::<f64>() / 200.0;
        assert!((number(of_place, "shift_mean_m") - mean(&whole.results[0])).abs() < 1e-12);
        assert!((number(of_place, "level_mean_db") - mean(&whole.results[1])).abs() < 1e-9);
        assert_eq!(number(of_place, "turning_point_m"), [0.12, 0.18, 0.24][place]);
        // 1 % of wave speed and up to 2 % of the taper's rate.
        assert!((2e-3..4e-3).contains(&number(of_place, "shift_deviation_m")));
        let quantiles: Vec<f64> =
            of_place["level_quantiles_db"].as_array().unwrap().iter().filter_map(|it| it.as_f64()).collect();
        assert!(quantiles.len() == 3 && quantiles.is_sorted());
    }
    let output = slipline(&["study", &spec]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && text.contains("Plates around membrane: 200 done"), "{text}");
    std::fs::remove_file(spec).unwrap();
}

#[test]
fn every_result_is_printed_by_its_name_and_two_dimensions_one_plate_at_once() {
    let all: Vec<&str> = StudyResult::ALL.iter().map(|it| it.name()).collect();
    let text =
        EXAMPLE.replace("count = 1000", &format!("count = 5\nresults = {all:?}")).replace("0.12, ", "");
    let spec = written("figures.toml", &text);
    let out = file("figures.csv");
    let value = json(&["study", &spec, "--out", out.to_str().unwrap()]);
    let rows = taken(&out);
    let header = rows.lines().find(|line| line.starts_with("plate,")).unwrap();
    for name in &all {
        assert!(header.contains(&format!(",{name}_at_0.24")), "{header}");
    }
    let [first, last] = [0, 1].map(|place| &value["turning_points"][place]);
    assert!(number(first, "contrast_mean_db") > 20.0 && number(first, "ripple_mean_db") > 0.0);
    assert!(number(first, "felt_edge_mean_m") > 0.2 && number(first, "crest_mean_db") > 0.0);
    assert!(last["felt_edge_mean_m"].is_null(), "felt up to the plate's end");
    let output = String::from_utf8(slipline(&["study", &spec]).stdout).unwrap();
    for word in ["Shift", "Level", "Peak's shift", "Felt edge", "Contrast", "Ripple", "Crest"] {
        assert!(output.contains(word), "{word}: {output}");
    }
    // In two dimensions the same bytes by one thread and by two.
    let text = EXAMPLE.replace("count = 1000", "count = 3\nkind = \"2d\"");
    let spec_2d = written("plane.toml", &text);
    let outs = ["1", "2"].map(|threads| {
        let out = file(&format!("plane-{threads}.csv"));
        json(&["study", &spec_2d, "--threads", threads, "--out", out.to_str().unwrap()]);
        taken(&out)
    });
    assert_eq!(outs[0], outs[1]);
    assert!(outs[0].contains("level_db_at_0.12,peak_shift_m_at_0.12,level_db_at_0.18"), "{}", outs[0]);
    for path in [spec, spec_2d] {
        std::fs::remove_file(path).unwrap();
    }
}

#[test]
fn bad_plates_are_counted_by_their_reasons_and_end_nothing() {
    let wild = EXAMPLE.replace("count = 1000", "count = 300").replace("normal = 0.01", "log_normal = 1.0");
    let spec = written("wild.toml", &wild);
    let out = file("wild.csv");
    let value = json(&["study", &spec, "--out", out.to_str().unwrap()]);
    let rows = taken(&out);
    let plates = value["plates"].as_array().unwrap();
    let statuses: Vec<&str> = plates.iter().filter_map(|it| it["status"].as_str()).collect();
    assert_eq!(statuses, ["done", "plate_refused", "wave_does_not_enter", "turns_far_beyond_the_end"]);
    let mut total = 0;
    for (status, count) in statuses.iter().zip(plates.iter().filter_map(|it| it["count"].as_u64())) {
        let found = rows.lines().filter(|row| row.split(',').nth(1) == Some(status)).count();
        assert_eq!(found as u64, count, "{status}");
        total += count;
    }
    assert_eq!(total, 300);
    std::fs::remove_file(spec).unwrap();
}

#[test]
fn what_a_study_cannot_do_is_refused_before_it_begins() {
    let spec = written("refused.toml", EXAMPLE);
    let out = written("refused.csv", "mine");
    assert!(failure(&["study", &spec, "--out", &out], 2).contains("--force"));
    assert_eq!(std::fs::read_to_string(&out).unwrap(), "mine");
    assert!(failure(&["study", &spec, "--threads", "0"], 2).contains("a whole number, 1 to 256"));
    assert!(failure(&["study", "no-such-file.toml"], 2).contains("no-such-file.toml: "));
    for (from, to, want) in [
        ("count = 1000", "count = 0", "count = 0: must be 1 to 1000000"),
        ("0.12", "0.02", "turning_point_m[0] = 0.02: must be 0.08 to 0.28 m, the plate's span"),
        ("seed", "sead", "line 4: unknown field `sead`"),
        ("seed = 7", "kind = \"2\"\nseed = 7", "kind = \"2\": must be one of 1d, 2d"),
        ("\"membrane\"", "\"mambrane\"", "did you mean membrane?"),
    ] {
        assert!(EXAMPLE.contains(from), "{from}");
        let bad = written("bad.toml", &EXAMPLE.replacen(from, to, 1));
        refused(&["study", &bad], 2, &[want]);
    }
    let bad = written("bad.toml", &EXAMPLE.replace("normal = 0.01", "normal = 2.0"));
    let output = slipline(&["study", &bad, "--json"]);
    let error: serde_json::Value = serde_json::from_slice(&output.stderr).unwrap();
    assert_eq!(error["field"], "vary.\"model.wave_speed_m_per_s\".normal");
    assert_eq!((number(&error, "value"), number(&error["range"], "high")), (2.0, 1.0));
    for path in [spec, out, bad] {
        std::fs::remove_file(path).unwrap();
    }
}
