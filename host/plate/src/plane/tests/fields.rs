//! Fields against exact solutions in a wedge, the golden values of the physics page, and finer divisions.

use super::super::discrete::{Discrete, Resolution};
use super::super::field::{RESOLUTION, far_end};
use super::super::outline::{Outline, ROUNDING};
use super::super::section::Section;
use super::super::strip::{sheet, wave_impedance};
use super::super::system::amplitudes;
use super::super::*;
use super::{aluminium, with_tension};
use crate::{
    Complex64, EndSlope as Slope, Equation, Film, Finger, Impedance, LeadIn, Model, Plate, RespondError,
    Taper, TurningWidth, preset, respond as one_mode,
};
use nalgebra::{DMatrix, DVector};

/// Bessel function J (`sign` -1) or I (`sign` 1) of the integer order `order`, by its power series.
pub(super) fn bessel(order: i32, z: Complex64, sign: f64) -> Complex64 {
    let half = 0.5 * z;
    let mut term: Complex64 = (1..=order).map(|n| half / f64::from(n)).product();
    let mut sum = term;
    for n in 1..60 {
        term *= half * half * sign / f64::from(n * (n + order));
        sum += term;
    }
    sum
}

/// On a linear taper the edges are the rays of a wedge of 2 x 15 degrees, for which w = J_6(K r) cos 6 theta (and I_6
/// in bending) is exact: the deflection at some places determines that at the others.
#[test]
fn on_a_linear_taper_the_field_matches_the_wedge() {
    let slope = (std::f64::consts::PI / 12.0).tan();
    let tip_m = 0.05 / slope;
    for bends in [false, true] {
        let mut spec =
            if bends { aluminium(false, 0.02) } else { preset("membrane").unwrap() }.spec().clone();
        spec.taper = Taper::Linear { half_width_m: 0.05, end_half_width_m: 0.05 - 0.15 * slope };
        (spec.length_m, spec.span_start_m, spec.span_end_m) = (0.15, 0.05, 0.1);
        let plate = Plate::new(spec).unwrap();
        let frequency_hz = plate.frequency_for_boundary_hz(0.09);
        let wavenumber = plate.spec().model.wavenumber_squared(std::f64::consts::TAU * frequency_hz).sqrt();
        let wavenumber = Complex64::new(1.0, plate.wave_loss()).sqrt() * wavenumber;
        let field = Field::solve(&plate, frequency_hz, &Setup::of(&plate)).unwrap();
        // The field at polar coordinates about the tip of the wedge.
        let at = |r: f64, theta: f64| field.at(tip_m - r * theta.cos(), r * theta.sin());
        let basis = |r: f64, theta: f64| -> Vec<Complex64> {
            let angular = (6.0 * theta).cos();
            let j = bessel(6, wavenumber * r, -1.0) * angular;
            if bends { vec![j, bessel(6, wavenumber * r, 1.0) * angular] } else { vec![j] }
        };
        let fitted: Vec<f64> = if bends { vec![0.1, 0.06] } else { vec![0.1] };
        let rows =
            DMatrix::from_fn(fitted.len(), fitted.len(), |row, column| basis(fitted[row], 0.0)[column]);
        let right = DVector::from_fn(fitted.len(), |row, _| at(fitted[row], 0.0));
        let shares = rows.lu().solve(&right).unwrap();
        for (r, theta) in [(0.11, 0.0), (0.09, 0.1), (0.08, 0.2), (0.07, -0.15), (0.05, 0.05)] {
            let wanted: Complex64 = basis(r, theta).iter().zip(&shares).map(|(f, share)| f * share).sum();
            let error = (at(r, theta) - wanted).norm() / at(0.1, 0.0).norm();
            assert!(error < 3e-4, "bends {bends} r {r} theta {theta}: {error:e}");
        }
    }
}

#[test]
fn the_clamped_taper_peaks_at_180_7_mm_where_the_width_mode_says_180_5() {
    let plate = aluminium(true, 0.002);
    let adiabatic = plate.with_turning_width(TurningWidth::Plain).airy_peak_m(40e3).unwrap();
    let peak = respond(&plate, 40e3, 1001, &Setup::of(&plate)).unwrap().peak.unwrap();
    assert!((adiabatic - 0.1805).abs() < 1e-4, "{adiabatic}");
    assert!((peak.position_m - 0.1807).abs() < 1e-4, "{}", peak.position_m);
}

