//! The sheet in air: against the plate in two dimensions with the same law, its energy, and what it states and refuses.

use super::super::air_wave::Stations;
use super::{AirWave, RATE, field, membrane, noise, settled, tone};
use crate::{
    Air, AirMounting, DriveEnd, Equation, Faces, Finger, Gas, Model, Peak, Plate, PlateSpec, Sheet,
    SheetError, SheetGrid, plane, preset, respond,
};
use std::f64::consts::TAU;

/// Air of 1.2 kg/m^3 on both faces, alpha times what an endless wave carries.
fn air(alpha: f64) -> Air {
    let gas = Gas::Given { density_kg_per_m3: 1.2, sound_speed_m_per_s: 343.0 };
    Air::Around { gas, mounting: AirMounting::Coefficient { alpha, faces: Faces::Two }, gap_m: None }
}

fn in_air(plate: &Plate, alpha: f64) -> Plate {
    Plate::new(PlateSpec { air: Some(air(alpha)), ..plate.spec().clone() }).unwrap()
}

/// The preset's membrane in a baffle: 34 % of its mass at 100 mm, 15 % at 280 mm.
fn light() -> Plate {
    in_air(&preset("membrane").unwrap(), 1.95)
}

/// A membrane without loss whose mass is `kg_per_m2`, in a baffle.
fn lossless(kg_per_m2: f64, end: DriveEnd) -> Plate {
    let mut spec = membrane(0.05, 4.62, 0.32, 0.0, end).spec().clone();
    spec.model =
        Model::Membrane { wave_speed_m_per_s: 12.0, tension_n_per_m: Some(144.0 * kg_per_m2), film: None };
    in_air(&Plate::new(spec).unwrap(), 1.95)
}

/// The place of the peak in mm and its height over the drive, on the centre line.
fn peak(line: &[f64], length_m: f64) -> (f64, f64) {
    let top = (1..line.len() - 1).max_by(|&a, &b| line[a].total_cmp(&line[b])).unwrap();
    let [before, at, after] = [line[top - 1], line[top], line[top + 1]];
    let aside = 0.5 * (before - after) / (before - 2.0 * at + after);
    let step_mm = 1e3 * length_m / (line.len() - 1) as f64;
    ((top as f64 + aside) * step_mm, at - 0.25 * (before - after) * aside)
}

/// How much farther and higher the peak is than another, mm and dB.
fn misses(found: (f64, f64), wanted: &Peak) -> (f64, f64) {
    (found.0 - 1e3 * wanted.position_m, 20.0 * (found.1 / wanted.amplitude).log10())
}

#[test]
fn a_tone_on_the_sheet_in_air_matches_the_plate_in_two_dimensions() {
    let plate = light();
    for frequency_hz in [80.0, 160.0] {
        let grid = SheetGrid { loss_at_hz: Some(frequency_hz), ..SheetGrid::new(233, 37) };
        let grid = grid.at_tones(&plate, &[frequency_hz]).unwrap();
        let rate_hz = 1000.0 * frequency_hz;
        let sheet = settled(Sheet::new(&plate, rate_hz, grid).unwrap(), &plate, rate_hz, frequency_hz);
        let found = peak(&sheet, plate.length_m());
        let line = respond(&plate, frequency_hz, 513, Equation::Corrected).unwrap().peak.unwrap();
        let (mm, db) = misses(found, &line);
        println!("{frequency_hz}: {mm:+.2} mm, {db:+.2} dB from the line");
        assert!(mm.abs() < 0.1 && db.abs() < 0.1, "{frequency_hz}: {mm} mm {db} dB");
        // Two dimensions of the same law have the derivatives of Omega, which line and sheet leave out.
        let truth = plane::respond(&plate, frequency_hz, 513, &plane::Setup::of(&plate)).unwrap();
        let (mm, db) = misses(found, &truth.peak.unwrap());
        println!("{frequency_hz}: {mm:+.2} mm, {db:+.2} dB from two dimensions");
        assert!(mm.abs() < 0.4 && db.abs() < 0.4, "{frequency_hz}: {mm} mm {db} dB");
    }
}

