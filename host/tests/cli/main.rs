//! The command line as other programs use it: JSON fields, exit codes, and messages about bad input.

mod answers;
mod brown_out;
mod calibrate;
mod defaults;
mod felt_edges;
mod figures;
mod files;
#[cfg(unix)]
mod following;
mod foreign;
mod harmonics;
mod held_up;
mod help;
mod holding;
mod installing;
mod json_errors;
mod json_page;
mod lights;
mod measure;
mod no_display;
mod numbers;
#[cfg(unix)]
mod page;
mod profile;
mod progress;
mod recordings;
mod refusals;
mod renamed;
mod selftest;
#[cfg(unix)]
mod serve;
#[cfg(unix)]
mod served;
#[cfg(unix)]
mod serving;
mod setups;
#[cfg(unix)]
mod signals;
mod streams;
mod study;
mod sweep;
mod terminal;
mod textures;
#[cfg(target_os = "linux")]
mod threads;
mod trace;
#[cfg(unix)]
mod travel;
#[cfg(unix)]
mod trigger;
mod trim;
#[cfg(unix)]
mod unarmed;
#[cfg(unix)]
mod upkeep;
#[cfg(unix)]
mod watch;
mod words;

use serde_json::Value;
use std::ffi::OsStr;
use std::path::PathBuf;
use std::process::{Child, Command, Output, Stdio};
use std::sync::{Condvar, Mutex, PoisonError};

/// A command with a simulated sensor computes a plate in real time, for some seconds; its device stops, as it should, where it
/// cannot. So at most two of them run at once: on a busy machine eight would keep each other from their device for a second.
struct Sensed;

static SENSED: (Mutex<usize>, Condvar) = (Mutex::new(0), Condvar::new());

impl Sensed {
    fn begin() -> Self {
        let (running, ended) = &SENSED;
        let running = running.lock().unwrap_or_else(PoisonError::into_inner);
        *ended.wait_while(running, |running| *running == 2).unwrap_or_else(PoisonError::into_inner) += 1;
        Self
    }
}

impl Drop for Sensed {
    fn drop(&mut self) {
        *SENSED.0.lock().unwrap_or_else(PoisonError::into_inner) -= 1;
        SENSED.1.notify_one();
    }
}

/// The program, without the defaults of the person who runs the tests.
fn program(arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_slipline"));
    command.env_remove("SLIPLINE_PORT").env_remove("SLIPLINE_PLATE");
    command.env("XDG_CONFIG_HOME", env!("CARGO_TARGET_TMPDIR")).args(arguments);
    command
}

/// The same, running, with its input, output and errors as pipes.
fn piped(arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Child {
    let mut command = program(arguments);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

fn slipline(arguments: &[&str]) -> Output {
    let _running = arguments.contains(&"--sensor").then(Sensed::begin);
    program(arguments).output().unwrap()
}

fn json(arguments: &[&str]) -> Value {
    let output = slipline(&[arguments, &["--json"]].concat());
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {error}");
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{arguments:?}: {error}"))
}

/// The message of a command that must fail with this code.
fn failure(arguments: &[&str], code: i32) -> String {
    let output = slipline(arguments);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {message}");
    assert!(!message.contains("panicked"), "{arguments:?}: {message}");
    message
}

/// Refuses these arguments with this code, and a message with these words.
fn refused(arguments: &[&str], code: i32, wanted: &[&str]) {
    let message = failure(arguments, code);
    for words in wanted {
        assert!(message.contains(words), "{arguments:?} does not say {words:?}: {message}");
    }
}

/// The output of a command that succeeds: exit code 0, or 3 where a light is red.
fn said(arguments: &[&str]) -> String {
    let output = slipline(arguments);
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(matches!(output.status.code(), Some(0 | 3)), "{arguments:?}: {error}");
    String::from_utf8(output.stdout).unwrap()
}

fn says(text: &str, wanted: &[&str]) {
    for words in wanted {
        assert!(text.contains(words), "{words:?} is not in: {text}");
    }
}

/// The arguments of a line in which no argument has a space.
fn words(line: &str) -> Vec<&str> {
    line.split(' ').collect()
}

fn number(value: &Value, field: &str) -> f64 {
    value[field].as_f64().unwrap_or_else(|| panic!("{field} is {:?}", value[field]))
}

/// Sends a process a signal, by the shell's own command: not every machine has a program of that name.
#[cfg(unix)]
fn signal(process: u32, signal: &str) {
    let sent = Command::new("sh").args(["-c", &format!("kill {signal} {process}")]).status().unwrap();
    assert!(sent.success());
}

/// A file for one test.
fn file(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("cli-{}-{name}", std::process::id()))
}

/// A design of the aluminium plate of the examples, with more options.
fn design(more: &[&str]) -> Output {
    let aluminium = "design --material aluminium --thickness 2mm --band 20kHz..40kHz --length 300mm";
    slipline(&aluminium.split(' ').chain(more.iter().copied()).collect::<Vec<_>>())
}
