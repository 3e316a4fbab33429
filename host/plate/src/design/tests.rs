//! Tests of the designer: its plates meet their requests, and other programs can read the cut files.

use super::*;
use crate::check::{Checker, Conditions};
use crate::{Air, Plate};
use proptest::prelude::*;

fn aluminium() -> Request {
    let wave = Wave::Bending { edge: Edge::Supported, thick_plate: true };
    Request::new("alu", Material::named("aluminium").expect("known"), 2e-3, wave, (20e3, 40e3), 0.3)
}

fn membrane() -> Request {
    let wave = Wave::Membrane { wave_speed_m_per_s: 12.0 };
    Request::new("skin", Material::named("latex").expect("known"), 0.5e-3, wave, (80.0, 220.0), 0.4)
}

#[test]
fn the_turning_points_of_the_band_ends_are_where_the_margins_say_after_a_round_trip_through_the_file() {
    for (edge, thick_plate) in [(Edge::Supported, false), (Edge::Supported, true), (Edge::Clamped, true)] {
        let mut request = aluminium();
        request.wave = Wave::Bending { edge, thick_plate };
        request.start_margin_m = Some(0.06);
        request.end_margin_m = Some(0.035);
        let designed = design(&request, &mut Progress::unwatched()).expect("possible");
        let read = Plate::from_toml(&designed.plate.to_toml()).expect("a valid plate file");
        assert_eq!(read, designed.plate);
        let near = read.turning_point_m(20e3).expect("enters");
        let far = read.turning_point_m(40e3).expect("enters");
        assert!((near - 0.06).abs() < 1e-9 && (far - 0.265).abs() < 1e-9, "{near} {far}");
        assert_eq!(read.span_m(), (0.06, 0.265));
        let (low, high) = read.band_hz();
        assert!((low - 20e3).abs() < 1e-3 && (high - 40e3).abs() < 1e-3, "{low} {high}");
    }
}

/// 50 um of polyester at 12 m/s: T = 10.0 N/m, E h/(1 - nu) = 363 kN/m, 28 ppm. The tension of a frame that is 6 ppm longer a
/// kelvin later is put into the plate's file, and its boundary is compared.
#[test]
fn a_film_that_is_stretched_by_28_ppm_is_called_a_thermometer_and_rubber_is_not() {
    let mut request = membrane();
    request.material = Material::named("polyester-film").expect("known");
    request.thickness_m = 50e-6;
    request.air = Some(Air::Vacuum);
    let designed = design(&request, &mut Progress::unwatched()).expect("possible");
    let (strain, shift_m) = designed.strain().expect("a film");
    assert!((strain / 27.6e-6 - 1.0).abs() < 5e-3, "{strain}");
    let mut spec = designed.plate.spec().clone();
    let share = 1e-3;
    let Model::Membrane { wave_speed_m_per_s, tension_n_per_m: Some(tension), film: Some(film) } =
        &mut spec.model
    else {
        panic!("a membrane")
    };
    let stiffness = film.youngs_modulus_pa * film.thickness_m / (1.0 - film.poisson_ratio);
    let more = share * 6e-6 * stiffness / *tension;
    *tension *= 1.0 + more;
    *wave_speed_m_per_s *= (1.0 + more).sqrt();
    let warm = Plate::new(spec).expect("valid");
    let boundary_m = 0.5 * (designed.low.boundary_m + designed.high.boundary_m);
    let hertz = designed.plate.frequency_for_boundary_hz(boundary_m);
    let moved_m = (boundary_m - warm.turning_point_m(hertz).expect("enters")) / share;
    assert!((moved_m.abs() / shift_m - 1.0).abs() < 1e-3, "{moved_m} {shift_m}");
    // By the tension alone: (dT/T)/(2 d). The film's own stiffness holds a fifth of it back.
    let alone_m = 6e-6 / strain / (2.0 * designed.rate_per_m);
    assert!((0.7..0.9).contains(&(shift_m / alone_m)), "{shift_m} {alone_m}");
    let caution = designed.caution().expect("a thermometer");
    assert!(caution.contains("28 ppm") && caution.contains("per kelvin"), "{caution}");
    let rubber = design(&membrane(), &mut Progress::unwatched()).expect("possible");
    assert!(rubber.strain().expect("a film").0 > 0.01);
    let caution = rubber.caution().expect("a finger sinks in");
    assert!(!caution.contains("thermometer") && caution.contains("sinks in"), "{caution}");
    assert_eq!(design(&aluminium(), &mut Progress::unwatched()).expect("possible").caution(), None);
}

