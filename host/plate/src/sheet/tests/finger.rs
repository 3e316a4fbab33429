//! A finger on the sheet: the energy, and the plane of the frequency domain.

use super::{RATE, field, membrane, settled, tone};
use crate::{Complex64, DriveEnd, Finger, Model, Plate, Sheet, SheetError, SheetGrid, plane};
use std::f64::consts::TAU;

/// The default membrane without loss, whose tension gives the load that a finger is.
fn tense(end: DriveEnd) -> Plate {
    let mut spec = membrane(0.05, 4.62, 0.32, 0.0, end).spec().clone();
    spec.model = Model::Membrane { wave_speed_m_per_s: 12.0, tension_n_per_m: Some(40.0), film: None };
    Plate::new(spec).unwrap()
}

/// The energy of a sheet with a finger every 200 codes, after a burst that has ended.
fn energies(finger: &Finger, whole: bool) -> Vec<f64> {
    let plate = tense(DriveEnd::Force { at_frequency_hz: 150.0 });
    let grid = SheetGrid { whole, ..SheetGrid::new(90, 14) };
    let mut sheet = Sheet::touched(&plate, Some(finger), RATE, grid).unwrap();
    sheet.push(&tone(150.0, 0, 4000));
    sheet.push(&[0.0; 100]);
    let mut energy = || {
        sheet.push(&[0.0; 200]);
        sheet.energy_j_per_kg_m2()
    };
    (0..50).map(|_| energy()).collect()
}

#[test]
fn a_finger_of_mass_alone_keeps_the_energy_and_one_that_resists_only_takes_it() {
    // One at the driven end, where it covers half cells, and one in the middle; a plate's weight of mass and far more.
    for (place_m, mass_kg) in [(0.0, 1e-4), (0.12, 1e-4), (0.12, 1.0), (0.3, 1e-5)] {
        for whole in [false, true] {
            let finger = Finger { resistance_n_s_per_m: 0.0, mass_kg, ..Finger::light(place_m) };
            let energy = energies(&finger, whole);
            for now in &energy {
                assert!((now / energy[0] - 1.0).abs() < 2e-5, "{place_m} {mass_kg}: {:e} {now:e}", energy[0]);
            }
        }
        for resistance_n_s_per_m in [0.1, 1.0, 1e9] {
            let finger = Finger { resistance_n_s_per_m, mass_kg, ..Finger::light(place_m) };
            let energy = energies(&finger, false);
            assert!(energy.iter().all(|energy| energy.is_finite() && *energy > 0.0));
            assert!(
                energy.windows(2).all(|pair| pair[1] <= pair[0] * (1.0 + 5e-6)),
                "{finger:?}: {energy:?}"
            );
            if place_m < 0.2 && mass_kg < 0.1 && resistance_n_s_per_m < 1e8 {
                assert!(energy[49] < 0.9 * energy[0], "{finger:?}: {energy:?}");
            }
        }
    }
}

#[test]
fn a_finger_of_nothing_changes_no_bit_and_one_on_a_plate_of_unstated_weight_is_refused() {
    let plate = tense(DriveEnd::Resistance { ratio: 1.0, at_frequency_hz: 150.0 });
    let nothing = Finger { resistance_n_s_per_m: 0.0, mass_kg: 0.0, ..Finger::light(0.1) };
    let run = |sheet: Result<Sheet, SheetError>| {
        let mut sheet = sheet.unwrap();
        sheet.push(&tone(150.0, 0, 3000));
        field(&sheet)
    };
    let grid = SheetGrid::new(90, 14);
    assert_eq!(run(Sheet::new(&plate, RATE, grid)), run(Sheet::touched(&plate, Some(&nothing), RATE, grid)));
    let untold = membrane(0.05, 4.62, 0.32, 0.0, DriveEnd::Displacement);
    let refused = |plate: &Plate, finger: Finger| {
        Sheet::touched(plate, Some(&finger), RATE, grid).unwrap_err().to_string()
    };
    assert!(refused(&untold, nothing).contains("model.tension_n_per_m is missing"));
    assert_eq!(refused(&plate, Finger::light(0.4)), "finger place = 0.4 m: must be 0 to 0.32 m");
}

/// The plane's loss divides the modulus by 1 + j eta, the sheet's multiplies the inertia by it. They are the same plate
/// if the plane's finger has 1/(1 + j eta) of the impedance.
fn on_the_plane(finger: &Finger, loss: f64, frequency_hz: f64) -> Finger {
    let impedance = finger.impedance().at_n_s_per_m(frequency_hz) / Complex64::new(1.0, loss);
    Finger { resistance_n_s_per_m: impedance.re, mass_kg: -impedance.im / (TAU * frequency_hz), ..*finger }
}

#[test]
fn a_finger_takes_from_the_sheet_what_it_takes_from_the_plane_at_second_order() {
    // A held end: the plane's damper acts on the first width mode alone, see the test beside the plane's reflections.
    let (frequency_hz, loss) = (125.0, 0.1);
    for (tension, finger) in [
        (40.0, Finger::light(0.108)),
        (400.0, Finger::firm(0.09)),
        (400.0, Finger { mass_kg: 1e-3, ..Finger::light(0.15) }),
        (400.0, Finger { contact_m: 0.05, ..Finger::firm(0.12) }),
    ] {
        let mut spec = membrane(0.05, 4.62, 0.32, loss, DriveEnd::Displacement).spec().clone();
        spec.model = Model::Membrane { wave_speed_m_per_s: 12.0, tension_n_per_m: Some(tension), film: None };
        let plate = Plate::new(spec).unwrap();
        let finger_there = on_the_plane(&finger, loss, frequency_hz);
        let on_plane = |finger: Option<Finger>, points: usize| -> Vec<f64> {
            let setup = plane::Setup { finger, ..plane::Setup::of(&plate) };
            let plane = plane::respond(&plate, frequency_hz, points, &setup).unwrap();
            plane.amplitude.iter().map(|f| f.norm()).collect()
        };
        let worst = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let errors: Vec<f64> = [1, 2]
            .map(|finer| {
                let along = finer * 128;
                let grid = SheetGrid { loss_at_hz: Some(frequency_hz), ..SheetGrid::new(along, finer * 20) };
                let sheet = Sheet::touched(&plate, Some(&finger), RATE, grid).unwrap();
                let sheet = settled(sheet, &plate, RATE, frequency_hz);
                let plane = on_plane(Some(finger_there), along + 1);
                assert!(worst(&on_plane(None, along + 1), &plane) > 0.2, "{finger:?} changes nothing");
                worst(&sheet, &plane)
            })
            .to_vec();
        assert!(errors[0] > 3.0 * errors[1] && errors[1] < 4e-3, "{tension} {finger:?}: {errors:?}");
    }
}
