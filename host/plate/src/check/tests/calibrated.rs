//! Lights over the intervals of a calibration, against random plates within them.

use super::{light, report};
use crate::check::{Checker, Colour, Conditions, Light, Report};
use crate::definition::Calibration;
use crate::truth::Random;
use crate::{DriveEnd, Impedance, Plate, PlateSpec, Source, preset};
use std::collections::BTreeSet;

/// Halves of the intervals of wave speed, loss, half-width and taper.
#[derive(Clone, Copy)]
struct Halves {
    speed: f64,
    loss: f64,
    half_width: f64,
    taper: f64,
}

const NOTHING: Halves = Halves { speed: 0.0, loss: 0.0, half_width: 0.0, taper: 0.0 };

/// The plate after a calibration with these intervals.
fn calibrated(mut spec: PlateSpec, halves: Halves, level_tolerance_db: Option<f64>) -> Plate {
    (spec.wave_speed_tolerance, spec.loss_tolerance) = (halves.speed, Some(halves.loss));
    spec.calibration = Some(Calibration {
        chi2_per_n: 1.0,
        half_width_tolerance: halves.half_width,
        taper_tolerance: halves.taper,
        level_tolerance_db,
        source_tolerance: None,
        correction: None,
    });
    Plate::new(spec).expect("valid")
}

/// A random plate within the intervals on which the wave of `frequency_hz` turns within the boundary's interval; each
/// parameter is at an end of its interval with a probability of one half. The truth has no intervals of its own.
fn truth(plate: &Plate, frequency_hz: f64, halves: Halves, random: &mut Random) -> Plate {
    let mut way = || {
        let drawn = random.within(-1.0, 1.0);
        if random.within(0.0, 1.0) < 0.5 { drawn.signum() } else { drawn }
    };
    let mut spec = plate.spec().clone();
    let power = 1.0 + way() * halves.taper;
    spec.taper = spec.taper.stretched((way() * halves.half_width).exp(), power);
    spec.loss_factor *= (1.0 + halves.loss).powf(way());
    let here_m = plate.turning_point_m(frequency_hz).expect("enters");
    let wanted_m = here_m + way() * plate.boundary_tolerance_m(here_m).expect("calibrated");
    let stretched = calibrated(spec, NOTHING, None);
    // The speed for which the wave turns there, by bisection.
    let (mut slow, mut fast) = (0.8, 1.25);
    for _ in 0..60 {
        let middle = 0.5 * (slow + fast);
        let place_m = stretched.with_wave_speed(middle).expect("near").turning_point_m(frequency_hz);
        // A faster wave is longer and turns nearer the drive.
        *if place_m.is_some_and(|x| x > wanted_m) { &mut slow } else { &mut fast } = middle;
    }
    stretched.with_wave_speed(slow).expect("near")
}

fn at(plate: &Plate, boundary_m: f64) -> Report {
    Checker::new(plate, Conditions::default()).expect("checks").at(boundary_m).expect("on it")
}

/// Lights whose numbers depend on the table; the table of the true plate differs.
const OF_THE_TABLE: [&str; 5] = ["excursion", "DAC resolution", "sensitivity", "sound level", "felt edge"];

#[test]
fn what_is_green_on_a_calibrated_plate_is_green_on_every_plate_within_its_intervals() {
    let halves = Halves { speed: 4e-3, loss: 0.3, half_width: 0.03, taper: 0.02 };
    let mut random = Random::new(5);
    let mut held = BTreeSet::new();
    for (name, places) in [("membrane", [0.04, 0.09, 0.21, 0.305]), ("al-bending", [0.08, 0.16, 0.235, 0.28])]
    {
        let plate = calibrated(preset(name).expect("a preset").spec().clone(), halves, None);
        for boundary_m in places {
            let stated = at(&plate, boundary_m);
            let frequency_hz = stated.frequency_hz.0;
            for _ in 0..4 {
                let truth = truth(&plate, frequency_hz, halves, &mut random);
                let found = at(&truth, truth.turning_point_m(frequency_hz).expect("enters"));
                let judged = stated.lights.iter().zip(&found.lights);
                for (stated, found) in judged.filter(|(stated, _)| !OF_THE_TABLE.contains(&stated.name)) {
                    let place = format!("{name} {boundary_m}: {stated:?} {found:?}");
                    assert!(stated.colour > Colour::Green || found.colour <= Colour::Green, "{place}");
                    within(stated, found, &place);
                    if stated.colour == Colour::Green && stated.low.is_some() {
                        assert!(
                            stated.sentence.contains("It holds over") && stated.sentence.contains('±'),
                            "{stated:?}"
                        );
                        held.insert(stated.name);
                    }
                }
            }
        }
    }
    assert!(held.len() >= 8, "{held:?}");
}

