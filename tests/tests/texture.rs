//! A texture through the protocol, the device and the plate in time: the plate does what was fitted.

use slipline_model::field::simulation::{SAMPLE_RATE_HZ, Simulated, Simulation, Solver, table_for};
use slipline_plate::texture::{Figures, Palette, Target, Texture};
use slipline_plate::{Plate, Progress, preset, quantity::decibels};

fn simulation<'a>(plate: &'a Plate, tones: &'a [(f64, f64)]) -> Simulation<'a> {
    let solver = Solver::Line;
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

/// The root mean square of the simulated plate at a place, in metres; linear between the points.
fn rms_m(simulated: &Simulated, x_m: f64) -> f64 {
    let at = x_m / (simulated.position_m[1] - simulated.position_m[0]);
    let before = (at as usize).min(simulated.rms_m.len() - 2);
    let (one, other) = (f64::from(simulated.rms_m[before]), f64::from(simulated.rms_m[before + 1]));
    one + (other - one) * (at - before as f64)
}

#[test]
fn a_texture_within_reach_is_reached_on_the_plate() {
    let plate = preset("membrane").unwrap();
    let (table, _) = table_for(&plate, SAMPLE_RATE_HZ).unwrap();
    let palette = Palette::new(&plate, &table);
    // One bump and two: every tone moves the plate everywhere before its turning point, so neither is reachable.
    let one: &[(f64, f64)] = &[(0.02, 0.1), (0.1, 0.1), (0.18, 1.0), (0.26, 0.0), (0.32, 0.0)];
    let two: &[(f64, f64)] = &[(0.02, 0.1), (0.08, 1.0), (0.14, 0.1), (0.2, 1.0), (0.26, 0.0), (0.32, 0.0)];
    for points in [one, two] {
        let target = Target::profile(&palette, points).unwrap();
        let texture = Texture::fit(&palette, &target, 16).unwrap();
        let tones: Vec<(f64, f64)> = texture.tones.iter().map(|tone| (tone.position_m, tone.level)).collect();
        let simulated = simulation(&plate, &tones).run(&table, &mut Progress::unwatched()).unwrap();
        let (mut square, mut count, mut largest_m) = (0.0, 0, 0.0_f64);
        for ((&x, &wanted_m), &weight) in texture.places_m.iter().zip(&texture.wanted_m).zip(target.weight())
        {
            if weight > 0.0 {
                square += (rms_m(&simulated, x) - wanted_m).powi(2);
                count += 1;
                largest_m = largest_m.max(wanted_m);
            }
        }
        let reached = (square / f64::from(count)).sqrt() / largest_m;
        let off_db = decibels(reached / texture.reach.rms_error);
        assert!(off_db.abs() <= 0.5, "{off_db} dB: {reached} of {}", texture.reach.rms_error);
        assert!(reached > 0.05, "{reached}: out of reach");
    }
}

#[test]
fn a_solid_area_is_on_the_plate_as_it_was_fitted() {
    let plate = preset("membrane").unwrap();
    let (table, _) = table_for(&plate, SAMPLE_RATE_HZ).unwrap();
    let palette = Palette::new(&plate, &table);
    for turning_point_m in [0.22, 0.26] {
        let target = Target::solid(&palette, turning_point_m).unwrap();
        let texture = Texture::fit(&palette, &target, 8).unwrap();
        let tones: Vec<(f64, f64)> = texture.tones.iter().map(|tone| (tone.position_m, tone.level)).collect();
        let simulated = simulation(&plate, &tones).run(&table, &mut Progress::unwatched()).unwrap();
        assert_eq!(simulated.clipped_samples, 0);
        let largest_m = texture.rms_m.iter().copied().fold(0.0, f64::max);
        for (&x, &fitted_m) in texture.places_m.iter().zip(&texture.rms_m) {
            let is_m = rms_m(&simulated, x);
            // Down to 40 dB below the largest, where the lines between the places are no longer the field.
            if fitted_m > 0.01 * largest_m {
                let off_db = decibels(is_m / fitted_m);
                assert!(off_db.abs() <= 0.5, "{turning_point_m}: {off_db} dB at {x} m");
            }
        }
        let Figures { ripple_db, .. } = texture.figures;
        assert!(ripple_db.unwrap() <= 1.0);
    }
}
