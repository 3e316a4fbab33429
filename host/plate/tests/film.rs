//! The stiffness of a film against the exact strip, an independent equation and a plate in two dimensions, and the
//! results that do not depend on it.

use crate::time_line::assert_answers_tones;
use slipline_plate::check::{Checker, Colour, Conditions, Light};
use slipline_plate::design::{DesignError, Material, Request, Wave, design};
use slipline_plate::{
    Air, AirMounting, Complex64, DriveEnd, DriveTable, Equation, Faces, Film, Gas, Impedance, Model, Plate,
    PlateSpec, Progress, Sheet, SheetError, SheetGrid, Source, TurningWidth, plane, preset, respond,
};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Polyester.
fn polyester(thickness_m: f64) -> Film {
    Film { youngs_modulus_pa: 4.5e9, poisson_ratio: 0.38, thickness_m }
}

/// s = sqrt(D/T), metres: how far from an edge a film bends.
fn edge_length_m(film: &Film, tension_n_per_m: f64) -> f64 {
    (film.stiffness_n_m() / tension_n_per_m).sqrt()
}

/// The specification of the preset `membrane` with its sheet replaced by `film` of this density, at the same wave
/// speed.
fn stretched(film: Film, density_kg_per_m3: f64) -> PlateSpec {
    let mut spec = preset("membrane").expect("a preset").spec().clone();
    let tension = density_kg_per_m3 * film.thickness_m * 12.0 * 12.0;
    spec.model =
        Model::Membrane { wave_speed_m_per_s: 12.0, tension_n_per_m: Some(tension), film: Some(film) };
    spec
}

fn plate() -> Plate {
    Plate::new(stretched(polyester(50e-6), 1390.0)).expect("a plate")
}