/// F/(2 pi T) ln(R/r) by hand: 0.5 N on 68.4 N/m (latex of 0.5 mm at 12 m/s).
#[test]
fn a_finger_sinks_into_a_slack_membrane_by_the_law_of_its_circle() {
    let designed = design(&membrane(), &mut Progress::unwatched()).expect("possible");
    let middle_m = 0.5 * (designed.low.boundary_m + designed.high.boundary_m);
    let radii = designed.plate.half_width_m(middle_m) / 5e-3;
    let wanted_m = 0.5 / (2.0 * std::f64::consts::PI * 68.4) * radii.ln();
    let found_m = designed.press_m().expect("a membrane");
    assert!((found_m / wanted_m - 1.0).abs() < 1e-3, "{found_m} {wanted_m}");
    assert_eq!(design(&aluminium(), &mut Progress::unwatched()).expect("possible").press_m(), None);
}

#[test]
fn a_thin_supported_plate_has_the_taper_worked_out_by_hand() {
    let mut request = aluminium();
    request.wave = Wave::Bending { edge: Edge::Supported, thick_plate: false };
    request.start_margin_m = Some(0.06);
    request.end_margin_m = Some(0.04);
    let designed = design(&request, &mut Progress::unwatched()).expect("possible");
    // An octave of bending: half the arcs at the turning points are 7.82 and 5.53 mm, and the widths fall by a little
    // more than the root of 2.
    let rate = designed.rate_per_m;
    let (near, far) = (designed.low.half_width_m, designed.high.half_width_m);
    assert!((rate * 0.2 - (near / far).ln()).abs() < 1e-9);
    assert!((1.0..1.001).contains(&(rate * 0.2 / (0.5 * 2.0_f64.ln()))), "{rate}");
    for (half_width_m, arc_m) in [(near, 7.82e-3), (far, 5.53e-3)] {
        let slope = rate * half_width_m;
        assert!((half_width_m * slope.atan() / slope - arc_m).abs() < 5e-6, "{half_width_m}");
    }
    let wide = designed.plate.half_width_m(0.0);
    assert!((wide / (designed.low.half_width_m * (rate * 0.06).exp()) - 1.0).abs() < 1e-9);
    // 2.729/(2 d kb^2)^(1/3) with kb = (pi/2)/W_t; the arc falls by W'^2 2/3 less than the width.
    let wavenumber = std::f64::consts::FRAC_PI_2 / far;
    let edge_m = 2.7286 / (2.0 * rate * wavenumber * wavenumber).cbrt();
    assert!((designed.high.edge_width_m / edge_m - 1.0).abs() < 1e-4);
}

#[test]
fn margins_left_open_give_the_first_peak_and_the_last_tail_their_room() {
    for request in [aluminium(), membrane()] {
        let designed = design(&request, &mut Progress::unwatched()).expect("possible");
        let plate = &designed.plate;
        let near = plate.kappa_per_m(request.band_hz.0).expect("enters") * designed.low.boundary_m;
        assert!((near - 2.338).abs() < 0.01, "{near}");
        let room = request.length_m - designed.high.boundary_m;
        let far = plate.kappa_per_m(request.band_hz.1).expect("enters") * room;
        assert!((far - 2.172).abs() < 0.01, "{far}");
        let first = crate::frequency::respond(plate, request.band_hz.0, 1001, crate::Equation::Corrected)
            .expect("solves");
        assert!(first.peak.is_some_and(|peak| peak.position_m > 0.0), "the nearest boundary has its peak");
    }
}

