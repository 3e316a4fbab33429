//! `slipline verify`: says equal when the codes are, and different when they are not.
#![cfg(unix)]

use clap::Parser;
use slipline::cli::Cli;
use slipline_app::thermal::Heat;
use slipline_link::simulator::Options;
use slipline_protocol::Command;
use slipline_tests::command_proxy::{Alter, CommandProxy, unaltered};

/// Runs the command line's `verify`, as its main function does, on a simulated device behind a socket.
fn verify(options: Options, alter: Alter) -> Result<(), String> {
    let proxy = CommandProxy::for_simulated(options, alter);
    let cli =
        Cli::try_parse_from(["slipline", "verify", "--port", &proxy.port(), "--window", "50ms"]).unwrap();
    cli.command.unwrap().run(true).map_err(|failure| failure.to_string())
}

#[test]
fn a_coil_that_counts_as_hot_after_a_reset_does_not_make_the_codes_differ() {
    // so starts every board; the fold-back halves what sounds, and lifts while it does.
    let hot = Options { heat: Heat::AssumedHot, ..Options::default() };
    assert_eq!(verify(hot, unaltered), Ok(()));
}

#[test]
fn a_level_that_is_off_by_its_smallest_step_is_reported() {
    let alter = |command: &mut Command| {
        if let Command::Drive(drive) = command
            && let Some(tone) = drive.tones.first_mut()
        {
            tone.level.0 -= 1;
        }
    };
    let told = verify(Options::default(), alter).unwrap_err();
    assert!(told.contains("not the mirror's"), "{told}");
}
