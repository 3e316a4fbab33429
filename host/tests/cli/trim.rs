//! `slipline trim`: the simulated device stands on a calibrated plate whose wave speed has changed.

use super::{file, json, number, refused, said, says};
use slipline_plate::{Calibration, Plate, PlateSpec, preset};
use std::path::PathBuf;

/// The plate in a file of this name.
pub(super) fn written(name: &str, plate: &Plate) -> PathBuf {
    let path = file(name);
    std::fs::write(&path, plate.to_toml()).unwrap();
    path
}

/// The preset as a calibration leaves it.
pub(super) fn calibrated() -> Plate {
    let calibration = Calibration {
        chi2_per_n: 1.0,
        half_width_tolerance: 2e-3,
        taper_tolerance: 2e-3,
        level_tolerance_db: None,
        source_tolerance: None,
        correction: None,
    };
    let spec = preset("al-bending").unwrap().spec().clone();
    Plate::new(PlateSpec { calibration: Some(calibration), ..spec }).unwrap()
}

#[test]
fn a_change_of_the_speed_is_reported_watched_and_written() {
    let plate = calibrated();
    let actual = written("trim-actual.toml", &plate.with_wave_speed(1.01).unwrap());
    let (plate, out) = (written("trim-plate.toml", &plate), file("trimmed.toml"));
    let [plate, actual, out] = [&plate, &actual, &out].map(|path| path.to_str().unwrap());
    let arguments = ["trim", "--port", "sim", "--plate", plate, "--actual-plate", actual, "--sensor", "34mm"];
    let value = json(&[&arguments[..], &["--watch", "0.3s", "--out", out]].concat());
    let later = value["later"].as_array().unwrap();
    assert!(!later.is_empty() && value["ended_by"] == "time", "{value}");
    for it in [&value["begin"], &later[0]] {
        let (low, high) = (number(it, "low"), number(it, "high"));
        assert!(low < 1.01 && 1.01 < high && high - low < 4e-3, "{value}");
        assert!(number(it, "chi2_per_n") < 3.0, "{value}");
    }
    // Half of d dV/V per cent of speed in bending.
    assert!((1e-3..4e-3).contains(&number(&value, "turning_point_error_m")), "{value}");
    assert!(value["caution"].as_str().unwrap().contains("from its mark"));
    let text = said(&["trim", "--port", "sim", "--plate", out, "--actual-plate", actual, "--sensor", "34mm"]);
    says(&text, &["Wave speed", "times the file's", "34.0 mm", "Note"]);
    assert!(text.contains("times their noise from this speed") && !text.contains("chi"), "{text}");
    refused(
        &["trim", "--port", "sim", "--plate", "al-bending", "--sensor", "34mm", "--points", "16"],
        1,
        &["holds no calibration"],
    );
    refused(&["trim", "--port", "sim", "--plate", plate, "--sensor", "1m"], 2, &["--sensor"]);
}

#[test]
#[cfg(unix)]
fn a_watch_that_a_signal_ends_keeps_and_writes_what_it_found() {
    use super::{piped, words};
    use std::ffi::OsStr;
    use std::os::unix::process::ExitStatusExt as _;
    let _running = super::Sensed::begin();
    let (plate, out) = (written("watched-plate.toml", &calibrated()), file("watched.toml"));
    let trim = words("trim --json --port sim --sensor 34mm --watch 60min --plate");
    let trim = trim.into_iter().map(OsStr::new).chain([plate.as_ref(), "--out".as_ref(), out.as_os_str()]);
    let mut child = piped(trim);
    // It is written first when the speed at the beginning is known.
    let begun = std::time::Instant::now();
    while !out.exists() {
        assert!(begun.elapsed().as_secs() < 120, "nothing is written");
        assert!(child.try_wait().unwrap().is_none(), "it has ended");
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    super::signal(child.id(), "-INT");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.signal(), Some(2));
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(value["ended_by"], "SIGINT");
    assert!((number(&value["begin"], "wave_speed_share") - 1.0).abs() < 4e-3, "{value}");
    assert!(Plate::from_toml(&std::fs::read_to_string(&out).unwrap()).is_ok());
}
