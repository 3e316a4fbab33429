//! The turning point along the arc that meets both edges at right angles, against two-dimensional solutions.

use slipline_plate::{
    DriveEnd, Equation, Model, Plate, PlateSpec, Taper, TurningWidth, plane, preset, respond,
};

fn variation(name: &str, change: impl FnOnce(&mut PlateSpec)) -> Plate {
    let mut spec = preset(name).expect("a preset").spec().clone();
    (spec.drive_end, spec.turning_width) = (DriveEnd::Displacement, TurningWidth::Arc);
    change(&mut spec);
    Plate::new(spec).expect("a valid variation")
}

fn peak_mm(plate: &Plate, frequency_hz: f64) -> f64 {
    let response = respond(plate, frequency_hz, 2001, Equation::Corrected).expect("enters");
    response.peak.expect("a peak").position_m * 1e3
}

#[test]
fn the_arc_puts_the_peak_at_least_three_times_nearer_to_the_two_dimensional_one() {
    // Peak on the centre line, mm: plain, arc, in two dimensions.
    let table = [
        ("membrane", 87.0, [42.82, 41.40, 41.37]),
        ("membrane", 110.0, [98.92, 98.04, 97.99]),
        ("membrane", 219.0, [259.59, 259.37, 259.37]),
        ("al-sh", 8e3, [83.37, 70.97, 72.14]),
        ("al-sh", 20e3, [314.55, 312.74, 312.59]),
        ("paper-as-printed", 10e3, [243.08, 235.35, 234.10]),
        ("paper-as-printed", 20e3, [416.16, 414.34, 414.19]),
    ];
    for (name, frequency_hz, wanted) in table {
        let arc = variation(name, |_| {});
        let plain = arc.with_turning_width(TurningWidth::Plain);
        let truth = plane::respond(&arc, frequency_hz, 2001, &plane::Setup::of(&arc)).expect("enters");
        let two = truth.peak.expect("a peak").position_m * 1e3;
        let found = [peak_mm(&plain, frequency_hz), peak_mm(&arc, frequency_hz), two];
        let off = |of: f64| (of - two).abs();
        assert!(off(found[0]) > 3.0 * off(found[1]), "{name} {frequency_hz}: {found:.2?}");
        for (found, wanted) in found.iter().zip(wanted) {
            assert!((found - wanted).abs() < 0.02, "{name} {frequency_hz}: {found:.2?} for {wanted:.2?}");
        }
    }
}

#[test]
fn between_straight_edges_the_peak_is_the_first_one_of_the_exact_bessel_function() {
    // Edges at +-alpha to the centre line: f = J_nu(K r), nu = pi/(2 alpha), r from their intersection. Its first
    // maximum is at j' = nu + 0.8086165 nu^(1/3) + 0.0724902 nu^(-1/3) - 0.0509702/nu
    // + 0.0093594 nu^(-5/3) (DLMF 10.21.40).
    let plate = variation("membrane", |spec| {
        spec.taper = Taper::Linear { half_width_m: 0.06, end_half_width_m: 0.004 };
        (spec.loss_factor, spec.span_start_m) = (0.0, 0.05);
    });
    let slope = 0.056 / plate.length_m();
    let order = std::f64::consts::FRAC_PI_2 / slope.atan();
    let (tip_m, root) = (0.06 / slope, order.cbrt());
    let maximum = order + 0.808_616_5 * root + 0.072_490_2 / root - 0.050_970_2 / order
        + 0.009_359_4 / (root * root * order);
    for frequency_hz in [70.0, 100.0, 160.0] {
        let wavenumber = std::f64::consts::TAU * frequency_hz / 12.0;
        let wanted_mm = (tip_m - maximum / wavenumber) * 1e3;
        let found_mm = peak_mm(&plate, frequency_hz);
        assert!((found_mm - wanted_mm).abs() < 0.01, "{frequency_hz}: {found_mm} for {wanted_mm}");
        let plain_mm = peak_mm(&plate.with_turning_width(TurningWidth::Plain), frequency_hz);
        assert!(plain_mm - wanted_mm > 1.0, "{frequency_hz}: {plain_mm} straight across");
        let turning_m = plate.turning_point_m(frequency_hz).expect("enters");
        assert!((wavenumber * (tip_m - turning_m) - order).abs() < 1e-9 * order, "{turning_m}");
    }
}