#[test]
fn the_damper_is_the_membranes_wave_impedance_and_is_off_by_the_same_factor_at_both_ends() {
    for request in [Request { air: None, ..membrane() }, membrane()] {
        the_damper_matches(&request);
    }
}

fn the_damper_matches(request: &Request) {
    let designed = design(request, &mut Progress::unwatched()).expect("possible");
    let damper = designed.damper;
    // T k0/omega with T = rho h c^2 W0, also in air and of a film: the damper feels the membrane alone. W0 is less by what the
    // film bends at its edges, D = E h^3/(12 (1 - nu^2)).
    let c = 12.0;
    let stiff = 1.5e6 * 0.5e-3_f64.powi(3) / (12.0 * (1.0 - 0.49_f64.powi(2))) / (950.0 * 0.5e-3 * c * c);
    let edge_m = stiff.sqrt();
    let wide = designed.plate.half_width_m(0.0) - edge_m;
    assert!((designed.plate.swinging_half_width_m(0.0) / wide - 1.0).abs() < 1e-5);
    let wide = designed.plate.swinging_half_width_m(0.0);
    let omega = TAU * damper.match_frequency_hz;
    let arc = designed.plate.turning_half_width_m(0.0);
    let squared = designed.plate.wavenumber_squared(damper.match_frequency_hz);
    let of_film = squared * (1.0 + stiff * squared);
    assert_eq!(request.air.is_none(), (of_film / (omega / c).powi(2) - 1.0).abs() < 1e-12, "{squared}");
    // In air K at the wide end is less than that of the turning point.
    let width_square = (std::f64::consts::FRAC_PI_2 / arc).powi(2);
    let air = designed.plate.width_mode(1).air(damper.match_frequency_hz);
    let there = air.map_or(squared, |air| air.at(width_square).wavenumber_squared);
    assert!(if air.is_some() { there < squared } else { there == squared });
    let k0 = (there - width_square).sqrt();
    let tension = 950.0 * 0.5e-3 * c * c;
    let resistance = tension * wide * k0 / omega;
    assert!((damper.resistance_n_s_per_m / resistance - 1.0).abs() < 1e-6, "{damper:?} {resistance}");
    assert!((designed.tension_n_per_m.unwrap_or(0.0) - tension).abs() < 1e-9);
    let (low, high) = damper.ratio_range;
    assert!((low * high - 1.0).abs() < 0.02 && high > 1.0 && high < 2.0, "{damper:?}");
    // R is constant, the plate's own Z is not.
    let at = |f: f64| resistance / designed.plate.matching_resistance_n_s_per_m(f).expect("a tension");
    assert!((at(80.0) / high - 1.0).abs() < 1e-3 && (at(220.0) / low - 1.0).abs() < 1e-3);
    assert!((at(damper.match_frequency_hz) - 1.0).abs() < 1e-9);
}

#[test]
fn a_bending_plate_gets_the_shortest_lead_in_that_matches_its_whole_band() {
    for (edge, thick_plate) in [(Edge::Supported, false), (Edge::Supported, true), (Edge::Clamped, true)] {
        let mut request = aluminium();
        request.wave = Wave::Bending { edge, thick_plate };
        let designed = design(&request, &mut Progress::unwatched()).expect("possible");
        let damper = designed.damper;
        let lead_in = damper.lead_in.expect("a lead-in");
        assert_eq!(lead_in.end_resistance_n_s_per_m, damper.resistance_n_s_per_m);
        let largest = (0..=400)
            .map(|i| 20e3 + 50.0 * f64::from(i))
            .map(|hz| crate::reflection(&designed.plate, hz).expect("enters").norm())
            .fold(0.0, f64::max);
        assert!(largest < 0.095, "{largest}");
        assert!((damper.largest_reflection - largest).abs() < 0.01, "{largest} {damper:?}");
        assert!(lead_in.length_m < 0.15, "{lead_in:?}");
    }
}