/// The wave of a sheet of 64 stations for these frequencies.
fn wave(plate: &Plate, band_hz: (f64, f64)) -> AirWave {
    AirWave::of(plate, band_hz, Stations { step_m: plate.length_m() / 64.0, count: 65 })
}

#[test]
fn one_tone_is_exact_and_more_share_the_least_error() {
    let plate = light();
    let (low_hz, high_hz) = plate.band_hz();
    let band = SheetGrid::new(64, 10).cost(&plate, RATE).unwrap();
    assert!((band.wavenumber_error - 0.0056).abs() < 2e-4, "{}", band.wavenumber_error);
    let vacuum = SheetGrid::new(64, 10).cost(&plate.in_vacuum(), RATE).unwrap();
    assert_eq!(
        (band.cells, band.step_rate_hz, vacuum.wavenumber_error),
        (vacuum.cells, vacuum.step_rate_hz, 0.0)
    );
    let error = |tones: &[f64]| {
        let grid = SheetGrid::new(64, 10).at_tones(&plate, tones).unwrap();
        (grid.air_at_hz.unwrap(), grid.cost(&plate, RATE).unwrap().wavenumber_error)
    };
    for tones in [&[150.0][..], &[low_hz], &[high_hz], &[150.0, 150.0]] {
        let (_, error) = error(tones);
        assert!(error < 1e-12, "{tones:?}: {error}");
    }
    for tones in [&[low_hz, high_hz][..], &[high_hz, low_hz], &[high_hz, 150.0, low_hz]] {
        assert_eq!(error(tones), ((low_hz, high_hz), band.wavenumber_error), "{tones:?}");
    }
    assert!(error(&[140.0, 160.0]).1 < 0.5 * band.wavenumber_error);
    // One a all along would be 2.8 % off at best: K changes along the plate by 4.5 %.
    let whole = wave(&plate, (low_hz, high_hz));
    assert!((whole.lift_per_m2(50) - whole.lift_per_m2(0)) * whole.speed_m_per_s.powi(2) > 1e4);
    // 1/c^2 is that of the group speed: 5 % beside its tone it is off by less than 0.2 %.
    assert!(wave(&plate, (150.0, 150.0)).error_between(&plate, (142.5, 157.5)) < 2e-3);
    // No tones and no air leave the grid as it is.
    let grid = SheetGrid::new(64, 10);
    assert_eq!(grid.at_tones(&plate, &[]).unwrap(), grid);
    assert_eq!(grid.at_tones(&plate.in_vacuum(), &[150.0]).unwrap(), grid);
}

#[test]
fn a_sheet_in_air_conserves_its_energy_and_nothing_on_it_grows() {
    // The lightest has more air than its own mass: its a is at the limit.
    for (kg_per_m2, tones_hz) in [(0.278, [150.0, 150.0]), (0.05, [130.0, 130.0]), (0.278, [75.0, 190.0])] {
        let plate = lossless(kg_per_m2, DriveEnd::Force { at_frequency_hz: 100.0 });
        let grid = SheetGrid::new(90, 14).at_tones(&plate, &tones_hz).unwrap();
        let mut sheet = Sheet::new(&plate, RATE, grid).unwrap();
        sheet.push(&noise());
        sheet.push(&[0.0; 100]);
        let before = sheet.energy_j_per_kg_m2();
        assert!(before > 0.0, "{kg_per_m2}: {before:e}");
        for _ in 0..10 {
            sheet.push(&vec![0.0; 20_000]);
            let now = sheet.energy_j_per_kg_m2();
            assert!((now / before - 1.0).abs() < 2e-5, "{kg_per_m2} {tones_hz:?}: {before:e} became {now:e}");
        }
    }
}

