//! `slipline drive --hold`: the device keeps the level at the simulated sensor.

use super::{failure, json, number};

const DRIVE: [&str; 7] = ["drive", "--port", "sim", "--plate", "al-bending", "--turning-point", "247mm"];

#[test]
fn a_drive_that_is_held_reports_each_tones_state_and_correction() {
    let value =
        json(&[&DRIVE[..], &["--level", "0.3", "--hold", "--sensor", "210mm", "--for", "1s"]].concat());
    let hold = &value["hold"];
    let tones = hold["tones"].as_array().unwrap_or_else(|| panic!("{value}"));
    assert_eq!((tones.len(), &tones[0]["state"]), (1, &serde_json::json!("held")), "{value}");
    assert!(number(&tones[0], "correction_db").abs() < 0.3, "nothing touches the plate: {value}");
    assert!(
        number(&tones[0], "amplitude_codes") > 10.0 && number(hold, "measured_windows") >= 1.0,
        "{value}"
    );
    assert!((number(&tones[0], "turning_point_m") - 0.247).abs() < 1e-9);
    // Without it there is none.
    let value = json(&[&DRIVE[..], &["--for", "0s"]].concat());
    assert!(value["hold"].is_null(), "{value}");
}

#[test]
fn what_cannot_be_held_is_refused() {
    let of = |more: &[&str], code| failure(&[&DRIVE[..], more].concat(), code);
    assert!(of(&["--hold", "--max-rise", "21"], 2).contains("0 to 20 dB"));
    assert!(of(&["--hold", "--sensor", "1m"], 2).contains("--sensor"));
    assert!(of(&["--sensor", "30mm"], 2).contains("--hold"));
    // No sensor receives full silence.
    let message = of(&["--level", "0.00002", "--hold"], 1);
    assert!(message.contains("receives only"), "{message}");
}