#[test]
fn the_wave_impedance_of_a_thin_supported_plate_is_twice_its_flux_over_its_wavenumber() {
    let mut request = aluminium();
    request.wave = Wave::Bending { edge: Edge::Supported, thick_plate: false };
    let designed = design(&request, &mut Progress::unwatched()).expect("possible");
    // omega = s (k^2 + (q/W)^2): v_g = 2 s k0 with s = sqrt(D/rho h) = 3.114 m^2/s.
    let wide = designed.plate.half_width_m(0.0);
    let k0 = (TAU * 28e3 / 3.114 - (std::f64::consts::FRAC_PI_2 / wide).powi(2)).sqrt();
    let resistance = 2700.0 * 2e-3 * wide * 2.0 * 3.114 * k0;
    let found = designed.plate.wave_impedance_n_s_per_m(28e3).expect("bending");
    assert!((found / resistance - 1.0).abs() < 2e-3, "{found} {resistance}");
}

#[test]
fn loss_limits_and_mode_free_travel_are_the_closed_forms() {
    let designed = design(&membrane(), &mut Progress::unwatched()).expect("possible");
    // The third width mode enters when the arc at the boundary is a third of the one at the driven end: a little more
    // than ln 3/d from it, or less in a film. The second enters at half of it.
    let d = designed.rate_per_m;
    let square = designed.plate.spec().model.film_square().expect("a film");
    // Half of the width that vibrates, and half of the wavefront's arc across it.
    let wide = |x: f64| {
        let half_width_m = designed.plate.half_width_m(0.0) * (-d * x).exp();
        std::f64::consts::FRAC_PI_2 * half_width_m / FilmEdge::new(half_width_m / square.sqrt()).number
    };
    let arc = |x: f64| {
        let slope = (wide(x + 1e-5) - wide(x - 1e-5)) / 2e-5;
        wide(x) * slope.atan() / slope
    };
    let enters = |mode: f64| {
        let (mut low, mut high) = (0.0, 0.6);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if arc(middle) > arc(0.0) / mode { low = middle } else { high = middle }
        }
        low
    };
    // A film's width falls faster than the plate's, and along an arc it falls more slowly.
    assert!((0.9..1.1).contains(&(enters(3.0) * d / 3.0_f64.ln())), "{}", enters(3.0));
    let third = enters(3.0).min(designed.high.boundary_m);
    assert!((designed.single_boundary_to_m - third).abs() < 1e-9);
    let second = enters(2.0).min(designed.high.boundary_m);
    assert!((designed.single_boundary_off_centre_to_m - second).abs() < 1e-9);
    assert!((designed.mode_free_travel_m() - (third - designed.low.boundary_m)).abs() < 1e-9);
    let scaled = designed.high.loss_integral * designed.loss_factor_limit / 0.05;
    assert!((scaled - 3.0).abs() < 1e-6, "{scaled}");
}

#[test]
fn requests_that_cannot_be_met_name_the_field_and_what_is_allowed() {
    let refused = |change: &dyn Fn(&mut Request)| {
        let mut request = aluminium();
        change(&mut request);
        design(&request, &mut Progress::unwatched()).expect_err("impossible").to_string()
    };
    for (field, error) in [
        ("thickness_m = 0:", refused(&|r| r.thickness_m = 0.0)),
        ("length_m = nan", refused(&|r| r.length_m = f64::NAN)),
        ("band high = 20000", refused(&|r| r.band_hz = (20e3, 20e3))),
        ("band low = -1", refused(&|r| r.band_hz.0 = -1.0)),
        ("start_margin_m = 0.4", refused(&|r| r.start_margin_m = Some(0.4))),
        ("end_margin_m = -0.1", refused(&|r| r.end_margin_m = Some(-0.1))),
        ("length_m = 0.01:", refused(&|r| r.length_m = 0.01)),
        ("rim_m = 0:", refused(&|r| r.rim_m = 0.0)),
        ("name", refused(&|r| r.name = String::new())),
        ("material.loss_factor = 7", refused(&|r| r.material.loss_factor = 7.0)),
    ] {
        assert!(error.starts_with(field) && error.contains("must be"), "{field}: {error}");
    }
    let error = refused(&|r| {
        r.start_margin_m = Some(0.2);
        r.end_margin_m = Some(0.2);
    });
    assert!(error.contains("margins"), "{error}");
    let error = Material::named("unobtainium").expect_err("unknown").to_string();
    assert!(error.contains("unobtainium") && error.contains("aluminium"), "{error}");
    assert!(material_names().all(|name| Material::named(name).is_ok_and(|m| m.validate().is_ok())));
}

