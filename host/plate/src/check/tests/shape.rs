//! Edge slope and curvature, wavelengths, edge width and ghost boundaries, against numbers worked out by hand.

use super::{light, report, value};
use crate::check::lights::shape::{edge_curvature, edge_slope};
use crate::check::{Checker, Colour, Conditions};
use crate::{DriveEnd, Model, Plate, Taper, TurningWidth, preset};

#[test]
fn a_half_width_of_100_mm_is_not_a_small_slope() {
    // d W0 = 4.62 x 0.1 = 0.462 and d^2 W0^2 = 0.213.
    let mut spec = preset("membrane").expect("preset").spec().clone();
    spec.taper = Taper::Exponential { half_width_m: 0.1, rate_per_m: 4.62 };
    spec.drive_end = DriveEnd::Displacement;
    let plate = Plate::new(spec).expect("plate");
    let report = Checker::new(&plate, Conditions::default()).expect("checks").at(0.16).expect("on it");
    // At the boundary the slope is d W: 0.462 e^(-4.62 x 0.16).
    let at = |x: f64| 0.462 * (-4.62_f64 * x).exp();
    assert!((value(&report, "edge slope") - at(0.16)).abs() < 1e-9);
    assert!((value(&report, "edge curvature") - 0.213_444).abs() < 1e-9);
    assert_eq!(light(&report, "edge slope").colour, Colour::Green);
    assert_eq!(light(&report, "edge curvature").colour, Colour::Amber);
    // Straight across, 0.319 at 80 mm gives W'^2/3 = 3.4 % of the width; along the arc at most a third of that
    // remains.
    let slope_light = |plate: &Plate, x: f64| {
        let report = Checker::new(plate, Conditions::default()).expect("checks").at(x).expect("on it");
        let light = light(&report, "edge slope");
        (light.colour, light.sentence.clone())
    };
    let (colour, said) = slope_light(&plate, 0.08);
    assert_eq!(colour, Colour::Green);
    assert!(said.contains("along the arc, holds to 1.1 %"), "{said}");
    let (colour, said) = slope_light(&plate.with_turning_width(TurningWidth::Plain), 0.08);
    assert_eq!(colour, Colour::Amber);
    assert!(said.contains("straight across, may be off by 3 %"), "{said}");
    // W0 = 200 mm, d W0 = 0.92: at 100 mm 0.58, at 20 mm 0.84.
    let steep = preset("al-sh").expect("preset");
    assert_eq!(slope_light(&steep, 0.1).0, Colour::Amber);
    assert_eq!(slope_light(&steep, 0.02).0, Colour::Red);
    assert_eq!(slope_light(&steep.with_turning_width(TurningWidth::Plain), 0.1).0, Colour::Red);
    // Clamped edges have the limits of the plain width: 0.3 at the drive of a linear taper.
    let mut spec = preset("al-bending-displacement").expect("preset").spec().clone();
    spec.taper = Taper::Linear { half_width_m: 0.06, end_half_width_m: 0.06 - 0.3 * 0.18 };
    (spec.length_m, spec.span_start_m, spec.span_end_m) = (0.18, 0.05, 0.15);
    assert_eq!(slope_light(&Plate::new(spec.clone()).expect("valid"), 0.1).0, Colour::Green);
    spec.model = Model::BendingClamped(spec.model.bending().expect("bending").clone());
    assert_eq!(slope_light(&Plate::new(spec).expect("valid"), 0.1).0, Colour::Amber);
}

#[test]
fn the_slope_of_a_linear_taper_is_the_same_everywhere_and_its_edges_do_not_bend() {
    let mut spec = preset("membrane").expect("preset").spec().clone();
    spec.taper = Taper::Linear { half_width_m: 0.05, end_half_width_m: 0.01 };
    spec.drive_end = DriveEnd::Displacement;
    let plate = Plate::new(spec).expect("plate");
    assert!((edge_slope(&plate, 0.2) - 0.04 / 0.32).abs() < 1e-12);
    assert!(edge_curvature(&plate, 0.2) < 1e-12);
}

#[test]
fn a_boundary_too_near_the_drive_has_no_room_for_a_peak() {
    let report = report("membrane", 0.02);
    assert_eq!(light(&report, "wavelengths").colour, Colour::Red);
    assert_eq!(light(&report, "peak").colour, Colour::Red);
    assert_eq!(report.worst(), Colour::Red);
}

#[test]
fn edge_widths_are_counted_in_fingertips() {
    // Aluminium in bending at 40 kHz: 2.729/kappa = 30.1 mm (29.8 mm exactly); membrane at 87 Hz: 102 mm.
    let forty = report("al-bending", 1.2861 / 4.62);
    assert!((value(&forty, "edge width") - 3.01).abs() < 0.01, "{}", value(&forty, "edge width"));
    assert_eq!(light(&forty, "edge width").colour, Colour::Green);
    let membrane = report("membrane", 0.08);
    assert!((value(&membrane, "edge width") - 10.2).abs() < 0.1, "{}", value(&membrane, "edge width"));
    assert_eq!(light(&membrane, "edge width").colour, Colour::Amber);
}

#[test]
fn ghosts_lie_ln_m_over_d_before_the_boundary_and_an_off_centre_drive_lets_the_second_in() {
    let plate = preset("al-bending").expect("preset").with_turning_width(TurningWidth::Plain);
    let centred = Checker::new(&plate, Conditions::default()).expect("checks");
    // ln 3/d = 237.8 mm.
    assert_eq!(light(&centred.at(0.23).expect("on it"), "ghost boundaries").colour, Colour::Green);
    let report = centred.at(0.27).expect("on it");
    assert_eq!(light(&report, "ghost boundaries").colour, Colour::Amber);
    assert!((value(&report, "ghost boundaries") - (0.27 - 3.0_f64.ln() / 4.62)).abs() < 1e-6);
    let off = Conditions { off_centre: true, ..Conditions::default() };
    let report = Checker::new(&plate, off).expect("checks").at(0.2).expect("on it");
    assert_eq!(light(&report, "ghost boundaries").colour, Colour::Red);
    assert!((value(&report, "ghost boundaries") - (0.2 - 2.0_f64.ln() / 4.62)).abs() < 1e-6);
}
