//! What a plate meets where it stands: a table below it, a frame that moves, warmth, age, and a finger that presses.

use super::time_line::assert_answers_tones;
use slipline_plate::check::{Checker, Colour, Conditions, Light};
use slipline_plate::design::{Material, Request, Wave, design};
use slipline_plate::{
    Air, AirMounting, Calibration, DriveEnd, DriveTable, Equation, Faces, Film, Frame, Gas, Model, Plate,
    PlateSpec, Progress, plane, preset, respond,
};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const GAS: Gas = Gas::Given { density_kg_per_m3: 1.204, sound_speed_m_per_s: 343.2 };

/// A membrane of this tension at 12 m/s in a bare frame, above a table.
fn above(tension: f64, gap_m: Option<f64>) -> Plate {
    let mut spec = preset("latex-membrane").expect("a preset").spec().clone();
    spec.model = Model::Membrane { wave_speed_m_per_s: 12.0, tension_n_per_m: Some(tension), film: None };
    spec.air = Some(Air::Around { gas: GAS, mounting: AirMounting::BareFrame, gap_m });
    Plate::new(spec).expect("valid")
}

/// Where a tone turns, by bisection of T K^2 = omega^2 (sigma + 1.29 rho (1 + coth K g)/K) alone, and half the arc between the
/// edges that is q/K.
fn turns_m(tension: f64, gap_m: f64, hertz: f64) -> f64 {
    let omega = TAU * hertz;
    let rest = |k: f64| {
        let slow = 1.0 + (12.0_f64 / (0.65 * 343.2)).powi(3);
        let air = 1.29 * 1.204 / slow * (1.0 + 1.0 / (k * gap_m).tanh()) / k;
        tension * k * k - omega * omega * (tension / 144.0 + air)
    };
    let (mut low, mut high) = (1.0, 1e4);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if rest(middle) < 0.0 { low = middle } else { high = middle }
    }
    let half_width_m = (4.62 * FRAC_PI_2 / low).tan() / 4.62;
    (0.05 / half_width_m).ln() / 4.62
}

#[test]
fn a_table_below_moves_a_boundary_by_the_law_of_its_layer_of_air() {
    for (tension, hertz, at_10_mm, at_5_mm) in [(40.0, 80.0, 10.7, 23.3), (400.0, 90.0, 1.5, 3.9)] {
        let open = above(tension, None);
        let x0 = open.turning_point_m(hertz).expect("enters");
        for (gap_m, wanted_mm) in [(0.01, at_10_mm), (0.005, at_5_mm), (0.05, 0.0)] {
            let plate = above(tension, Some(gap_m));
            let there = plate.turning_point_m(hertz).expect("enters");
            assert!((there - turns_m(tension, gap_m, hertz)).abs() < 1e-7, "{tension} {gap_m}: {there}");
            let moved_mm = 1e3 * (there - x0);
            assert!((moved_mm - wanted_mm).abs() < 0.25, "{tension} {gap_m}: {moved_mm} for {wanted_mm}");
            // Every law has it: the peak of `respond`, and the table's frequency at that place.
            let peak = |plate: &Plate| {
                let response = respond(plate, hertz, 1601, Equation::Corrected).expect("enters");
                response.peak.expect("a peak").position_m
            };
            let peak_mm = 1e3 * (peak(&plate) - peak(&open));
            assert!(
                (peak_mm - moved_mm).abs() < 0.1 * moved_mm + 0.05,
                "{tension} {gap_m}: {peak_mm} {moved_mm}"
            );
            let table = DriveTable::build(&plate, 400e3, 65).expect("a table");
            assert!((table.frequency_hz(there.max(0.08)) / hertz - 1.0).abs() < 1e-4 || there < 0.08);
        }
    }
}

#[test]
fn a_plate_above_a_table_answers_in_time_and_in_two_dimensions_as_by_the_law() {
    let plate = above(40.0, Some(0.01));
    assert_answers_tones(&plate, 4e3, &[120.0], 2e-3);
    // In two dimensions the sheet has the air's own matrix, and its image in the table. By the mass of the law alone 10 mm of gap moved
    // that peak by 5.2 mm.
    let hertz = above(40.0, None).frequency_for_boundary_hz(0.16);
    let peak_m = |gap_m: Option<f64>| {
        let plate = above(40.0, gap_m);
        let by_law = respond(&plate, hertz, 1001, Equation::Corrected).expect("enters");
        let in_two = plane::respond(&plate, hertz, 1001, &plane::Setup::of(&plate)).expect("solves");
        let shift_m = plane::Comparison::of(&by_law, &in_two).peak_shift_m.expect("peaks");
        assert!(shift_m.abs() < 1e-3, "{gap_m:?}: {shift_m}");
        in_two.peak.expect("a peak").position_m
    };
    let open_m = peak_m(None);
    for (gap_m, wanted_mm) in [(0.05, 0.28), (0.02, 2.1), (0.01, 6.09), (0.005, 13.78)] {
        let moved_mm = 1e3 * (peak_m(Some(gap_m)) - open_m);
        assert!((moved_mm - wanted_mm).abs() < 0.05 * wanted_mm + 0.05, "{gap_m}: {moved_mm}");
    }
}

