//! `-`: standard input and output as files of a command.

use super::{failure, file, json, piped};
use serde_json::Value;
use std::io::Write as _;
use std::process::{Command, Output};

fn output(arguments: &[&str], input: &[u8]) -> Output {
    let mut child = piped(arguments);
    // A command that refuses before it reads has closed the pipe.
    let _ = child.stdin.take().unwrap().write_all(input);
    child.wait_with_output().unwrap()
}

/// Exit code, output and errors of a command that is fed this input.
pub(crate) fn fed(arguments: &[&str], input: &[u8]) -> (Option<i32>, (String, String)) {
    let output = output(arguments, input);
    let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
    (output.status.code(), (text(output.stdout), text(output.stderr)))
}

fn membrane() -> String {
    slipline_plate::preset("membrane").unwrap().to_toml()
}

#[test]
fn a_plate_and_a_setup_are_read_from_standard_input() {
    let wanted = json(&["table", "--plate", "membrane", "--knots", "5"]);
    let (code, (text, error)) =
        fed(&["table", "--plate", "-", "--knots", "5", "--json"], membrane().as_bytes());
    assert_eq!((code, serde_json::from_str::<Value>(&text).unwrap()), (Some(0), wanted), "{error}");
    // A pipe from one command to the next.
    let (code, (setup, error)) =
        fed(&["texture", "--plate", "membrane", "--stripes", "50mm", "--out", "-"], b"");
    assert!(code == Some(0) && error.contains("Stripes"), "{error}");
    let record = ["record", "--setup", "-", "--for", "1ms", "--out", "-"];
    let wav = output(&record, setup.as_bytes());
    assert!(
        wav.status.success() && wav.stdout.starts_with(b"RIFF"),
        "{}",
        String::from_utf8_lossy(&wav.stderr)
    );
    let (code, (_, error)) = fed(&["table", "--plate", "-"], b"name = 3");
    assert!(code == Some(2) && error.contains("-: "), "{error}");
    let (code, (_, error)) = fed(&["table", "--plate", "-"], &vec![b'#'; 3 << 20]);
    assert!(code == Some(2) && error.contains("too big"), "{error}");
}

#[test]
fn a_file_on_standard_output_is_the_same_as_on_disk_and_the_text_goes_to_standard_error() {
    let tone = ["--plate", "membrane", "--turning-point", "120mm", "--for", "20ms"];
    for (command, name) in [("simulate", "stream.csv"), ("record", "stream.wav")] {
        let path = file(name);
        let to = |out: &str| output(&[&[command][..], &tone, &["--out", out]].concat(), b"");
        let on_disk = to(path.to_str().unwrap());
        assert!(on_disk.status.success() && on_disk.stderr.is_empty(), "{command}");
        let streamed = to("-");
        assert!(streamed.stdout == std::fs::read(&path).unwrap(), "{command}");
        let shown = String::from_utf8(streamed.stderr).unwrap();
        let wanted = String::from_utf8(on_disk.stdout).unwrap().replace(path.to_str().unwrap(), "-");
        assert_eq!(shown, wanted, "{command}");
        std::fs::remove_file(path).unwrap();
    }
    let figure = output(&["respond", "--plate", "membrane", "--freq", "126Hz", "--out", "-"], b"");
    assert!(figure.stdout.starts_with(b"\x89PNG"));
    let (code, (frames, text)) = fed(&["info", "--port", "sim", "--trace", "-"], b"");
    assert!(code == Some(0) && text.contains("Board") && frames.lines().count() > 3, "{frames} {text}");
}

#[test]
fn what_does_not_fit_one_stream_is_refused_before_the_work() {
    let simulate = ["simulate", "--plate", "membrane", "--turning-point", "120mm"];
    let with = |more: &[&str]| failure(&[&simulate[..], more].concat(), 2);
    assert!(with(&["--out", "-", "--json"]).contains("--json and a file named - both need standard output"));
    assert!(with(&["--out", "-", "--figure", "-"]).contains("two files named - both need standard output"));
    assert!(with(&["--out", "-", "--trace", "-"]).contains("two files named -"));
    assert!(with(&["--trace", "-", "--json"]).contains("--json and a file"));
    assert!(failure(&["watch", "--port", "sim", "--trace", "-"], 2).contains("--json and a file"));
    let design = super::design(&["--out", "-"]);
    let message = String::from_utf8(design.stderr).unwrap();
    assert!(design.status.code() == Some(2) && message.contains("name a folder"), "{message}");
    let twice = [&simulate[..2], &["-", "--actual-plate", "-", "--turning-point", "120mm"]].concat();
    let (code, (_, message)) = fed(&twice, membrane().as_bytes());
    assert!(code == Some(2) && message.contains("standard input is read already"), "{message}");
}

/// Exit code and errors of a command in a shell, with these redirections.
#[cfg(target_os = "linux")]
fn redirected(command: &str, redirections: &str) -> (Option<i32>, String) {
    let script = format!("\"$0\" {command} {redirections}");
    let output = Command::new("sh").args(["-c", &script, env!("CARGO_BIN_EXE_slipline")]).output().unwrap();
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_output_is_a_failure_with_a_sentence() {
    let full = "slipline: standard output: no space left on device\n";
    for command in ["--version", "--help", "drive --help", "presets", "completions bash", "ports"] {
        assert_eq!(redirected(command, ">/dev/full"), (Some(1), full.to_owned()), "{command}");
    }
    let table = "table --plate membrane --knots 5 --out -";
    let (code, message) = redirected(table, ">/dev/full");
    assert!(code == Some(1) && message.ends_with("slipline: -: no space left on device\n"), "{message}");
    let (code, message) = redirected("info --port sim --trace -", ">/dev/full");
    assert!(code == Some(1) && message.contains("standard output is not whole: no space left"), "{message}");
    for command in [table, "info --port sim --trace -", "presets", "presets --json", "--version"] {
        let (code, message) = redirected(command, ">&-");
        assert!(code == Some(1) && message.contains("standard output is closed"), "{message}");
        assert_eq!(redirected(command, ">/dev/null").0, Some(0), "the command asked for no output");
    }
    // A refusal that cannot be shown has its code.
    assert_eq!(redirected("table --plate no-such", "2>/dev/full").0, Some(2));
}

#[test]
#[cfg(unix)]
fn a_reader_that_leaves_early_is_no_error() {
    // More than a pipe holds.
    let script = "{ \"$0\" record --plate membrane --turning-point 120mm --for 1s --out - 2>/dev/null; echo $? >&2; } | head -c 4";
    let output = Command::new("sh").args(["-c", script, env!("CARGO_BIN_EXE_slipline")]).output().unwrap();
    assert_eq!(String::from_utf8_lossy(&output.stdout), "RIFF");
    assert_eq!(String::from_utf8_lossy(&output.stderr), "0\n");
    // The reader of a trace has left before its second line.
    let script = "{ \"$0\" drive --port sim --plate membrane --turning-point 120mm --for 300ms --trace - 2>/dev/null; \
                  echo $? >&2; } | true";
    let output = Command::new("sh").args(["-c", script, env!("CARGO_BIN_EXE_slipline")]).output().unwrap();
    assert_eq!(String::from_utf8_lossy(&output.stderr), "0\n");
}