/// |amplitude| of a width mode at 2001 uniform places, where the driven end moves in the shape of a width mode with the
/// amplitude 1: `modes` are the numbers of the one that is driven and of the one that is asked for.
fn along(plate: &Plate, frequency_hz: f64, modes: [u32; 2]) -> Vec<f64> {
    let outline = Outline::of(&plate.edges, 0.0, RESOLUTION.rounding);
    let setup = Setup { end: End::Displacement(Slope::Free), ..Setup::of(plate) };
    let end_m = far_end(plate, frequency_hz);
    let mut discrete = Discrete::new(plate, frequency_hz, &setup, outline, end_m, RESOLUTION).unwrap();
    let (edges, energy, _) = sheet(plate, frequency_hz);
    let [driven, asked] = modes.map(|mode| {
        let number = plate.spec().model.width_number(mode);
        Section::new(edges, energy, discrete.section.orders, [number; 2])
    });
    discrete.section = driven;
    let unknowns = discrete.solve().unwrap();
    let amplitude = |x: f64| -> f64 {
        let shares = amplitudes(&discrete.section, &discrete.mesh, &unknowns, x);
        shares.iter().zip(&asked.projection).map(|(share, form)| share * form).sum::<Complex64>().norm()
    };
    (0..2001).map(|i| amplitude(plate.length_m() * f64::from(i) / 2000.0)).collect()
}

fn top(along: &[f64]) -> f64 {
    along.iter().copied().fold(0.0, f64::max)
}

#[test]
fn the_third_width_mode_dies_out_before_the_first() {
    let plate = preset("al-sh").unwrap();
    let frequency_hz = plate.frequency_for_boundary_hz(0.45);
    // Where a mode that is driven in its own shape last has 0.3 of its largest amplitude.
    let [first_m, third_m] = [1, 3].map(|mode| {
        let along = along(&plate, frequency_hz, [mode, mode]);
        let last = along.iter().rposition(|&amplitude| amplitude > 0.3 * top(&along)).expect("it moves");
        plate.length_m() * last as f64 / 2000.0
    });
    let ghost_m = plate.ghost_boundary_m(frequency_hz, 3).expect("the third mode enters");
    assert!((first_m - third_m - (0.45 - ghost_m)).abs() < 0.05, "{first_m} {third_m}");
}

#[test]
fn two_dimensions_confirm_the_gain_of_the_one_mode_equation_and_not_the_papers() {
    // SH waves: bending has a near field at the driven end. The plain width: the arc moves the resonances of this end, and
    // with them the gain near them, by 1 %.
    let bending = aluminium(false, 0.002).with_turning_width(TurningWidth::Plain);
    let mut spec = bending.spec().clone();
    spec.turning_width = TurningWidth::Plain;
    spec.model = preset("al-sh").unwrap().spec().model.clone();
    let plate = Plate::new(spec).unwrap();
    for bending_hz in [22e3, 31e3, 40e3] {
        let frequency_hz = plate.frequency_for_boundary_hz(bending.turning_point_m(bending_hz).unwrap());
        let of = |equation| {
            let field = one_mode(&plate, frequency_hz, 2001, equation).unwrap().amplitude;
            top(&field.iter().map(|f| f.norm()).collect::<Vec<f64>>())
        };
        let (one, paper) = (of(Equation::Corrected), of(Equation::Paper));
        let two = top(&along(&plate, frequency_hz, [1, 1]));
        assert!((two / one - 1.0).abs() < 0.005, "{frequency_hz}: {two} in two dimensions, {one} in one");
        assert!(paper / two < 0.65, "{frequency_hz}: {paper} by the paper's equation, {two}");
    }
}

#[test]
fn a_drive_of_the_first_shape_leaves_the_higher_modes_faint() {
    let plate = preset("membrane").unwrap();
    let [first, third] = [1, 3].map(|mode| top(&along(&plate, 150.0, [1, mode])));
    assert!(third < 0.1 * first, "{third}");
    assert!(third > 1e-4 * first, "they are coupled: {third}");
}

