//! Red lights and the exit code: `check` fails with them, `design` only reports them.

use super::{failure, json, said, says, slipline, words};

#[test]
fn red_lights_end_a_check_with_3_and_are_counted() {
    for (arguments, code, last) in [
        (&["check", "--plate", "al-sh"][..], 3, "slipline: 3 of 22 lights are red\n"),
        (
            &["check", "--plate", "al-sh", "--json"],
            3,
            "{\"error\":\"3 of 22 lights are red\",\"exit_code\":3,\"field\":null,\"range\":null,\"schema\":1,\"value\":null}\n",
        ),
        (&["check", "--plate", "membrane"], 0, ""),
        (&["check", "--plate", "membrane", "--turning-point", "120mm"], 0, ""),
    ] {
        let output = slipline(arguments);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}");
        assert_eq!(String::from_utf8(output.stderr).unwrap(), last, "{arguments:?}");
        let text = String::from_utf8(output.stdout).unwrap();
        let red = if arguments.contains(&"--json") { "\"colour\":\"red\"" } else { "red    " };
        assert_eq!(text.matches(red).count(), if code == 3 { 3 } else { 0 }, "{text}");
    }
    let lines = said(&["check", "--plate", "membrane"]);
    assert!(lines.starts_with("green      edge slope "), "{lines}");
    assert!(lines.contains("\nunchecked  actuator band "), "{lines}");
    assert!(lines.contains("\nunchecked  excursion "), "{lines}");
    let report = json(&["check", "--plate", "membrane"]);
    assert_eq!(
        (&report["lights"][12]["name"], &report["lights"][12]["colour"]),
        (&"actuator band".into(), &"unchecked".into())
    );
    assert!(failure(&["check", "--plate", "nope"], 2).contains("nope"));
    says(&said(&["--help"]), &["Exit code: 0 done; 1 could not be done; 2 bad usage"]);
}

#[test]
fn a_design_ends_with_0_though_lights_are_red_and_its_help_says_so() {
    let designed = json(&words("design --material acrylic --thickness 2mm --band 2kHz..8kHz --length 1m"));
    let lights = designed["check"]["lights"].as_array().unwrap();
    assert!(lights.iter().any(|light| light["colour"] == "red"), "{lights:?}");
    assert!(designed["mounting"].as_str().unwrap().contains("Cut the frame twice"));
    let help = said(&["design", "--help"]);
    assert!(
        help.split_whitespace()
            .collect::<Vec<_>>()
            .join(" ")
            .contains("0 designed, also where lights are red"),
        "{help}"
    );
}

#[test]
fn a_check_for_a_board_counts_with_its_linear_share() {
    let of_board = said(&["check", "--plate", "membrane", "--linear-share", "0.88"]);
    says(&of_board, &["amber      linear output", "linear up to 88 %", "Lower the level by 1.2 dB."]);
    let quieter = said(&["check", "--plate", "membrane", "--linear-share", "0.88", "--level", "-1.2dB"]);
    says(&quieter, &["green      linear output"]);
    assert!(!said(&["check", "--plate", "membrane"]).contains("linear output"));
    assert!(failure(&["check", "--linear-share", "0.05"], 2).contains("must be 0.1 to 1"));
}
