//! The profile of a board's actuator: shown, written with the button only, and refused with its field.

use super::served::Served;
use super::{failure, file, json, refused, slipline, words};
use slipline_link::simulator::Options;

#[test]
fn a_profile_is_written_while_the_button_is_held_and_shown_as_it_was_written() {
    let served = Served::new("profile.sock", Options::default());
    let path = file("coil.toml");
    let text = "name = \"coil\"\nmax_sum = 0.4\nlongest_drive_s = 60\n[travel]\nresonance_hz = 60\nquality = 2\nstatic_travel = 0.5\n";
    std::fs::write(&path, text).unwrap();
    let path = path.display().to_string();
    let show = ["profile", "--port", &served.port];
    let write = ["profile", "write", &path, "--port", &served.port];
    assert_eq!(json(&show)["profile"], serde_json::Value::Null);
    let message = failure(&write, 1);
    assert!(message.contains("hold the user button on the board"), "{message}");
    served.device.lock().unwrap().press_button(true);
    let written = json(&write);
    served.device.lock().unwrap().press_button(false);
    assert_eq!(written, json(&show));
    let profile = &written["profile"];
    assert_eq!((&profile["name"], &profile["max_sum"]), (&"coil".into(), &0.4.into()));
    assert_eq!(
        (&profile["travel"]["resonance_hz"], &profile["coil"]["winding_s"]),
        (&60.0.into(), &8.0.into())
    );
    assert_eq!(json(&["info", "--port", &served.port])["profile_name"], "coil");
    // What is printed is a profile's file.
    let output = slipline(&show);
    std::fs::write(&path, &output.stdout).unwrap();
    served.device.lock().unwrap().press_button(true);
    assert_eq!(json(&write), written);

    // The link has tried to arm the simulated device while its button was held.
    let drive = words("drive --clear-faults --plate membrane --turning-point 120mm --for 50ms --port");
    let drive = [&drive[..], &[&served.port]].concat();
    served.device.lock().unwrap().press_button(false);
    let mut message = failure(&drive, 1);
    let limit = std::time::Instant::now() + std::time::Duration::from_secs(60);
    while message.contains("it can be cleared 2 s after the button is released") {
        assert!(std::time::Instant::now() < limit, "{message}");
        message = failure(&drive, 1);
    }
    assert!(message.contains("of full scale; lower their levels"), "{message}");
    served.device.lock().unwrap().press_button(true);
    assert_eq!(json(&["profile", "erase", "--port", &served.port])["profile"], serde_json::Value::Null);
}

#[test]
fn a_profile_out_of_range_is_refused_with_its_field() {
    let path = file("loud.toml");
    std::fs::write(&path, "name = \"coil\"\nmax_sum = 1.4\n").unwrap();
    refused(
        &["profile", "write", &path.display().to_string(), "--port", "sim"],
        2,
        &["loud.toml: max_sum = 1.4: must be 0.001 to 1"],
    );
    assert!(json(&["profile"])["profile"].is_null(), "the default port is the simulated device");
}
