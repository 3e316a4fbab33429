//! A texture through the protocol, the device and the plate in time: what was fitted is what the plate does.

use slipline_model::field::simulation::{SAMPLE_RATE_HZ, Simulation, Solver, table_for};
use slipline_plate::texture::{Figures, Palette, Target, Texture};
use slipline_plate::{Plate, preset};

fn simulation<'a>(plate: &'a Plate, tones: &'a [(f64, f64)]) -> Simulation<'a> {
    let solver = Solver::Line;
    Simulation { plate, actual: plate, tones, has_gains: true, seconds: None, solver, finger: None }
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
        let simulated = simulation(&plate, &tones).run_with(&table).unwrap();
        assert_eq!(simulated.clipped_samples, 0);
        let largest_m = texture.rms_m.iter().copied().fold(0.0, f64::max);
        let step_m = simulated.position_m[1] - simulated.position_m[0];
        for (&x, &fitted_m) in texture.places_m.iter().zip(&texture.rms_m) {
            let at = x / step_m;
            let before = (at as usize).min(simulated.rms_m.len() - 2);
            let (one, other) = (f64::from(simulated.rms_m[before]), f64::from(simulated.rms_m[before + 1]));
            let is_m = one + (other - one) * (at - before as f64);
            // Down to 40 dB below the largest, where the lines between the places are no longer the field.
            if fitted_m > 0.01 * largest_m {
                let off_db = 20.0 * (is_m / fitted_m).log10();
                assert!(off_db.abs() <= 0.5, "{turning_point_m}: {off_db} dB at {x} m");
            }
        }
        let Figures { ripple_db, .. } = texture.figures;
        assert!(ripple_db.unwrap() <= 1.0);
    }
}