#[test]
fn the_svg_is_well_formed_and_as_large_as_the_part_in_millimetres() {
    for request in [aluminium(), membrane()] {
        let designed = design(&request, &mut Progress::unwatched()).expect("possible");
        let (wide, length) = (designed.plate.half_width_m(0.0) * 1e3, request.length_m * 1e3);
        let start = -designed.damper.lead_in.map_or(0.0, |lead_in| lead_in.length_m * 1e3);
        let frame = designed.frame_drawing();
        let expected = [start - 35.0, -wide - 20.0, length + 20.0, wide + 20.0];
        close(&svg_cut_extents(&frame.to_svg()), &expected);
        close(&frame.cut_extents_mm(), &expected);
        let plate = designed.plate_drawing();
        let expected = if designed.mounting == Mounting::Lip {
            [start, -wide - 1.0, length + 1.0, wide + 1.0]
        } else {
            [start, -wide - 20.0, length + 20.0, wide + 20.0]
        };
        close(&svg_cut_extents(&plate.to_svg()), &expected);
        assert!(plate.to_svg().contains(&format!("{:.2} mm", expected[2] - start)), "the length is written");
    }
}

#[test]
fn the_dxf_is_release_12_and_as_large_as_the_part_in_millimetres() {
    for request in [aluminium(), membrane()] {
        let designed = design(&request, &mut Progress::unwatched()).expect("possible");
        for drawing in [designed.plate_drawing(), designed.frame_drawing()] {
            close(&dxf_cut_extents(&drawing.to_dxf()), &drawing.cut_extents_mm());
        }
    }
}

#[test]
fn the_cut_edge_stays_within_a_hundredth_of_a_millimetre_of_the_taper() {
    let designed = design(&membrane(), &mut Progress::unwatched()).expect("possible");
    let frame = designed.frame_drawing();
    let window = outlines(&frame)[1];
    let upper: Vec<[f64; 2]> = window.iter().copied().filter(|p| p[1] > 0.0 && p[0] >= 0.0).collect();
    assert!(upper.len() > 10);
    for pair in upper.windows(2) {
        let middle = [0.5 * (pair[0][0] + pair[1][0]), 0.5 * (pair[0][1] + pair[1][1])];
        let exact = designed.plate.half_width_m(middle[0] * 1e-3) * 1e3;
        assert!((middle[1] - exact).abs() < 0.01, "{middle:?} {exact}");
    }
}

#[test]
fn bolts_stand_in_the_rim_and_never_in_the_window() {
    let designed = design(&membrane(), &mut Progress::unwatched()).expect("possible");
    let (wide, length) = (designed.plate.half_width_m(0.0) * 1e3, 400.0);
    let mut holes = 0;
    for shape in designed.frame_drawing().shapes {
        if let Shape::Hole { centre: [x, z], diameter } = shape {
            holes += 1;
            let clear = 0.5 * diameter + 5.0;
            assert!(z.abs() >= wide + clear || x >= length + clear, "({x}, {z})");
        }
    }
    assert!(holes >= 12, "{holes}");
}

