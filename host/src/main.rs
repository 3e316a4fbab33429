//! `slipline`: the app without a command, the command line with one.

#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::expect_used, clippy::unwrap_used))]
// A new error, request or outcome must be handled wherever these are matched.
#![warn(clippy::wildcard_enum_match_arm)]

use slipline::cli::{Cli, Failure, asks_for_json, note};
use slipline::{signals, trace};
use slipline_link::Port;
use slipline_model::atomic_file::{self, said};
use std::path::PathBuf;
use std::process::ExitCode;

fn main() -> ExitCode {
    let words: Vec<_> = std::env::args_os().collect();
    let as_json = asks_for_json(&words);
    let cli = match Cli::of_words(&words) {
        Ok(cli) => cli,
        Err(failure) => return ended(&failure, as_json),
    };
    if let Err(error) = signals::watch() {
        // If signals cannot be handled, they still end the program, and the device stops by itself when its
        // host is silent.
        note(format_args!(
            "slipline: Ctrl-C will end the program without stopping the device first: {}",
            said(&error)
        ));
    }
    for sentence in cli.command.iter().flat_map(|command| command.renamed(&words)) {
        note(format_args!("slipline: {sentence}"));
    }
    let traced =
        trace::start(cli.trace.as_deref(), cli.may_replace, cli.prints_json()).and_then(|()| cli.checked());
    let result = traced.and_then(|cli| match cli.command {
        None => open_window(cli.file, cli.port, cli.kiosk),
        Some(command) => command.run(cli.json),
    });
    let result = result.and_then(|()| trace::end());
    // If a signal has ended the command, nothing more is printed.
    signals::hold_while_ending();
    // A thread of the window may still be writing a file.
    atomic_file::remove_unfinished();
    let code = match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => ended(&failure, as_json),
    };
    signals::end_by_signal();
    code
}

/// Prints why the program fails, as a sentence or as a line of JSON.
fn ended(failure: &Failure, as_json: bool) -> ExitCode {
    if as_json {
        note(format_args!("{}", failure.json()));
    } else {
        note(format_args!("slipline: {failure}"));
    }
    ExitCode::from(failure.exit_code())
}

#[cfg(feature = "gui")]
fn open_window(file: Option<PathBuf>, port: Option<Port>, kiosk: bool) -> Result<(), Failure> {
    let opening = slipline_window::app::Opening { file, port, kiosk };
    slipline_window::app::run(opening, signals::end_window)
        .map_err(|error| Failure::Failed(format!("{error:#}")))
}

#[cfg(not(feature = "gui"))]
fn open_window(_file: Option<PathBuf>, _port: Option<Port>, _kiosk: bool) -> Result<(), Failure> {
    Err(Failure::Usage("this build has no window; see slipline --help".to_owned()))
}