#[test]
fn membranes_peak_a_little_nearer_to_the_drive_than_the_one_mode_equation_says_straight_across() {
    let plate = preset("membrane").unwrap().with_turning_width(TurningWidth::Plain);
    for (boundary_m, shift_m) in [(0.08, -1.6e-3), (0.28, -0.3e-3)] {
        let frequency_hz = plate.frequency_for_boundary_hz(boundary_m);
        let one = one_mode(&plate, frequency_hz, 801, Equation::Corrected).unwrap();
        let two = respond(&plate, frequency_hz, 801, &Setup::of(&plate)).unwrap();
        let differs = Comparison::of(&one, &two);
        assert!((differs.peak_shift_m.unwrap() - shift_m).abs() < 1e-4, "{boundary_m}: {differs:?}");
        assert!(differs.level_db.unwrap().abs() < 0.3, "{differs:?}");
        assert_eq!(differs.nodes[0], differs.nodes[1]);
    }
}

/// A soft source with a damped lead-in that matches the aluminium plate over the band.
fn matched(plate: &Plate, frequency_hz: f64) -> Setup {
    let end_resistance_n_s_per_m = 0.37 * wave_impedance(plate, frequency_hz);
    Setup {
        end: End::Source {
            impedance: Impedance::default(),
            force: Force::OfWave { multiple: 2.0, at_frequency_hz: frequency_hz },
            slope: Slope::Free,
        },
        lead_in: Some(LeadIn { length_m: 0.06, loss_factor: 0.2, end_resistance_n_s_per_m }),
        ..Setup::of(plate)
    }
}

/// Polyester of 50 um in place of the membrane.
fn polyester() -> Plate {
    let mut spec = preset("membrane").unwrap().spec().clone();
    let film = Film { youngs_modulus_pa: 4.5e9, poisson_ratio: 0.38, thickness_m: 50e-6 };
    spec.model =
        Model::Membrane { wave_speed_m_per_s: 12.0, tension_n_per_m: Some(10.008), film: Some(film) };
    Plate::new(spec).unwrap()
}

fn touched(setup: Setup, place_m: f64, resistance_n_s_per_m: f64, mass_kg: f64) -> Setup {
    Setup { finger: Some(Finger { resistance_n_s_per_m, mass_kg, ..Finger::light(place_m) }), ..setup }
}

#[test]
fn a_finger_at_the_peak_takes_what_the_physics_page_says() {
    let db = |field: &Field, place_m: f64, free: f64| 20.0 * (field.at(place_m, 0.0).norm() / free).log10();
    let loose = preset("membrane").unwrap();
    let frequency_hz = loose.frequency_for_boundary_hz(0.16);
    for (tension, resistance, mass_kg, page) in [(40.0, 0.1, 1e-5, -8.8), (400.0, 1.0, 1e-4, -8.8)] {
        let membrane = with_tension(&loose, tension);
        let setup = Setup::of(&membrane);
        let free = respond(&membrane, frequency_hz, 801, &setup).unwrap().peak.unwrap();
        let setup = touched(setup, free.position_m, resistance, mass_kg);
        let field = Field::solve(&membrane, frequency_hz, &setup).unwrap();
        let level = db(&field, free.position_m, free.amplitude);
        assert!((level - page).abs() < 0.3, "{tension}: {level} {page}");
    }
    let plate = preset("al-bending").unwrap();
    let setup = matched(&plate, 28e3);
    let free = respond(&plate, 28e3, 801, &setup).unwrap().peak.unwrap();
    for (resistance, mass_kg, most, least) in [(1.0, 0.0, -0.3, -2.0), (1.0, 1e-3, -13.0, -15.0)] {
        let setup = touched(setup, free.position_m, resistance, mass_kg);
        let field = Field::solve(&plate, 28e3, &setup).unwrap();
        let level = db(&field, free.position_m, free.amplitude);
        assert!((least..=most).contains(&level), "{resistance} {mass_kg}: {level}");
    }
}