#[test]
fn a_plate_that_may_turn_lies_on_the_frame_all_around_the_window_and_clear_of_the_bolts() {
    let mut request = aluminium();
    request.rim_m = limits::RIM.low;
    let designed = design(&request, &mut Progress::unwatched()).expect("possible");
    let (plate, frame) = (designed.plate_drawing(), designed.frame_drawing());
    let (sheet, window) = (outlines(&plate)[0], outlines(&frame)[1]);
    let half_at = |outline: &[[f64; 2]], x: f64| {
        let upper: Vec<_> = outline.iter().filter(|p| p[1] > 0.0).collect();
        let pair = upper.windows(2).find(|p| p[0][0] <= x && x < p[1][0]).expect("on it");
        pair[0][1] + (pair[1][1] - pair[0][1]) * (x - pair[0][0]) / (pair[1][0] - pair[0][0])
    };
    let lead_in_mm = designed.damper.lead_in.expect("a lead-in").length_m * 1e3;
    for step in 0..300 + lead_in_mm as u32 {
        let x = f64::from(step) - lead_in_mm;
        let lip = half_at(sheet, x) - half_at(window, x);
        assert!((lip - outline::LIP_MM).abs() < 1e-6, "{x}: {lip}");
    }
    // Closed by a lip at the narrow end, free at the lead-in's.
    assert_eq!(plate.cut_extents_mm()[2], 300.0 + outline::LIP_MM);
    assert_eq!(plate.cut_extents_mm()[0], -lead_in_mm);
    for shape in &frame.shapes {
        if let Shape::Hole { centre: [x, z], diameter } = *shape {
            let is_clear = x - 0.5 * diameter > 300.5 + outline::LIP_MM
                || z.abs() - 0.5 * diameter > half_at(sheet, x.min(299.0)) + 0.5;
            assert!(is_clear, "({x}, {z})");
        }
    }
    assert!(designed.mounting.sentence().contains(&format!("lip of {} mm", outline::LIP_MM)));
}

#[test]
fn the_cut_files_say_how_the_parts_are_put_together() {
    let mut clamped = aluminium();
    clamped.wave = Wave::Bending { edge: Edge::Clamped, thick_plate: true };
    for (request, word) in
        [(aluminium(), "must turn"), (clamped, "cannot turn"), (membrane(), "once it is stretched")]
    {
        let designed = design(&request, &mut Progress::unwatched()).expect("possible");
        for drawing in [designed.plate_drawing(), designed.frame_drawing()] {
            let notes: Vec<&str> = drawing
                .shapes
                .iter()
                .filter_map(|shape| match shape {
                    Shape::Note { text, .. } => Some(text.as_str()),
                    _ => None,
                })
                .collect();
            assert!(notes.join(" ").starts_with(designed.mounting.sentence()), "{notes:?}");
            let (svg, dxf) = (drawing.to_svg(), drawing.to_dxf());
            let document = roxmltree::Document::parse(&svg).expect("well-formed");
            for note in notes {
                assert!(document.descendants().any(|node| node.text() == Some(note)), "{note}");
                assert!(dxf.lines().any(|line| line == note), "{note}");
            }
            assert!(designed.mounting.sentence().contains(word));
        }
    }
}

#[test]
fn the_description_rounds_its_numbers_and_writes_kilohertz() {
    let described = |request: &Request| {
        design(request, &mut Progress::unwatched()).expect("possible").plate.spec().description.clone()
    };
    assert_eq!(
        described(&aluminium()),
        "Designed: aluminium 2 mm, bending, supported edges, turning points from 20 kHz to 40 kHz"
    );
    let text = described(&membrane());
    assert!(text.ends_with("0.5 mm, stretched, turning points from 80 Hz to 220 Hz"), "{text}");
    let mut request = aluminium();
    request.thickness_m = 2.0 / 3.0 * 1e-3;
    request.band_hz.0 = 1e5 / 3.0;
    assert!(described(&request).contains("0.6667 mm") && described(&request).contains("33.333 kHz"));
}