#[test]
fn every_taper_gives_one_frequency_to_each_place_and_back() {
    let wavy = |depth: f64| Taper::Sampled {
        points: (0..=64)
            .map(|i| [0.005 * f64::from(i), 0.05 - 6e-4 * f64::from(i) - depth * f64::from(i % 2)])
            .collect(),
    };
    for taper in [
        Taper::Exponential { half_width_m: 0.05, rate_per_m: 4.62 },
        Taper::Exponential { half_width_m: 2.0, rate_per_m: 20.0 },
        Taper::Linear { half_width_m: 0.3, end_half_width_m: 0.001 },
        wavy(0.0),
        wavy(5e-5),
    ] {
        let plate = variation("membrane", |spec| spec.taper = taper.clone());
        for place_m in (1..64).map(|i| 0.005 * f64::from(i)) {
            let frequency_hz = plate.frequency_for_boundary_hz(place_m);
            let back_m = plate.turning_point_m(frequency_hz).expect("enters");
            assert!((back_m - place_m).abs() < 1e-9, "{taper:?} {place_m}: {back_m}");
            assert!(plate.kappa_per_m(frequency_hz).expect("enters") > 0.0, "{taper:?} {place_m}");
        }
    }
    // Points with so much noise that the arc would grow in places: no two frequencies may turn in the wrong order.
    let noisy = variation("membrane", |spec| spec.taper = wavy(5.9e-4));
    let mut before = 0.0;
    for place_m in (1..640).map(|i| 0.0005 * f64::from(i)) {
        let frequency_hz = noisy.frequency_for_boundary_hz(place_m);
        assert!(frequency_hz > before, "{place_m}: {frequency_hz} after {before}");
        before = frequency_hz;
        assert!(noisy.kappa_per_m(frequency_hz).expect("enters") > 0.0, "{place_m}");
        assert!(
            noisy.turning_half_width_m(place_m) < noisy.half_width_m(place_m) * (1.0 + 1e-9),
            "{place_m}"
        );
    }
}

/// Aluminium, 2 mm, in bending, with this taper of 300 mm.
fn bending(is_clamped: bool, taper: Taper, poisson_ratio: f64) -> Plate {
    variation("al-bending", |spec| {
        let mut bending = spec.model.bending().expect("bending").clone();
        bending.poisson_ratio = poisson_ratio;
        spec.model =
            if is_clamped { Model::BendingClamped(bending) } else { Model::BendingSupported(bending) };
        (spec.taper, spec.length_m, spec.loss_factor) = (taper, 0.3, 0.02);
        (spec.wave_speed_tolerance, spec.drive_end) = (0.0, DriveEnd::Displacement);
        (spec.span_start_m, spec.span_end_m) = (0.1, 0.2);
    })
}

#[test]
fn in_bending_the_arc_and_the_term_of_bent_edges_put_the_peak_where_a_kirchhoff_plate_has_it() {
    let exponential = Taper::Exponential { half_width_m: 0.05, rate_per_m: 4.62 };
    let linear = Taper::Linear { half_width_m: 0.08, end_half_width_m: 0.008 };
    for (is_clamped, taper, poisson_ratio, better) in [
        (false, &exponential, 0.0, 3.0),
        (false, &exponential, 0.33, 3.0),
        (false, &linear, 0.33, 3.0),
        (true, &exponential, 0.33, 2.5),
        (true, &linear, 0.33, 2.5),
    ] {
        let arc = bending(is_clamped, taper.clone(), poisson_ratio);
        let plain = arc.with_turning_width(TurningWidth::Plain);
        for place_m in [0.15, 0.2] {
            let frequency_hz = arc.frequency_for_boundary_hz(place_m);
            let two = plane::respond(&arc, frequency_hz, 2001, &plane::Setup::of(&arc)).expect("enters");
            let two = two.peak.expect("a peak").position_m * 1e3;
            let off = [&plain, &arc].map(|plate| peak_mm(plate, frequency_hz) - two);
            assert!(
                off[0].abs() > better * off[1].abs(),
                "{is_clamped} {taper:?} {place_m}: {off:.3?} of {two:.2}"
            );
        }
    }
}

