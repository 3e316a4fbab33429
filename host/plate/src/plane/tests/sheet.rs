//! The plane against the sheet of the time domain, whose driven end differs.
//!
//! The plane's damper acts on the first width mode alone, as in the one-mode equation; the sheet's acts on every
//! point of the driven end. The two agree only where no other width mode propagates. On al-sh the edges meet the
//! driven end at 43 degrees, and the third mode propagates there.

use super::super::discrete::Discrete;
use super::super::field::{RESOLUTION, far_end};
use super::super::outline::Outline;
use super::super::setup::Setup;
use super::super::strip::wave_impedance;
use super::super::system::amplitudes;
use crate::{DriveEnd, Plate, Sheet, SheetGrid, preset};
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// |w| on the centre line at `points` uniform places, with a damper at every point of the end or on the first mode.
fn centre_line(plate: &Plate, frequency_hz: f64, points: usize, resists_everywhere: bool) -> Vec<f64> {
    let outline = Outline::of(&plate.width, 0.0, RESOLUTION.rounding);
    let end_m = far_end(plate, frequency_hz);
    let setup = Setup::of(plate);
    let discrete = Discrete::new(plate, frequency_hz, &setup, outline, end_m, RESOLUTION).unwrap();
    let mut system = discrete.equations(plate.wave_loss(), 1.0, discrete.level);
    let (section, node) = (&discrete.section, discrete.mesh.node_at(0.0));
    if resists_everywhere {
        // The sheet's tension has no loss; the plane's has the factor 1/(1 + j eta). The damper is scaled alike.
        let compliance = Complex64::new(1.0, plate.wave_loss());
        system.right.iter_mut().for_each(|force| *force /= compliance);
        let DriveEnd::Resistance { ratio, at_frequency_hz } = plate.spec().drive_end else {
            panic!("a damper")
        };
        let force = Complex64::new(0.0, -TAU * frequency_hz * ratio * wave_impedance(plate, at_frequency_hz));
        for (at, mass) in section.mass.iter().enumerate() {
            let (m, n) = (at / section.orders, at % section.orders);
            let on_the_mode = section.projection[m] * section.projection[n];
            let unknown = |order: usize| 2 * (node * section.orders + order);
            system.matrix.add(unknown(m), unknown(n), force * (mass / compliance - on_the_mode));
        }
    }
    system.clamp(discrete.mesh.elements());
    let unknowns = system.solve();
    let centre = section.values(0.0);
    let at = |x: f64| -> Complex64 {
        let f = amplitudes(section, &discrete.mesh, &unknowns, x);
        f.iter().zip(&centre).map(|(amplitude, value)| amplitude * value).sum()
    };
    (0..points).map(|i| at(plate.length_m() * i as f64 / (points - 1) as f64).norm()).collect()
}

/// |v| on the centre line of a sheet with `cells` cells on the half-width at the end of the span, in the steady
/// state.
fn on_the_sheet(plate: &Plate, frequency_hz: f64, cells: f64) -> Vec<f64> {
    let cell = plate.half_width_m(plate.span_m().1) / cells;
    let count = |length_m: f64| (length_m / cell).ceil() as usize;
    let grid = SheetGrid {
        loss_at_hz: Some(frequency_hz),
        ..SheetGrid::new(count(plate.length_m()), count(plate.half_width_m(0.0)))
    };
    // One code per step, so that the drive is neither held nor averaged.
    let most = grid.cost(plate, 1e3 * frequency_hz).unwrap().step_rate_hz;
    let codes_per_period = (1.01 * most / frequency_hz).ceil() as usize;
    let mut sheet = Sheet::new(plate, codes_per_period as f64 * frequency_hz, grid).unwrap();
    assert!((sheet.step_rate_hz() / frequency_hz - codes_per_period as f64).abs() < 1e-6);
    let tone = |periods: std::ops::Range<usize>| -> Vec<f32> {
        let codes = periods.start * codes_per_period..periods.end * codes_per_period;
        let turns = codes.map(|n| n as f64 / codes_per_period as f64);
        let rise = |turns: f64| 0.5 - 0.5 * (PI * (turns / 30.0).min(1.0)).cos();
        turns.map(|turns| (rise(turns) * (TAU * turns).sin()) as f32).collect()
    };
    sheet.push(&tone(0..90));
    sheet.reset_envelope();
    sheet.push(&tone(90..100));
    let scale = 2f64.sqrt() / plate.spec().full_scale_m;
    sheet.envelope().rms_m.iter().map(|rms| f64::from(*rms) * scale).collect()
}

#[test]
fn the_sheet_is_the_plane_whose_whole_end_is_resisted() {
    let top = |line: &[f64]| line.iter().copied().fold(0.0, f64::max);
    for (name, boundary_m, by_the_end_db, most) in
        [("membrane", 0.16, 0.004, 1.5e-3), ("al-sh", 0.24, 0.311, 2.5e-4)]
    {
        let plate = preset(name).unwrap();
        let frequency_hz = plate.frequency_for_boundary_hz(boundary_m);
        let errors = [2.5, 5.0, 10.0].map(|cells| {
            let sheet = on_the_sheet(&plate, frequency_hz, cells);
            let plane = centre_line(&plate, frequency_hz, sheet.len(), true);
            let one_mode = centre_line(&plate, frequency_hz, sheet.len(), false);
            let level_db = 20.0 * (top(&one_mode) / top(&plane)).log10();
            println!("{name}: the end makes {level_db:.4} dB");
            assert!((level_db - by_the_end_db).abs() < 2e-3, "{name}: {level_db} dB");
            sheet.iter().zip(&plane).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / top(&plane)
        });
        println!("{name}: {errors:?}");
        assert!(errors.windows(2).all(|pair| pair[1] < 0.7 * pair[0]), "{name}: {errors:?}");
        assert!(errors[2] < most, "{name} is not the plane: {errors:?}");
    }
}