#[test]
fn names_with_markup_do_not_break_the_files() {
    let mut request = membrane();
    request.name = "a<b>&\"c\" \u{e9}".to_owned();
    let designed = design(&request, &mut Progress::unwatched()).expect("possible");
    svg_cut_extents(&designed.frame_drawing().to_svg());
    dxf_cut_extents(&designed.frame_drawing().to_dxf());
    assert!(Plate::from_toml(&designed.plate.to_toml()).is_ok());
}

/// Numbers as they may come from outside: in range, far out of range, and not a number.
fn any_number(low: f64, high: f64) -> impl Strategy<Value = f64> {
    prop_oneof![
        12 => (low.ln()..high.ln()).prop_map(f64::exp),
        1 => prop_oneof![Just(0.0), Just(-1.0), Just(f64::NAN), Just(f64::INFINITY), Just(1e-300), Just(1e300)],
    ]
}

fn any_wave() -> impl Strategy<Value = Wave> {
    prop_oneof![
        6 => any::<bool>().prop_map(|thick_plate| Wave::Bending { edge: Edge::Supported, thick_plate }),
        // Its lead-in takes a tenth of a second to find.
        1 => any::<bool>().prop_map(|thick_plate| Wave::Bending { edge: Edge::Clamped, thick_plate }),
        6 => any_number(1.0, 1e3).prop_map(|wave_speed_m_per_s| Wave::Membrane { wave_speed_m_per_s }),
        6 => Just(Wave::ShearHorizontal),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn any_request_is_refused_with_the_allowed_range_or_gives_a_plate_with_its_band(
        number in 0..11_usize,
        thickness_m in any_number(1e-5, 1e-2),
        wave in any_wave(),
        low_hz in any_number(20.0, 5e4),
        octaves in 0.0..3.0_f64,
        length_m in any_number(0.02, 5.0),
        margins in (proptest::option::of(any_number(1e-3, 1.0)), proptest::option::of(any_number(1e-3, 1.0))),
        rim_m in any_number(0.01, 0.5),
    ) {
        let name = material_names().nth(number).expect("eleven");
        let material = Material::named(name).expect("known");
        let band_hz = (low_hz, low_hz * octaves.exp2());
        let mut request = Request::new("any", material, thickness_m, wave, band_hz, length_m);
        (request.start_margin_m, request.end_margin_m) = margins;
        request.rim_m = rim_m;
        match design(&request, &mut Progress::unwatched()) {
            Err(error) => {
                let text = error.to_string();
                prop_assert!(text.contains("must be") || text.contains("at most"), "{}", text);
            }
            Ok(designed) => {
                let read = Plate::from_toml(&designed.plate.to_toml()).expect("a valid plate file");
                let (low, high) = read.band_hz();
                let is_near = |found: f64, wanted: f64| (found / wanted - 1.0).abs() < 1e-6;
                prop_assert!(is_near(low, band_hz.0) && is_near(high, band_hz.1), "{low} to {high} Hz, not {band_hz:?}");
                prop_assert!(designed.damper.resistance_n_s_per_m > 0.0);
                for drawing in [designed.plate_drawing(), designed.frame_drawing()] {
                    let extents = drawing.cut_extents_mm();
                    prop_assert!(extents.iter().all(|x| x.is_finite()) && extents[2] > extents[0]);
                }
                if let Ok(checker) = Checker::new(&designed.plate, Conditions::default()) {
                    let report = checker.at(designed.low.boundary_m).expect("on the plate");
                    prop_assert!(report.lights.iter().all(|light| light.value.is_none_or(f64::is_finite)));
                }
            }
        }
    }
}

fn outlines(drawing: &Drawing) -> Vec<&[[f64; 2]]> {
    let shapes = drawing.shapes.iter();
    shapes
        .filter_map(|shape| match shape {
            Shape::Outline { points } => Some(points.as_slice()),
            _ => None,
        })
        .collect()
}

fn close(found: &[f64; 4], expected: &[f64; 4]) {
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() < 1e-3, "{found:?} {expected:?}");
    }
}

fn grow(extents: &mut [f64; 4], x: f64, z: f64, r: f64) {
    *extents = [extents[0].min(x - r), extents[1].min(z - r), extents[2].max(x + r), extents[3].max(z + r)];
}

