//! `slipline serve`: another program reaches the simulated device at a socket or a pseudo-terminal.
#![cfg(unix)]

use crate::{failure, file};
use serde_json::Value;
use slipline_link::native::Worker;
use slipline_link::{Outcome, Port, Request};
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::Duration;

/// Longer than anything here takes; no length is asserted.
const PATIENCE: Duration = Duration::from_secs(30);

/// A program that serves, and the line of JSON with which it began.
struct Serving(Child, Value);

impl Serving {
    fn start(arguments: &[&str]) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_slipline"))
            .args(["--json", "serve"])
            .args(arguments)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut line).unwrap();
        Self(child, serde_json::from_str(&line).unwrap())
    }

    fn port(&self) -> Port {
        self.1["port"].as_str().unwrap().parse().unwrap()
    }

    /// Ends it as `kill` does.
    fn end(mut self) -> ExitStatus {
        assert!(Command::new("kill").arg(self.0.id().to_string()).status().unwrap().success());
        self.0.wait().unwrap()
    }
}

impl Drop for Serving {
    fn drop(&mut self) {
        // Ended already, unless the test has failed.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Connects, and returns the held table's CRC.
fn talk(port: Port) -> Option<u32> {
    let worker = Worker::spawn(|| ()).unwrap();
    for request in [Request::Connect(port), Request::Arm, Request::Stop, Request::Refresh] {
        let ticket = worker.send(request);
        let outcome = worker.wait(ticket, PATIENCE);
        assert!(matches!(outcome, Some(Outcome::Done { .. })), "{outcome:?}");
    }
    let snapshot = worker.snapshot();
    assert!(snapshot.identity.as_ref().unwrap().simulated);
    snapshot.table.active.map(|header| header.crc)
}

#[test]
fn a_device_at_a_socket_serves_one_program_after_the_other_and_ends_with_its_file_removed() {
    let path = file("serve.sock");
    let serving = Serving::start(&["--socket", path.to_str().unwrap()]);
    assert_eq!(serving.1["path"].as_str(), path.to_str());
    assert_eq!(talk(serving.port()), None);
    assert_eq!(talk(serving.port()), None);
    let message = failure(&["serve", "--socket", path.to_str().unwrap()], 1);
    assert!(message.contains("another program already serves"), "{message}");
    assert_eq!(serving.end().code(), Some(0));
    assert!(!path.exists());
}

#[test]
fn a_device_at_a_pseudo_terminal_holds_the_plates_table() {
    let serving = Serving::start(&["--pty", "--plate", "membrane"]);
    assert!(talk(serving.port()).is_some());
    assert_eq!(serving.end().code(), Some(0));
}

#[test]
fn a_file_that_is_not_a_socket_is_not_replaced() {
    let path = file("serve.txt");
    std::fs::write(&path, "mine").unwrap();
    let message = failure(&["serve", "--socket", path.to_str().unwrap()], 1);
    assert!(message.contains("not a socket"), "{message}");
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "mine");
}
