use super::*;
use slipline_plate::DriveTable;
use std::sync::Arc;

/// A setup on a preset, and its plate's table.
fn setup(name: &str, level: f64) -> (Setup, DriveTable) {
    let plate = slipline_plate::preset(name).unwrap();
    let table = DriveTable::build(&plate, 400e3, 65).unwrap();
    let mut setup = Setup::new(Arc::new(plate));
    setup.tones[0].level = level;
    (setup, table)
}

fn line_at(setup: &Setup, table: &DriveTable, place_m: f64) -> Line {
    let tone = setup.tones[0];
    let position_m = turning_point_m(setup, &tone, Some(table), place_m);
    Line::of(setup, &ToneSetup { position_m, ..tone }, Some(table))
}

#[test]
fn the_line_is_put_where_it_is_wanted_all_over_the_span_of_felt_edges() {
    for (name, level) in [("membrane", 0.03), ("al-bending", 0.8), ("paper-rubber", 0.5), ("al-sh", 1.0)] {
        let (setup, table) = setup(name, level);
        let (low_m, high_m) = limits_m(&setup, &setup.tones[0], Some(&table));
        let (mut felt, mut nearest_m) = (0, None);
        for i in 0..=20 {
            let place_m = low_m + (high_m - low_m) * f64::from(i) / 20.0;
            let line = line_at(&setup, &table, place_m);
            if line.holds != Holds::FeltEdge {
                assert_eq!(line.place_m, place_m, "{name}");
            } else if (line.place_m - place_m).abs() < 1e-5 {
                felt += 1;
            } else {
                // No tone has its felt edge as near: the line is at the nearest possible felt edge.
                let nearest_m = *nearest_m.get_or_insert(line.place_m);
                assert!(
                    place_m < nearest_m && (line.place_m - nearest_m).abs() < 1e-4,
                    "{name} {place_m}: {line:?}"
                );
            }
        }
        assert!(felt > 4, "{name}");
    }
}

#[test]
fn beyond_the_limits_the_line_stays_at_them() {
    let (setup, table) = setup("al-bending", 0.8);
    let (low_m, high_m) = limits_m(&setup, &setup.tones[0], Some(&table));
    let (start_m, end_m) = setup.plate.span_m();
    // The lowest tone of the span is below 20 kHz: its line is its turning point.
    assert!(low_m == start_m && high_m > end_m + 0.01, "{low_m} {high_m}");
    assert!((line_at(&setup, &table, 0.33).place_m - high_m).abs() < 1e-5);
    let lowest = line_at(&setup, &table, 0.1);
    assert_eq!((lowest.place_m, lowest.holds), (start_m, Holds::Unfelt(NotFelt::BelowUltrasound)));
    // Between the tones that are not felt and the nearest felt edge no line is possible: the nearest felt
    // edge is used.
    let nearest = line_at(&setup, &table, 0.21);
    assert!(nearest.holds == Holds::FeltEdge && nearest.place_m > 0.22, "{nearest:?}");
    let hertz = |line: Line| {
        let at_m = turning_point_m(&setup, &setup.tones[0], Some(&table), line.place_m);
        setup.plate.frequency_for_boundary_hz(at_m)
    };
    assert!((hertz(nearest) / 20e3 - 1.0).abs() < 1e-3, "{}", hertz(nearest));
}

#[test]
fn what_the_line_holds_stays_when_the_level_changes_and_returns_when_it_can() {
    let (mut setup, table) = setup("al-bending", 0.8);
    let place_m = 0.25;
    let at = [(0, place_m)];
    setup = held(setup, &at, Some(&table));
    let loud_m = setup.tones[0].position_m;
    for (master_db, is_felt) in [(-6.0, true), (-60.0, false), (0.0, true)] {
        setup.master_db = master_db;
        setup = held(setup, &at, Some(&table));
        let line = lines(&setup, Some(&field(&setup, &table)))[0];
        assert_eq!(line.holds == Holds::FeltEdge, is_felt, "{master_db} dB: {line:?}");
        assert!((line.place_m - place_m).abs() < 1e-5, "{master_db} dB: {line:?}");
    }
    assert!((setup.tones[0].position_m - loud_m).abs() < 1e-5);
}

fn field(setup: &Setup, table: &DriveTable) -> SteadyField {
    SteadyField::solve(&setup.plate, &crate::field::steady_field::steady_tones(setup, Some(table)))
}

#[test]
fn another_tone_does_not_move_the_line() {
    let (mut setup, table) = setup("al-bending", 0.4);
    let alone = lines(&setup, Some(&field(&setup, &table)))[0];
    setup.tones.push(ToneSetup { slot: 1, position_m: 0.27, ..setup.tones[0] });
    let both = lines(&setup, Some(&field(&setup, &table)));
    assert_eq!(both[0], alone);
    assert!(both[1].place_m > alone.place_m);
}

#[test]
fn by_choice_and_while_the_height_is_unknown_the_line_is_the_turning_point() {
    let (mut setup, table) = setup("membrane", 0.8);
    let tone = setup.tones[0];
    assert_eq!(Line::of(&setup, &tone, None).holds, Holds::TurningPoint);
    assert_eq!(turning_point_m(&setup, &tone, None, 0.3), setup.plate.span_m().1);
    let felt = Line::of(&setup, &tone, Some(&table));
    assert!(felt.holds == Holds::FeltEdge && felt.place_m > tone.position_m + 0.05, "{felt:?}");
    setup.boundary = BoundaryMode::TurningPoint;
    let line = Line::of(&setup, &tone, Some(&table));
    assert_eq!((line.place_m, line.holds), (tone.position_m, Holds::TurningPoint));
    assert_eq!(limits_m(&setup, &tone, Some(&table)), setup.plate.span_m());
    assert_eq!(turning_point_m(&setup, &tone, Some(&table), 0.12), 0.12);
}

#[test]
fn a_loud_tone_is_felt_to_the_plates_end() {
    let (mut setup, table) = setup("membrane", 1.0);
    setup.tones[0].position_m = 0.26;
    let line = Line::of(&setup, &setup.tones[0], Some(&table));
    assert_eq!((line.place_m, line.holds), (setup.plate.length_m(), Holds::PlateEnd));
    let inside = line_at(&setup, &table, 0.25);
    assert!(inside.holds == Holds::FeltEdge && (inside.place_m - 0.25).abs() < 1e-5, "{inside:?}");
}
