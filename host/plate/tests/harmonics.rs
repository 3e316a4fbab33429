//! The second boundaries of a drive with harmonics, against figures that two independent programs computed: a finite-difference
//! solver of the amplitude equation with its own contact and threshold, and that of the issue which asked for them.

use super::merit::merit;
use slipline_plate::check::{Checker, Colour, Conditions};
use slipline_plate::feeling::{Feeling, FeltEdge, FeltTone};
use slipline_plate::second_boundary::{DrivenTone, HarmonicWave, SecondBoundary};
use slipline_plate::{
    DriveTable, Equation, Harmonics, Plate, PlateSpec, Progress, ResponseCurve, preset, respond,
};

/// The level of all figures here.
const LEVEL: f64 = 0.8;

fn flat(percent: f64) -> Option<ResponseCurve> {
    let db = 20.0 * (0.01 * percent).log10();
    Some(ResponseCurve { points: vec![[10.0, db, 0.0], [1000.0, db, 0.0]] })
}

/// A preset whose drive has these percents of second and third harmonic at [`LEVEL`].
fn distorting(name: &str, second: f64, third: f64) -> Plate {
    let harmonics = Harmonics { level: LEVEL, second: flat(second), third: flat(third) };
    let spec = preset(name).expect("a preset").spec().clone();
    Plate::new(PlateSpec { harmonics: Some(harmonics), ..spec }).expect("valid")
}

/// The felt edge of a tone, and its second boundaries by the second and the third harmonic.
fn found(plate: &Plate, table: &DriveTable, turns_m: f64) -> (FeltEdge, Vec<SecondBoundary>) {
    let (frequency_hz, points) = (table.frequency_hz(turns_m), 801);
    let drive_m = table.driven_end_m(plate, turns_m) * LEVEL;
    let tone = respond(plate, frequency_hz, points, Equation::Corrected).expect("enters");
    let squares: Vec<f64> = tone.amplitude.iter().map(|f| 0.5 * (f * drive_m).norm_sqr()).collect();
    let feeling = Feeling::default();
    let strength = feeling.strength(plate, &[FeltTone { frequency_hz, squares: &squares }]);
    let edge = Feeling::edge(plate, &strength);
    let driven = DrivenTone { frequency_hz, level: LEVEL, drive_m };
    let waves = HarmonicWave::of_tone(plate, &driven, points).expect("in range");
    (edge, SecondBoundary::each(plate, &feeling, edge, &waves))
}

/// A harmonic by where it turns (mm), how far it is over the threshold beyond the felt edge (dB), and where it is felt to end (mm;
/// the plate's length where that is its end). `None` is not stated.
type Row = (f64, f64, Option<f64>);

#[test]
fn second_boundaries_have_the_figures_of_independent_solvers() {
    let membrane: [(f64, f64, Row, Row); 4] = [
        (80.0, 187.0, (231.0, 12.1, Some(256.0)), (319.0, 10.0, Some(320.0))),
        (130.0, 229.0, (281.0, 15.1, Some(308.0)), (369.0, 1.4, None)),
        (180.0, 272.0, (331.0, 13.6, Some(320.0)), (418.0, -7.6, None)),
        (230.0, 314.0, (380.0, 0.2, Some(315.0)), (468.0, -15.0, None)),
    ];
    let latex: [(f64, f64, Row, Row); 4] = [
        (80.0, 182.0, (221.0, 9.8, Some(241.0)), (305.0, 9.9, Some(320.0))),
        (130.0, 226.0, (272.0, 13.0, Some(296.0)), (357.0, 2.9, None)),
        (180.0, 269.0, (323.0, 14.5, Some(320.0)), (409.0, -5.6, None)),
        (230.0, 312.0, (374.0, 5.4, Some(320.0)), (460.0, -14.0, None)),
    ];
    for (name, rows) in [("membrane", membrane), ("latex-membrane", latex)] {
        let plate = distorting(name, 1.0, 0.5);
        let table = DriveTable::build(&plate, 400e3, 257).expect("has a table");
        for (turns_mm, edge_mm, second, third) in rows {
            let (edge, boundaries) = found(&plate, &table, 1e-3 * turns_mm);
            let place_mm = |edge: FeltEdge| match edge {
                FeltEdge::At(place_m) => 1e3 * place_m,
                FeltEdge::PlateEnd => 1e3 * plate.length_m(),
                FeltEdge::Nowhere => 0.0,
            };
            assert!((place_mm(edge) - edge_mm).abs() < 2.0, "{name} {turns_mm}: felt to {edge:?}");
            assert_eq!(boundaries.len(), 2);
            for (is, (turns_there_mm, over_db, to_mm)) in boundaries.iter().zip([second, third]) {
                let at = format!("{name} {turns_mm} mm: {is:?}");
                assert!((1e3 * is.turning_point_m - turns_there_mm).abs() < 2.0, "{at}");
                assert!((is.over_threshold_db - over_db).abs() < 1.0, "{at}");
                assert!(to_mm.is_none_or(|to_mm| (place_mm(is.felt_to) - to_mm).abs() < 2.0), "{at}");
                assert_eq!(is.is_felt(), over_db > 0.0, "{at}");
            }
        }
    }
    // The heavy film masks more: its band begins where the threshold falls no more.
    let plate = distorting("tungsten-membrane", 1.0, 0.5);
    let table = DriveTable::build(&plate, 400e3, 257).expect("has a table");
    for (hertz, edge_mm, turns_there_mm, over_db) in
        [(204.0, 87.0, 277.0, -3.5), (395.0, 300.0, 749.0, -28.0)]
    {
        let (edge, boundaries) = found(&plate, &table, plate.turning_point_m(hertz).expect("turns"));
        let second = boundaries[0];
        assert!((1e3 * edge.place_m().expect("an edge") - edge_mm).abs() < 2.0, "{hertz}: {edge:?}");
        assert!((1e3 * second.turning_point_m - turns_there_mm).abs() < 2.0, "{hertz}: {second:?}");
        assert!((second.over_threshold_db - over_db).abs() < 1.0, "{hertz}: {second:?}");
    }
}

