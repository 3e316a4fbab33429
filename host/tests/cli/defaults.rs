//! Defaults of `--port` and `--plate`: option, environment, settings file, built-in.
#![cfg(target_os = "linux")]

use super::{file, program};
use serde_json::{Value, json};
use std::process::Output;

/// A run with a folder of settings and variables.
fn run(settings: Option<&str>, variables: &[(&str, &str)], arguments: &[&str]) -> Output {
    static NUMBER: std::sync::atomic::AtomicUsize = std::sync::atomic::AtomicUsize::new(0);
    let number = NUMBER.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
    let folder = file(&format!("settings-{number}"));
    std::fs::create_dir_all(folder.join("slipline")).unwrap();
    if let Some(text) = settings {
        std::fs::write(folder.join("slipline/settings.toml"), text).unwrap();
    }
    let mut command = program(arguments);
    let output = command.env("XDG_CONFIG_HOME", &folder).envs(variables.iter().copied()).output().unwrap();
    std::fs::remove_dir_all(folder).unwrap();
    output
}

fn defaults(settings: Option<&str>, variables: &[(&str, &str)], more: &[&str]) -> Value {
    let output = run(settings, variables, &[&["info", "--json"], more].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice::<Value>(&output.stdout).unwrap()["defaults"].clone()
}

#[test]
fn each_source_stands_before_the_next_and_info_names_it() {
    let chosen = |value: &str, from: &str| json!({ "value": value, "from": from });
    let found = defaults(None, &[], &[]);
    assert_eq!(
        (&found["port"], &found["plate"]),
        (&chosen("sim", "built-in"), &chosen("membrane", "built-in"))
    );
    assert!(found["settings_file"].as_str().unwrap().ends_with("slipline/settings.toml"), "{found}");
    let settings = Some("port = \"sim\"\nplate = \"al-bending\"\n");
    let found = defaults(settings, &[], &[]);
    assert_eq!(found["port"], chosen("sim", "settings file"));
    assert_eq!(found["plate"], chosen("al-bending", "settings file"));
    let found = defaults(settings, &[("SLIPLINE_PORT", "sim"), ("SLIPLINE_PLATE", "al-sh")], &[]);
    assert_eq!(found["port"], chosen("sim", "environment"));
    assert_eq!(found["plate"], chosen("al-sh", "environment"));
    let found = defaults(settings, &[("SLIPLINE_PORT", "unix:/no/such/device")], &["--port", "sim"]);
    assert_eq!(found["port"], chosen("sim", "option"));
    let text = String::from_utf8(run(settings, &[], &["info"]).stdout).unwrap();
    assert!(text.contains("al-bending (settings file)") && text.contains("sim (settings file)"), "{text}");
}

#[test]
fn a_command_takes_the_default_and_an_option_stands_before_it() {
    let plate = |variables: &[(&str, &str)], more: &[&str]| {
        let output = run(None, variables, &[&["table", "--knots", "9", "--json"], more].concat());
        serde_json::from_slice::<Value>(&output.stdout).unwrap()["plate"].clone()
    };
    assert_eq!(plate(&[], &[]), "membrane");
    assert_eq!(plate(&[("SLIPLINE_PLATE", "al-bending")], &[]), "al-bending");
    assert_eq!(plate(&[("SLIPLINE_PLATE", "al-bending")], &["--plate", "al-sh"]), "al-sh");
    let output =
        run(None, &[("SLIPLINE_PORT", "unix:/no/such/device")], &["drive", "--turning-point", "120mm"]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(1) && message.contains("/no/such/device"), "{message}");
    // Where a device is one of several sources, it is asked for by the option.
    let output = run(None, &[("SLIPLINE_PORT", "sim")], &["calibrate", "--sensor", "34mm"]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(2) && message.contains("--port"), "{message}");
}

#[test]
fn a_default_that_cannot_be_used_is_refused_with_its_source_where_it_is_needed() {
    for (settings, variables, wanted) in [
        (None, &[("SLIPLINE_PORT", "unix:")][..], "SLIPLINE_PORT = \"unix:\": "),
        (Some("port = \"unix:\"\n"), &[], "settings.toml: port = \"unix:\": "),
        (
            Some("plates = \"membrane\"\n"),
            &[],
            "settings.toml: plates is no setting: the settings are port and plate",
        ),
        (Some("plate = 3\n"), &[], "settings.toml: plate = 3: write a text in quotes"),
        (
            Some("\nplate = \"me\n"),
            &[],
            "settings.toml: line 2: 'plate = \"me' is no setting: write port = \"NAME\"",
        ),
        (Some("plate ="), &[], "settings.toml: line 1: 'plate =' is no setting"),
    ] {
        // It needs both.
        let output = run(settings, variables, &["drive", "--turning-point", "120mm", "--for", "10ms"]);
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(2) && message.contains(wanted), "{wanted}: {message}");
        for needless in
            ["presets", "ports", "--version", "info --port sim", "table --knots 9 --plate membrane"]
        {
            let output = run(settings, variables, &needless.split(' ').collect::<Vec<_>>());
            let message = String::from_utf8(output.stderr).unwrap();
            assert_eq!((output.status.code(), message.as_str()), (Some(0), ""), "{wanted}: {needless}");
        }
    }
    // An option or a variable that precedes the file needs no valid file, and one setting does not need the other.
    for (settings, variables, arguments) in [
        ("plate =", &[("SLIPLINE_PLATE", "membrane")][..], "table --knots 9"),
        ("port = 3\nplate = \"membrane\"", &[], "table --knots 9"),
        ("plate = 3", &[], "info"),
    ] {
        let output = run(Some(settings), variables, &arguments.split(' ').collect::<Vec<_>>());
        assert_eq!(output.status.code(), Some(0), "{settings}: {}", String::from_utf8_lossy(&output.stderr));
    }
    let text = String::from_utf8(run(Some("plate = 3"), &[], &["info"]).stdout).unwrap();
    assert!(text.contains("plate = 3: write a text in quotes"), "{text}");
}
