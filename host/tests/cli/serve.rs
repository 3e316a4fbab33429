//! `slipline serve`: another program reaches the simulated device at a socket or a pseudo-terminal.
#![cfg(unix)]

use crate::serving::Serving;
use crate::{failure, file, json, refused};
use slipline_link::native::Worker;
use slipline_link::protocol::event::State;
use slipline_link::{Outcome, Port, Request};
use std::path::Path;
use std::time::Duration;

/// Longer than anything here takes; no length is asserted.
const PATIENCE: Duration = Duration::from_secs(30);

/// Serves the simulated device.
fn start(arguments: &[&str]) -> Serving {
    Serving::start(Path::new("."), &[&["serve"], arguments].concat())
}

impl Serving {
    fn port(&self) -> Port {
        self.1["port"].as_str().unwrap().parse().unwrap()
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
    assert!(snapshot.device.identity.as_ref().unwrap().simulated);
    snapshot.table.report.active.map(|header| header.crc)
}

#[test]
fn a_device_at_a_socket_serves_one_program_after_the_other_and_ends_with_its_file_removed() {
    let path = file("serve.sock");
    let serving = start(&["--socket", path.to_str().unwrap()]);
    assert_eq!(serving.1["path"].as_str(), path.to_str());
    assert_eq!(talk(serving.port()), None);
    assert_eq!(talk(serving.port()), None);
    refused(&["serve", "--socket", path.to_str().unwrap()], 1, &["another program already serves"]);
    assert_eq!(serving.end("-TERM").code(), Some(0));
    assert!(!path.exists());
}

#[test]
fn a_second_program_at_a_taken_device_is_refused_and_disturbs_nothing() {
    let path = file("taken.sock");
    let serving = start(&["--socket", path.to_str().unwrap()]);
    let worker = Worker::spawn(|| ()).unwrap();
    let done = |request: Request| {
        let outcome = worker.wait(worker.send(request), PATIENCE);
        assert!(matches!(outcome, Some(Outcome::Done { .. })), "{outcome:?}");
    };
    done(Request::Connect(serving.port()));
    done(Request::Arm);
    let port = serving.port().to_string();
    let message =
        failure(&["drive", "--port", &port, "--plate", "membrane", "--felt-edge", "250mm", "--for", "1s"], 1);
    assert!(message.contains(&format!("{port} is in use by another program")), "{message}");
    // The first one's session has not ended.
    done(Request::Refresh);
    assert!(worker.snapshot().drive.status.is_some_and(|status| status.state == State::Armed));
    drop(worker);
    assert_eq!(talk(serving.port()), None);
}

#[test]
fn a_device_at_a_pseudo_terminal_holds_the_plates_table() {
    let serving = start(&["--pty", "--plate", "membrane"]);
    assert!(talk(serving.port()).is_some());
    assert_eq!(serving.end("-TERM").code(), Some(0));
}

#[test]
fn a_file_that_is_not_a_socket_is_not_replaced() {
    let path = file("serve.txt");
    std::fs::write(&path, "mine").unwrap();
    refused(&["serve", "--socket", path.to_str().unwrap()], 1, &["not a socket"]);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "mine");
}

#[test]
fn a_device_with_a_sensor_is_measured_by_another_program() {
    let path = file("heard.sock");
    let path = path.to_str().unwrap();
    let plate = ["--plate", "al-bending", "--sensor", "30mm"];
    let serving = start(&[&["--socket", path, "--actual-plate", "secret:5"], &plate[..]].concat());
    let port = serving.port().to_string();
    let measured = json(&[&["measure", "--port", &port, "--points", "16"], &plate[..]].concat());
    let (response, noise) = (measured["response"].as_array().unwrap(), measured["noise"].as_array().unwrap());
    assert_eq!((response.len(), noise.len()), (16, 16), "{measured}");
    for (response, noise) in response.iter().zip(noise) {
        let size = response["re"].as_f64().unwrap().hypot(response["im"].as_f64().unwrap());
        assert!(size > 10.0 * noise.as_f64().unwrap(), "{measured}");
    }
}

#[test]
fn a_sensor_needs_a_plate_and_a_place_on_it() {
    let socket = ["serve", "--socket", "nowhere.sock"];
    let refused = |more: &[&str]| failure(&[&socket[..], more].concat(), 2);
    assert!(refused(&["--sensor", "30mm"]).contains("--plate"));
    assert!(refused(&["--plate", "membrane", "--actual-plate", "secret"]).contains("--sensor"));
    let message = refused(&["--plate", "membrane", "--sensor", "9m"]);
    assert!(message.contains("on the plate"), "{message}");
}