const NOTHING: [f64; 4] = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];

/// Extents of the cut layer, read by an XML parser; they must lie in the view box, whose unit is 1 mm.
fn svg_cut_extents(svg: &str) -> [f64; 4] {
    let document = roxmltree::Document::parse(svg).expect("well-formed");
    let root = document.root_element();
    let number = |node: roxmltree::Node<'_, '_>, name: &str| -> f64 {
        node.attribute(name).expect(name).trim_end_matches("mm").parse().expect(name)
    };
    let view: Vec<f64> =
        root.attribute("viewBox").expect("view box").split(' ').map(|n| n.parse().expect("number")).collect();
    assert_eq!([number(root, "width"), number(root, "height")], [view[2], view[3]], "true size");
    let cut = root.children().find(|node| node.attribute("id") == Some("cut")).expect("cut layer");
    let mut extents = NOTHING;
    for node in cut.children().filter(roxmltree::Node::is_element) {
        match node.tag_name().name() {
            "path" => {
                let path = node.attribute("d").expect("d").trim();
                let path = path.strip_prefix('M').and_then(|p| p.strip_suffix('Z')).expect("closed");
                for pair in path.split('L') {
                    let (x, y) = pair.trim().split_once(' ').expect("a pair");
                    grow(&mut extents, x.parse().expect("x"), -y.parse::<f64>().expect("y"), 0.0);
                }
            }
            "circle" => grow(&mut extents, number(node, "cx"), -number(node, "cy"), number(node, "r")),
            other => panic!("{other} is not cut"),
        }
    }
    assert!(extents[0] >= view[0] && extents[2] <= view[0] + view[2], "{extents:?} {view:?}");
    assert!(-extents[3] >= view[1] && -extents[1] <= view[1] + view[3], "{extents:?} {view:?}");
    extents
}

/// Extents of the cut layer, from the file's group codes; sections and polylines must be properly closed.
fn dxf_cut_extents(dxf: &str) -> [f64; 4] {
    let lines: Vec<&str> = dxf.lines().collect();
    assert!(dxf.is_ascii() && lines.len().is_multiple_of(2), "pairs of lines");
    let pairs: Vec<(i32, &str)> =
        lines.chunks(2).map(|pair| (pair[0].trim().parse().expect("a group code"), pair[1])).collect();
    for (name, value) in [("$ACADVER", (1, "AC1009")), ("$INSUNITS", (70, "4")), ("$MEASUREMENT", (70, "1"))]
    {
        assert!(
            pairs.windows(2).any(|w| w[0] == (9, name) && w[1] == value),
            "{name}: release 12, millimetres"
        );
    }
    assert_eq!(pairs.last(), Some(&(0, "EOF")));
    let (mut extents, mut sections, mut open) = (NOTHING, 0, false);
    let starts: Vec<usize> = (0..pairs.len()).filter(|&i| pairs[i].0 == 0).collect();
    for (n, &start) in starts.iter().enumerate() {
        let body = &pairs[start..starts.get(n + 1).copied().unwrap_or(pairs.len())];
        let number = |code: i32| {
            body.iter().find(|pair| pair.0 == code).and_then(|pair| pair.1.parse::<f64>().ok()).unwrap_or(0.0)
        };
        let cut = body.contains(&(8, "CUT"));
        match body[0].1 {
            "SECTION" => sections += 1,
            "ENDSEC" => sections -= 1,
            "POLYLINE" => {
                assert!(!open && number(70) == 1.0 && number(66) == 1.0, "closed");
                open = true;
            }
            "VERTEX" => {
                assert!(open && cut);
                grow(&mut extents, number(10), number(20), 0.0);
            }
            "SEQEND" => open = false,
            "CIRCLE" if cut => grow(&mut extents, number(10), number(20), number(40)),
            _ => {}
        }
    }
    assert_eq!((sections, open), (0, false));
    extents
}
