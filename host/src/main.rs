//! `slipline`: the app without a command, the command line with one.

#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::expect_used, clippy::unwrap_used))]

use clap::Parser;
use slipline::cli::Cli;
use slipline::cli::Failure;
use slipline::{signals, trace};
use slipline_link::Port;
use slipline_model::atomic_file;
use std::path::PathBuf;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = Cli::parse();
    if let Err(error) = signals::watch() {
        // If signals cannot be handled, they still end the program, and the device stops by itself when its
        // host is silent.
        eprintln!("slipline: Ctrl-C will end the program without stopping the device first: {error}");
    }
    let arguments: Vec<_> = std::env::args_os().collect();
    for sentence in cli.command.iter().flat_map(|command| command.renamed(&arguments)) {
        eprintln!("slipline: {sentence}");
    }
    let traced =
        trace::start(cli.trace.as_deref(), cli.may_replace(), cli.prints_json()).and_then(|()| cli.checked());
    let ended = traced.map_err(described).and_then(|cli| match cli.command {
        None => open_window(cli.file, cli.port, cli.kiosk),
        Some(command) => command.run(cli.json).map_err(described),
    });
    // If a signal has ended the command, nothing more is printed.
    signals::hold_while_ending();
    // A thread of the window may still be writing a file.
    atomic_file::remove_unfinished();
    let code = match ended {
        Ok(()) => ExitCode::SUCCESS,
        Err((message, code)) => {
            eprintln!("slipline: {message}");
            ExitCode::from(code)
        }
    };
    signals::end_by_signal();
    code
}

fn described(failure: Failure) -> (String, u8) {
    (failure.to_string(), failure.exit_code())
}

#[cfg(feature = "gui")]
fn open_window(file: Option<PathBuf>, port: Option<Port>, kiosk: bool) -> Result<(), (String, u8)> {
    let opening = slipline_window::app::Opening { file, port, kiosk };
    slipline_window::app::run(opening, signals::end_window).map_err(|error| (format!("{error:#}"), 1))
}

#[cfg(not(feature = "gui"))]
fn open_window(_file: Option<PathBuf>, _port: Option<Port>, _kiosk: bool) -> Result<(), (String, u8)> {
    Err(("this build has no window; see slipline --help".to_owned(), 2))
}
