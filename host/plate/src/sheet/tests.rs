//! What a sheet promises: energy, independence of threads and vectors, and the modal solution as its limit.

use super::kernel::Width;
use super::*;
use crate::{DriveEnd, Equation, Model, PlateSpec, Taper, preset, respond};

const RATE: f64 = 100_000.0;

fn membrane(half_width_m: f64, rate_per_m: f64, length_m: f64, loss: f64, end: DriveEnd) -> Plate {
    Plate::new(PlateSpec {
        name: "test".to_owned(),
        description: String::new(),
        taper: Taper::Exponential { half_width_m, rate_per_m },
        length_m,
        model: Model::Membrane { wave_speed_m_per_s: 12.0 },
        loss_factor: loss,
        drive_end: end,
        actuator: None,
        full_scale_m: 1e-3,
        span_start_m: 0.3 * length_m,
        span_end_m: 0.85 * length_m,
    })
    .unwrap()
}

fn tone(frequency_hz: f64, from: usize, count: usize) -> Vec<f32> {
    // A raised-cosine start over 2000 codes.
    (from..from + count)
        .map(|n| {
            let rise = 0.5 - 0.5 * (std::f64::consts::PI * (n as f64 / 2000.0).min(1.0)).cos();
            (rise * (TAU * frequency_hz * n as f64 / RATE).sin()) as f32
        })
        .collect()
}

fn field(sheet: &Sheet) -> Vec<f32> {
    let mut field = vec![f32::NAN; sheet.positions_m().len() * sheet.widths_m().len()];
    sheet.field_m(&mut field);
    field
}

#[test]
fn a_lossless_sheet_conserves_its_energy() {
    for (end, whole) in [
        (DriveEnd::Displacement, false),
        (DriveEnd::Displacement, true),
        (DriveEnd::Force { at_frequency_hz: 150.0 }, false),
    ] {
        let plate = membrane(0.05, 4.62, 0.32, 0.0, end);
        let mut sheet = Sheet::new(&plate, RATE, SheetGrid { whole, ..SheetGrid::new(90, 14) }).unwrap();
        // A burst that ends at zero, then a held (or free) end.
        let burst: Vec<f32> = (0..6000)
            .map(|n| {
                let n = f64::from(n);
                ((TAU * 150.0 * n / RATE).sin() * (std::f64::consts::PI * n / 6000.0).sin().powi(2)) as f32
            })
            .collect();
        sheet.push(&burst);
        sheet.push(&[0.0; 100]);
        let before = sheet.energy_j_per_kg_m2();
        assert!(before > 1e-12, "the burst must leave energy behind: {before:e}");
        for _ in 0..20 {
            sheet.push(&vec![0.0; 20_000]);
            let now = sheet.energy_j_per_kg_m2();
            assert!((now / before - 1.0).abs() < 2e-5, "{end:?} {whole}: {before:e} became {now:e}");
        }
    }
}

#[test]
fn loss_takes_energy_at_the_rate_it_says() {
    let plate = membrane(0.05, 4.62, 0.32, 0.03, DriveEnd::Displacement);
    let grid = SheetGrid { loss_at_hz: Some(150.0), ..SheetGrid::new(90, 14) };
    let mut sheet = Sheet::new(&plate, RATE, grid).unwrap();
    sheet.push(&tone(150.0, 0, 20_000));
    sheet.push(&[0.0; 1000]);
    let before = sheet.energy_j_per_kg_m2();
    let seconds = 0.1;
    sheet.push(&vec![0.0; (seconds * RATE) as usize]);
    let now = sheet.energy_j_per_kg_m2();
    // v_tt + r v_t: the energy of every mode falls as e^(-r t), r = eta omega.
    let expected = (-0.03 * TAU * 150.0 * seconds).exp();
    assert!((now / before / expected - 1.0).abs() < 0.03, "{} against {expected}", now / before);
}

