//! `--trace FILE` and `RUST_LOG`.

use crate::{failure, file, refused, slipline};
use std::process::Command;

const DRIVE: [&str; 8] =
    ["drive", "--port", "sim", "--plate", "membrane", "--turning-point", "120mm", "--for"];

#[test]
fn a_trace_has_one_line_for_each_frame_in_both_directions() {
    let path = file("trace.txt");
    let output = slipline(&[&DRIVE[..], &["0.3s", "--trace", path.to_str().unwrap()]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let trace = std::fs::read_to_string(&path).unwrap();
    let mut latest = 0.0;
    for line in trace.lines() {
        let mut words = line.split_whitespace();
        let time: f64 = words.next().unwrap().parse().unwrap();
        assert!(time >= latest, "{line}");
        latest = time;
        assert_eq!(words.next(), Some("to"), "{line}");
        assert!(matches!(words.next(), Some("device" | "host")), "{line}");
        assert!(words.next().unwrap().starts_with("id=") && words.next().unwrap().starts_with("sequence="));
        assert!(words.next().is_some(), "{line}");
    }
    for body in
        ["Hello(Hello {", "Hello(Identity {", "TableCommit", "Arm", "Drive(Drive {", "Accepted(", "Stop"]
    {
        assert!(trace.lines().any(|line| line.contains(body)), "{body} is missing:\n{trace}");
    }
    std::fs::remove_file(path).unwrap();
}

#[test]
fn rust_log_writes_to_standard_error_and_a_bad_one_is_refused() {
    let program = |filter: &str| {
        Command::new(env!("CARGO_BIN_EXE_slipline"))
            .args(["info", "--port", "sim"])
            .env("RUST_LOG", filter)
            .output()
            .unwrap()
    };
    let output = program("slipline_link=trace");
    assert_eq!(output.status.code(), Some(0));
    assert!(String::from_utf8_lossy(&output.stderr).contains("to device"));
    let output = program("slipline_link=loud");
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("RUST_LOG is 'slipline_link=loud'"));
}

#[test]
fn a_trace_that_cannot_be_written_is_refused_by_name() {
    refused(
        &["presets", "--trace", "/no/such/folder/trace.txt"],
        1,
        &["the trace /no/such/folder/trace.txt cannot be written"],
    );
}

#[test]
#[cfg(target_os = "linux")]
fn a_trace_that_is_not_whole_ends_the_command_with_1_after_its_work() {
    let output = slipline(&["info", "--port", "sim", "--trace", "/dev/full"]);
    assert!(String::from_utf8_lossy(&output.stdout).contains("Board"));
    let message = String::from_utf8(output.stderr).unwrap();
    let wanted = "slipline: the trace /dev/full is not whole: no space left on device\n";
    assert_eq!((output.status.code(), message.as_str()), (Some(1), wanted));
    // A link to nothing is not followed without permission.
    let (link, nothing) = (file("trace-link"), file("trace-nothing"));
    std::os::unix::fs::symlink(&nothing, &link).unwrap();
    let message = failure(&["info", "--port", "sim", "--trace", link.to_str().unwrap()], 2);
    assert!(message.contains("trace-link exists: write --force") && !nothing.exists(), "{message}");
    std::fs::remove_file(link).unwrap();
}

#[test]
fn a_trace_replaces_no_file_unless_it_may() {
    // The plate that it reads.
    let plate = file("traced-plate.toml");
    let text = slipline_plate::preset("membrane").unwrap().to_toml();
    std::fs::write(&plate, &text).unwrap();
    let name = plate.to_str().unwrap();
    refused(
        &["table", "--plate", name, "--knots", "5", "--trace", name],
        2,
        &["traced-plate.toml exists: write --force"],
    );
    assert_eq!(std::fs::read_to_string(&plate).unwrap(), text);
    refused(&["presets", "--trace", name], 2, &["traced-plate.toml exists"]);
    assert_eq!(slipline(&["info", "--port", "sim", "--force", "--trace", name]).status.code(), Some(0));
    assert!(std::fs::read_to_string(&plate).unwrap().contains("Hello("));
}