#[test]
fn the_field_does_not_depend_on_the_resolution_or_on_the_radius_of_a_corner() {
    let peak = |plate: &Plate, frequency_hz: f64, setup: &Setup, resolution| {
        let field = Field::solve_with(plate, frequency_hz, setup, resolution).unwrap();
        field.centre_line(801).unwrap().peak.unwrap()
    };
    let standard =
        Resolution { elements_per_wavelength: 12.0, extra_orders: 0, rounding: ROUNDING, panels: 1.0 };
    let fine = Resolution { elements_per_wavelength: 24.0, extra_orders: 3, ..standard };
    let sharp = Resolution { rounding: 0.25 * ROUNDING, ..fine };
    let (supported, clamped) = (aluminium(false, 0.002), aluminium(true, 0.002));
    let with_lead_in = matched(&supported, 28e3);
    let membrane = with_tension(&preset("membrane").unwrap(), 400.0);
    let on_membrane = Setup::of(&membrane);
    let film = polyester();
    for (plate, frequency_hz, setup, finer, most_db) in [
        (&supported, 28e3, with_lead_in, fine, 0.01),
        (&supported, 28e3, with_lead_in, sharp, 0.02),
        (&supported, 28e3, touched(with_lead_in, 0.2, 2.0, 1e-4), fine, 0.02),
        (&clamped, 38e3, Setup::of(&clamped), fine, 0.02),
        (&membrane, 151.0, touched(on_membrane, 0.1, 1.0, 1e-4), fine, 0.05),
        (&film, 194.7, Setup::of(&film), fine, 0.02),
    ] {
        let (coarse, fine) =
            (peak(plate, frequency_hz, &setup, standard), peak(plate, frequency_hz, &setup, finer));
        let level_db = 20.0 * (coarse.amplitude / fine.amplitude).log10();
        assert!((coarse.position_m - fine.position_m).abs() < 1e-5, "{coarse:?} {fine:?}");
        assert!(level_db.abs() < most_db, "{level_db} dB: {coarse:?} {fine:?}");
    }
}

#[test]
fn a_held_end_is_held_in_deflection_and_slope() {
    for clamped in [false, true] {
        let plate = aluminium(clamped, 0.002);
        let step = 1e-5;
        // Three-point difference: its error is a third of step^2 times the third derivative.
        let slope_at = |setup: &Setup, z: f64| {
            let field = Field::solve(&plate, 28e3, setup).unwrap();
            let w = |steps: f64| field.at(steps * step, z);
            ((4.0 * w(1.0) - 3.0 * w(0.0) - w(2.0)) / (2.0 * step), w(0.0))
        };
        let setup = |end| Setup { end, ..Setup::of(&plate) };
        let held = setup(End::Displacement(Slope::Held));
        let guide = End::Source {
            impedance: Impedance { resistance_n_s_per_m: 100.0, ..Impedance::default() },
            force: Force::Constant(1e3),
            slope: Slope::Held,
        };
        let (hinged_slope, _) = slope_at(&setup(End::Displacement(Slope::Free)), 0.01);
        assert!(hinged_slope.norm() > 10.0, "{hinged_slope}");
        let (slope, deflection) = slope_at(&held, 0.0);
        assert!((deflection - 1.0).norm() < 1e-5, "{deflection}");
        assert!(slope.norm() < 0.5, "{slope}");
        for end in [held, setup(guide)] {
            let (slope, deflection) = slope_at(&end, 0.01);
            assert!(slope.norm() < 0.5 * deflection.norm(), "{slope} {deflection}");
        }
    }
}

#[test]
fn a_field_is_zero_beside_the_plate_and_reaches_into_the_lead_in() {
    let plate = aluminium(false, 0.002);
    let field = Field::solve(&plate, 28e3, &matched(&plate, 28e3)).unwrap();
    let zero = Complex64::ZERO;
    assert!(field.at(-0.05, 0.0).norm() > 0.01 && field.at(0.1, -0.012).norm() > 0.01);
    assert_eq!(
        [(-0.0601, 0.0), (0.1, 0.013), (0.341, 0.0), (f64::NAN, 0.0)].map(|(x, z)| field.at(x, z)),
        [zero; 4]
    );
    assert!(field.at(0.339, 0.0).norm() < 1e-3);
    assert!((field.at(0.1, 0.007) - field.at(0.1, -0.007)).norm() < 1e-12);
}