#[test]
fn the_gap_is_read_written_and_refused_where_no_law_has_it() {
    let plate = above(40.0, Some(0.012));
    let text = plate.to_toml();
    assert!(text.contains("gap_m = 0.012"), "{text}");
    assert_eq!(Plate::from_toml(&text).expect("its own text"), plate);
    let refused = |text: &str| Plate::from_toml(text).expect_err("refused").to_string();
    let error = refused(&text.replace("gap_m = 0.012", "gap_m = 0.002"));
    assert!(error.contains("air.gap_m = 0.002: must be 0.003 to 1 m"), "{error}");
    let error = refused(&text.replace("bare-frame", "baffle"));
    assert!(error.contains("air.gap_m"), "{error}");
    let mounting = AirMounting::Baffle { faces: Faces::Two };
    let air = Some(Air::Around { gas: GAS, mounting, gap_m: Some(0.01) });
    let error = Plate::new(PlateSpec { air, ..plate.spec().clone() }).expect_err("refused").to_string();
    assert!(error.contains("air.gap_m") && error.contains("closes the gap"), "{error}");
}

fn light(plate: &Plate, name: &str, boundary_m: f64) -> Light {
    let report = Checker::new(plate, Conditions::default()).expect("checks").at(boundary_m).expect("on it");
    report.light(name).expect("a light").clone()
}

#[test]
fn the_light_of_the_air_counts_a_table_and_warns_of_one_that_is_not_stated() {
    let stated = light(&above(40.0, Some(0.005)), "air", 0.1);
    assert!(stated.sentence.contains("of it by the table 5.0 mm below"), "{}", stated.sentence);
    let open = light(&above(40.0, None), "air", 0.1);
    assert!(open.sentence.contains("A table 10.0 mm below would move it by another"), "{}", open.sentence);
    let heavy = light(&above(4000.0, None), "air", 0.1);
    assert!(!heavy.sentence.contains("table"), "{}", heavy.sentence);
}

/// A film of this material on the preset's taper at this wave speed, in a vacuum.
fn film(youngs_modulus_pa: f64, poisson_ratio: f64, density: f64, thickness_m: f64, speed: f64) -> Plate {
    let mut spec = preset("latex-membrane").expect("a preset").in_vacuum().spec().clone();
    spec.drive_end = DriveEnd::Displacement;
    spec.model = Model::Membrane {
        wave_speed_m_per_s: speed,
        tension_n_per_m: Some(density * thickness_m * speed * speed),
        film: Some(Film { youngs_modulus_pa, poisson_ratio, thickness_m }),
    };
    Plate::new(spec).expect("valid")
}

/// A film's dT/T per kelvin is 6 ppm over its strain, and half of that over d the shift: 12 um of polyester at 60 m/s has
/// 2.4 MPa over 7.26 GPa, 0.069 %, and moves by 0.94 mm/K. Latex of 0.3 mm at 12 m/s has 4.7 % and, by the entropy of its
/// chains less its own expansion, 0.13 mm/K.
#[test]
fn the_light_of_the_drift_is_that_of_the_strain() {
    let polyester = light(&film(4.5e9, 0.38, 1390.0, 12e-6, 60.0), "drift", 0.18);
    let strain = 1390.0 * 3600.0 / (4.5e9 / 0.62);
    let wanted_mm = 1e3 * 6e-6 / strain / 2.0 / 4.62;
    let found = polyester.value.expect("mm/K");
    // The stiffness of the film holds a few thousandths of it back, and the arc as much.
    assert!((found / wanted_mm - 1.0).abs() < 0.03, "{found} {wanted_mm}");
    assert!(
        polyester.colour == Colour::Amber && polyester.sentence.contains("10 % of humidity"),
        "{polyester:?}"
    );
    let thermometer = light(&film(4.5e9, 0.38, 1390.0, 50e-6, 12.0), "drift", 0.12);
    assert!(thermometer.colour == Colour::Red && thermometer.sentence.contains("28 ppm"), "{thermometer:?}");
    let latex = light(&film(1.5e6, 0.49, 950.0, 0.3e-3, 12.0), "drift", 0.18);
    let lambda: f64 = 1.0 + 950.0 * 144.0 / (1.5e6 / 0.51);
    let slope = 1.0 / 293.0
        - 2.2e-4 * (2.0 * lambda.powi(2) + 4.0 * lambda.powi(-4)) / (lambda.powi(2) - lambda.powi(-4));
    let (found, wanted_mm) = (latex.value.expect("mm/K"), 1e3 * slope.abs() / 2.0 / 4.62);
    assert!((found / wanted_mm - 1.0).abs() < 0.05 && latex.colour == Colour::Green, "{found} {wanted_mm}");
    assert!(
        latex.sentence.contains("3 % of its tension") && !latex.sentence.contains("humidity"),
        "{latex:?}"
    );
    // 3 % of T are 1.5 % of c.
    assert!(latex.sentence.contains("3.2 mm of the boundary"), "{latex:?}");
    assert_eq!(light(&preset("al-bending").expect("a preset"), "drift", 0.24).colour, Colour::Green);
}

