//! The lights on the presets, against numbers worked out by hand.

use super::*;
use crate::{DriveEnd, Model, Plate, Taper, preset, presets};

fn report(name: &str, boundary_m: f64) -> Report {
    let plate = preset(name).expect("a preset");
    Checker::new(&plate, Conditions::default()).expect("checks").at(boundary_m).expect("on the plate")
}

fn light<'a>(report: &'a Report, name: &str) -> &'a Light {
    report.light(name).unwrap_or_else(|| panic!("no light {name}"))
}

fn value(report: &Report, name: &str) -> f64 {
    light(report, name).value.unwrap_or(f64::NAN)
}

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
    let wide = Checker::new(&plate, Conditions::default()).expect("checks").at(0.08).expect("on it");
    assert_eq!(light(&wide, "edge slope").colour, Colour::Amber);
    // W0 = 200 mm, d W0 = 0.92: at 100 mm 0.58.
    assert_eq!(light(&self::report("al-sh", 0.1), "edge slope").colour, Colour::Red);
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
fn wavelengths_and_loss_are_the_closed_forms_of_an_exponential_taper() {
    // Phi = nu acosh(nu/s0) - sqrt(nu^2 - s0^2), I = (eta/2) nu acosh(nu/s0); s0 = q/(W0 d), nu = s0 e^(d x0).
    for (name, half_width_m, eta) in
        [("membrane", 0.05, 0.03), ("al-bending", 0.02, 0.001), ("paper-rubber", 0.05, 0.1)]
    {
        let plate = preset(name).expect("preset");
        let s0 = std::f64::consts::FRAC_PI_2 / (half_width_m * 4.62);
        for x0 in [0.08, 0.15, 0.27] {
            let nu = s0 * (4.62_f64 * x0).exp();
            let phase = nu * (nu / s0).acosh() - (nu * nu - s0 * s0).sqrt();
            let turns = wavelengths(&plate, x0);
            assert!((turns / (phase / std::f64::consts::TAU) - 1.0).abs() < 1e-4, "{name} {x0}: {turns}");
            let loss = loss_integral(&plate, x0);
            let exact = 0.5 * eta * nu * (nu / s0).acosh();
            assert!((loss / exact - 1.0).abs() < 1e-4, "{name} {x0}: {loss} {exact}");
        }
    }
}

