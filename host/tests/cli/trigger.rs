//! `slipline drive --at trigger`.

use super::served::Served;
use super::signals::Socket;
use super::{json, piped, words};
use slipline_link::protocol::{Command as Message, Event};
use slipline_link::simulator::Options;
use std::time::{Duration, Instant};

#[test]
fn a_drive_at_the_trigger_waits_and_reports_where_it_began() {
    let served = Served::new("trigger.sock", Options::default());
    let drive = "drive --json --plate membrane --turning-point 120mm --at trigger --for 50ms --port";
    let mut child = piped(drive.split(' ').chain([served.port.as_str()]));
    let begun = Instant::now();
    let (mut seen, mut raised_at) = (0, None);
    while child.try_wait().unwrap().is_none() {
        assert!(begun.elapsed() < Duration::from_secs(60), "it never began");
        let mut device = served.device.lock().unwrap();
        seen += u32::from(device.waits_for_trigger());
        // It is raised once only, and some blocks after the drive has begun to wait.
        if raised_at.is_none() && seen == 3 {
            device.raise_trigger();
            raised_at = Some(device.now());
        }
        drop(device);
        std::thread::sleep(Duration::from_millis(5));
    }
    let output = child.wait_with_output().unwrap();
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(value["at_samples"].as_u64(), raised_at, "the block that was rendered next");
    assert!(value["stopped_at_samples"].as_u64() > raised_at);
    let drive = words("drive --plate membrane --turning-point 120mm --for 1ms --port");
    let again = json(&[&drive[..], &[&served.port]].concat());
    assert!(again["at_samples"].as_u64() > raised_at, "and without the option it waits for nothing");
}

/// Makes a device one without a trigger input, which the link does not arm by itself.
fn without_trigger_input(event: &mut Event) {
    match event {
        Event::Board(board) => board.trigger_input = false,
        Event::Hello(identity) => identity.simulated = false,
        _ => {}
    }
}

#[test]
fn a_device_without_a_trigger_input_is_not_armed_for_it() {
    let socket = Socket::serve_altered("no-trigger", without_trigger_input);
    let port = format!("unix:{}", socket.path.display());
    let drive = "drive --despite-no-profile --plate membrane --turning-point 120mm --at trigger --port";
    let mut child = piped(drive.split(' ').chain([port.as_str()]));
    let is_armed = || socket.sent().iter().any(|sent| matches!(sent, Message::Arm | Message::ArmFor(_)));
    let begun = Instant::now();
    // It would wait without end.
    while begun.elapsed() < Duration::from_secs(60) && child.try_wait().unwrap().is_none() && !is_armed() {
        std::thread::sleep(Duration::from_millis(5));
    }
    let _ = child.kill();
    let output = child.wait_with_output().unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(!is_armed(), "{:?}", socket.sent());
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("the device has no trigger input"), "{message}");
    std::fs::remove_file(&socket.path).unwrap();
    assert_eq!(json(&["info", "--port", "sim"])["trigger_input"], true);
}
