//! The field and felt edge of a tone in the window equal those of the tone that the device plays.

use slipline_model::field::line::{Holds, Line, limits_m, turning_point_m};
use slipline_model::field::simulation::{KNOTS, SAMPLE_RATE_HZ, Simulation, Solver, device_table};
use slipline_model::field::steady_field::{POINTS, SteadyField, SteadyTone};
use slipline_model::setup::{Setup, ToneSetup};
use slipline_plate::{DriveTable, Progress, ToneDrive, predict_envelope};
use std::sync::Arc;

/// Presets at levels at which their felt edges lie on the plate.
const LEVELS: [(&str, f64); 6] = [
    ("membrane", 0.03),
    ("membrane-heavy", 0.03),
    ("al-bending", 0.8),
    ("al-bending-displacement", 1.0),
    ("paper-rubber", 0.5),
    ("al-sh", 1.0),
];

/// Places of each preset, from its nearest felt edge to its farthest on the plate.
const PLACES: u32 = 5;

#[test]
fn the_line_is_where_the_simulated_plate_stops_being_felt() {
    std::thread::scope(|scope| {
        for (name, level) in LEVELS {
            scope.spawn(move || compare(name, level));
        }
    });
}

fn compare(name: &str, level: f64) {
    let plate = Arc::new(slipline_plate::preset(name).unwrap());
    let table = DriveTable::build(&plate, f64::from(SAMPLE_RATE_HZ), KNOTS).unwrap();
    let mut setup = Setup::new(Arc::clone(&plate));
    setup.tones[0].level = level;
    the_field_is_that_of_what_the_device_plays(name, &setup, &table);
    let (tone, known) = (setup.tones[0], Some(&table));
    let line = |position_m| Line::of(&setup, &ToneSetup { position_m, ..tone }, known);
    // Tones below 20 kHz are not felt on an ultrasonic plate.
    let (start_m, end_m) = plate.span_m();
    let mut turning_points = (0..=200).map(|i| start_m + (end_m - start_m) * f64::from(i) / 200.0);
    let nearest = turning_points.find(|&at_m| line(at_m).holds == Holds::FeltEdge).unwrap();
    let (nearest_m, (_, farthest_m)) = (line(nearest).place_m, limits_m(&setup, &tone, known));
    for i in 0..PLACES {
        let share = (f64::from(i) + 0.5) / f64::from(PLACES);
        let place_m = nearest_m + (farthest_m - nearest_m) * share;
        let position_m = turning_point_m(&setup, &tone, known, place_m);
        let drawn_m = line(position_m).place_m;
        assert!((drawn_m - place_m).abs() < 1e-5, "{name}: {drawn_m} for {place_m}");
        let simulation = Simulation {
            plate: &plate,
            actual: &plate,
            tones: &[(position_m, level)],
            sounding: None,
            has_gains: true,
            seconds: None,
            solver: Solver::Line,
            finger: None,
        };
        let simulated = simulation.run(&table, &mut Progress::unwatched()).unwrap();
        let felt = simulated.felt(&plate, &setup.feeling).unwrap();
        let felt_m = felt.edge.place_m().unwrap_or(f64::NAN);
        assert!((felt_m - drawn_m).abs() < 1e-3, "{name}: drawn at {drawn_m}, felt to {felt_m}");
    }
}

/// Turning points at which a field is compared with the played one, also between knots.
const TURNING_POINTS: u32 = 39;

/// The setup's tone at places over the whole span: its field is within 1 % of the frequency solver's for the
/// step and the gain that the device takes from its table.
fn the_field_is_that_of_what_the_device_plays(name: &str, setup: &Setup, table: &DriveTable) {
    let plate = &setup.plate;
    let on_device = device_table(table).unwrap();
    for i in 0..=TURNING_POINTS {
        let share = f64::from(i) / f64::from(TURNING_POINTS);
        let position_m = table.span_m().0 + (table.span_m().1 - table.span_m().0) * share;
        let tone = ToneSetup { position_m, ..setup.tones[0] };
        let position = on_device.position(position_m).unwrap();
        let played = ToneDrive {
            frequency_hz: on_device.frequency_hz(position),
            amplitude: f64::from(on_device.setting(position.fine()).gain.0) / f64::from(1_u32 << 31)
                * tone.level,
            phase_rad: 0.0,
        };
        let truth = predict_envelope(plate, None, &[played], f64::from(SAMPLE_RATE_HZ), POINTS).unwrap();
        let drawn = SteadyField::solve(plate, &[SteadyTone::of(setup, &tone, table)]);
        let highest_m = truth.bound_m.iter().copied().fold(0.0, f64::max);
        let off_m = truth.bound_m.iter().zip(&drawn.bound_m).map(|(is, drawn)| (is - drawn).abs());
        let off = off_m.fold(0.0, f64::max) / highest_m;
        assert!(off < 0.01, "{name}, turning point {position_m} m: {} % off", 100.0 * off);
    }
}
