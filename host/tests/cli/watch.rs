//! `slipline watch`: status as lines of JSON, and nothing is armed.

use super::signals::Socket;
use super::{piped, signal};
use serde_json::Value;
use slipline_link::protocol::Command as Message;
use std::io::{BufRead, BufReader};
use std::process::Child;

/// It watches, and the lines that it prints.
fn watching(socket: &Socket) -> (Child, impl Iterator<Item = Value>) {
    let mut child = piped(["watch", "--port", &format!("unix:{}", socket.path.display())]);
    let lines = BufReader::new(child.stdout.take().unwrap()).lines();
    (child, lines.map(|line| serde_json::from_str(&line.unwrap()).unwrap()))
}

fn ended(child: Child, socket: &Socket) {
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
    let sent = socket.sent();
    let is_armed = |sent: &Message| matches!(sent, Message::Arm | Message::ArmFor(_) | Message::Drive(_));
    assert!(!sent.iter().any(is_armed), "{sent:?}");
    std::fs::remove_file(&socket.path).unwrap();
}

#[test]
fn the_status_comes_as_lines_until_a_signal_ends_it_with_0() {
    for option in ["-TERM", "-INT"] {
        let socket = Socket::serve(&format!("watched{option}"));
        let (child, mut lines) = watching(&socket);
        let three: Vec<Value> = lines.by_ref().take(3).collect();
        for pair in three.windows(2) {
            assert!(pair[0]["now_samples"].as_u64() < pair[1]["now_samples"].as_u64(), "{pair:?}");
        }
        for line in &three {
            // A simulated device, which the link arms for every other command.
            assert_eq!((&line["state"], &line["faults"]), (&"Idle".into(), &Value::Array(Vec::new())));
            let (samples, seconds) = (line["now_samples"].as_f64().unwrap(), line["now_s"].as_f64().unwrap());
            assert!((samples / 400e3 - seconds).abs() < 1e-9 && line["heat"] == 0.0, "{line}");
        }
        signal(child.id(), option);
        assert!(lines.all(|line| line["state"] == "Idle"));
        ended(child, &socket);
    }
}

#[test]
fn commands_that_only_look_arm_nothing() {
    for command in ["info", "profile"] {
        let socket = Socket::serve(&format!("looks-{command}"));
        let port = format!("unix:{}", socket.path.display());
        let value = super::json(&[command, "--port", &port]);
        let sent = socket.sent();
        assert!(!sent.iter().any(|sent| matches!(sent, Message::Arm | Message::ArmFor(_))), "{sent:?}");
        assert!(command == "profile" || value["state"] == "Idle", "{value}");
        std::fs::remove_file(&socket.path).unwrap();
    }
}

#[test]
fn watch_ends_when_the_reader_of_its_lines_leaves() {
    let socket = Socket::serve("unread");
    let (child, mut lines) = watching(&socket);
    assert!(lines.next().is_some());
    drop(lines);
    ended(child, &socket);
}
