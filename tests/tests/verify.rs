//! `slipline verify`: says equal when the codes are, and different when they are not.
#![cfg(unix)]

use clap::Parser;
use slipline::cli::Cli;
use slipline_app::safety::thermal::Heat;
use slipline_link::simulator::Options;
use slipline_protocol::Command;
use slipline_tests::command_proxy::{Alter, CommandProxy, unaltered};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// Runs the command line's `verify`, as its main function does, on a simulated device behind a socket.
fn verify(options: Options, alter: Alter) -> Result<(), String> {
    verify_window(options, alter, "50ms")
}

fn verify_window(options: Options, alter: Alter, window: &str) -> Result<(), String> {
    let proxy = CommandProxy::for_simulated(options, alter);
    let cli =
        Cli::try_parse_from(["slipline", "verify", "--port", &proxy.port(), "--window", window]).unwrap();
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
    let error = verify(Options::default(), alter).unwrap_err();
    assert!(error.contains("differ from the mirror's"), "{error}");
}

#[test]
fn a_stop_of_the_devices_own_is_not_called_a_difference_of_the_codes() {
    // The host learns of the stop only afterwards, and not where its ramp began: the window cannot be compared.
    let alter = |command: &mut Command| {
        static STAGES: AtomicU32 = AtomicU32::new(0);
        static IS_STOPPED: AtomicBool = AtomicBool::new(false);
        match command {
            Command::DigestStart(_) => drop(STAGES.fetch_add(1, Ordering::Relaxed)),
            // In the second window the tones sound on, until this.
            Command::KeepAlive(_)
                if STAGES.load(Ordering::Relaxed) == 2 && !IS_STOPPED.swap(true, Ordering::Relaxed) =>
            {
                *command = Command::EmergencyStop;
            }
            _ => {}
        }
    };
    let error = verify_window(Options::default(), alter, "1s").unwrap_err();
    assert!(error.contains("stopped by itself") && error.contains("cannot be compared"), "{error}");
}
