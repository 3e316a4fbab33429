//! Figures of merit, against other parts of the crate and against the table in PERFORMANCE.md.

use slipline_plate::merit::Merit;
use slipline_plate::quantity::number_format::with_decimals;
use slipline_plate::texture::Palette;
use slipline_plate::{
    Complex64, DriveTable, Equation, Film, KNOTS_MAX, Model, Plate, PlateSpec, preset, presets, respond,
};
use std::f64::consts::TAU;

/// The merit with a table as that of the command `slipline merit`.
pub(super) fn merit(plate: &Plate, turning_point_m: f64) -> Merit {
    let table = DriveTable::build(plate, 400e3, KNOTS_MAX).expect("has a table");
    Merit::of(&Palette::new(plate, &table), turning_point_m).expect("room for an area")
}

/// Group delay from the code to the peak for a wave that is not reflected, seconds: d phase/d omega.
fn group_delay_s(plate: &Plate, frequency_hz: f64) -> f64 {
    let step_hz = 5e-4 * frequency_hz;
    let peak_m = plate.airy_peak_m(frequency_hz).expect("enters");
    let [low, high] = [-step_hz, step_hz].map(|step_hz| -> Complex64 {
        let response = respond(plate, frequency_hz + step_hz, 401, Equation::Corrected).expect("in range");
        let actuator =
            plate.spec().actuator.as_ref().map_or(Complex64::ONE, |it| it.response(frequency_hz + step_hz));
        response.amplitude[(peak_m / plate.length_m() * 400.0).round() as usize] * actuator
    });
    (high / low).arg() / (2.0 * TAU * step_hz)
}

#[test]
fn a_matched_plate_is_switched_soon_after_the_wave_has_come() {
    let film = Film { youngs_modulus_pa: 4.5e9, poisson_ratio: 0.38, thickness_m: 25e-6 };
    let still = preset("membrane").expect("a preset");
    let model = Model::Membrane { wave_speed_m_per_s: 12.0, tension_n_per_m: Some(5.0), film: Some(film) };
    let film = Plate::new(PlateSpec { model, ..still.spec().clone() }).expect("a film");
    for (plate, place_m) in [(preset("al-sh").expect("a preset"), 0.4), (still, 0.22), (film, 0.22)] {
        let (name, merit) = (plate.name(), merit(&plate, place_m));
        let delay_s = group_delay_s(&plate, merit.frequency_hz);
        let switched_s = merit.switching_time_s.expect("has a line");
        assert!(delay_s < switched_s && switched_s < 2.0 * delay_s, "{name}: {delay_s} s, {switched_s} s");
    }
}

#[test]
fn a_plate_that_rings_is_switched_when_it_has_rung() {
    let plate = preset("al-bending-displacement").expect("a preset");
    let merit = merit(&plate, 0.2);
    // The amplitude of a resonance decays as e^(-eta omega t / 2): a change is within a tenth after 2.3 time constants.
    let decay_s = 2.0 / (plate.spec().loss_factor * TAU * merit.frequency_hz);
    let switched_s = merit.switching_time_s.expect("has a line");
    assert!((1.0..8.0).contains(&(switched_s / decay_s)), "{switched_s} s, {decay_s} s");
}

#[test]
fn the_hold_of_a_slow_dac_delays_no_boundary() {
    // At 100 kS/s the hold reduces 38 kHz by 2 dB.
    let plate = preset("al-sh").expect("a preset");
    let [slow_s, fast_s] = [100e3, 400e3].map(|rate_hz| {
        let table = DriveTable::build(&plate, rate_hz, 257).expect("has a table");
        let merit = Merit::of(&Palette::new(&plate, &table), 0.495).expect("room for an area");
        merit.switching_time_s.expect("has a line")
    });
    assert!((slow_s / fast_s - 1.0).abs() < 0.1, "{slow_s} s, {fast_s} s");
}

#[test]
fn the_bits_match_the_distances_and_the_time() {
    let plate = preset("membrane").expect("a preset");
    let merit = merit(&plate, 0.22);
    let (start_m, end_m) = plate.span_m();
    let boundaries = 1.0 + (end_m - start_m) / merit.two_point_m.expect("two peaks");
    let bits = merit.bits_per_s.expect("switched") * merit.switching_time_s.expect("has a line");
    assert!((bits - boundaries.log2()).abs() < 1e-12);
    // The edge of the solid area is about as wide as that of its last tone alone.
    let alone_m = plate.edge_width_m(merit.frequency_hz).expect("enters");
    assert!((0.7..1.3).contains(&(merit.edge_width_m / alone_m)), "{}", merit.edge_width_m);
}

/// A row of the page's table: each preset's boundary in the middle of its span.
fn row(plate: &Plate) -> String {
    let (start_m, end_m) = plate.span_m();
    let merit = merit(plate, 0.5 * (start_m + end_m));
    let or_none = |number: Option<String>| number.unwrap_or_else(|| "none".to_owned());
    format!(
        "| `{}` | {} dB | {} dB | {} mm | {} ms | {} | {} |",
        plate.name(),
        with_decimals(merit.contrast_db, 0),
        with_decimals(merit.ripple_db, 1),
        with_decimals(1e3 * merit.edge_width_m, 0),
        or_none(merit.switching_time_s.map(|time_s| with_decimals(1e3 * time_s, 1))),
        or_none(merit.two_point_m.map(|distance_m| format!("{} mm", with_decimals(1e3 * distance_m, 0)))),
        or_none(merit.bits_per_s.map(|bits| with_decimals(bits, 0))),
    )
}

#[test]
fn the_readme_has_the_figures_of_merit() {
    let page = include_str!("../PERFORMANCE.md");
    let missing: Vec<String> = presets()
        .iter()
        .map(|preset| preset.plate().expect("valid"))
        // Plates whose middle has no room for an even area are left out.
        .filter(|plate| {
            let table = DriveTable::build(plate, 400e3, 17).expect("has a table");
            let (start_m, end_m) = plate.span_m();
            slipline_plate::texture::Target::solid(&Palette::new(plate, &table), 0.5 * (start_m + end_m))
                .is_ok()
        })
        .map(|plate| row(&plate))
        .filter(|row| !page.contains(row.as_str()))
        .collect();
    assert!(missing.is_empty(), "not in PERFORMANCE.md:\n{}", missing.join("\n"));
}
