//! Help, version and completions.

use super::{failure, json, said, says};
use slipline::cli::EXAMPLES;
use std::process::Command;

/// The help of a command, as a terminal of this many columns shows it.
fn help(arguments: &[&str], columns: &str) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_slipline"));
    let output = command.args(arguments).arg("--help").env("COLUMNS", columns).output().unwrap();
    String::from_utf8(output.stdout).unwrap()
}

fn commands() -> Vec<String> {
    let help = help(&[], "100");
    let commands = help.lines().skip_while(|line| !line.starts_with("Commands:")).skip(1);
    let commands = commands.take_while(|line| !line.is_empty());
    let commands = commands.filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    let commands = commands.filter_map(|line| line.split_whitespace().next()).map(str::to_owned);
    commands.filter(|command| command != "help").collect()
}

#[test]
fn the_help_of_every_command_ends_with_its_examples_unbroken() {
    let commands = commands();
    let of_examples: Vec<&str> = EXAMPLES.iter().map(|(command, _)| *command).collect();
    assert!(
        commands.len() > 15 && commands.iter().all(|it| of_examples.contains(&it.as_str())),
        "{commands:?}"
    );
    for (command, examples) in EXAMPLES {
        assert!(commands.iter().any(|name| name == command), "{command}");
        let help = help(&[command], "100");
        let (_, end) = help.split_once("\nExamples:\n").unwrap_or_else(|| panic!("{command}: {help}"));
        assert_eq!(end.lines().map(str::trim_start).collect::<Vec<_>>(), *examples, "{command}");
    }
}

#[test]
fn help_fits_the_terminal_and_groups_the_options() {
    for command in commands() {
        for line in help(&[&command], "72").lines() {
            // The parser does not break the line of the usage.
            assert!(line.chars().count() <= 72 || line.starts_with("Usage:"), "{command}: {line}");
        }
    }
    for (command, headings) in [
        ("drive", &["Device:", "Plate:", "Tones:", "Level hold:", "Drive circuit:", "Output:"][..]),
        ("simulate", &["Plate:", "Tones:", "Output:"]),
        (
            "calibrate",
            &["Device:", "Plate:", "Measurements:", "Sensor:", "Frequencies:", "Calipers:", "Output:"],
        ),
    ] {
        let help = help(&[command], "100");
        for heading in headings {
            let count = help.lines().filter(|line| line == heading).count();
            assert_eq!(count, 1, "{command}: {heading}");
        }
    }
    let text = help(&["check"], "100").split_whitespace().collect::<Vec<_>>().join(" ");
    let order = "Without this option: SLIPLINE_PLATE of the environment, else plate = \"...\" of the settings file, else membrane";
    assert!(text.contains(order), "{text}");
}

#[test]
fn the_version_names_the_commit_of_the_tree() {
    let version = said(&["--version"]);
    let mut git = Command::new("git");
    git.args(["rev-parse", "--short=10", "HEAD"]).current_dir(env!("CARGO_MANIFEST_DIR"));
    let commit = git.output().ok().filter(|output| output.status.success());
    let commit = commit.map(|output| format!(" ({})", String::from_utf8(output.stdout).unwrap().trim()));
    let wanted = format!("slipline {}{}\n", env!("CARGO_PKG_VERSION"), commit.unwrap_or_default());
    assert_eq!(version, wanted);
}

#[test]
fn shells_get_a_script_that_completes_commands_and_options() {
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let value = json(&["completions", shell]);
        let script = value["script"].as_str().unwrap();
        says(script, &["calibrate", "felt-edge", "turning-point"]);
        assert_eq!(said(&["completions", shell]), script);
    }
    assert!(failure(&["completions", "dos"], 2).contains("bash, elvish, fish, powershell, zsh"));
}
