//! What can be refused is refused before the device is armed: each command against a device that keeps what it was sent.

use super::signals::Socket;
use super::trim::{calibrated, written};
use super::{file, refused};
use slipline_link::protocol::{Command as Message, Event};
use slipline_plate::preset;
use std::path::PathBuf;

/// A folder in which nobody can write a file.
const CLOSED: &str = "/proc";

/// The link arms a simulated device by itself, and a real one never.
fn real(event: &mut Event) {
    if let Event::Hello(identity) = event {
        identity.simulated = false;
    }
}

/// Files of the cases, and their paths.
fn prepared() -> [String; 5] {
    // Without what a source acts on.
    let membrane = preset("membrane").unwrap().to_toml();
    let light =
        membrane.lines().filter(|line| !line.starts_with("tension_n_per_m")).collect::<Vec<_>>().join("\n");
    assert_ne!(light.len() + 1, membrane.len(), "{membrane}");
    let weightless = file("weightless.toml");
    std::fs::write(&weightless, light).unwrap();
    let kept = file("kept.csv");
    std::fs::write(&kept, "mine").unwrap();
    let finger = file("no-finger.toml");
    std::fs::write(&finger, "[feeling]\nthreshold = 0.0\n").unwrap();
    let calibrated = written("unarmed-calibrated.toml", &calibrated());
    let plate = written("unarmed-plate.toml", &preset("membrane").unwrap());
    [weightless, kept, finger, calibrated, plate].map(|path: PathBuf| path.to_str().unwrap().to_owned())
}

#[test]
#[cfg(target_os = "linux")]
fn what_can_be_refused_is_refused_before_the_device_is_armed() {
    let paths = prepared();
    let names = ["{weightless}", "{kept}", "{finger}", "{calibrated}", "{plate}", "{CLOSED}"];
    let cases = [
        // Outputs that cannot be written, or that exist.
        ("measure --plate al-bending --sensor 34mm --out {CLOSED}/m.csv", 1, "/proc/m.csv"),
        ("sweep --plate al-bending --out {CLOSED}/s.toml", 1, "/proc/s.toml"),
        (
            "calibrate --plate al-bending --sensor 34mm --sensor 187mm --out {CLOSED}/c.toml",
            1,
            "/proc/c.toml",
        ),
        ("trim --plate {calibrated} --sensor 34mm --out {CLOSED}/t.toml", 1, "/proc/t.toml"),
        ("measure --plate al-bending --sensor 34mm --out no/such/m.csv", 1, "there is no folder no/such"),
        ("measure --plate al-bending --sensor 34mm --out {kept}", 2, "--force"),
        ("drive --plate membrane --turning-point 120mm --trace {kept}", 2, "--force"),
        ("info --trace {kept}", 2, "--force"),
        ("measure --plate al-bending --sensor 34mm --out m.doc", 2, ".csv, .uff, .unv or .frd"),
        // Plates that nothing measured could calibrate or trim, and places that are one.
        ("trim --plate al-bending --sensor 34mm", 1, "holds no calibration"),
        ("calibrate --plate {weightless} --sensor 34mm", 1, "a fit of the source"),
        ("calibrate --plate {weightless} --current coil", 1, "a fit of the source"),
        (
            "calibrate --plate al-bending --sensor 34mm --sensor 34.1mm",
            1,
            "both measurements are of the place",
        ),
        ("calibrate --plate al-bending --sensor 34mm --sensor 9m", 2, "'9m' for '--sensor'"),
        // What is to sound.
        ("drive --plate membrane --felt-edge 120mm", 2, "the felt edges of tones"),
        ("drive --plate membrane --turning-point 9m", 2, "80 to 280 mm"),
        ("drive --plate membrane --boundary 120mm", 2, "--turning-point 120mm"),
        (
            "drive --despite-no-profile --plate membrane --turning-point 120mm:0.9 --turning-point 200mm:0.9",
            2,
            "lower their levels",
        ),
        ("drive --plate membrane --felt-edge 250mm --feeling {finger}", 2, "feeling.threshold"),
        ("drive --plate membrane --felt-edge 250mm --feeling no-such.toml", 2, "no-such.toml"),
        ("drive --setup {plate}", 2, "a plate alone"),
        ("drive --setup no-such.toml", 2, "no-such.toml"),
        ("drive --plate membrane --turning-point 120mm --glide 1h", 2, "5 ms to 10 s"),
        (
            "drive --despite-no-profile --plate al-bending --turning-point 240mm --level 0.00002 --hold",
            1,
            "slipline: ",
        ),
        // A board that does not limit what drives it.
        ("drive --plate membrane --turning-point 120mm", 1, "--despite-no-profile"),
        (
            "measure --despite-no-profile --plate al-bending --sensor 34mm --from 1Hz --to 300kHz",
            2,
            "must be",
        ),
        ("sweep --despite-no-profile --plate al-bending --time 10ms --out s.toml", 2, "time = 10 ms"),
        ("verify --despite-no-profile --window 9s", 2, "10 ms to 2.621 s"),
        ("verify --despite-no-profile --plate no-such", 2, "no-such"),
    ];
    for (number, (arguments, code, words)) in cases.iter().enumerate() {
        let socket = Socket::serve_altered(&format!("unarmed-{number}"), real);
        let port = format!("unix:{}", socket.path.display());
        let given = paths.iter().map(String::as_str).chain([CLOSED]);
        let filled = names
            .iter()
            .zip(given)
            .fold((*arguments).to_owned(), |line, (name, path)| line.replace(name, path));
        let arguments: Vec<&str> = filled.split(' ').chain(["--port", &port]).collect();
        refused(&arguments, *code, &[words]);
        let sent = socket.sent();
        assert!(
            !sent.iter().any(|sent| matches!(sent, Message::Arm | Message::ArmFor(_))),
            "{arguments:?}: {sent:?}"
        );
        std::fs::remove_file(&socket.path).unwrap();
    }
    assert_eq!(std::fs::read(&paths[1]).unwrap(), b"mine");
}