#[test]
fn the_papers_equation_has_the_papers_width_on_every_plate() {
    let arc = preset("membrane").expect("a preset");
    let plain = arc.with_turning_width(TurningWidth::Plain);
    assert_eq!(respond(&arc, 150.0, 101, Equation::Paper), respond(&plain, 150.0, 101, Equation::Paper));
    assert_ne!(
        respond(&arc, 150.0, 101, Equation::Corrected),
        respond(&plain, 150.0, 101, Equation::Corrected)
    );
}

/// Cells of the rows of the page's list of changed frequencies: plate, boundary in mm, plain, arc and 2-D in Hz.
fn changed_frequencies() -> Vec<(&'static str, [f64; 4])> {
    let page = include_str!("../PHYSICS.md");
    let (_, list) =
        page.split_once("| plate | boundary, mm | plain, Hz | arc, Hz | 2-D, Hz |\n").expect("the list");
    let rows = list.lines().skip(1).map_while(|line| line.strip_prefix("| ")?.strip_suffix(" |"));
    rows.map(|row| {
        let (name, numbers) = row.split_once(" | ").expect("cells");
        let numbers: Vec<f64> = numbers.split(" | ").map(|cell| cell.parse().expect(row)).collect();
        (name, numbers.try_into().expect(row))
    })
    .collect()
}

#[test]
fn every_changed_frequency_of_a_preset_is_listed_and_nearer_to_the_two_dimensional_one() {
    let listed = changed_frequencies();
    for preset in slipline_plate::presets() {
        let count = listed.iter().filter(|(name, _)| *name == preset.name).count();
        let plate = preset.plate().expect("a preset");
        // Two presets are younger than the change: that in air, and that with shot.
        let is_younger = plate.carries_air() || preset.name == "tungsten-membrane";
        let has_changed = plate.spec().turning_width == TurningWidth::Arc && !is_younger;
        assert_eq!(count >= 2, has_changed, "{}", preset.name);
    }
    for (name, [place_mm, wanted @ ..]) in listed {
        let arc = preset(name).expect("a preset");
        let place_m = place_mm * 1e-3;
        let plain_hz = arc.with_turning_width(TurningWidth::Plain).frequency_for_boundary_hz(place_m);
        let arc_hz = arc.frequency_for_boundary_hz(place_m);
        // The wave that turns at this place in two dimensions is the one with its peak where the one-mode equation
        // puts it. Its loss is low: loss does not move the turning point, but it moves the peak before it.
        let held = variation(name, |spec| spec.loss_factor = spec.loss_factor.min(0.01));
        let two = plane::respond(&held, arc_hz, 2001, &plane::Setup::of(&held)).expect("enters");
        let shift_m = two.peak.expect("a peak").position_m - 1e-3 * peak_mm(&held, arc_hz);
        let two_hz = arc.frequency_for_boundary_hz(place_m - shift_m);
        for (found, wanted) in [plain_hz, arc_hz, two_hz].iter().zip(wanted) {
            assert!((found / wanted - 1.0).abs() < 1.3e-4, "{name} {place_mm} mm: {found} for {wanted}");
        }
        assert!((plain_hz - two_hz).abs() > 3.0 * (arc_hz - two_hz).abs(), "{name} {place_mm} mm");
    }
}