#[test]
fn the_silent_ratio_of_a_harmonic_makes_it_just_not_felt() {
    // At 130 mm: 0.18 % of second harmonic on the membrane.
    let plate = distorting("membrane", 1.0, 0.5);
    let table = DriveTable::build(&plate, 400e3, 257).expect("has a table");
    let silent = found(&plate, &table, 0.13).1[0].silent_below().expect("sounds");
    assert!((silent - 0.0018).abs() < 1e-4, "{silent}");
    for (factor, is_felt) in [(0.99, false), (1.01, true)] {
        let plate = distorting("membrane", 100.0 * silent * factor, 1e-3);
        assert_eq!(found(&plate, &table, 0.13).1[0].is_felt(), is_felt, "{factor}");
    }
}

#[test]
fn the_light_of_distortion_names_the_second_boundary_and_the_silent_ratio() {
    let conditions = || Conditions { level: LEVEL, ..Conditions::default() };
    let light = |plate: &Plate, boundary_m: f64| {
        let report = Checker::new(plate, conditions()).expect("checks").at(boundary_m).expect("on it");
        report.light("distortion").cloned()
    };
    assert_eq!(light(&preset("membrane").expect("a preset"), 0.08), None, "no harmonics are stated");
    let plate = distorting("membrane", 1.0, 0.5);
    let near = light(&plate, 0.08).expect("stated");
    assert!((near.value.expect("a number") - 12.1).abs() < 1.0 && near.colour == Colour::Red, "{near:?}");
    let words = "second boundary at 231 mm, +12 dB over the threshold; silent below 0.25 %.";
    assert!(near.sentence.contains(words), "{}", near.sentence);
    assert!((near.stretches[0].from_m - 0.187).abs() < 2e-3 && (near.stretches[0].to_m - 0.256).abs() < 2e-3);
    let weak = light(&distorting("membrane", 0.1, 0.05), 0.08).expect("stated");
    assert!(weak.colour == Colour::Green && weak.sentence.contains("8 dB below the threshold"), "{weak:?}");
    assert!(light(&distorting("membrane", 0.3, 0.05), 0.08).is_some_and(|it| it.colour == Colour::Amber));
    // Felt up to the end: no side is still.
    let far = light(&plate, 0.27).expect("stated");
    assert_eq!((far.value, far.colour), (None, Colour::Green), "{far:?}");
    // Over the span the worst place counts, which is between those of the table.
    let checker = Checker::new(&plate, conditions()).expect("checks");
    let span = checker.over_span(&mut Progress::unwatched()).expect("checks");
    let worst = span.light("distortion").expect("stated");
    assert!((worst.boundary_m - 0.16).abs() < 6e-3, "{worst:?}");
    assert!(worst.sentence.contains("+16 dB over the threshold; silent below 0.16 %"), "{worst:?}");
}

#[test]
fn harmonics_take_the_contrast_of_an_area_in_sensation_and_leave_that_of_the_tones() {
    let clean = merit(&preset("membrane").expect("a preset"), 0.18);
    let with = merit(&distorting("membrane", 1.0, 0.5), 0.18);
    assert_eq!((clean.felt_contrast_db, clean.contrast_db), (None, with.contrast_db));
    let felt_db = with.felt_contrast_db.expect("harmonics are stated");
    // The figure: 63 dB of contrast are 28 dB in sensation.
    assert!(
        (with.contrast_db - 63.0).abs() < 1.0 && (felt_db - 28.0).abs() < 1.0,
        "{felt_db} of {}",
        with.contrast_db
    );
    // Without amplitude they leave the contrast as it is felt without them.
    let silent_db = merit(&distorting("membrane", 1e-8, 1e-8), 0.18).felt_contrast_db.expect("stated");
    assert!(silent_db > felt_db + 20.0, "{silent_db}");
}