#[test]
fn the_light_of_a_calibrated_rubber_says_when_to_calibrate_again() {
    let plate = film(1.5e6, 0.49, 950.0, 0.3e-3, 12.0);
    let calibration = Calibration {
        chi2_per_n: 1.0,
        half_width_tolerance: 1e-3,
        taper_tolerance: 1e-3,
        level_tolerance_db: None,
        source_tolerance: None,
        correction: None,
    };
    let spec = PlateSpec { calibration: Some(calibration), ..plate.spec().clone() };
    let found = light(&Plate::new(spec).expect("valid"), "drift", 0.18);
    assert!(found.sentence.contains("the calibration ages: trim or calibrate again"), "{}", found.sentence);
    assert!(!light(&plate, "drift", 0.18).sentence.contains("calibration"));
}

/// F/(2 pi T) ln(W/r): 0.5 N, 5 mm.
#[test]
fn the_light_of_the_press_is_that_of_a_membrane_held_on_a_circle() {
    for (name, tension) in [("latex-membrane", 40.0), ("membrane-heavy", 400.0)] {
        let found = light(&preset(name).expect("a preset"), "press", 0.1);
        let half_width_m = 0.05 * (-0.462_f64).exp();
        let wanted_mm = 1e3 * 0.5 / (2.0 * PI * tension) * (half_width_m / 5e-3).ln();
        assert!((found.value.expect("mm") / wanted_mm - 1.0).abs() < 1e-9, "{found:?}");
        assert_eq!(found.colour, if tension < 100.0 { Colour::Amber } else { Colour::Green }, "{found:?}");
    }
    assert_eq!(light(&preset("al-bending").expect("a preset"), "press", 0.24).colour, Colour::Green);
}

#[test]
fn the_light_of_the_frame_says_which_table_keeps_it_still() {
    let with = |frame: Option<Frame>| {
        let spec = preset("membrane-heavy").expect("a preset").spec().clone();
        Plate::new(PlateSpec { frame, ..spec }).expect("valid")
    };
    let boundary_m = 0.16;
    assert_eq!(light(&with(None), "frame", boundary_m).colour, Colour::Unchecked);
    let free = Frame {
        youngs_modulus_pa: 8e9,
        density_kg_per_m3: 680.0,
        thickness_m: 0.01,
        rim_m: 0.02,
        table_mass_kg: 0.0,
    };
    let found = light(&with(Some(free)), "frame", boundary_m);
    println!("{found:?}");
    assert!(found.colour > Colour::Green && found.sentence.contains("screw it to a table of"), "{found:?}");
    let words = found.sentence.split("a table of ").nth(1).expect("a mass");
    let table_mass_kg: f64 = words.split(' ').next().expect("kg").parse().expect("a number");
    let still = light(&with(Some(Frame { table_mass_kg, ..free })), "frame", boundary_m);
    assert!(still.colour == Colour::Green && still.sentence.contains("screwed to a table"), "{still:?}");
    // Half of that mass does not do.
    let table_mass_kg = 0.5 * table_mass_kg;
    let half = light(&with(Some(Frame { table_mass_kg, ..free })), "frame", boundary_m);
    assert!(half.colour > Colour::Green, "{half:?}");
    let text = with(Some(free)).to_toml();
    assert!(text.contains("[frame]") && Plate::from_toml(&text).expect("its own text") == with(Some(free)));
    let error =
        Plate::from_toml(&text.replace("rim_m = 0.02", "rim_m = 0.6")).expect_err("refused").to_string();
    assert!(error.contains("frame.rim_m = 0.6: must be 0.01 to 0.5 m"), "{error}");
}

