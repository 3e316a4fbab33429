//! Edges that give: every law takes W + delta, and a file without the field keeps its numbers.

use super::calibration::film;
use super::time_line::assert_answers_tones;
use slipline_plate::{
    Complex64, Equation, Plate, PlateFileError, PlateSpec, Taper, plane, preset, presets, respond,
};

fn giving(plate: &Plate, give_m: f64) -> Plate {
    Plate::new(PlateSpec { edge_give_m: Some(give_m), ..plate.spec().clone() }).expect("a plate")
}

/// The half-width of the clamped strip that cuts off like one of half-width `cut_m` whose edges turn by `give_m`: where
/// tan p + tanh p = -2 p give/W, by bisection.
fn of_turning_edges_m(cut_m: f64, give_m: f64) -> f64 {
    let rest = |p: f64| p.sin() + p.cos() * (p.tanh() + 2.0 * p * give_m / cut_m);
    let clamped = 2.365_020_372_431_352;
    let (mut low, mut high) = (std::f64::consts::FRAC_PI_2, clamped);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if rest(middle) > 0.0 { low = middle } else { high = middle }
    }
    cut_m * clamped / low
}

/// The plate whose cut is as wide as that of `plate` between its edges.
fn cut_wider(plate: &Plate, give_m: f64) -> Plate {
    let length_m = plate.length_m();
    let turns = plate.spec().model.is_clamped() && give_m > 0.0;
    let wider = |cut_m: f64| if turns { of_turning_edges_m(cut_m, give_m) } else { cut_m + give_m };
    let at = |i: u32| 2.0 * length_m * f64::from(i) / 2000.0;
    let cut = (0..=2000).map(|i| [at(i), plate.cut_half_width_m(at(i))]);
    // Straight edges meet before.
    let points = cut.take_while(|[_, cut_m]| *cut_m > 1e-3).map(|[x, cut_m]| [x, wider(cut_m)]).collect();
    Plate::new(PlateSpec { taper: Taper::Sampled { points }, edge_give_m: None, ..plate.spec().clone() })
        .expect("a plate")
}

fn clamped() -> Plate {
    Plate::from_toml(include_str!("edges/clamp_gives_nominal.toml")).expect("a plate")
}

/// The largest difference of two fields over the largest amplitude.
fn differs(a: &[Complex64], b: &[Complex64]) -> f64 {
    let largest = a.iter().map(|f| f.norm()).fold(0.0, f64::max);
    a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max) / largest
}

#[test]
fn a_plate_whose_edges_give_is_the_plate_that_is_cut_as_much_wider() {
    let mut plates: Vec<Plate> =
        ["membrane", "al-bending", "al-sh"].map(|name| preset(name).expect("a preset")).to_vec();
    plates.extend([clamped(), film()]);
    let mut linear = plates[0].spec().clone();
    linear.taper = Taper::Linear { half_width_m: 0.05, end_half_width_m: 0.011 };
    plates.push(Plate::new(linear).expect("a plate"));
    for plate in &plates {
        for give_m in [-3e-4, 4e-4] {
            let (given, wider) = (giving(plate, give_m), cut_wider(plate, give_m));
            let (start_m, end_m) = plate.span_m();
            for place_m in [start_m, 0.5 * (start_m + end_m), end_m] {
                let name = format!("{} {:?} {give_m} {place_m}", plate.name(), plate.spec().model);
                let frequency_hz = given.frequency_for_boundary_hz(place_m);
                let wanted = wider.turning_point_m(frequency_hz).expect("turns");
                assert!((wanted - place_m).abs() < 2e-7, "{name}: {wanted}");
                let [a, b] = [&given, &wider].map(|plate| {
                    respond(plate, frequency_hz, 401, Equation::Corrected).expect("enters").amplitude
                });
                assert!(differs(&a, &b) < 1e-4, "{name}: {}", differs(&a, &b));
                assert!(
                    (given.half_width_m(place_m) / wider.half_width_m(place_m) - 1.0).abs() < 1e-7,
                    "{name}"
                );
                assert_eq!(given.cut_half_width_m(place_m), plate.cut_half_width_m(place_m), "{name}");
                // delta/(W d), the rule of thumb, where delta is small.
                let moved_m =
                    given.turning_point_m(plate.frequency_for_boundary_hz(place_m)).expect("turns") - place_m;
                let half_width_m = plate.half_width_m(place_m);
                let wider_m = given.half_width_m(place_m) - half_width_m;
                assert!((wider_m / give_m - 1.0).abs() < 0.15, "{name}: {wider_m}");
                let rule_m = wider_m / (-plate.narrowing_per_m(place_m) * half_width_m);
                assert!((moved_m / rule_m - 1.0).abs() < 0.15, "{name}: {moved_m} {rule_m}");
            }
        }
    }
}

/// The figures of PLATES.md.
#[test]
fn a_tenth_of_a_millimetre_moves_a_boundary_by_some_millimetres() {
    for (name, stated_mm) in [("al-bending", [2.7, 3.9]), ("membrane", [0.6, 1.6])] {
        let plate = preset(name).expect("a preset");
        let given = giving(&plate, 1e-4);
        let (start_m, end_m) = plate.span_m();
        for (place_m, stated_mm) in [start_m, end_m].into_iter().zip(stated_mm) {
            let frequency_hz = plate.frequency_for_boundary_hz(place_m);
            let moved_mm = 1e3 * (given.turning_point_m(frequency_hz).expect("turns") - place_m);
            assert!((moved_mm - stated_mm).abs() < 0.1, "{name} {place_m}: {moved_mm}");
        }
    }
}

