//! `slipline`: the app with no arguments, the command line with some.

#![cfg_attr(not(test), warn(clippy::expect_used, clippy::unwrap_used))]

use clap::Parser;
use slipline::cli::Cli;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = Cli::parse();
    match cli.command {
        None => open_window(),
        Some(command) => match command.run(cli.json) {
            Ok(()) => ExitCode::SUCCESS,
            Err(failure) => {
                eprintln!("slipline: {failure}");
                ExitCode::from(failure.exit_code())
            }
        },
    }
}

#[cfg(feature = "gui")]
fn open_window() -> ExitCode {
    slipline::ending::remove_parts_on_ending(|| {});
    match slipline_window::app::run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("slipline: {error:#}");
            ExitCode::FAILURE
        }
    }
}

#[cfg(not(feature = "gui"))]
fn open_window() -> ExitCode {
    eprintln!("slipline: this build has no window; see slipline --help");
    ExitCode::from(2)
}