#[test]
fn a_resisting_end_only_takes_energy() {
    let end = DriveEnd::Resistance { ratio: 1.0, at_frequency_hz: 150.0 };
    let plate = membrane(0.05, 4.62, 0.32, 0.0, end);
    let mut sheet = Sheet::new(&plate, RATE, SheetGrid::new(90, 14)).unwrap();
    sheet.push(&tone(150.0, 0, 10_000));
    sheet.push(&[0.0; 200]);
    let first = sheet.energy_j_per_kg_m2();
    let mut before = first;
    for _ in 0..50 {
        sheet.push(&[0.0; 200]);
        let now = sheet.energy_j_per_kg_m2();
        assert!(now <= before * (1.0 + 1e-6), "{before:e} rose to {now:e}");
        before = now;
    }
    assert!(before < 0.2 * first, "a matched end empties the plate: {first:e} to {before:e}");
}

#[test]
fn threads_and_vector_widths_do_not_change_a_bit() {
    let plate = preset("membrane").unwrap();
    let run = |threads: usize, whole: bool, width: Width, chunk: usize| {
        let grid = SheetGrid {
            whole,
            threads,
            envelope: EnvelopeScope::Everywhere,
            drive: DriveShape::Patch { centre: if whole { 0.2 } else { 0.0 }, reach: 0.5 },
            ..SheetGrid::new(256, 40)
        };
        let mut sheet = Sheet::new(&plate, RATE, grid).unwrap();
        sheet.lattice.use_width(width);
        for codes in tone(160.0, 0, 9000).chunks(chunk) {
            sheet.push(codes);
        }
        (sheet.lattice.threads(), field(&sheet), sheet.envelope())
    };
    for whole in [false, true] {
        let (_, field, envelope) = run(1, whole, Width::portable(), 9000);
        assert!(field.iter().any(|v| v.abs() > 1e-5));
        for (threads, chunk) in [(1, 317), (2, 9000), (2, 1), (3, 700)] {
            let (used, other_field, other_envelope) = run(threads, whole, Width::detect(), chunk);
            assert!(used > 1 || threads == 1, "{threads} threads were not used");
            assert_eq!(field, other_field, "{threads} threads, {chunk} codes at once");
            assert_eq!(envelope, other_envelope, "{threads} threads, {chunk} codes at once");
        }
    }
}

#[test]
fn a_half_sheet_is_the_whole_sheet_of_a_symmetric_drive() {
    let plate = preset("membrane").unwrap();
    let run = |whole: bool| {
        let mut sheet = Sheet::new(&plate, RATE, SheetGrid { whole, ..SheetGrid::new(120, 19) }).unwrap();
        sheet.push(&tone(160.0, 0, 9000));
        (field(&sheet), sheet.energy_j_per_kg_m2())
    };
    let ((half, half_energy), (whole, whole_energy)) = (run(false), run(true));
    let largest = whole.iter().fold(0.0, |most: f32, v| most.max(v.abs()));
    for (a, b) in half.iter().zip(&whole) {
        assert!((a - b).abs() < 1e-5 * largest);
    }
    assert!((half_energy / whole_energy - 1.0).abs() < 1e-5);
}

/// Steady |f| on the centre line at `frequency_hz`: root 2 times the RMS over whole periods, in drive units.
fn steady(plate: &Plate, grid: SheetGrid, frequency_hz: f64, periods: usize) -> (Vec<f64>, Vec<f64>) {
    let grid = SheetGrid { loss_at_hz: Some(frequency_hz), ..grid };
    let mut sheet = Sheet::new(plate, RATE, grid).unwrap();
    let period = (RATE / frequency_hz).round() as usize;
    assert!((period as f64 * frequency_hz / RATE - 1.0).abs() < 1e-9, "whole codes per period");
    sheet.push(&tone(frequency_hz, 0, periods * period));
    sheet.reset_envelope();
    sheet.push(&tone(frequency_hz, periods * period, 10 * period));
    let envelope = sheet.envelope();
    let amplitude = envelope.rms_m.iter().map(|rms| f64::from(*rms) * 2f64.sqrt() / 1e-3).collect();
    (sheet.positions_m().to_vec(), amplitude)
}