#[test]
fn the_plate_in_time_and_in_two_dimensions_takes_the_same_edges() {
    let plate = giving(&preset("membrane").expect("a preset"), 1e-3);
    assert_answers_tones(&plate, 4e3, &[130.0], 2e-3);
    for (plate, most_m) in [(plate, 2e-4), (giving(&preset("al-bending").expect("a preset"), 3e-4), 3e-4)] {
        let frequency_hz = plate.frequency_for_boundary_hz(0.2);
        let one = respond(&plate, frequency_hz, 601, Equation::Corrected).expect("enters");
        let two = plane::respond(&plate, frequency_hz, 601, &plane::Setup::of(&plate)).expect("enters");
        let shift_m = plane::Comparison::of(&one, &two).peak_shift_m.expect("peaks");
        assert!(shift_m.abs() < most_m, "{}: {shift_m}", plate.name());
    }
}

/// A clamped edge that turns against D/(c h) per length, in two dimensions, has delta = c h.
#[test]
fn clamped_edges_that_turn_against_springs_give_by_their_compliance() {
    let plate = clamped();
    let thickness_m = plate.spec().model.bending().expect("bending").thickness_m;
    for (c, places_m) in [(0.2, &[0.11, 0.16, 0.205][..]), (0.5, &[0.11, 0.16, 0.205]), (1.0, &[0.11, 0.16])]
    {
        let give_m = c * thickness_m;
        let given = giving(&plate, give_m);
        let setup = plane::Setup { edge_compliance_m: give_m, ..plane::Setup::of(&plate) };
        for &place_m in places_m {
            let frequency_hz = given.frequency_for_boundary_hz(place_m);
            let one = respond(&given, frequency_hz, 1001, Equation::Corrected).expect("enters");
            let stiff = respond(&plate, frequency_hz, 1001, Equation::Corrected).expect("enters");
            let two = plane::respond(&plate, frequency_hz, 1001, &setup).expect("enters");
            let off_m = plane::Comparison::of(&one, &two).peak_shift_m.expect("peaks");
            let before_m = plane::Comparison::of(&stiff, &two).peak_shift_m.expect("peaks");
            println!("{c} {place_m}: {before_m} {off_m}");
            assert!(off_m.abs() < 2.5e-4, "{c} {place_m}: {off_m}");
            assert!(before_m > 3.0 * off_m.abs() && before_m > 1e-3, "{c} {place_m}: {before_m} {off_m}");
        }
    }
    let membrane = preset("membrane").expect("a preset");
    let setup = plane::Setup { edge_compliance_m: 1e-4, ..plane::Setup::of(&membrane) };
    let error = plane::respond(&membrane, 150.0, 65, &setup).expect_err("no clamped edge").to_string();
    assert!(error.contains("edge_compliance_m"), "{error}");
}

#[test]
fn the_fields_are_read_written_and_refused_by_their_ranges() {
    let text = preset("membrane").expect("a preset").to_toml();
    assert!(!text.contains("edge_give"), "{text}");
    let with = |line: &str| Plate::from_toml(&format!("{line}\n{text}"));
    let plate = with("edge_give_m = 3e-4\nedge_give_tolerance_m = 1e-4").expect("a plate");
    assert_eq!((plate.spec().edge_give_m, plate.spec().edge_give_tolerance_m), (Some(3e-4), Some(1e-4)));
    assert_eq!(Plate::from_toml(&plate.to_toml()), Ok(plate.clone()));
    let refused = |line: &str| match with(line) {
        Err(error @ PlateFileError::Plate { line: Some(1), .. }) => error.to_string(),
        other => panic!("{line}: {other:?}"),
    };
    for (line, sentence) in [
        ("edge_give_m = 0.006", "edge_give_m = 0.006: must be -0.002 to 0.005"),
        ("edge_give_m = -0.0021", "edge_give_m = -0.0021: must be -0.002 to 0.005"),
        ("edge_give_m = nan", "edge_give_m"),
        ("edge_give_tolerance_m = -1e-4", "edge_give_tolerance_m = -0.0001: must be 0 to 0.005"),
    ] {
        assert!(refused(line).contains(sentence), "{}", refused(line));
    }
    // A plate whose narrow end would vanish.
    let mut spec = plate.spec().clone();
    spec.taper = Taper::Linear { half_width_m: 0.05, end_half_width_m: 1e-3 };
    spec.edge_give_m = Some(-1e-3);
    let error = Plate::new(spec).expect_err("nothing is left").to_string();
    assert!(error.starts_with("edge_give_m = -0.001: must be -0.00099 to 0.005"), "{error}");
}

#[test]
fn edges_that_give_by_nothing_change_no_bit_of_a_preset() {
    for entry in presets() {
        let plate = entry.plate().expect("a preset");
        let frequency_hz = plate.frequency_for_boundary_hz(plate.span_m().1);
        let [a, b] = [&plate, &giving(&plate, 0.0)]
            .map(|plate| respond(plate, frequency_hz, 65, Equation::Corrected).expect("enters").amplitude);
        assert_eq!(a, b, "{}", entry.name);
    }
}