#[test]
fn every_preset_has_a_field_over_its_band() {
    for preset in crate::presets() {
        let plate = preset.plate().unwrap();
        let (low, high) = plate.band_hz();
        for frequency_hz in [plate.cut_off_hz() * 1.0001, low, (low * high).sqrt(), high] {
            let line = respond(&plate, frequency_hz, 101, &Setup::of(&plate)).unwrap();
            let is_finite = line.amplitude.iter().all(|f| f.is_finite());
            assert!(is_finite && line.amplitude[0].norm() > 0.0, "{} {frequency_hz}", preset.name);
        }
    }
}

#[test]
fn what_cannot_be_solved_is_refused_by_its_field() {
    let (membrane, plate) = (preset("membrane").unwrap(), aluminium(false, 0.002));
    let told = |plate: &Plate, frequency_hz: f64, setup: &Setup| {
        let error = Field::solve(plate, frequency_hz, setup).unwrap_err();
        assert_eq!(
            reflection(plate, frequency_hz, &Setup { finger: None, ..*setup }).is_err(),
            setup.finger.is_none()
        );
        error.to_string()
    };
    let base = Setup::of(&plate);
    let source = |force| {
        let impedance = Impedance { mass_kg: -1.0, ..Impedance::default() };
        Setup { end: End::Source { impedance, force, slope: Slope::Free }, ..base }
    };
    assert_eq!(told(&plate, 28e3, &source(Force::Constant(1.0))), "mass_kg = -1 kg: must be 0 to 1000 kg");
    let lead_in = LeadIn { length_m: 0.06, loss_factor: 2.5, end_resistance_n_s_per_m: 0.0 };
    let with_lead_in = |lead_in| Setup { lead_in: Some(lead_in), ..base };
    assert_eq!(told(&plate, 28e3, &with_lead_in(lead_in)), "drive.lead_in.loss_factor = 2.5: must be 0 to 2");
    let lead_in = LeadIn { loss_factor: 0.1, ..lead_in };
    assert_eq!(
        told(&membrane, 150.0, &Setup { lead_in: Some(lead_in), ..Setup::of(&membrane) }),
        "drive.lead_in on a plate that is not in bending: must be absent"
    );
    let endless = LeadIn { length_m: f64::NAN, ..lead_in };
    assert_eq!(
        told(&plate, 28e3, &with_lead_in(endless)),
        "drive.lead_in.length_m = nan: must be 0.001 to 10 m"
    );
    let mut spec = membrane.spec().clone();
    spec.model = Model::Membrane { wave_speed_m_per_s: 12.0, tension_n_per_m: None, film: None };
    let untold = Plate::new(spec).unwrap();
    assert_eq!(
        told(&untold, 150.0, &touched(Setup::of(&untold), 0.1, 1.0, 0.0)),
        "model.tension_n_per_m is missing: a finger needs it: the force per metre of width, in N/m"
    );
    assert_eq!(
        told(&plate, 28e3, &touched(base, 0.5, 1.0, 0.0)),
        "finger place = 0.5 m: must be 0 to 0.34 m"
    );
    let damper = Setup { end: End::Damper { ratio: 1.0, at_frequency_hz: 100.0 }, ..base };
    assert!(told(&plate, 28e3, &damper).starts_with("at_frequency_hz = 100 Hz: must be "));
    assert!(matches!(
        Field::solve(&plate, 100.0, &base),
        Err(PlaneError::Respond(RespondError::CannotEnter { .. }))
    ));
    assert!(matches!(respond(&plate, 28e3, 3, &base), Err(PlaneError::Respond(RespondError::OutOfRange(_)))));

    let mut spec = membrane.spec().clone();
    spec.model = Model::Membrane { wave_speed_m_per_s: 200.0, tension_n_per_m: None, film: None };
    (spec.taper, spec.length_m) = (Taper::Exponential { half_width_m: 10.0, rate_per_m: 0.4 }, 10.0);
    (spec.span_start_m, spec.span_end_m) = (1.0, 9.0);
    spec.drive_end = crate::DriveEnd::Displacement;
    let huge = Plate::new(spec).unwrap();
    let highest = crate::respond_range(&huge).high;
    let error = Field::solve(&huge, highest, &Setup::of(&huge)).unwrap_err();
    assert!(matches!(error, PlaneError::TooFine { .. }), "{error}");
}