/// A heavy skin under a strong drive shakes every usual frame. What its design says before it is built, the light says of its plate
/// file, the worst over the span; on the table that the design names it is green.
#[test]
fn a_design_whose_frame_shakes_says_so_and_which_table_keeps_it_still() {
    let skin = |material: &str, thickness_m: f64, full_scale_m: f64| {
        let wave = Wave::Membrane { wave_speed_m_per_s: 12.0 };
        let material = Material::named(material).expect("known");
        let request = Request::new("skin", material, thickness_m, wave, (80.0, 220.0), 0.4);
        let request = Request { full_scale_m, ..request };
        design(&request, &mut Progress::unwatched()).expect("possible")
    };
    let worst = |plate: &Plate| {
        let checker = Checker::new(plate, Conditions::default()).expect("a table");
        let report = checker.over_span(&mut Progress::unwatched()).expect("a report");
        report.lights.into_iter().find(|light| light.name == "frame").expect("a light")
    };
    let shakes = skin("silicone-rubber", 2.5e-3, 5e-4);
    let (chosen, found) = (shakes.frame.expect("a frame"), worst(&shakes.plate));
    println!("{chosen:?} {found:?}");
    assert!(found.colour > Colour::Green && chosen.table_mass_kg > 0.0, "{found:?} {chosen:?}");
    let caution = shakes.caution().expect("it shakes");
    let table = format!("Screw it to a table of {} kg or more.", chosen.table_mass_kg);
    assert!(caution.contains("No usual frame is still") && caution.contains(&table), "{caution}");
    let stated = shakes.plate.spec().frame.expect("in the plate file");
    let frame = Some(Frame { table_mass_kg: chosen.table_mass_kg, ..stated });
    let screwed = Plate::new(PlateSpec { frame, ..shakes.plate.spec().clone() }).expect("valid");
    let screwed = worst(&screwed);
    assert_eq!(screwed.colour, Colour::Green, "{screwed:?}");
    let still = skin("latex", 0.3e-3, 1e-4);
    let (chosen, found) = (still.frame.expect("a frame"), worst(&still.plate));
    assert!(chosen.table_mass_kg == 0.0 && found.colour == Colour::Green, "{chosen:?} {found:?}");
    assert!(still.caution().is_none_or(|caution| !caution.contains("Screw")), "{:?}", still.caution());
}

/// Stretched by 1/sqrt(Tz/Tx) across, a membrane of two tensions is one of one tension: its wave enters above
/// sqrt(Tz/sigma)/(4 W0), and it answers as a plate of that half-width.
#[test]
fn a_membrane_of_two_tensions_is_one_of_another_half_width() {
    let still = preset("membrane").expect("a preset");
    let with = |ratio: Option<f64>, half_width_m: f64| {
        let taper = slipline_plate::Taper::Exponential { half_width_m, rate_per_m: 4.62 };
        let spec = PlateSpec {
            taper,
            tension_ratio: ratio,
            turning_width: slipline_plate::TurningWidth::Plain,
            ..still.spec().clone()
        };
        Plate::new(spec).expect("valid")
    };
    let pulled = with(Some(1.21), 0.05);
    assert!((pulled.cut_off_hz() / (12.0 * 1.1 / 0.2) - 1.0).abs() < 1e-9, "{}", pulled.cut_off_hz());
    assert!((pulled.cut_half_width_m(0.0) - 0.05).abs() < 1e-15, "it is cut as it is stated");
    let narrower = with(None, 0.05 / 1.1);
    let field = |plate: &Plate| respond(plate, 130.0, 201, Equation::Corrected).expect("enters").amplitude;
    for (a, b) in field(&pulled).into_iter().zip(field(&narrower)) {
        assert!((a - b).norm() < 1e-9, "{a} {b}");
    }
    let text = pulled.to_toml();
    assert!(
        text.contains("tension_ratio = 1.21") && Plate::from_toml(&text).expect("its own text") == pulled
    );
    let refused = |line: &str| {
        let text = text.replace("tension_ratio = 1.21", line);
        Plate::from_toml(&text).expect_err("refused").to_string()
    };
    let error = refused("tension_ratio = 2.5");
    assert!(error.contains("tension_ratio = 2.5: must be 0.5 to 2"), "{error}");
    let error = refused("tension_ratio_tolerance = 0.6");
    assert!(error.contains("tension_ratio_tolerance = 0.6: must be 0 to 0.5"), "{error}");
    let bends = preset("al-bending").expect("a preset");
    let error =
        Plate::new(PlateSpec { tension_ratio: Some(1.1), ..bends.spec().clone() }).expect_err("refused");
    assert!(error.to_string().contains("only a membrane has a tension"), "{error}");
}
