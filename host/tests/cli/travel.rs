//! The limit of the actuator's travel in the command line's output.

use super::signals::Socket;
use super::{file, slipline};
use slipline_link::protocol::Event;

/// Makes the hello that of a device with protocol 1.0, which has no limit of the travel.
fn of_minor_0(event: &mut Event) {
    if let Event::Hello(identity) = event {
        identity.version.minor = 0;
    }
}

/// What a short drive of a plate says beside its results, and how it ends.
fn said(plate: &str, device: fn(&mut Event)) -> (Option<i32>, String) {
    let socket = Socket::serve_altered("travel", device);
    let port = format!("unix:{}", socket.path.display());
    let output =
        slipline(&["drive", "--plate", plate, "--turning-point", "120mm", "--for", "50ms", "--port", &port]);
    std::fs::remove_file(&socket.path).unwrap();
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn a_drive_warns_if_the_plate_limits_the_travel_and_the_devices_firmware_is_too_old_for_it() {
    let plate = file("limited.toml");
    let actuator =
        "[actuator]\nresonance_hz = 40\nquality = 2\npeak_travel_m = 5e-3\nstatic_travel_m = 2e-3\n";
    let membrane = slipline_plate::preset("membrane").unwrap().to_toml();
    std::fs::write(&plate, format!("{membrane}{actuator}")).unwrap();
    let limited = plate.to_str().unwrap();
    let warning = "the device does not limit the actuator's travel: its firmware is too old for it";
    for (plate, device, warns) in [
        (limited, of_minor_0 as fn(&mut Event), true),
        (limited, |_| (), false),
        ("membrane", of_minor_0, false),
    ] {
        let (code, said) = said(plate, device);
        assert_eq!((code, said.contains(warning)), (Some(0), warns), "{plate}: {said}");
    }
}
