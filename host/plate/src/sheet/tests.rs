//! Tests of the sheet: conservation of energy, results that do not depend on threads and vector widths, and convergence
//! to the modal solution.

mod air;
mod energy;
mod finger;

use super::vector::Width;
use super::*;
use crate::{DriveEnd, Equation, Model, PlateSpec, Taper, TurningWidth, preset, respond};
use std::f64::consts::PI;

const RATE: f64 = 100_000.0;

fn membrane(half_width_m: f64, rate_per_m: f64, length_m: f64, loss: f64, end: DriveEnd) -> Plate {
    Plate::new(PlateSpec {
        name: "test".to_owned(),
        taper: Taper::Exponential { half_width_m, rate_per_m },
        length_m,
        model: Model::Membrane { wave_speed_m_per_s: 12.0, tension_n_per_m: None, film: None },
        loss_factor: loss,
        turning_width: TurningWidth::Arc,
        drive_end: end,
        full_scale_m: 1e-3,
        span_start_m: 0.3 * length_m,
        span_end_m: 0.85 * length_m,
        ..preset("membrane").unwrap().spec().clone()
    })
    .unwrap()
}

/// A sine whose amplitude rises as a raised cosine over 20 ms.
fn tone_at(rate_hz: f64, frequency_hz: f64, from: usize, count: usize) -> Vec<f32> {
    (from..from + count)
        .map(|n| {
            let seconds = n as f64 / rate_hz;
            let rise = 0.5 - 0.5 * (PI * (seconds / 0.02).min(1.0)).cos();
            (rise * (TAU * frequency_hz * seconds).sin()) as f32
        })
        .collect()
}

fn tone(frequency_hz: f64, from: usize, count: usize) -> Vec<f32> {
    tone_at(RATE, frequency_hz, from, count)
}

fn field(sheet: &Sheet) -> Vec<f32> {
    let mut field = vec![f32::NAN; sheet.positions_m().len() * sheet.widths_m().len()];
    sheet.field_m(&mut field);
    field
}

