//! `slipline trim`: the simulated device stands on a calibrated plate whose wave speed has changed.

use super::{failure, file, json, number, slipline};
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
fn a_change_of_the_speed_is_told_watched_and_written() {
    let plate = calibrated();
    let actual = written("trim-actual.toml", &plate.with_wave_speed(1.01).unwrap());
    let (plate, out) = (written("trim-plate.toml", &plate), file("trimmed.toml"));
    let [plate, actual, out] = [&plate, &actual, &out].map(|path| path.to_str().unwrap());
    let arguments = ["trim", "--port", "sim", "--plate", plate, "--actual-plate", actual, "--sensor", "34mm"];
    let value = json(&[&arguments[..], &["--watch", "0.3s", "--out", out]].concat());
    let later = value["later"].as_array().unwrap();
    assert!(!later.is_empty(), "{value}");
    for it in [&value["begin"], &later[0]] {
        let (low, high) = (number(it, "low"), number(it, "high"));
        assert!(low < 1.01 && 1.01 < high && high - low < 4e-3, "{value}");
        assert!(number(it, "chi2_per_n") < 3.0, "{value}");
    }
    // Half of d dV/V per cent of speed in bending.
    assert!((1e-3..4e-3).contains(&number(&value, "boundary_error_m")), "{value}");
    assert!(value["caution"].as_str().unwrap().contains("from its mark"));
    let again =
        slipline(&["trim", "--port", "sim", "--plate", out, "--actual-plate", actual, "--sensor", "34mm"]);
    let text = String::from_utf8(again.stdout).unwrap();
    for wanted in ["Wave speed", "times the file's", "34.0 mm", "Note"] {
        assert!(text.contains(wanted), "{wanted}: {text}");
    }
    let message =
        failure(&["trim", "--port", "sim", "--plate", "al-bending", "--sensor", "34mm", "--points", "16"], 1);
    assert!(message.contains("holds no calibration"), "{message}");
    let message = failure(&["trim", "--port", "sim", "--plate", plate, "--sensor", "1m"], 2);
    assert!(message.contains("--sensor"), "{message}");
}
