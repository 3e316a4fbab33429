use super::*;

/// Tones on a plate that is what it was taken for, with its table's gains.
fn on_plate<'a>(plate: &'a Plate, tones: &'a [(f64, f64)], solver: Solver) -> Simulation<'a> {
    Simulation { plate, actual: plate, tones, has_gains: true, seconds: None, solver, finger: None }
}

#[test]
fn the_boundary_asked_for_is_where_the_wave_turns() {
    let plate = slipline_plate::preset("membrane").unwrap();
    let run = on_plate(&plate, &[(0.16, 0.8)], Solver::Line);
    let result = run.run().unwrap();
    let tone = &result.tones[0];
    let measured = tone.measured.unwrap();
    let peak = tone.predicted.peak.unwrap();
    assert!((measured.position_m - peak.position_m).abs() < tone.predicted.edge_width_m / 20.0);
    assert!((tone.measured_turning_point_m.unwrap() - 0.16).abs() < tone.predicted.edge_width_m / 20.0);
    let wanted_m = 0.8 * result.peak_at_full_scale_m;
    assert!(
        (20.0 * (measured.amplitude / wanted_m).log10()).abs() < 0.2,
        "{} {wanted_m}",
        measured.amplitude
    );
    assert_eq!(result.clipped_samples, 0);
}

/// The tone at `boundary_m` of a plate, on the sheet.
fn on_the_sheet(name: &str, boundary_m: f64) -> ToneResult {
    let plate = slipline_plate::preset(name).unwrap();
    let tones = [(boundary_m, 0.8)];
    let run = on_plate(&plate, &tones, Solver::Sheet { threads: 1 });
    let result = run.run().unwrap();
    result.tones[0].clone()
}

#[test]
fn the_sheet_differs_from_the_one_mode_equation_as_the_plane_in_the_frequency_domain_says() {
    for (name, boundary_m, tolerance_m, tolerance_db) in
        [("membrane", 0.16, 1e-4, 0.05), ("al-sh", 0.24, 3e-4, 0.25)]
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
fn tones_together_are_told_apart() {
    let plate = slipline_plate::preset("membrane").unwrap();
    let tones = [(0.12, 0.4), (0.2, 0.3)];
    let run = on_plate(&plate, &tones, Solver::Line);
    let result = run.run().unwrap();
    for tone in &result.tones {
        let (measured, predicted_m) = (tone.measured.unwrap(), tone.predicted_peak_m.unwrap());
        assert!(
            (measured.amplitude / predicted_m - 1.0).abs() < 0.02,
            "{} {predicted_m}",
            measured.amplitude
        );
    }
}