#[test]
fn a_gentle_taper_converges_to_the_modal_solution_at_second_order() {
    // d W0 = 0.01: coupling between width modes, which the modal solution leaves out, is far below 1e-3.
    let frequency_hz = 400.0;
    let end = DriveEnd::Resistance { ratio: 1.0, at_frequency_hz: frequency_hz };
    let plate = membrane(0.01, 1.0, 0.4, 0.02, end);
    let modal = respond(&plate, frequency_hz, 1601, Equation::Corrected).unwrap();
    let largest = modal.amplitude.iter().map(|f| f.norm()).fold(0.0, f64::max);
    let mut errors = Vec::new();
    for across in [6, 12, 24] {
        let along = 25 * across;
        let (positions, amplitude) = steady(&plate, SheetGrid::new(along, across), frequency_hz, 120);
        let stride = 1600 as f64 / along as f64;
        let error = positions
            .iter()
            .zip(&amplitude)
            .enumerate()
            .map(|(station, (_, amplitude))| {
                let place = station as f64 * stride;
                let (low, part) = (place.floor() as usize, place.fract());
                let f = |i: usize| modal.amplitude[i.min(1600)].norm();
                (amplitude - (f(low) * (1.0 - part) + f(low + 1) * part)).abs()
            })
            .fold(0.0, f64::max);
        errors.push(error / largest);
    }
    println!("errors {errors:?}");
    assert!(errors[0] / errors[1] > 3.0 && errors[1] / errors[2] > 3.0, "{errors:?}");
    assert!(errors[2] < 5e-3, "{errors:?}");
}

#[test]
fn the_default_membrane_has_its_peak_where_the_modal_solution_has_it() {
    let plate = preset("membrane").unwrap();
    let frequency_hz = 125.0;
    let modal = respond(&plate, frequency_hz, 641, Equation::Corrected).unwrap();
    let peak = modal.peak.unwrap();
    let (positions, amplitude) = steady(&plate, SheetGrid::new(256, 40), frequency_hz, 40);
    let scale = 1e-3 / plate.spec().full_scale_m;
    let top = (1..amplitude.len()).max_by(|&a, &b| amplitude[a].total_cmp(&amplitude[b])).unwrap();
    println!("peak {} at {}, modal {peak:?}", amplitude[top] / 1e-3 * 1e-3 * scale, positions[top]);
    assert!((positions[top] - peak.position_m).abs() < 3e-3);
}

#[test]
fn bad_grids_are_refused_by_name() {
    let plate = preset("membrane").unwrap();
    let refused = |grid: SheetGrid, rate: f64| Sheet::new(&plate, rate, grid).unwrap_err().to_string();
    let good = SheetGrid::new(64, 10);
    assert!(refused(SheetGrid { along: 3, ..good }, RATE).starts_with("along = 3"));
    assert!(refused(SheetGrid { across: 1, ..good }, RATE).starts_with("across = 1"));
    assert!(refused(SheetGrid { threads: 0, ..good }, RATE).starts_with("threads = 0"));
    assert!(refused(good, f64::NAN).starts_with("sample_rate_hz = NaN"));
    assert!(refused(SheetGrid { along: 16384, across: 4096, ..good }, RATE).contains("cells"));
    let bending = preset("al-bending").unwrap();
    assert!(matches!(Sheet::new(&bending, 4e5, good), Err(SheetError::Bends { .. })));
}

#[test]
fn codes_that_are_no_numbers_do_not_reach_the_sheet() {
    let plate = preset("membrane").unwrap();
    let mut sheet = Sheet::new(&plate, RATE, SheetGrid::new(64, 10)).unwrap();
    sheet.push(&[f32::NAN, f32::INFINITY, -1e30, 5.0]);
    sheet.push(&[0.0; 2000]);
    assert!(field(&sheet).iter().all(|v| v.is_finite()));
}