/// The zero of f between `low` and `high`, where f rises from below zero to above it.
fn root(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if f(middle) < 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// K of the cut-off of a clamped strip: a tan aW + b tanh bW = 0 with a = K and b^2 = K^2 + 1/s^2, times cos aW.
fn exact_cut_off(half_width_m: f64, edge_m: f64) -> f64 {
    let balance = |k: f64| {
        let b = k.hypot(edge_m.recip());
        k * (k * half_width_m).sin() + b * (b * half_width_m).tanh() * (k * half_width_m).cos()
    };
    root(FRAC_PI_2 / half_width_m, 2.37 / half_width_m, |k| -balance(k))
}

/// Frequency in Hz of this K, for a wave speed of 12 m/s.
fn frequency_hz(k: f64, edge_m: f64) -> f64 {
    12.0 * k * (1.0 + (edge_m * k).powi(2)).sqrt() / TAU
}

#[test]
fn cut_offs_match_the_exact_strip() {
    let mut spec = stretched(polyester(50e-6), 1390.0);
    spec.turning_width = TurningWidth::Plain;
    let plate = Plate::new(spec).expect("a plate");
    let edge_m = edge_length_m(&polyester(50e-6), 1390.0 * 50e-6 * 144.0);
    assert!((edge_m - 2.34e-3).abs() < 1e-5, "{edge_m}");
    // Ratio to the cut-off of the ideal membrane, at 80, 160 and 280 mm.
    for (x, ratio) in [(0.08, 1.0788), (0.16, 1.1218), (0.28, 1.2461)] {
        let half_width_m = plate.half_width_m(x);
        let exact = frequency_hz(exact_cut_off(half_width_m, edge_m), edge_m);
        let found = plate.frequency_for_boundary_hz(x);
        assert!((found / exact - 1.0).abs() < 1e-8, "{x}: {found} {exact}");
        let ideal = plate.without_film().frequency_for_boundary_hz(x);
        assert!((found / ideal - ratio).abs() < 1e-4, "{x}: {}", found / ideal);
        assert!((plate.turning_point_m(found).expect("enters") - x).abs() < 1e-9);
    }
}

/// k^2 of the exact strip at K: a tan aW + b tanh bW = 0 with a^2 = K^2 - k^2, b^2 = K^2 + k^2 + 1/s^2.
fn exact_square(axial: f64, half_width_m: f64, edge_m: f64) -> f64 {
    let balance = |square: f64| {
        let (a, b) = ((axial - square).sqrt(), (axial + square + edge_m.powi(-2)).sqrt());
        a * (a * half_width_m).sin() + b * (b * half_width_m).tanh() * (a * half_width_m).cos()
    };
    // aW is between pi/2 and 2.37.
    let square = |a: f64| axial - (a / half_width_m).powi(2);
    root(square(2.37), square(FRAC_PI_2), balance)
}

/// Golden numbers of PHYSICS.md, section 11, for each film: the edge length, the excess of its cut-offs over those of
/// the ideal membrane, and the shift of its turning points towards the drive, mm; then the errors of the law.
#[test]
fn the_table_of_films_matches_the_page() {
    let page = include_str!("../PHYSICS.md");
    for (name, film, density_kg_per_m3) in [
        ("polyester, 25 µm", polyester(25e-6), 1390.0),
        ("polyester, 50 µm", polyester(50e-6), 1390.0),
        ("polyester, 100 µm", polyester(100e-6), 1390.0),
        (
            "silicone rubber, 2.5 mm",
            Film { youngs_modulus_pa: 2e6, poisson_ratio: 0.49, thickness_m: 2.5e-3 },
            1100.0,
        ),
        (
            "latex, 0.25 mm",
            Film { youngs_modulus_pa: 1.5e6, poisson_ratio: 0.49, thickness_m: 0.25e-3 },
            950.0,
        ),
    ] {
        let edge_m = edge_length_m(&film, density_kg_per_m3 * film.thickness_m * 144.0);
        let ideal = |x: f64| 12.0 / (4.0 * 0.05 * (-4.62 * x).exp());
        let exact = |x: f64| frequency_hz(exact_cut_off(0.05 * (-4.62 * x).exp(), edge_m), edge_m);
        let places = [0.08, 0.16, 0.28];
        let cut_offs = places.map(|x| format!("{:.1}", 100.0 * (exact(x) / ideal(x) - 1.0)));
        let nearer = places.map(|x| format!("{:.1}", 1e3 * (x - root(-0.1, x, |y| exact(y) - ideal(x)))));
        let row =
            format!("| {name} | {:.2} | +{} | {} |", 1e3 * edge_m, cut_offs.join(", +"), nearer.join(", "));
        assert!(page.contains(&row), "{row}");
    }
    for widths in [20.0, 12.0, 10.0, 9.0, 8.6, 8.0, 6.0, 5.5] {
        let edge_m = 1.0 / widths;
        let cut_off = exact_cut_off(1.0, edge_m);
        let law = FRAC_PI_2 / (1.0 - edge_m);
        let off = 100.0 * (frequency_hz(law, edge_m) / frequency_hz(cut_off, edge_m) - 1.0);
        let row = format!("| {widths} | {off:.2} | {:.2} |", missed_percent(edge_m));
        assert!(page.contains(&row), "{row}");
    }
}

/// Amount by which k of the law of the turning half-width is too small just before the turning point, %; W = 1.
fn missed_percent(edge_m: f64) -> f64 {
    let cut_off = exact_cut_off(1.0, edge_m);
    let at = |factor: f64| exact_square(cut_off * cut_off * factor, 1.0, edge_m);
    let slope = (at(1.0 + 1e-5) - at(1.0 - 1e-5)) / (2e-5 * cut_off * cut_off);
    100.0 * (slope.sqrt() - 1.0)
}

#[test]
fn before_the_boundary_the_wavenumber_misses_what_the_light_says() {
    let edge_m = edge_length_m(&polyester(50e-6), 10.008);
    for x in [0.16, 0.24, 0.28] {
        let found = thin_plate(&plate(), x).value.expect("a number");
        let wanted = missed_percent(edge_m / plate().half_width_m(x));
        assert!((found - wanted).abs() < 1e-3, "{x}: {found} {wanted}");
    }
    // Where the plate is wider, the error of the law is smaller.
    let axial = exact_cut_off(1.0, 0.15).powi(2);
    let mut before = missed_percent(0.15);
    for wider in [1.05, 1.2, 1.5, 2.0, 4.0] {
        let law = axial - exact_cut_off(wider, 0.15).powi(2);
        let missed = 100.0 * ((exact_square(axial, wider, 0.15) / law).sqrt() - 1.0);
        assert!(missed > 0.0 && missed < before, "{wider}: {missed} {before}");
        before = missed;
    }
}

/// Half-width of the membrane that turns every wave at the same place as the film.
fn swinging(plate: &Plate, edge_m: f64, x: f64) -> f64 {
    FRAC_PI_2 / exact_cut_off(plate.half_width_m(x), edge_m)
}

/// f'' + (w'/w) f' + (K^2 (1 + j eta) - (pi/2w)^2) f = 0 by the Runge-Kutta method from the plate's end to the driven
/// end; the result is at every 16th step, with f(0) = 1.
fn integrated(plate: &Plate, edge_m: f64, frequency_hz: f64, steps: usize) -> Vec<Complex64> {
    let squared = (TAU * frequency_hz / 12.0).powi(2);
    let bent = 0.5 * ((1.0 + 4.0 * edge_m * edge_m * squared).sqrt() - 1.0);
    let loss = plate.spec().loss_factor * (1.0 + bent) / (1.0 + 2.0 * bent);
    let axial = bent / (edge_m * edge_m) * Complex64::new(1.0, loss);
    let step = plate.length_m() / steps as f64;
    // w at half steps; its slope by central differences.
    let width: Vec<f64> =
        (0..=2 * steps + 2).map(|i| swinging(plate, edge_m, (i as f64 - 1.0) * 0.5 * step)).collect();
    let slope_of = |i: usize, [f, df]: [Complex64; 2]| {
        let narrowing = (width[i + 2] - width[i]) / (step * width[i + 1]);
        [df, -narrowing * df - (axial - (FRAC_PI_2 / width[i + 1]).powi(2)) * f]
    };
    let decay = ((FRAC_PI_2 / width[2 * steps + 1]).powi(2) - axial).sqrt();
    let mut state = [Complex64::from(1e-30), -decay * 1e-30];
    let mut field = vec![state[0]];
    for i in (1..=steps).rev() {
        let at = |state: [Complex64; 2], slope: [Complex64; 2], h: f64| {
            [state[0] - h * slope[0], state[1] - h * slope[1]]
        };
        let first = slope_of(2 * i, state);
        let second = slope_of(2 * i - 1, at(state, first, 0.5 * step));
        let third = slope_of(2 * i - 1, at(state, second, 0.5 * step));
        let fourth = slope_of(2 * i - 2, at(state, third, step));
        for (n, value) in state.iter_mut().enumerate() {
            *value -= step / 6.0 * (first[n] + 2.0 * second[n] + 2.0 * third[n] + fourth[n]);
        }
        field.push(state[0]);
    }
    field.iter().rev().step_by(16).map(|f| f / state[0]).collect()
}

#[test]
fn the_response_matches_the_equation_with_the_width_of_the_exact_strip() {
    let mut spec = stretched(polyester(50e-6), 1390.0);
    (spec.turning_width, spec.drive_end) = (TurningWidth::Plain, DriveEnd::Displacement);
    let plate = Plate::new(spec).expect("a plate");
    let edge_m = edge_length_m(&polyester(50e-6), 10.008);
    for x in [0.12, 0.2] {
        let hz = plate.frequency_for_boundary_hz(x);
        let wanted = integrated(&plate, edge_m, hz, 3200);
        let found = respond(&plate, hz, 201, Equation::Corrected).expect("enters").amplitude;
        let largest = wanted.iter().map(|f| f.norm()).fold(0.0, f64::max);
        // The end of the film moves by 1 + (s k0)^2 times its wave.
        let k0 = plate.wavenumber_squared(hz) - (FRAC_PI_2 / swinging(&plate, edge_m, 0.0)).powi(2);
        let rise = 1.0 + edge_m * edge_m * k0;
        // The plate continues beyond its end, where the integration starts with an assumed decay.
        for (found, wanted) in found.iter().zip(&wanted).take(180) {
            assert!((found * rise - wanted).norm() < 1e-6 * largest, "{x}: {found} {wanted}");
        }
    }
}

/// One dimension less two dimensions: the place of the peak, mm, and its level, dB.
fn misses(plate: &Plate, x: f64) -> (f64, f64) {
    let hz = plate.frequency_for_boundary_hz(x);
    let one = respond(plate, hz, 2001, Equation::Corrected).expect("enters").peak.expect("a peak");
    let setup = plane::Setup::of(plate);
    let two = plane::respond(plate, hz, 2001, &setup).expect("solves").peak.expect("a peak");
    (1e3 * (one.position_m - two.position_m), 20.0 * (one.amplitude / two.amplitude).log10())
}

#[test]
fn films_peak_where_two_dimensions_with_their_stiffness_have_them() {
    let impedance = Impedance { resistance_n_s_per_m: 0.05, mass_kg: 1e-5, stiffness_n_per_m: 10.0 };
    let source = Source { impedance, at_frequency_hz: 150.0, slope: None, lead_in: None };
    for end in [
        DriveEnd::Displacement,
        DriveEnd::Force { at_frequency_hz: 150.0 },
        DriveEnd::Resistance { ratio: 1.0, at_frequency_hz: 150.0 },
        DriveEnd::Source(source),
    ] {
        for thickness_m in [25e-6, 50e-6] {
            let spec = PlateSpec { drive_end: end, ..stretched(polyester(thickness_m), 1390.0) };
            let plate = Plate::new(spec).expect("a plate");
            for x in [0.08, 0.16, 0.28] {
                let (mm, db) = misses(&plate, x);
                assert!(mm.abs() < 0.35 && db.abs() < 0.35, "{end:?} {thickness_m} {x}: {mm} mm {db} dB");
            }
        }
    }
}

#[test]
fn wavenumber_and_frequency_are_each_others_inverse_with_film_and_air_together() {
    let film = polyester(50e-6);
    let spec = PlateSpec { air: Some(Air::ROOM), ..stretched(film, 1390.0) };
    let plate = Plate::new(spec).expect("a plate");
    let (tension, density) = (10.008, 1390.0 * 50e-6);
    for x in [0.08, 0.15, 0.28] {
        let hz = plate.frequency_for_boundary_hz(x);
        let squared = plate.wavenumber_squared(hz);
        // T K^2 + D K^4 = omega^2 (sigma + 2 alpha g rho/K).
        let restoring = tension * squared + film.stiffness_n_m() * squared * squared;
        let vacuum = (restoring / density / squared).sqrt();
        let slow = 1.0 / (1.0 + (vacuum / (0.65 * 343.2)).powi(3));
        let inertia = density + 2.0 * 1.29 * slow * 1.2041 / squared.sqrt();
        assert!((restoring / ((TAU * hz).powi(2) * inertia) - 1.0).abs() < 1e-5, "{x}");
        // d ln K^2/d ln of the frequency is twice the ratio of the losses.
        let step = 1e-4;
        let rise =
            (plate.wavenumber_squared(hz * (1.0 + step)) / plate.wavenumber_squared(hz * (1.0 - step))).ln();
        let share = plate.wave_loss_at(hz) / plate.wave_loss();
        assert!((rise / (4.0 * step * share) - 1.0).abs() < 2e-3, "{x}: {rise} {share}");
        let still = plate.in_vacuum();
        assert!(still.frequency_for_boundary_hz(x) > 1.05 * hz && still.wave_loss_at(hz) < still.wave_loss());
    }
}

/// Polyester of 50 um, a quarter of the mass of latex: the air moves its peaks three times as far.
#[test]
fn a_film_in_air_peaks_where_two_dimensions_with_its_stiffness_and_its_air_have_it() {
    let gas = Gas::Given { density_kg_per_m3: 1.204, sound_speed_m_per_s: 343.2 };
    for (mounting, (within_mm, within_db)) in [
        (AirMounting::BareFrame, (2.5, 1.0)),
        (AirMounting::Coefficient { alpha: 1.9, faces: Faces::Two }, (0.5, 0.5)),
    ] {
        let air = Some(Air::Around { gas, mounting, gap_m: None });
        let plate = Plate::new(PlateSpec { air, ..stretched(polyester(50e-6), 1390.0) }).expect("a plate");
        let (mm, db) = misses(&plate, 0.18);
        println!("{mounting:?}: {mm:+.2} mm {db:+.2} dB");
        assert!(mm.abs() < within_mm && db.abs() < within_db, "{mounting:?}: {mm} mm {db} dB");
    }
}

#[test]
fn without_its_film_a_plate_is_the_ideal_membrane_to_the_last_bit() {
    let (film, ideal) = (plate(), {
        let mut spec = plate().spec().clone();
        let Model::Membrane { film, .. } = &mut spec.model else { panic!("a membrane") };
        *film = None;
        Plate::new(spec).expect("a plate")
    });
    assert_eq!(film.without_film(), ideal);
    assert_eq!(ideal.without_film(), ideal);
    let paper = |plate: &Plate| respond(plate, 150.0, 129, Equation::Paper).expect("enters");
    assert_eq!(paper(&film), paper(&ideal));
    // A film of negligible stiffness is computed by the law of films.
    let limp = Film { youngs_modulus_pa: 1e3, thickness_m: 1e-6, ..polyester(0.0) };
    let mut spec = film.spec().clone();
    let Model::Membrane { film, .. } = &mut spec.model else { panic!("a membrane") };
    *film = Some(limp);
    let limp = Plate::new(spec).expect("a plate");
    for hz in [100.0, 150.0, 200.0] {
        let of = |plate: &Plate| respond(plate, hz, 257, Equation::Corrected).expect("enters").amplitude;
        for (a, b) in of(&limp).iter().zip(of(&ideal)) {
            assert!((a - b).norm() < 3e-5, "{hz}: {a} {b}");
        }
    }
}

#[test]
fn the_line_in_time_answers_a_tone_as_the_frequency_domain_and_a_sheet_refuses_a_film() {
    let plate = plate();
    assert_answers_tones(&plate, 20_000.0, &[150.0], 4e-3);
    let refused = Sheet::new(&plate, 400e3, SheetGrid::new(64, 8));
    assert!(matches!(refused, Err(SheetError::Film { .. })), "{:?}", refused.err());
}

#[test]
fn a_table_is_level_on_a_film() {
    let plate = plate();
    let table = DriveTable::build(&plate, 400e3, 129).expect("a table");
    for x in [0.1, 0.17, 0.27] {
        let frequency_hz = table.frequency_hz(x);
        assert!((frequency_hz / plate.frequency_for_boundary_hz(x) - 1.0).abs() < 1e-4);
        let peak = respond(&plate, frequency_hz, 801, Equation::Corrected).expect("enters").peak;
        let level = table.gain(x) * peak.expect("a peak").amplitude * plate.spec().full_scale_m;
        assert!((level / table.peak_m(x) - 1.0).abs() < 0.01, "{x}: {level}");
    }
}

fn thin_plate(plate: &Plate, x: f64) -> Light {
    let report = Checker::new(plate, Conditions::default()).expect("checks").at(x).expect("on it");
    report.light("thin plate").expect("a light").clone()
}

#[test]
fn the_light_warns_where_a_film_is_stiff_and_a_stiffer_one_is_refused_with_the_largest_thickness() {
    let near = thin_plate(&plate(), 0.1);
    assert_eq!(near.colour, Colour::Green);
    assert!(near.sentence.starts_with("The film's stiffness makes the plate 4."), "{}", near.sentence);
    let far = thin_plate(&plate(), 0.28);
    assert_eq!(far.colour, Colour::Amber);
    assert!((far.value.expect("a number") - 1.63).abs() < 0.05, "{far:?}");
    assert!(
        far.sentence.ends_with(
            "a film of up to 34.0 µm of this material, at the same wave speed, is near to a membrane."
        ),
        "{}",
        far.sentence
    );
    let stretch = far.stretches.first().expect("a stretch");
    assert!(stretch.from_m > 0.15 && stretch.to_m == 0.28, "{far:?}");
    // A film of that thickness is green up to the end of the span.
    let thinner = Plate::new(stretched(polyester(34e-6), 1390.0)).expect("a plate");
    assert_eq!(thin_plate(&thinner, 0.28).colour, Colour::Green);
    let ideal = thin_plate(&plate().without_film(), 0.28);
    assert_eq!((ideal.colour, ideal.value), (Colour::Green, None));
    assert!(
        ideal.sentence.contains("give youngs_modulus_pa, poisson_ratio and thickness_m"),
        "{}",
        ideal.sentence
    );
    let error = Plate::new(stretched(polyester(100e-6), 1390.0)).expect_err("too stiff").to_string();
    assert!(error.starts_with("model.thickness_m = 0.0001: must be at most 5.3e-5 m at this wave speed: where the plate is 0.0274 m wide"), "{error}");
    assert!(error.contains("at most 2 % may be"), "{error}");
    let allowed = Plate::new(stretched(polyester(53e-6), 1390.0)).expect("a plate");
    assert_eq!(thin_plate(&allowed, 0.28).colour, Colour::Amber);
}

#[test]
fn a_film_is_read_and_written_by_its_three_fields_and_needs_the_tension() {
    let text = plate().to_toml().replace("10.008000000000001", "10.008");
    assert_eq!(Plate::from_toml(&plate().to_toml()).expect("its own text"), plate());
    let refused = |from: &str, to: &str| {
        assert!(text.contains(from), "{text}");
        Plate::from_toml(&text.replace(from, to)).expect_err("refused").to_string()
    };
    let without = refused("poisson_ratio = 0.38\n", "");
    assert!(without.contains("model.poisson_ratio is missing"), "{without}");
    let untold = refused("tension_n_per_m = 10.008\n", "");
    assert!(untold.contains("model.tension_n_per_m is missing: the film's stiffness needs it"), "{untold}");
    let limp = refused("youngs_modulus_pa = 4500000000.0", "youngs_modulus_pa = 10.0");
    assert!(limp.contains("model.youngs_modulus_pa = 10: must be 1000 to 1e13 Pa"), "{limp}");
}

#[test]
fn a_design_counts_its_film_and_says_which_film_would_be_better() {
    let request = |thickness_m: f64| {
        let film = Material::named("polyester-film").expect("known");
        let wave = Wave::Membrane { wave_speed_m_per_s: 12.0 };
        Request::new("film", film, thickness_m, wave, (80.0, 200.0), 0.3)
    };
    let plate = design(&request(25e-6), &mut Progress::unwatched()).expect("a design").plate;
    assert_eq!(plate.spec().model.film(), Some(&polyester(25e-6)));
    assert_eq!(Plate::from_toml(&plate.to_toml()).expect("its own text"), plate);
    let (low, high) = plate.band_hz();
    assert!((low / 80.0 - 1.0).abs() < 1e-6 && (high / 200.0 - 1.0).abs() < 1e-6, "{low} {high}");
    // The membrane's half-widths alone would put the band too high by 8 % and more.
    assert!(plate.without_film().band_hz().1 < 0.9 * high);
    let stiff = design(&request(50e-6), &mut Progress::unwatched()).expect("a design").plate;
    let warned = thin_plate(&stiff, stiff.span_m().1);
    assert_eq!(warned.colour, Colour::Amber);
    assert!(warned.sentence.contains("a film of up to"), "{}", warned.sentence);
    let Err(DesignError::Plate(error)) = design(&request(150e-6), &mut Progress::unwatched()) else {
        panic!("too stiff")
    };
    assert_eq!(error.field(), "thickness_m");
    assert!(error.to_string().contains("at this wave speed"), "{error}");
}