#[test]
fn a_sheet_that_is_retuned_is_the_one_that_was_made_for_the_tone() {
    let plate = light();
    let frequency_hz = 100.0;
    let grid = SheetGrid { loss_at_hz: Some(frequency_hz), ..SheetGrid::new(120, 19) };
    let made = Sheet::new(&plate, RATE, grid.at_tones(&plate, &[frequency_hz]).unwrap()).unwrap();
    let wanted = settled(made, &plate, RATE, frequency_hz);
    let mut sheet = Sheet::new(&plate, RATE, grid).unwrap();
    let before = settled(Sheet::new(&plate, RATE, grid).unwrap(), &plate, RATE, frequency_hz);
    sheet.push(&tone(180.0, 0, 5000));
    sheet.push(&[0.0; 20_000]);
    sheet.retune(&[frequency_hz]);
    let found = settled(sheet, &plate, RATE, frequency_hz);
    let largest = wanted.iter().copied().fold(0.0, f64::max);
    let worst =
        |line: &[f64]| line.iter().zip(&wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest;
    assert!(worst(&found) < 2e-3 && worst(&before) > 0.02, "{} {}", worst(&found), worst(&before));
    // Without air it changes no bit.
    let still = plate.in_vacuum();
    let [mut one, mut other] = [(), ()].map(|()| Sheet::new(&still, RATE, grid).unwrap());
    other.retune(&[frequency_hz]);
    one.push(&tone(150.0, 0, 3000));
    other.push(&tone(150.0, 0, 3000));
    assert_eq!(field(&one), field(&other));
}

#[test]
fn a_finger_on_a_sheet_in_air_matches_the_plate_in_two_dimensions() {
    let (plate, frequency_hz) = (light(), 100.0);
    let finger = Finger::light(0.06);
    let grid = SheetGrid { loss_at_hz: Some(frequency_hz), ..SheetGrid::new(180, 28) };
    let grid = grid.at_tones(&plate, &[frequency_hz]).unwrap();
    let of_sheet = |sheet: Sheet| peak(&settled(sheet, &plate, RATE, frequency_hz), plate.length_m());
    let touched = of_sheet(Sheet::touched(&plate, Some(&finger), RATE, grid).unwrap());
    let free = of_sheet(Sheet::new(&plate, RATE, grid).unwrap());
    let truth = |finger: Option<Finger>| {
        let setup = plane::Setup { finger, ..plane::Setup::of(&plate) };
        plane::respond(&plate, frequency_hz, 513, &setup).unwrap().peak.unwrap()
    };
    // What the finger changes.
    let (with, without) = (misses(touched, &truth(Some(finger))), misses(free, &truth(None)));
    let (millimetres, decibel) = (with.0 - without.0, with.1 - without.1);
    let changed = 20.0 * (touched.1 / free.1).log10();
    println!("{millimetres} mm, {decibel} dB of {changed} dB");
    assert!(millimetres.abs() < 0.3 && decibel.abs() < 0.2, "{millimetres} {decibel}");
    assert!(changed.abs() > 1.0, "{changed}");
}

#[test]
fn air_that_one_equation_does_not_follow_is_refused_with_its_error() {
    let plate = lossless(0.05, DriveEnd::Displacement);
    let (low_hz, high_hz) = plate.band_hz();
    let error = Sheet::new(&plate, RATE, SheetGrid::new(64, 10)).unwrap_err();
    assert!(matches!(error, SheetError::Air { error, .. } if error > 0.01 && error < 0.05), "{error:?}");
    assert!(
        error.to_string().starts_with("test carries air: the wavenumber of a sheet would be wrong by "),
        "{error}"
    );
    // One tone it does follow, whatever the air; all over the band it does not.
    let grid = SheetGrid::new(64, 10);
    let one = grid.at_tones(&plate, &[130.0]).unwrap();
    assert!(one.cost(&plate, RATE).unwrap().wavenumber_error < 1e-12);
    assert!(matches!(grid.at_tones(&plate, &[low_hz, 130.0, high_hz]), Err(SheetError::Air { .. })));
    for nodes in [(f64::NAN, 100.0), (100.0, 50.0), (0.0, 100.0)] {
        let refused = SheetGrid { air_at_hz: Some(nodes), ..grid }.cost(&plate, RATE).unwrap_err();
        assert!(matches!(refused, SheetError::OutOfRange(_)), "{nodes:?}: {refused}");
    }
    assert!((TAU * 130.0 / plate.wavenumber_squared(130.0).sqrt()) < 10.0, "far below 12 m/s");
}
