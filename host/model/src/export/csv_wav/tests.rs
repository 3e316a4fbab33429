use super::*;
use crate::field::steady_field::steady_tones;
use crate::field::time_domain::SimulatedField;
use crate::setup::BoundaryMode;
use slipline_plate::DriveTable;
use std::sync::Arc;

fn setup() -> Setup {
    Setup::new(Arc::new(slipline_plate::preset("membrane").unwrap()))
}

#[test]
fn theory_and_simulated_plate_keep_their_own_places_and_their_own_values() {
    let setup = setup();
    let table = DriveTable::build(&setup.plate, 400e3, 17).unwrap();
    let steady = SteadyField::solve(&setup.plate, &steady_tones(&setup, Some(&table)));
    let position_m: Vec<f64> = (0..16).map(|i| 0.01 + 0.02 * f64::from(i)).collect();
    let maximum_m: Vec<f64> = (0..16).map(|i| 1e-6 * (1.0 + f64::from(i))).collect();
    let rms_m: Vec<f64> = (0..16).map(|i| 1e-7 * (3.0 + f64::from(i))).collect();
    let measured = SimulatedField {
        number: 1,
        position_m: position_m.clone(),
        maximum_m: maximum_m.clone(),
        rms_m: rms_m.clone(),
        tones: 1,
    };
    let text = envelope_csv(&setup, &steady, Some(&Rings::new(&measured, true, None)), 1e-4);
    let hidden = Rings::new(&measured, true, Some(&steady));
    let fitted = envelope_csv(&setup, &steady, Some(&hidden), 1e-4);
    let stated =
        format!("places; maximum and root mean square, all multiplied by {:.4}\n", hidden.fitted.unwrap());
    assert!(
        fitted.contains("# simulated: the hidden test plate, level fitted while") && fitted.contains(&stated),
        "{fitted:.900}"
    );
    let rows: Vec<Vec<&str>> = text
        .lines()
        .filter(|line| !line.starts_with('#'))
        .skip(1)
        .map(|line| line.split(',').collect())
        .collect();
    assert!(rows.iter().all(|row| row.len() == 5));
    let column = |i: usize| -> Vec<f64> { rows.iter().filter_map(|row| row[i].parse().ok()).collect() };
    assert!(column(0).windows(2).all(|pair| pair[0] <= pair[1]), "the places rise");
    assert_eq!(column(1), steady.bound_m);
    assert_eq!(column(2), steady.rms_m);
    assert_eq!((column(3), column(4)), (maximum_m, rms_m), "each simulated value once");
    let at: Vec<f64> =
        rows.iter().filter(|row| !row[3].is_empty()).map(|row| row[0].parse().unwrap()).collect();
    assert!(at.iter().zip(&position_m).all(|(a, b)| (a - b).abs() < 1e-6));
}

#[test]
fn the_head_says_what_the_envelope_is_of() {
    let mut setup = setup();
    setup.master_db = -3.0;
    setup.tones[0].level = 0.03;
    let table = DriveTable::build(&setup.plate, 400e3, 17).unwrap();
    let steady = SteadyField::solve(&setup.plate, &steady_tones(&setup, Some(&table)));
    let text = envelope_csv(&setup, &steady, None, 1e-4);
    setup.boundary = BoundaryMode::TurningPoint;
    assert_eq!(envelope_csv(&setup, &steady, None, 1e-4), text, "both places, whatever the line holds");
    let felt_edge = TonePlaces::of(&setup, &setup.tones[0], &table).felt_edge.place_m().unwrap();
    assert!(text.contains(&format!("felt edge {felt_edge:.6} m")), "{felt_edge}: {text:.900}");
    for part in [
        "# plate: membrane",
        "# felt edge: of the tone alone, at its level; illustrative",
        "# master level: -3.00 dB",
        "# peak at level 1: 1e-4 m",
        "# tone 1: frequency 138.2",
        "turning point 0.180000 m",
        "level 0.0300",
        "# simulated: not run",
        "# units: metres",
    ] {
        assert!(text.contains(part), "{part}: {text:.900}");
    }
    assert!(text.lines().take_while(|line| line.starts_with('#')).count() >= 8);
}
