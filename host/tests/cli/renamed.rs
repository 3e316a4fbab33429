//! One name for a duration and an output; the old names are taken for a release.

use super::{failure, file, said, slipline};

/// Runs a command that must succeed; returns its error stream.
fn noted(arguments: &str) -> String {
    let output = slipline(&arguments.split(' ').collect::<Vec<_>>());
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{arguments}: {error}");
    error
}

#[test]
fn an_old_name_still_works_and_names_the_new_one() {
    let [wav, csv, svg] = ["old.wav", "old.txt", "old.svg"].map(|name| file(name).display().to_string());
    let tone = "--plate membrane --turning-point 120mm";
    for (old, new, sentences) in [
        (
            format!("record {tone} --force --seconds 1ms --wav {wav}"),
            format!("record {tone} --force --for 1ms --out {wav}"),
            "slipline: --seconds of record is --for now; the old name will go\n\
             slipline: --wav of record is --out now; the old name will go\n",
        ),
        (
            // A name without an ending was CSV.
            format!("simulate {tone} --force --seconds=20ms --csv {csv}"),
            format!("simulate {tone} --force --for 20ms --out {csv}.csv"),
            "slipline: --seconds of simulate is --for now; the old name will go\n\
             slipline: --csv of simulate is --out now; the old name will go\n",
        ),
        (
            format!("simulate {tone} --force --for 20ms --png {svg}"),
            format!("simulate {tone} --force --for 20ms --out {svg}"),
            "slipline: --png of simulate is --out now; the old name will go\n",
        ),
        (
            format!("respond --plate membrane --freq 126Hz --force --figure {svg}"),
            format!("respond --plate membrane --freq 126Hz --force --out {svg}"),
            "slipline: --figure of respond is --out now; the old name will go\n",
        ),
    ] {
        let written = |arguments: &str| std::fs::read(arguments.rsplit(' ').next().unwrap()).unwrap();
        assert_eq!(noted(&old), sentences);
        let before = written(&old);
        assert_eq!(noted(&new), "", "{new}");
        assert!(written(&new) == before, "{new}");
    }
}

#[test]
fn help_has_the_new_names_only_and_endings_are_checked() {
    for (command, old) in [
        ("simulate", &["--seconds", "--csv", "--figure", "--png"][..]),
        ("record", &["--seconds", "--wav "]),
        ("respond", &["--figure"]),
        ("sweep", &["--time"]),
        ("trim", &["--watch"]),
    ] {
        let help = said(&[command, "--help"]);
        assert!(
            help.contains("--out <") && (command == "respond" || help.contains("--for <TIME>")),
            "{help}"
        );
        for old in old {
            assert!(!help.contains(old), "{command} {old}: {help}");
        }
    }
    let tone = ["--plate", "membrane", "--turning-point", "120mm", "--out"];
    let refused = |command: &str, name: &str| failure(&[&[command][..], &tone, &[name]].concat(), 2);
    assert!(refused("record", "a.mp3").contains("must end in .wav"));
    assert!(refused("simulate", "a.pdf").contains("must end in .csv, .svg or .png"));
}