/// The places just on the green side of a light's limit, with the light's name.
fn just_green(plate: &Plate) -> Vec<(f64, &'static str)> {
    let checker = Checker::new(plate, Conditions::default()).expect("checks");
    let lights = |x: f64| checker.at(x).expect("on it").lights;
    let grid: Vec<(f64, Vec<Light>)> =
        (1..=16).map(|i| plate.length_m() * f64::from(i) / 16.0).map(|x| (x, lights(x))).collect();
    let mut found = Vec::new();
    for pair in grid.windows(2) {
        for (i, (near, far)) in pair[0].1.iter().zip(&pair[1].1).enumerate() {
            let [near_green, far_green] = [near, far].map(|light| light.colour == Colour::Green);
            if near_green == far_green {
                continue;
            }
            let (mut green, mut other) =
                if near_green { (pair[0].0, pair[1].0) } else { (pair[1].0, pair[0].0) };
            for _ in 0..10 {
                let middle = 0.5 * (green + other);
                let is_green = lights(middle)[i].colour == Colour::Green;
                *if is_green { &mut green } else { &mut other } = middle;
            }
            found.push((green, near.name));
        }
    }
    found
}

#[test]
fn a_light_that_fails_at_an_end_of_the_interval_is_amber_and_says_how_well_the_plate_is_known() {
    let halves = Halves { speed: 4e-3, loss: 0.3, half_width: 0.03, taper: 0.02 };
    let changed = |name: &str, change: fn(&mut PlateSpec)| {
        let mut spec = preset(name).expect("a preset").spec().clone();
        change(&mut spec);
        spec
    };
    let plates = [
        changed("membrane", |_| {}),
        changed("membrane", |spec| spec.loss_factor = 0.15),
        changed("membrane", |spec| spec.taper = spec.taper.stretched(2.0, 1.0)),
        changed("al-bending", |_| {}),
        changed("al-bending", |spec| spec.taper = spec.taper.stretched(0.9, 1.0)),
        changed("membrane-heavy", |_| {}),
    ];
    let mut failed = BTreeSet::new();
    for spec in plates {
        let exact = calibrated(spec.clone(), NOTHING, None);
        let checker = Checker::new(&calibrated(spec, halves, None), Conditions::default()).expect("checks");
        for (boundary_m, name) in just_green(&exact) {
            let report = checker.at(boundary_m).expect("on it");
            let stated = light(&report, name);
            // From 20 kHz on a tone is felt in another way, and its frequency is exact on every plate of the interval.
            if name == "felt edge" && (report.frequency_hz.0 / 20e3 - 1.0).abs() < 1e-3 {
                continue;
            }
            assert_eq!(stated.colour, Colour::Amber, "{stated:?}");
            assert!(stated.sentence.contains('±'), "{stated:?}");
            failed.insert(name);
        }
    }
    for name in [
        "drive match",
        "edge slope",
        "edge width",
        "felt edge",
        "finger load",
        "ghost boundaries",
        "loss",
        "peak",
        "sound level",
        "thin plate",
        "wavelengths",
        "width",
    ] {
        assert!(failed.contains(name), "{name}: {failed:?}");
    }
    // The curvature is largest at the drive, for every boundary: d^2 W0^2 = 0.0611; green up to 0.0625.
    let curved = changed("membrane", |spec| spec.taper = spec.taper.stretched(1.07, 1.0));
    let of = |halves: Halves| at(&calibrated(curved.clone(), halves, None), 0.2);
    let [exact, stated] = [NOTHING, halves].map(of);
    let colours = [&exact, &stated].map(|report| light(report, "edge curvature").colour);
    assert_eq!(colours, [Colour::Green, Colour::Amber]);
}

/// The true number lies between the stated ends. The reflection may be lower than at all ends: only its highest value
/// is at one.
fn within(stated: &Light, found: &Light, place: &str) {
    let (Some(low), Some(high), Some(value)) = (stated.low, stated.high, found.value) else { return };
    let slack = 2e-3 * value.abs();
    assert!(value <= high + slack, "{place}");
    assert!(low - slack <= value || stated.name == "drive match", "{place}");
}

#[test]
fn an_unmeasured_plate_has_no_intervals() {
    let report = report("al-bending", 0.24);
    assert_eq!((report.boundary_tolerance_m, report.level_tolerance_db, report.known()), (None, None, None));
    assert!(report.lights.iter().all(|light| light.low.is_none() && light.high.is_none()));
}

#[test]
fn a_boundary_is_known_as_well_as_the_speed_that_would_move_it() {
    let halves = Halves { speed: 2e-3, ..NOTHING };
    for name in ["membrane", "al-bending"] {
        let plate = calibrated(preset(name).expect("a preset").spec().clone(), halves, Some(0.4));
        let frequency_hz = plate.frequency_for_boundary_hz(0.2);
        let faster =
            plate.with_wave_speed(1.002).expect("near").turning_point_m(frequency_hz).expect("enters");
        let known_m = plate.boundary_tolerance_m(0.2).expect("calibrated");
        assert!((known_m / (0.2 - faster) - 1.0).abs() < 0.01, "{name}: {known_m} {faster}");
        let report = at(&plate, 0.2);
        assert_eq!(report.boundary_tolerance_m, Some(known_m));
        let words = report.known().expect("calibrated");
        assert!(words.contains("±") && words.ends_with("the level of the peak to ±0.40 dB"), "{words}");
    }
}