/// Everything that the grid carries: signs that change at random, each held for 20 codes.
fn noise() -> Vec<f32> {
    (0..20_000_u32)
        .map(|n| if (n / 20).wrapping_mul(2_654_435_761) >> 31 == 0 { 1.0 } else { -1.0 })
        .collect()
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
                ((TAU * 150.0 * n / RATE).sin() * (PI * n / 6000.0).sin().powi(2)) as f32
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
fn energy_is_conserved_where_the_plate_is_one_row_wide() {
    // A tip of 2 mm on rows of 3.6 mm, shaken by everything the grid carries.
    let plate = membrane(0.05, 10.0, 0.32, 0.0, DriveEnd::Displacement);
    for whole in [false, true] {
        let mut sheet = Sheet::new(&plate, RATE, SheetGrid { whole, ..SheetGrid::new(90, 14) }).unwrap();
        sheet.push(&noise());
        sheet.push(&[0.0; 100]);
        let before = sheet.energy_j_per_kg_m2();
        for _ in 0..50 {
            sheet.push(&[0.0; 200]);
            let now = sheet.energy_j_per_kg_m2();
            assert!((now / before - 1.0).abs() < 2e-6, "{whole}: {before:e} became {now:e}");
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
fn the_rounded_weights_keep_a_constant_field_to_the_last_bit() {
    for (loss, rate_hz) in [(0.0, RATE), (0.03, RATE), (0.03, 417_231.0), (0.5, 2.3e6), (1e-4, 1e7)] {
        let plate = membrane(0.05, 4.62, 0.32, loss, DriveEnd::Displacement);
        for (along, across) in [(90, 14), (301, 77)] {
            let sheet = Sheet::new(&plate, rate_hz, SheetGrid::new(along, across)).unwrap();
            let weights = sheet.fdtd.plan().weights;
            let [own, past, along, across] =
                [weights.own, weights.past, weights.along, weights.across].map(f64::from);
            assert_eq!(own + 2.0 * along + 2.0 * across - past, 1.0, "{loss} {rate_hz}: {weights:?}");
        }
    }
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
        // A contact on the boundary of two bands, and one that covers cells at the edge.
        let finger = Finger { contact_m: 0.05, ..Finger::firm(0.2) };
        let mut sheet = Sheet::touched(&plate, Some(&finger), RATE, grid).unwrap();
        sheet.fdtd.use_width(width);
        for codes in tone(160.0, 0, 4000).chunks(chunk) {
            sheet.push(codes);
        }
        (sheet.fdtd.threads(), field(&sheet), sheet.envelope())
    };
    for whole in [false, true] {
        let (_, field, envelope) = run(1, whole, Width::Portable, 4000);
        assert!(field.iter().any(|v| v.abs() > 1e-5));
        for width in Width::all() {
            for (threads, chunk) in [(1, 317), (2, 4000), (2, 1), (3, 700)] {
                let (used, other_field, other_envelope) = run(threads, whole, width, chunk);
                assert_eq!(used, threads, "threads that were used");
                assert_eq!(field, other_field, "{width:?}, {threads} threads, {chunk} codes at once");
                assert_eq!(envelope, other_envelope, "{width:?}, {threads} threads, {chunk} codes at once");
            }
        }
    }
}

#[test]
fn a_plate_that_is_a_driven_column_and_nothing_else_can_be_pushed() {
    let mut plate = membrane(0.05, 4.62, 0.32, 0.0, DriveEnd::Displacement).spec().clone();
    plate.taper = Taper::Sampled { points: vec![[0.0, 0.05], [0.01, 0.005], [0.32, 0.004]] };
    let plate = Plate::new(plate).unwrap();
    for whole in [false, true] {
        let mut sheet = Sheet::new(&plate, RATE, SheetGrid { whole, ..SheetGrid::new(16, 4) }).unwrap();
        sheet.push(&[0.5; 100]);
        assert!(field(&sheet).iter().all(|v| v.is_finite()));
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

/// Steady |f| on the centre line in drive units: root 2 times the RMS over whole periods, over full scale.
fn steady(plate: &Plate, along: usize, across: usize, rate_hz: f64, frequency_hz: f64) -> Vec<f64> {
    let grid = SheetGrid { loss_at_hz: Some(frequency_hz), ..SheetGrid::new(along, across) };
    settled(Sheet::new(plate, rate_hz, grid).unwrap(), plate, rate_hz, frequency_hz)
}

/// As [`steady`], of a sheet at rest.
fn settled(mut sheet: Sheet, plate: &Plate, rate_hz: f64, frequency_hz: f64) -> Vec<f64> {
    let period = (rate_hz / frequency_hz).round() as usize;
    assert!((period as f64 * frequency_hz / rate_hz - 1.0).abs() < 1e-9, "whole codes per period");
    let settled = (0.35 * frequency_hz) as usize * period;
    sheet.push(&tone_at(rate_hz, frequency_hz, 0, settled));
    sheet.reset_envelope();
    sheet.push(&tone_at(rate_hz, frequency_hz, settled, 10 * period));
    let scale = 2f64.sqrt() / plate.spec().full_scale_m;
    sheet.envelope().rms_m.iter().map(|rms| f64::from(*rms) * scale).collect()
}

/// |f| of the modal solution at each of `along` + 1 stations.
fn modal(plate: &Plate, along: usize, frequency_hz: f64) -> (Vec<f64>, Option<crate::Peak>) {
    let response = respond(plate, frequency_hz, along + 1, Equation::Corrected).unwrap();
    (response.amplitude.iter().map(|f| f.norm()).collect(), response.peak)
}

#[test]
fn a_gentle_taper_converges_to_the_modal_solution_at_second_order() {
    // d W0 = 0.01: the coupling of width modes, which the modal solution neglects, is far below the error here.
    let frequency_hz = 400.0;
    let end = DriveEnd::Resistance { ratio: 1.0, at_frequency_hz: frequency_hz };
    let plate = membrane(0.01, 1.0, 0.4, 0.02, end);
    let errors: Vec<f64> = [6, 12, 24]
        .map(|across| {
            let along = 25 * across;
            // Many codes per step, so that all three grids run at about the same Courant number.
            let sheet = steady(&plate, along, across, 1e6, frequency_hz);
            let (modal, _) = modal(&plate, along, frequency_hz);
            let largest = modal.iter().copied().fold(0.0, f64::max);
            let worst = sheet.iter().zip(&modal).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            worst / largest
        })
        .to_vec();
    assert!(errors[0] / errors[1] > 3.6 && errors[1] / errors[2] > 3.6, "not second order: {errors:?}");
    assert!(errors[2] < 2e-3, "{errors:?}");
}

#[test]
fn the_default_membrane_peaks_where_and_as_high_as_the_modal_solution_says() {
    // d W0 = 0.23: here the two differ by the coupling of the modes, which is small.
    let plate = preset("membrane").unwrap();
    let (along, frequency_hz) = (256, 125.0);
    let sheet = steady(&plate, along, 40, RATE, frequency_hz);
    let (_, peak) = modal(&plate, along, frequency_hz);
    let peak = peak.unwrap();
    let top = (1..sheet.len()).max_by(|&a, &b| sheet[a].total_cmp(&sheet[b])).unwrap();
    let position_m = top as f64 * plate.length_m() / along as f64;
    assert!((position_m - peak.position_m).abs() < 2e-3, "{position_m} against {}", peak.position_m);
    assert!((sheet[top] / peak.amplitude - 1.0).abs() < 0.01, "{} against {}", sheet[top], peak.amplitude);
}

#[test]
fn a_sample_rate_that_would_need_too_many_steps_per_code_is_refused_with_the_lowest_one() {
    // Waves of 1e6 m/s on cells of 0.3 um: a stable step is 0.3 ps, and a code at 1 kHz would take 3e9 of them.
    let plate = Plate::new(PlateSpec {
        model: Model::ShearHorizontal { shear_modulus_pa: 1e12, density_kg_per_m3: 1.0, thickness_m: None },
        ..membrane(0.05, 10.0, 0.005, 0.0, DriveEnd::Displacement).spec().clone()
    })
    .unwrap();
    let grid = SheetGrid::new(16_384, 4);
    let refused = grid.cost(&plate, 1000.0).unwrap_err();
    let SheetError::OutOfRange(error) = refused else { panic!("{refused}") };
    assert_eq!((error.field, error.value), ("sample_rate_hz", 1000.0));
    assert!(error.range.low > 3e6 && error.range.low < 4e6, "{error}");
    assert!(grid.cost(&plate, error.range.low * 1.000_001).is_ok());
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
fn codes_that_are_not_numbers_count_as_zero_and_large_ones_are_clamped() {
    let plate = preset("membrane").unwrap();
    let mut sheet = Sheet::new(&plate, RATE, SheetGrid::new(64, 10)).unwrap();
    sheet.push(&[f32::NAN, f32::INFINITY, -1e30, 5.0]);
    sheet.push(&[0.0; 2000]);
    assert!(field(&sheet).iter().all(|v| v.is_finite()));
}
