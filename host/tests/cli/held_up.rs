//! A command whose output is blocked while it drives: its device is stopped and disarmed, and the command reports it.
#![cfg(target_os = "linux")]

use super::program;
use super::signals::{HANG, Socket};
use super::terminal::terminal;
use slipline_link::protocol::Command as Message;
use std::io::{Read as _, Write as _};
use std::process::Stdio;
use std::time::{Duration, Instant};

/// Ctrl-S and Ctrl-Q at a terminal: its output pauses, and resumes.
const HOLD: u8 = 0x13;
const GO_ON: u8 = 0x11;

#[test]
fn a_command_whose_terminal_is_held_is_stopped_and_disarmed_and_says_so() {
    let socket = Socket::serve("held");
    let (mut ours, theirs) = terminal();
    ours.write_all(&[HOLD]).unwrap();
    let drive = "drive --plate membrane --turning-point 120mm --for 500ms --port unix:";
    let drive = format!("{drive}{}", socket.path.display());
    let mut child = program(drive.split(' ')).stdout(theirs).stderr(Stdio::piped()).spawn().unwrap();
    let begun = Instant::now();
    let mut until = |what: &str, is_so: &dyn Fn() -> bool| {
        while !is_so() {
            assert!(begun.elapsed() < HANG, "not {what}");
            assert!(child.try_wait().unwrap().is_none(), "it has ended, not {what}");
            std::thread::sleep(Duration::from_millis(5));
        }
    };
    // It writes what it drives, and waits for the terminal.
    let last = |is_it: fn(&Message) -> bool| socket.sent().iter().rposition(is_it);
    let driven = || last(|sent| matches!(sent, Message::Drive(_)));
    let disarmed = || last(|sent| matches!(sent, Message::Disarm));
    until("driven", &|| driven().is_some());
    until("disarmed", &|| disarmed() > driven());
    let before = driven();
    let stopped = last(|sent| matches!(sent, Message::Stop));
    assert!(stopped > driven() && stopped < disarmed());
    // Its time, shorter than the second after which it was stopped, is over when it goes on, and it must not say that it
    // drove for as long.
    ours.write_all(&[GO_ON]).unwrap();
    let mut error = String::new();
    child.stderr.take().unwrap().read_to_string(&mut error).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(1), "{error}");
    assert!(error.contains("held up for 1 s, so the device was stopped and disarmed"), "{error}");
    assert_eq!(driven(), before, "it does not drive again");
    std::fs::remove_file(&socket.path).unwrap();
}

#[test]
fn a_drive_and_a_verification_that_take_seconds_are_not_held_up() {
    for arguments in ["drive --plate membrane --turning-point 120mm --for 1500ms", "verify --window 300ms"] {
        let arguments: Vec<&str> = arguments.split(' ').chain(["--port", "sim"]).collect();
        let output = super::slipline(&arguments);
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    }
}
