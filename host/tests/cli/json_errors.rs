//! Errors under `--json`: one line of JSON with the message, and field, value and range where a value is refused.

use super::{file, slipline};
use serde_json::{Value, json};

/// The line on the error stream of a command that ends with this code.
fn error(arguments: &[&str], code: i32) -> Value {
    let output = slipline(&[arguments, &["--json"]].concat());
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {text}");
    assert_eq!(text.lines().count(), 1, "{arguments:?}: {text}");
    let value: Value = serde_json::from_str(&text).unwrap();
    assert_eq!((&value["schema"], &value["exit_code"]), (&json!(1), &json!(code)), "{text}");
    value
}

#[test]
fn a_refused_value_is_named_with_its_field_and_its_range() {
    let plate = file("lossy.toml");
    let text = slipline_plate::preset("membrane").unwrap().to_toml();
    std::fs::write(&plate, text.replacen("loss_factor = ", "loss_factor = 0.7 # ", 1)).unwrap();
    let plate = plate.to_str().unwrap();
    let at = ["simulate", "--plate", "membrane", "--turning-point"];
    let respond = ["respond", "--plate", "membrane", "--freq"];
    let range = |low: f64, high: f64, unit: &str| json!({ "low": low, "high": high, "unit": unit });
    for (arguments, field, value, allowed) in [
        // By the plate's span, by the parser's own range, by a file's field, by the model.
        (&[&at[..], &["900mm"]].concat()[..], "--turning-point", json!("900mm"), range(0.08, 0.28, "m")),
        (&[&at[..], &["120mm", "--for", "9999s"]].concat(), "--for", json!("9999s"), range(0.01, 600.0, "s")),
        (&[&at[..], &["120mm", "--level", "120%"]].concat(), "--level", json!("120%"), range(0.0, 1.0, "")),
        (&["table", "--plate", plate], "loss_factor", json!(0.7), range(0.0, 0.5, "")),
        (
            &[&respond[..], &["120Hz", "--finger", "9m:light"]].concat(),
            "finger place",
            json!(9.0),
            range(0.0, 0.32, "m"),
        ),
        (&[&at[..], &["120mm", "--no-such"]].concat(), "--no-such", Value::Null, Value::Null),
        (&["table", "--knots", "1026"], "--knots", json!("1026"), range(2.0, 1025.0, "")),
        (&["completions", "dos"], "<SHELL>", json!("dos"), Value::Null),
    ] {
        let found = error(arguments, 2);
        assert_eq!((&found["field"], &found["value"]), (&json!(field), &value), "{found}");
        assert_eq!(found["range"]["unit"], allowed["unit"], "{found}");
        for end in ["low", "high"] {
            let (is, wanted) = (found["range"][end].as_f64(), allowed[end].as_f64());
            assert!(
                is.zip(wanted).map_or(is == wanted, |(is, wanted)| (is - wanted).abs() < 1e-9),
                "{found}"
            );
        }
        assert!(found["error"].as_str().unwrap().len() > 20, "{found}");
    }
}

#[test]
fn what_cannot_be_done_and_red_lights_are_lines_of_json_too() {
    let found = error(&["info", "--port", "no-such-port"], 1);
    assert!(found["error"].as_str().unwrap().contains("no-such-port") && found["field"].is_null(), "{found}");
    let found = error(&["frobnicate"], 2);
    assert!(found["error"].as_str().unwrap().contains("neither a file nor a command"), "{found}");
    assert_eq!(error(&["check", "--plate", "al-sh"], 3)["error"], "3 of 22 lights are red");
    // The sentence is that without --json.
    let output = slipline(&["simulate", "--plate", "membrane", "--turning-point", "900mm"]);
    let found = error(&["simulate", "--plate", "membrane", "--turning-point", "900mm"], 2);
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(text, format!("slipline: {}\n", found["error"].as_str().unwrap()));
}
