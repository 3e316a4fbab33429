//! The physics page: its pictures exist and are small, and it has a row for every light.

use slipline_plate::check::{Checker, Conditions};
use slipline_plate::preset;
use std::path::Path;

const PAGE: &str = include_str!("../PHYSICS.md");

/// Paths in `![..](path)`.
fn pictures() -> Vec<&'static str> {
    PAGE.split("](").skip(1).filter_map(|rest| rest.split(')').next()).collect()
}

#[test]
fn every_picture_exists_and_is_small() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let sizes: Vec<u64> =
        pictures().iter().map(|path| std::fs::metadata(folder.join(path)).expect(path).len()).collect();
    assert_eq!(sizes.len(), 11);
    assert!(sizes.iter().sum::<u64>() < 700_000, "{sizes:?}");
}

#[test]
fn every_light_has_its_row_with_the_limits_in_force() {
    use slipline_plate::check::thresholds as limits;
    let plate = preset("membrane").expect("preset");
    let report = Checker::new(&plate, Conditions::default()).expect("checks").at(0.16).expect("on it");
    let row = |name: &str| {
        PAGE.lines().find(|line| line.starts_with(&format!("| {name} |"))).unwrap_or_else(|| panic!("{name}"))
    };
    for light in &report.lights {
        row(light.name);
    }
    for (name, limit) in [
        ("edge slope", limits::EDGE_SLOPE),
        ("edge slope", limits::EDGE_SLOPE_STRICT),
        ("edge curvature", limits::EDGE_CURVATURE),
        ("wavelengths", limits::WAVELENGTHS),
        ("edge width", limits::EDGE_WIDTH),
        ("drive match", limits::DRIVE_REFLECTION),
        ("thin plate", limits::THIN_PLATE_PERCENT),
        ("thin plate", limits::THICKNESS_SHARE),
        ("thin plate", limits::FILM_PERCENT),
        ("width", limits::WIDTH),
        ("finger load", limits::FINGER_LOAD),
        ("DAC resolution", limits::DAC_STEPS),
        ("sensitivity", limits::SENSITIVITY_DB),
        ("actuator band", limits::ACTUATOR_LOSS_DB),
        ("excursion", limits::EXCURSION_PERCENT),
        ("sound level", limits::AUDIBLE_DB_A),
        ("distortion", limits::HARMONIC_DB),
    ] {
        let cells: Vec<&str> = row(name).split(" | ").collect();
        assert!(cells[2].contains(&limit.green.to_string()), "{name}: {cells:?}");
        assert!(cells[3].contains(&limit.amber.to_string()), "{name}: {cells:?}");
    }
}
