use super::*;
use slipline_plate::{Calibration, PlateSpec, ResponseCurve, quantity::decibels};

/// Tones on the plate for which their table is made, with the table's gains.
fn on_plate<'a>(plate: &'a Plate, tones: &'a [(f64, f64)], solver: Solver) -> Simulation<'a> {
    Simulation {
        plate,
        actual: plate,
        tones,
        sounding: None,
        has_gains: true,
        seconds: None,
        solver,
        finger: None,
    }
}

/// Runs with the table of the plate that commands the boundary.
fn simulated(run: &Simulation<'_>) -> Simulated {
    let (table, _) = table_for(run.plate, SAMPLE_RATE_HZ).unwrap();
    run.run(&table, &mut Progress::unwatched()).unwrap()
}

#[test]
fn the_wave_turns_at_the_requested_boundary() {
    let plate = slipline_plate::preset("membrane").unwrap();
    let run = on_plate(&plate, &[(0.16, 0.8)], Solver::Line);
    let result = simulated(&run);
    let tone = &result.tones[0];
    let measured = tone.measured.unwrap();
    let peak = tone.predicted.peak.unwrap();
    assert!((measured.position_m - peak.position_m).abs() < tone.predicted.edge_width_m / 20.0);
    assert!((tone.measured_turning_point_m.unwrap() - 0.16).abs() < tone.predicted.edge_width_m / 20.0);
    let wanted_m = 0.8 * result.peak_at_full_scale_m;
    assert!(decibels(measured.amplitude / wanted_m).abs() < 0.2, "{} {wanted_m}", measured.amplitude);
    assert_eq!(result.clipped_samples, 0);
}

#[test]
fn a_calibrated_plate_peaks_at_the_level_that_its_table_gives() {
    let nominal = slipline_plate::preset("membrane").unwrap();
    // 8 dB from end to end of the band, as by the resonance of an actuator that the file does not contain.
    let points = vec![[80.0, -3.0, 0.0], [120.0, 2.0, 0.0], [160.0, 5.0, 0.0], [240.0, 1.0, 0.0]];
    let calibration = Calibration {
        chi2_per_n: 1.0,
        half_width_tolerance: 0.003,
        taper_tolerance: 0.004,
        level_tolerance_db: None,
        source_tolerance: None,
        correction: Some(ResponseCurve { points }),
    };
    let plate = Plate::new(PlateSpec { calibration: Some(calibration), ..nominal.spec().clone() }).unwrap();
    let simulated = |plate: &Plate, boundary_m: f64, solver: Solver| {
        let result = simulated(&on_plate(plate, &[(boundary_m, 0.8)], solver));
        result.tones[0].measured.unwrap().amplitude / (0.8 * result.peak_at_full_scale_m)
    };
    for boundary_m in [0.1, 0.16, 0.26] {
        for solver in [Solver::Line, Solver::Sheet { threads: 1 }] {
            let [level, plain] = [&plate, &nominal].map(|plate| simulated(plate, boundary_m, solver));
            // The table rounds its gains.
            let error_db = decibels(level / plain);
            assert!(error_db.abs() < 0.05, "{boundary_m} {solver:?}: {error_db} dB, {level} {plain}");
        }
    }
}

/// The tone at `boundary_m` of a plate, on the sheet.
fn on_the_sheet(name: &str, boundary_m: f64) -> ToneResult {
    let plate = slipline_plate::preset(name).unwrap();
    let tones = [(boundary_m, 0.8)];
    let run = on_plate(&plate, &tones, Solver::Sheet { threads: 1 });
    let result = simulated(&run);
    result.tones[0].clone()
}

#[test]
fn the_sheet_differs_from_the_one_mode_equation_as_the_plane_in_the_frequency_domain_says() {
    for (name, boundary_m, tolerance_m, tolerance_db) in
        [("membrane", 0.16, 1e-4, 0.05), ("al-sh", 0.232, 3e-4, 0.25)]
    {
        let plate = slipline_plate::preset(name).unwrap();
        let tone = on_the_sheet(name, boundary_m);
        let setup = plane::Setup::of(&plate);
        let two = plane::respond(&plate, tone.frequency_hz, tone.field_m.len(), &setup).unwrap();
        let expected = plane::Comparison::of(&tone.predicted, &two);
        let found = tone.differs;
        assert_eq!(found.nodes, expected.nodes, "{name}");
        let shift_m = found.peak_shift_m.unwrap() - expected.peak_shift_m.unwrap();
        let level_db = found.level_db.unwrap() - expected.level_db.unwrap();
        assert!(
            shift_m.abs() < tolerance_m && level_db.abs() < tolerance_db,
            "{name}: {shift_m} m, {level_db} dB"
        );
    }
}

#[test]
fn tones_together_are_separated() {
    let plate = slipline_plate::preset("membrane").unwrap();
    let tones = [(0.12, 0.4), (0.2, 0.3)];
    let run = on_plate(&plate, &tones, Solver::Line);
    let result = simulated(&run);
    for tone in &result.tones {
        let (measured, predicted_m) = (tone.measured.unwrap(), tone.predicted_peak_m.unwrap());
        assert!(
            (measured.amplitude / predicted_m - 1.0).abs() < 0.02,
            "{} {predicted_m}",
            measured.amplitude
        );
    }
}

#[test]
fn a_beat_slower_than_the_measured_time_is_reported_and_no_edge_is_made_up() {
    let plate = slipline_plate::preset("membrane").unwrap();
    // 120 and 120.3 mm differ by 0.14 Hz: a beat of 7 s.
    let tones = [(0.12, 0.3), (0.1203, 0.3), (0.2, 0.3)];
    let run = Simulation { seconds: Some(0.4), ..on_plate(&plate, &tones, Solver::Line) };
    let result = simulated(&run);
    let beat = result.slow_beat.expect("a slow beat");
    let difference_hz = beat.between_hz.1 - beat.between_hz.0;
    assert!((0.1..0.2).contains(&difference_hz), "{beat:?}");
    assert!((beat.needed_s * difference_hz - 4.0).abs() < 1e-9, "{beat:?}");
    for tone in &result.tones[..2] {
        assert!(tone.is_blurred && tone.measured.is_none() && tone.measured_turning_point_m.is_none());
    }
    assert!(!result.tones[2].is_blurred && result.tones[2].measured.is_some());
    assert_eq!(slow_beat(&[100.0, 100.0], 1.0).map(|beat| beat.needed_s), Some(f64::INFINITY));
    assert_eq!(slow_beat(&[100.0, 104.1, 200.0], 1.0), None);
    assert_eq!(slow_beat(&[100.0], 1.0), None);
}