#[test]
fn what_was_measured_of_the_level_decides_sensitivity_and_sound() {
    let spec = preset("membrane").expect("a preset").spec().clone();
    let halves = Halves { speed: 1e-3, loss: 0.1, ..NOTHING };
    let of = |level_db: Option<f64>| at(&calibrated(spec.clone(), halves, level_db), 0.2);
    for (level_db, wanted) in [(0.4, Colour::Green), (1.5, Colour::Amber), (7.0, Colour::Red)] {
        let report = of(Some(level_db));
        let sensitivity = light(&report, "sensitivity");
        assert_eq!((sensitivity.value, sensitivity.colour), (Some(level_db), wanted), "{sensitivity:?}");
        let sound = light(&report, "sound level");
        let value = sound.value.expect("a number");
        assert_eq!((sound.low, sound.high), (Some((value - level_db).max(0.0)), Some(value + level_db)));
    }
    // Without levels, speed and loss decide: by the 2-D solver twice the loss changes the level by 3 dB here.
    let open = of(None);
    let open_db = light(&open, "sensitivity").value.expect("a number");
    assert!((0.05..0.6).contains(&open_db), "{open_db}");
    let wide = Halves { loss: 1.0, ..halves };
    let wide = at(&calibrated(spec.clone(), wide, None), 0.2);
    assert!(light(&wide, "sensitivity").value.expect("a number") > 2.0 * open_db);
    // A drift of 1 % in wave speed makes the table of a resonator useless, however well it was measured.
    let still = preset("al-bending-displacement").expect("a preset").spec().clone();
    let report = at(&calibrated(still, halves, Some(0.3)), 0.24);
    let sensitivity = light(&report, "sensitivity");
    assert_eq!(sensitivity.colour, Colour::Amber, "{sensitivity:?}");
    assert!(sensitivity.sentence.contains("drifts by 1 %"), "{sensitivity:?}");
}

#[test]
fn a_drive_matches_only_if_it_does_over_the_whole_interval_of_its_source() {
    let mut spec =
        calibrated(preset("membrane").expect("a preset").spec().clone(), NOTHING, None).spec().clone();
    let frequency_hz = Plate::new(spec.clone()).expect("valid").frequency_for_boundary_hz(0.2);
    let wave =
        Plate::new(spec.clone()).expect("valid").wave_impedance_n_s_per_m(frequency_hz).expect("stated");
    let impedance = Impedance::damper(1.2 * wave);
    let source = Source { impedance, ..Source::soft(&spec.model, frequency_hz) };
    spec.drive_end = DriveEnd::Source(source);
    let mut with = |share: f64| {
        let half = Impedance {
            resistance_n_s_per_m: share * wave,
            mass_kg: 0.05 * wave / frequency_hz,
            stiffness_n_per_m: 0.0,
        };
        if let Some(calibration) = &mut spec.calibration {
            calibration.source_tolerance = Some(half);
        }
        light(&at(&Plate::new(spec.clone()).expect("valid"), 0.2), "drive match").clone()
    };
    let (known, unknown) = (with(0.02), with(0.4));
    assert_eq!((known.colour, unknown.colour), (Colour::Green, Colour::Amber), "{known:?} {unknown:?}");
    assert!(known.sentence.contains("the drive's resistance to ±"), "{known:?}");
    // (1.6 - 1)/(1.6 + 1), plus a small part by the mass.
    assert!((unknown.high.expect("an interval") - 0.23).abs() < 0.05, "{unknown:?}");
    // For every source within the interval the reflection is at most the highest at the corners.
    let mut random = Random::new(3);
    for _ in 0..200 {
        let resistance_n_s_per_m = wave * random.within(0.8, 1.6);
        let mass_kg = 0.05 * wave / frequency_hz * random.within(0.0, 1.0);
        let impedance = Impedance { resistance_n_s_per_m, mass_kg, stiffness_n_per_m: 0.0 };
        let plate = Plate::new(spec.clone())
            .expect("valid")
            .with_drive_end(DriveEnd::Source(Source { impedance, ..source }));
        let share = crate::reflection(&plate, frequency_hz).expect("enters").norm();
        assert!(share <= unknown.high.expect("an interval") + 1e-3, "{impedance:?} {share}");
    }
}

#[test]
fn an_interval_that_reaches_beyond_any_plate_is_not_green() {
    let halves = Halves { taper: 1.0, ..NOTHING };
    let plate = calibrated(preset("membrane").expect("a preset").spec().clone(), halves, Some(0.1));
    let report = at(&plate, 0.2);
    let slope = light(&report, "edge slope");
    assert!(slope.colour > Colour::Green && slope.sentence.contains("interval"), "{slope:?}");
}