#[test]
fn loss_dims_the_peak_light_from_green_over_amber_to_red() {
    let mut spec = preset("al-bending").expect("preset").spec().clone();
    let mut seen = Vec::new();
    for loss_factor in [0.002, 0.12, 0.4] {
        spec.loss_factor = loss_factor;
        let plate = Plate::new(spec.clone()).expect("plate");
        let report = Checker::new(&plate, Conditions::default()).expect("checks").at(0.27).expect("on it");
        seen.push((value(&report, "loss"), light(&report, "loss").colour, light(&report, "peak").colour));
    }
    assert_eq!(seen[0].1, Colour::Green);
    assert!(seen[1].0 > 3.0 && seen[1].0 < 6.0, "{seen:?}");
    assert_eq!((seen[1].1, seen[1].2), (Colour::Amber, Colour::Amber), "{seen:?}");
    assert!(seen[2].0 > 6.0, "{seen:?}");
    assert_eq!((seen[2].1, seen[2].2), (Colour::Red, Colour::Red), "{seen:?}");
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
    let plate = preset("al-bending").expect("preset");
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

#[test]
fn a_matched_drive_is_green_and_a_held_displacement_is_red_for_match_and_sensitivity() {
    let mut spec = preset("membrane").expect("preset").spec().clone();
    spec.loss_tolerance = Some(0.0);
    let matched = Plate::new(spec).expect("plate");
    let matched_hz = matched.spec().drive_end.at_frequency_hz().expect("a resistance");
    let boundary_m = matched.turning_point_m(matched_hz).expect("enters");
    let report =
        Checker::new(&matched, Conditions::default()).expect("checks").at(boundary_m).expect("on it");
    let (fit, sensitivity) = (light(&report, "drive match"), light(&report, "sensitivity"));
    assert_eq!(fit.colour, Colour::Green, "{fit:?}");
    assert_eq!(sensitivity.colour, Colour::Green, "{sensitivity:?}");
    assert!(sensitivity.value.unwrap_or(9.0) < 0.15, "0.07 dB with r = 1: {sensitivity:?}");

    let held = preset("al-bending-displacement").expect("preset");
    let report = Checker::new(&held, Conditions::default()).expect("checks").over_span().expect("span");
    let sensitivity = light(&report, "sensitivity");
    assert_eq!(sensitivity.colour, Colour::Red);
    assert!((20.0..36.0).contains(&sensitivity.value.unwrap_or(0.0)), "about 25 dB: {sensitivity:?}");
    assert_eq!(light(&report, "drive match").colour, Colour::Red);
    assert!((value(&report, "drive match") - 1.0).abs() < 1e-9, "every wave comes back");
}

/// The membrane whose loss is known within `tolerance`: the sensitivity light at each end of the span.
fn sensitivity_of_membrane(tolerance: Option<f64>) -> [Light; 2] {
    let mut spec = preset("membrane").expect("preset").spec().clone();
    spec.loss_tolerance = tolerance;
    let checker = Checker::new(&Plate::new(spec).expect("plate"), Conditions::default()).expect("checks");
    [0.08, 0.28].map(|boundary_m| light(&checker.at(boundary_m).expect("on it"), "sensitivity").clone())
}

#[test]
fn a_loss_that_may_be_twice_as_high_is_no_green_sensitivity() {
    // By the 2-D solver the peak of the membrane changes by -1.1 to -6.0 dB if its loss is doubled.
    let [near, far] = sensitivity_of_membrane(None);
    for (light, wanted) in [(&near, 1.1), (&far, 6.0)] {
        assert!(light.colour > Colour::Green, "{light:?}");
        assert!(light.sentence.contains("halved or doubled") && light.sentence.contains("loss_tolerance"));
        assert!((light.value.expect("a number") - wanted).abs() < 0.2, "{light:?}");
    }
    let [_, known] = sensitivity_of_membrane(Some(0.05));
    assert_eq!(known.colour, Colour::Green, "{known:?}");
    assert!(known.sentence.contains("1.05 times"), "{known:?}");
    // What the file tells is what the table is levelled for: the middle of the two peaks, so that neither is farther
    // off than half of their distance.
    let [_, told] = sensitivity_of_membrane(Some(1.0));
    let ratio = told.value.expect("a number") / far.value.expect("a number");
    assert!((0.5..0.9).contains(&ratio), "{told:?} {far:?}");
    let [_, wide] = sensitivity_of_membrane(Some(4.0));
    assert_eq!(wide.colour, Colour::Red, "{wide:?}");
}

#[test]
fn a_bending_plate_with_a_damper_alone_is_amber_and_one_with_a_lead_in_behind_a_soft_force_green() {
    let still = preset("al-bending-displacement").expect("preset");
    let end = |drive_end: DriveEnd| {
        let spec = crate::PlateSpec { drive_end, ..still.spec().clone() };
        let plate = Plate::new(spec).expect("plate");
        let report = Checker::new(&plate, Conditions::default()).expect("checks").at(0.24).expect("on it");
        light(&report, "drive match").clone()
    };
    let damped = end(DriveEnd::Resistance { ratio: 1.0, at_frequency_hz: 28e3 });
    assert_eq!(damped.colour, Colour::Amber, "{damped:?}");
    assert!(
        (damped.value.expect("known") - 0.57).abs() < 0.01 && damped.sentence.contains("lead-in"),
        "{damped:?}"
    );
    assert_eq!(end(DriveEnd::Resistance { ratio: 9.0, at_frequency_hz: 28e3 }).colour, Colour::Red);

    let lead_in = crate::LeadIn { length_m: 0.06, loss_factor: 0.2, end_resistance_n_s_per_m: 55.0 };
    let source = crate::Source { lead_in: Some(lead_in), ..crate::Source::soft(&still.spec().model, 28e3) };
    let matched = end(DriveEnd::Source(source));
    assert_eq!(matched.colour, Colour::Green, "{matched:?}");
    let heavy = end(DriveEnd::Source(crate::Source { mass_kg: 5e-3, ..source }));
    assert!(heavy.colour == Colour::Red && heavy.sentence.contains("hide"), "{heavy:?}");
    let bare = end(DriveEnd::Source(crate::Source { lead_in: None, ..source }));
    assert!(bare.colour == Colour::Red && bare.sentence.contains("lead-in"), "{bare:?}");
}

#[test]
fn a_measured_actuator_that_does_not_reach_the_frequency_is_amber() {
    let mut spec = preset("membrane").expect("preset").spec().clone();
    let points = vec![[20.0, 0.0, 0.0], [110.0, -3.0, -45.0]];
    spec.actuator = Some(crate::Actuator::Measured(crate::ResponseCurve { points }));
    let checker = Checker::new(&Plate::new(spec).expect("plate"), Conditions::default()).expect("checks");
    let found = |boundary_m: f64| {
        let report = checker.at(boundary_m).expect("on it");
        (light(&report, "actuator band").colour, light(&report, "actuator band").value)
    };
    let near_m = checker.plate().turning_point_m(100.0).expect("enters");
    assert_eq!(found(near_m).0, Colour::Green);
    assert_eq!(found(0.2), (Colour::Amber, None));
}

#[test]
fn the_drive_ratio_drifts_by_a_fifth_over_an_octave_of_bending() {
    let mut spec = preset("al-bending-displacement").expect("preset").spec().clone();
    spec.drive_end = DriveEnd::Resistance { ratio: 1.0, at_frequency_hz: 28e3 };
    let plate = Plate::new(spec).expect("plate");
    let ratio = |frequency_hz: f64| lights::drive::drive_ratio(&plate, frequency_hz).expect("it enters");
    let matched_hz = plate.spec().drive_end.at_frequency_hz().expect("a resistance");
    assert!((ratio(matched_hz) - 1.0).abs() < 1e-12);
    // r goes with omega/k0, k0 ~ sqrt(omega): 2^(1/4) up and down, a little less so near the cut-off.
    for (step, expected) in [(1.0 / 2.0_f64.sqrt(), 0.855), (2.0_f64.sqrt(), 1.18)] {
        let found = ratio(matched_hz * step);
        assert!((found - expected).abs() < 0.02, "{step}: {found}");
    }
}

#[test]
fn one_micrometre_at_5_khz_can_reach_113_db_in_front_of_a_wide_plate() {
    assert!((plane_wave_level_db(5e3, 1e-6) - 113.2).abs() < 0.1, "{}", plane_wave_level_db(5e3, 1e-6));
    for (frequency_hz, db) in [(1e3, 0.0), (100.0, -19.1), (10e3, -2.5), (31.623, -39.4)] {
        assert!(
            (a_weighting_db(frequency_hz) - db).abs() < 0.1,
            "{frequency_hz}: {}",
            a_weighting_db(frequency_hz)
        );
    }
}

#[test]
fn sound_grows_by_20_db_for_ten_times_the_level_and_stays_below_the_plane_wave() {
    let plate = preset("al-bending").expect("preset");
    let at_level = |level: f64| {
        let checker = Checker::new(&plate, Conditions { level, ..Conditions::default() }).expect("checks");
        let report = checker.at(0.25).expect("on it");
        (value(&report, "sound level"), checker.peak_m(), report.frequency_hz.0)
    };
    let (full, peak_m, frequency_hz) = at_level(1.0);
    let (tenth, ..) = at_level(0.1);
    assert!((full - tenth - 20.0).abs() < 1e-9);
    assert!(full < plane_wave_level_db(frequency_hz, 3.0 * peak_m) && full > 60.0, "{full}");
    assert_eq!(at_level(0.0).0, 0.0);
    // The membrane's slow waves hardly radiate: far below the 120 dB and more of a plane wave.
    let membrane = report("membrane", 0.16);
    assert!(value(&membrane, "sound level") < 85.0, "{:?}", light(&membrane, "sound level"));
}

#[test]
fn two_ultrasonic_tones_closer_than_a_kilohertz_beat() {
    let plate = preset("al-bending").expect("preset");
    let near = plate.turning_point_m(30_500.0).expect("enters");
    let boundary = plate.turning_point_m(30_000.0).expect("enters");
    let far = plate.turning_point_m(35_000.0).expect("enters");
    let with = |other_boundaries_m: Vec<f64>| {
        let conditions = Conditions { other_boundaries_m, ..Conditions::default() };
        let report = Checker::new(&plate, conditions).expect("checks").at(boundary).expect("on it");
        (light(&report, "beat").value, light(&report, "beat").colour)
    };
    assert_eq!(with(vec![]), (None, Colour::Green));
    let (value, colour) = with(vec![far, near]);
    assert!((value.unwrap_or(0.0) - 500.0).abs() < 0.01);
    assert_eq!(colour, Colour::Amber);
    assert_eq!(with(vec![far]).1, Colour::Green);
    // Two tones of a membrane, 20 Hz apart, are not ultrasonic: that is what a texture is made of.
    assert_eq!(light(&report("membrane", 0.16), "beat").colour, Colour::Green);
}

#[test]
fn the_actuator_light_follows_its_resonance() {
    let mut spec = preset("membrane").expect("preset").spec().clone();
    spec.actuator = Some(crate::Actuator::Resonator(crate::Resonator {
        resonance_hz: 200.0,
        quality: 0.7,
        travel: None,
    }));
    let plate = Plate::new(spec.clone()).expect("plate");
    let report = Checker::new(&plate, Conditions::default()).expect("checks").at(0.16).expect("on it");
    assert_eq!(light(&report, "actuator band").colour, Colour::Green);
    // Two octaves and a half above resonance: -12 dB per octave.
    spec.actuator =
        Some(crate::Actuator::Resonator(crate::Resonator { resonance_hz: 20.0, quality: 0.7, travel: None }));
    let plate = Plate::new(spec).expect("plate");
    let report = Checker::new(&plate, Conditions::default()).expect("checks").at(0.16).expect("on it");
    assert_eq!(light(&report, "actuator band").colour, Colour::Red);
    let expected = -40.0 * (125.62_f64 / 20.0).log10();
    assert!((value(&report, "actuator band") - expected).abs() < 0.3, "{}", value(&report, "actuator band"));
}

#[test]
fn the_excursion_light_tells_how_far_the_actuator_would_move_and_what_the_limit_takes() {
    let checker = |static_m: Option<f64>| {
        let mut spec = preset("membrane").expect("preset").spec().clone();
        let travel = static_m.map(|static_m| crate::Travel { peak_m: 1e-4, static_m });
        spec.actuator =
            Some(crate::Actuator::Resonator(crate::Resonator { resonance_hz: 60.0, quality: 0.7, travel }));
        Checker::new(&Plate::new(spec).expect("plate"), Conditions::default()).expect("checks")
    };
    let excursion = |static_m: f64| {
        let report = checker(Some(static_m)).over_span().expect("span");
        let found = light(&report, "excursion");
        (found.value.expect("a number"), found.colour)
    };
    let (small, colour) = excursion(1e-4);
    assert!(small > 1.0 && small < 20.0 && colour == Colour::Green, "{small} {colour:?}");
    let (large, colour) = excursion(5e-3);
    assert!((large / small - 50.0).abs() < 1e-9 && colour == Colour::Amber, "{large} {colour:?}");
    assert_eq!(excursion(50e-3).1, Colour::Red);
    // The other lights judge the level that is left.
    let free_m = checker(None).peak_m();
    assert_eq!(checker(Some(1e-4)).peak_m(), free_m);
    let left = checker(Some(5e-3)).peak_m() / free_m;
    assert!((left / (0.998 * 100.0 / large) - 1.0).abs() < 0.02, "{left}");
    let unknown = checker(None).over_span().expect("span");
    assert_eq!(light(&unknown, "excursion").colour, Colour::Unchecked);
    assert!(light(&unknown, "excursion").sentence.contains("not limited"));
}

#[test]
fn a_band_that_nothing_is_known_of_is_unchecked_and_no_worry() {
    for preset in presets() {
        let plate = preset.plate().expect("a preset");
        let checker = Checker::new(&plate, Conditions::default()).expect("checks");
        for mut report in [checker.at(plate.span_m().0).expect("on it"), checker.over_span().expect("span")] {
            let band = light(&report, "actuator band");
            assert_eq!((band.colour, band.value), (Colour::Unchecked, None));
            report.lights.retain(|light| light.colour <= Colour::Green);
            assert_eq!(report.worst(), Colour::Green, "{}", preset.name);
        }
    }
}

#[test]
fn thin_plate_theory_is_off_by_what_mindlin_says() {
    // 2 mm aluminium: the thick plate's wavenumber is larger by 1.5 % at 20 kHz, 2.9 % at 40 kHz.
    let twenty = report("al-bending", 0.939 / 4.62);
    assert!((value(&twenty, "thin plate") - 1.5).abs() < 0.1, "{}", value(&twenty, "thin plate"));
    let forty = report("al-bending", 1.286 / 4.62);
    assert!((value(&forty, "thin plate") - 2.9).abs() < 0.25, "{}", value(&forty, "thin plate"));
    assert_eq!(light(&forty, "thin plate").colour, Colour::Amber);
    assert_eq!(light(&report("membrane", 0.16), "thin plate").colour, Colour::Green);
}

#[test]
fn a_boundary_too_near_the_drive_has_no_room_for_a_peak() {
    let report = report("membrane", 0.02);
    assert_eq!(light(&report, "wavelengths").colour, Colour::Red);
    assert_eq!(light(&report, "peak").colour, Colour::Red);
    assert_eq!(report.worst(), Colour::Red);
}

#[test]
fn every_preset_has_every_light_in_one_order_each_with_a_sentence() {
    let mut order: Option<Vec<&str>> = None;
    for preset in presets() {
        let plate = preset.plate().expect("a preset");
        let report = Checker::new(&plate, Conditions::default()).expect("checks").over_span().expect("span");
        let names: Vec<&str> = report.lights.iter().map(|light| light.name).collect();
        assert_eq!(names.len(), 17);
        assert_eq!(*order.get_or_insert(names.clone()), names);
        for light in &report.lights {
            assert!(light.sentence.ends_with('.') && light.sentence.len() > 20, "{light:?}");
            assert!(light.value.is_none_or(f64::is_finite), "{light:?}");
        }
    }
}

#[test]
fn a_span_is_as_bad_as_its_worst_boundary() {
    let plate = preset("membrane").expect("preset");
    let checker = Checker::new(&plate, Conditions::default()).expect("checks");
    let (span, near) = (checker.over_span().expect("span"), checker.at(plate.span_m().0).expect("on it"));
    assert_eq!(value(&span, "edge width"), value(&near, "edge width"), "the softest edge is the nearest");
    assert_eq!(light(&span, "edge width").boundary_m, plate.span_m().0);
    for light in &near.lights {
        assert!(span.light(light.name).expect("same lights").colour >= light.colour, "{}", light.name);
    }
}

#[test]
fn boundaries_off_the_plate_and_absurd_conditions_are_refused_with_their_range() {
    let plate = preset("membrane").expect("preset");
    let checker = Checker::new(&plate, Conditions::default()).expect("checks");
    for boundary_m in [0.0, -0.1, 0.321, f64::NAN, f64::INFINITY] {
        let error = checker.at(boundary_m).expect_err("off the plate").to_string();
        assert!(error.contains("boundary =") && error.contains("0.32 m"), "{error}");
    }
    let refused = |conditions: Conditions| Checker::new(&plate, conditions).expect_err("absurd").to_string();
    assert!(
        refused(Conditions { level: 1.5, ..Conditions::default() }).contains("level = 1.5: must be 0 to 1")
    );
    assert!(refused(Conditions { sample_rate_hz: 100.0, ..Conditions::default() }).contains("sample rate"));
    let off = Conditions { other_boundaries_m: vec![9.0], ..Conditions::default() };
    assert!(refused(off).contains("other boundary = 9"));
}

#[test]
fn a_plate_whose_band_just_fits_the_rate_is_checked_to_its_very_end() {
    let plate = preset("membrane").expect("a preset");
    // At 1 % more wave speed the band would no longer fit: the boundaries' own frequencies do.
    let sample_rate_hz = 1.001 * crate::sample_rates(&plate).low;
    let checker = Checker::new(&plate, Conditions { sample_rate_hz, ..Conditions::default() }).expect("fits");
    assert!(checker.at(plate.span_m().1).is_ok());
    assert!(checker.over_span().is_ok());
    assert!(crate::sensitivity_per_percent(&plate, sample_rate_hz).is_ok());
}

#[test]
fn the_loss_of_a_clamped_plate_is_the_decay_of_its_wave() {
    let mut spec = preset("al-bending-displacement").expect("a preset").spec().clone();
    spec.model = Model::BendingClamped(spec.model.bending().expect("bending").clone());
    (spec.span_start_m, spec.span_end_m) = (0.1, 0.24);
    let plate = Plate::new(spec).expect("a valid plate");
    let boundary_m = 0.2;
    let frequency_hz = plate.frequency_for_boundary_hz(boundary_m);
    let steps = 20_000;
    let decay: f64 = (0..steps)
        .map(|i| {
            let u = (f64::from(i) + 0.5) / f64::from(steps);
            let x = boundary_m * (1.0 - u * u);
            let k = plate.width_mode(1).lossy_wavenumber_squared(x, frequency_hz).sqrt();
            2.0 * u * boundary_m * k.im / f64::from(steps)
        })
        .sum();
    let found = loss_integral(&plate, boundary_m);
    assert!((found / decay - 1.0).abs() < 0.03, "{found} for {decay}");
}

#[test]
fn steel_thicker_than_wide_is_no_plate_even_when_it_is_taken_as_thick() {
    let mut spec = preset("al-bending").expect("preset").spec().clone();
    spec.drive_end = DriveEnd::Displacement;
    for (thick_plate, thickness_m, wanted) in
        [(true, 1.8 * 0.0126, Colour::Red), (true, 0.003, Colour::Amber), (true, 0.002, Colour::Green)]
    {
        let Model::BendingSupported(bending) = &mut spec.model else { panic!("bending") };
        (bending.thick_plate, bending.thickness_m) = (thick_plate, thickness_m);
        let plate = Plate::new(spec.clone()).expect("plate");
        let report = Checker::new(&plate, Conditions::default()).expect("checks").at(0.25).expect("on it");
        assert_eq!(light(&report, "thin plate").colour, wanted, "{thickness_m}");
    }
}

#[test]
fn a_plate_narrower_than_a_fingertip_is_not_green() {
    // 2 W = 100 mm e^(-4.62 x).
    let mut spec = preset("membrane").expect("preset").spec().clone();
    (spec.length_m, spec.span_end_m) = (0.7, 0.5);
    let plate = Plate::new(spec).expect("plate");
    let checker = Checker::new(&plate, Conditions::default()).expect("checks");
    for (millimetres, wanted) in [(10.1, Colour::Green), (9.9, Colour::Amber), (4.9, Colour::Red)] {
        let report = checker.at((100.0_f64 / millimetres).ln() / 4.62).expect("on it");
        assert_eq!(light(&report, "width").colour, wanted, "{millimetres}");
        assert!((value(&report, "width") - millimetres / 10.0).abs() < 1e-9);
    }
}

#[test]
fn a_resonator_whose_table_needs_few_steps_of_the_dac_is_not_green() {
    // Without loss a held plate's resonances stand so high that the table turns them down to a few steps.
    let mut spec = preset("al-bending-displacement").expect("preset").spec().clone();
    let mut steps = Vec::new();
    for loss_factor in [0.002, 0.0] {
        spec.loss_factor = loss_factor;
        let plate = Plate::new(spec.clone()).expect("plate");
        let checker = Checker::new(&plate, Conditions::default()).expect("checks");
        let report = checker.over_span().expect("span");
        let found = light(&report, "DAC resolution").clone();
        let value = found.value.expect("a number");
        assert_eq!(found.colour == Colour::Green, value >= 16.0, "{found:?}");
        // The lowest gain of the table, whose knots lie nearer to the resonances than the light's boundaries.
        let table = crate::DriveTable::build(&plate, 400e3, 257).expect("table");
        let lowest = table.knots.iter().map(|knot| knot.gain).fold(1.0, f64::min);
        steps.push((value, 2047.5 * lowest));
    }
    assert!(steps[0].0 > 16.0 && steps[1].0 < 16.0, "{steps:?}");
    assert!((steps[0].1 / steps[0].0).ln().abs() < 1.0, "{steps:?}");
}

#[test]
fn the_loss_light_never_contradicts_the_peak_light() {
    let mut spec = preset("membrane").expect("preset").spec().clone();
    let mut seen = std::collections::BTreeSet::new();
    for loss_factor in [0.0, 0.02, 0.1, 0.2, 0.3, 0.5] {
        spec.loss_factor = loss_factor;
        let checker =
            Checker::new(&Plate::new(spec.clone()).expect("plate"), Conditions::default()).expect("checks");
        for boundary_m in [0.08, 0.15, 0.28] {
            let report = checker.at(boundary_m).expect("on it");
            let (loss, peak) = (light(&report, "loss"), light(&report, "peak"));
            if loss.value.expect("a number") > 1.0 {
                assert_eq!(loss.colour, peak.colour, "{loss:?} {peak:?}");
                seen.insert(loss.colour);
            } else {
                assert!(!loss.sentence.contains("peak"), "{loss:?}");
            }
        }
    }
    assert!(seen.len() >= 2, "{seen:?}");
}

#[test]
fn a_light_touch_costs_what_the_finger_light_says_and_the_heavy_membrane_survives_it() {
    for (name, wanted) in [("membrane", Colour::Amber), ("membrane-heavy", Colour::Green)] {
        let plate = preset(name).expect("preset");
        let report = report(name, 0.16);
        let found = light(&report, "finger load");
        assert_eq!(found.colour, wanted, "{found:?}");
        let hz = report.frequency_hz.0;
        let free = crate::plane::respond(&plate, hz, 257, &crate::plane::Setup::of(&plate)).expect("free");
        let place_m = free.peak.expect("a peak").position_m;
        for finger in [crate::Finger::light(place_m), crate::Finger::firm(place_m)] {
            let setup = crate::plane::Setup { finger: Some(finger), ..crate::plane::Setup::of(&plate) };
            let touched = crate::plane::respond(&plate, hz, 257, &setup).expect("touched");
            let at = |response: &crate::Response| {
                let index = (place_m / plate.length_m() * 256.0).round() as usize;
                response.amplitude[index].norm()
            };
            let truth_db = 20.0 * (at(&free) / at(&touched)).log10();
            let load = finger.load(&plate, hz).expect("told");
            let said_db = lights::touch::touched_db(&plate, hz, load);
            assert!((said_db - truth_db).abs() < 1.5, "{name} {said_db} {truth_db}");
        }
    }
    assert_eq!(light(&self::report("paper-as-printed", 0.3), "finger load").colour, Colour::Unchecked);
}
