//! Plate files: a file that is written is read back unchanged, and no invalid text is accepted or causes a panic.

mod air;
mod drive;

use proptest::prelude::*;
use slipline_plate::{
    Actuator, DriveEnd, DriveTable, EndSlope, Impedance, LeadIn, Plate, PlateError, PlateFileError,
    ResponseCurve, Source, TurningWidth, preset, presets,
};

const GOOD: &str = r#"
name = "mine"
length_m = 0.3
loss_factor = 0.01
span_start_m = 0.08
span_end_m = 0.25

[taper]
kind = "exponential"
half_width_m = 0.05
rate_per_m = 4.62

[model]
kind = "membrane"
wave_speed_m_per_s = 12.0

[drive]
end = "displacement"
"#;

fn refusal(from: &str, to: &str) -> String {
    assert!(GOOD.contains(from), "{from}");
    Plate::from_toml(&GOOD.replace(from, to)).expect_err(to).to_string()
}

/// Cases of (text in a good file, its replacement, text that the refusal must contain).
fn assert_refused(cases: &[(&str, &str, &str)]) {
    for (from, to, wanted) in cases {
        let found = refusal(from, to);
        assert!(found.contains(wanted), "{to}: {found}");
    }
}

/// Cases of (line that takes the place of a good file's line of the same field, text that the refusal must contain).
fn assert_line_refused(cases: &[(&str, &str)]) {
    for (line, wanted) in cases {
        let field = line.split_inclusive(" = ").next().expect("a field");
        let good = GOOD.lines().find(|good| good.starts_with(field)).expect(field);
        assert_refused(&[(good, line, wanted)]);
    }
}

#[test]
fn every_preset_reads_writes_and_reads_the_same() {
    assert_eq!(presets()[0].name, "latex-membrane", "first what one can build");
    for entry in presets() {
        let plate = Plate::from_toml(entry.toml).unwrap_or_else(|error| panic!("{}: {error}", entry.name));
        assert_eq!(plate.name(), entry.name);
        assert!(!entry.description().is_empty() && entry.description().len() < 200);
        assert_eq!(Plate::from_toml(&plate.to_toml()).expect("its own text"), plate);
    }
}

#[test]
fn a_refusal_names_the_field_its_line_and_the_allowed_range() {
    assert_line_refused(&[
        ("half_width_m = -1.0", "line 10: taper.half_width_m = -1: must be 1e-5 to 10 m"),
        ("half_width_m = 0.0", "taper.half_width_m = 0"),
        ("half_width_m = nan", "taper.half_width_m = nan: must be 1e-5 to 10 m"),
        ("rate_per_m = inf", "line 11: taper.rate_per_m = inf: must be 0.01 to 1000 1/m"),
        ("rate_per_m = 900.0", "taper.rate_per_m = 900: must be at most"),
        ("loss_factor = -0.1", "line 4: loss_factor = -0.1: must be 0 to 0.5"),
        ("length_m = 1e300", "length_m"),
        ("span_end_m = 0.05", "span_end_m = 0.05: must be 0.0803 to 0.3 m"),
        ("wave_speed_m_per_s = 12.0\ndensity_kg_per_m3 = 1000.0", "model.density_kg_per_m3 does not belong"),
        ("wave_speed_m_per_s = 1e9", "model.wave_speed_m_per_s"),
        ("end = \"resistance\"\nratio = 1.0", "drive.at_frequency_hz is missing"),
        (
            "end = \"resistance\"\nratio = 1.0\nat_frequency_hz = 20.0",
            "line 20: drive.at_frequency_hz = 20: must be 61.059 to 1e7 Hz",
        ),
        (
            "name = \"mine\"\ncolour = 3",
            "line 3: colour does not belong here: the fields here are name, description",
        ),
        ("name = ", "line 2:"),
        ("name = \"\"", "name has 0 characters: must be 1 to 80"),
    ]);
    assert_refused(&[
        ("span_start_m = 0.08\n", "", "span_start_m is missing"),
        ("rate_per_m = 4.62\n", "", "line 8: taper.rate_per_m is missing: \"exponential\" needs it"),
        ("kind = \"membrane\"", "kind = \"jelly\"", "model.kind = \"jelly\": must be one of \"membrane\""),
    ]);
}

#[test]
fn a_value_of_another_kind_is_quoted_with_the_expected_kind() {
    assert_line_refused(&[
        ("length_m = \"300 mm\"", "line 3: length_m = \"300 mm\": must be a number, 0.005 to 10 m"),
        ("length_m = 1e999", "line 3: length_m = 1e999: must be a number, 0.005 to 10 m"),
        ("length_m = 1e300", "line 3: length_m = 1e300: must be 0.005 to 10 m"),
        ("length_m = 99999999999999999999", "line 3: length_m = 1e20: must be 0.005 to 10 m"),
        ("name = 5", "line 2: name = 5: must be a text in quotes, 1 to 80 characters"),
        ("half_width_m = true", "line 10: taper.half_width_m = true: must be a number, 1e-5"),
        ("half_width_m = [1]", "line 10: taper.half_width_m = [1]: must be a number"),
        ("span_end_m = \"far\"", "span_end_m = \"far\": must be a number, up to length_m, in m"),
        ("end = \"displacment\"", "\"resistance\", \"source\"; did you mean \"displacement\"?"),
    ]);
    assert_refused(&[
        ("kind = \"membrane\"", "kind = 3", "line 14: model.kind = 3: must be one of \"membrane\", \"shear"),
        ("[taper]", "[[taper]]", "line 8: taper = "),
    ]);
    let sampled = "kind = \"sampled\"\npoints = [[0.0, 0.05],\n  [0.1, \"x\"], [0.3, 0.01]]";
    let found = refusal("kind = \"exponential\"\nhalf_width_m = 0.05\nrate_per_m = 4.62", sampled);
    assert!(found.contains("line 11: taper.points[1] = [0.1, \"x\"]: must be a pair"), "{found}");
}

#[test]
fn a_number_that_toml_cannot_read_is_refused_with_its_field_and_range() {
    assert_line_refused(&[
        (
            "half_width_m = 0,05",
            "line 10: taper.half_width_m = 0,05: must be a number with a decimal point and no unit, 1e-5 to 10 m (",
        ),
        ("length_m = 300mm", "line 3: length_m = 300mm: must be a number with a decimal point"),
        ("name = mine", "line 2: name = mine: must be a text in quotes, 1 to 80 characters ("),
        ("loss_factor = 0.01\nloss_factor = 0.02", "line 5: loss_factor: duplicate key"),
    ]);
}

#[test]
fn a_name_that_is_not_known_is_answered_with_the_one_that_was_meant() {
    assert_line_refused(&[
        ("rate_per_m = 4.62\nloss_factor = 0.1", "write it above the first [section]"),
        (
            "name = \"mine\"\nrate_per_m = 4.62",
            "line 3: rate_per_m does not belong here: it is a field of [taper]",
        ),
        ("rate_per_m = 4.62\npoints = []", "\"exponential\" has half_width_m, rate_per_m"),
    ]);
    assert_refused(&[
        ("length_m = 0.3", "lenght_m = 0.3", "line 3: lenght_m does not belong here: did you mean length_m?"),
        ("length_m = 0.3", "length = 0.3", "did you mean length_m?"),
        ("[taper]", "[tapper]", "line 8: [tapper] does not belong here: did you mean [taper]?"),
        ("[drive]", "[colour]", "[colour] does not belong here: the sections of a plate are [taper]"),
        (
            "rate_per_m = 4.62",
            "rat_per_m = 4.62",
            "line 11: taper.rat_per_m does not belong here: did you mean rate_per_m?",
        ),
    ]);
    let long = format!("{} = 1\n", "x".repeat(1 << 19));
    assert!(Plate::from_toml(&long).expect_err("a long name").to_string().len() < 400);
}

#[test]
fn missing_fields_are_listed_at_once_with_meaning_and_range() {
    let found = Plate::from_toml("name = \"x\"\n").expect_err("a name alone").to_string();
    assert_eq!(
        found,
        "length_m is missing: from the driven end to the narrow end, a number, 0.005 to 10 m; missing too: \
         loss_factor, span_start_m, span_end_m, [taper], [model], [drive]"
    );
    let found = Plate::from_toml("").expect_err("nothing").to_string();
    assert!(
        found.starts_with("name is missing: the plate's short name, a text in quotes, 1 to 80"),
        "{found}"
    );
    let cases = [
        (
            "span_end_m = 0.25\n",
            "span_end_m is missing: the farthest turning point that is offered, a number, up to length_m",
        ),
        (
            "span_start_m = 0.08\nspan_end_m = 0.25\n",
            "span_start_m and span_end_m, or band_start_hz and band_end_hz",
        ),
        (
            "rate_per_m = 4.62\n",
            "\"exponential\" needs it: how fast the half-width falls, a number, 0.01 to 1000 1/m",
        ),
        (
            "kind = \"membrane\"\n",
            "line 13: model.kind is missing: material, edge and wave, one of \"membrane\"",
        ),
        (
            "[drive]\nend = \"displacement\"\n",
            "drive is missing: the boundary condition at the driven end, a section [drive]",
        ),
    ];
    for (from, wanted) in cases {
        let found = refusal(from, "");
        assert!(found.contains(wanted), "{from}: {found}");
    }
    let found =
        Plate::from_toml(&format!("{GOOD}[actuator]\nresonance_hz = 40\n")).expect_err("half an actuator");
    assert_eq!(
        found.to_string(),
        "line 19: actuator.quality is missing: quality factor of the resonance, a number, 0.1 to 1000"
    );
}

#[test]
fn a_calibration_is_read_written_and_corrects_the_drive() {
    let section = "[calibration]\nchi2_per_n = 0.9\nhalf_width_tolerance = 0.001\ntaper_tolerance = 0.002\n";
    let read = |points: &str| Plate::from_toml(&format!("{GOOD}{section}{points}"));
    let plain = Plate::from_toml(GOOD).expect("a plate");
    let without = read("").expect("a calibration of places alone");
    assert_eq!(without.drive_response(100.0), plain.drive_response(100.0));
    let plate = read("points = [[50.0, 20.0, 0.0], [500.0, 20.0, 0.0]]\n").expect("a calibration");
    for plate in [&plate, &without] {
        assert_eq!(Plate::from_toml(&plate.to_toml()).as_ref(), Ok(plate));
    }
    assert!((plate.drive_response(100.0) / plain.drive_response(100.0) - 10.0).norm() < 1e-9);
    let peak = |plate: &Plate| DriveTable::build(plate, 400e3, 17).expect("a table").peak_at_full_scale_m();
    assert!((peak(&plate) / peak(&plain) - 10.0).abs() < 1e-9, "what the table levels");
    let known = read(
        "level_tolerance_db = 0.4\nresistance_tolerance_n_s_per_m = 0.1\nmass_tolerance_kg = 1e-4\nstiffness_tolerance_n_per_m = 20.0\n",
    );
    let known = known.expect("intervals of level and source");
    assert_eq!(Plate::from_toml(&known.to_toml()).as_ref(), Ok(&known));
    let calibration = known.spec().calibration.as_ref().expect("calibrated");
    let source = calibration.source_tolerance.expect("stated");
    assert_eq!(
        (calibration.level_tolerance_db, source.mass_kg, source.stiffness_n_per_m),
        (Some(0.4), 1e-4, 20.0)
    );
    let loud = read("level_tolerance_db = 41\n").expect_err("out of range").to_string();
    assert!(loud.contains("calibration.level_tolerance_db = 41: must be 0 to 40 dB"), "{loud}");
    let part = read("mass_tolerance_kg = 1e-4\n").expect_err("a part of a source").to_string();
    assert!(part.contains("calibration.resistance_tolerance_n_s_per_m is missing"), "{part}");
    let light = read(
        "resistance_tolerance_n_s_per_m = 0.1\nmass_tolerance_kg = -1\nstiffness_tolerance_n_per_m = 0\n",
    );
    let light = light.expect_err("out of range").to_string();
    assert!(light.contains("calibration.mass_tolerance_kg = -1: must be 0 to 1000 kg"), "{light}");
    let falling = read("points = [[50.0, 0.0, 0.0], [40.0, 0.0, 0.0]]\n").expect_err("falls");
    assert!(falling.to_string().contains("calibration.points[1][0] = 40"), "{falling}");
    let half = GOOD.to_owned() + "[calibration]\nchi2_per_n = 0.9\n";
    let half = Plate::from_toml(&half).expect_err("half a calibration");
    assert!(half.to_string().contains("calibration.half_width_tolerance is missing"), "{half}");
    let wide = format!("{GOOD}{}", section.replace("0.001", "1.5"));
    let wide = Plate::from_toml(&wide).expect_err("out of range");
    assert!(wide.to_string().contains("calibration.half_width_tolerance = 1.5: must be 0 to 1"), "{wide}");
}

#[test]
fn a_loss_tolerance_is_read_written_and_refused_by_its_range() {
    let plate = Plate::from_toml(GOOD).expect("good");
    assert_eq!(plate.spec().loss_tolerance, None);
    assert!(!plate.to_toml().contains("loss_tolerance"));
    let text = GOOD.replace("loss_factor = 0.01", "loss_factor = 0.01\nloss_tolerance = 1.5");
    let plate = Plate::from_toml(&text).expect("stated");
    assert_eq!(plate.spec().loss_tolerance, Some(1.5));
    assert_eq!(Plate::from_toml(&plate.to_toml()).expect("written"), plate);
    assert_refused(&[
        (
            "loss_factor = 0.01",
            "loss_factor = 0.01\nloss_tolerance = 4.5",
            "loss_tolerance = 4.5: must be 0 to 4",
        ),
        (
            "loss_factor = 0.01",
            "loss_factor = 0.01\nloss_tolerance = -0.1",
            "line 5: loss_tolerance = -0.1: must be 0 to 4",
        ),
    ]);
}

#[test]
fn a_band_that_cannot_enter_is_refused_with_the_lowest_frequency_that_can() {
    let band = |low: f64, high: f64| {
        GOOD.replace(
            "span_start_m = 0.08\nspan_end_m = 0.25",
            &format!("band_start_hz = {low:?}\nband_end_hz = {high:?}"),
        )
    };
    let plate = Plate::from_toml(&band(87.0, 190.0)).expect("a band that enters");
    assert!((plate.band_hz().0 - 87.0).abs() < 1e-6 && (plate.band_hz().1 - 190.0).abs() < 1e-6);
    for (low, high, wanted) in [
        (40.0, 190.0, "band_start_hz = 40: must be above 61.135 Hz and up to 240.19 Hz"),
        (87.0, 9e3, "band_end_hz = 9000: must be above 87 Hz and up to 240.19 Hz"),
    ] {
        let found = Plate::from_toml(&band(low, high)).expect_err("out of band").to_string();
        assert!(found.contains(wanted), "{found}");
    }
}

#[test]
fn a_sampled_taper_must_narrow_cover_the_plate_and_be_short() {
    let sampled = |points: &str| {
        GOOD.replace(
            "kind = \"exponential\"\nhalf_width_m = 0.05\nrate_per_m = 4.62",
            &format!("kind = \"sampled\"\npoints = {points}"),
        )
    };
    assert!(Plate::from_toml(&sampled("[[0.0, 0.05], [0.1, 0.03], [0.3, 0.012]]")).is_ok());
    for (points, wanted) in [
        ("[[0.0, 0.05], [0.1, 0.06], [0.3, 0.01]]", "taper.points[1]"),
        ("[[0.0, 0.05], [0.0, 0.04], [0.3, 0.01]]", "taper.points[1]"),
        ("[[0.0, 0.05], [0.1, 0.0], [0.3, -0.01]]", "taper.points[1][1] = 0"),
        ("[[0.0, 0.05], [0.2, 0.01]]", "must cover the plate"),
        ("[[0.1, 0.05], [0.3, 0.01]]", "the driven end"),
        ("[]", "taper.points has 0 points: must be 2 to 10000"),
        ("[[0.0, nan], [0.3, 0.01]]", "taper.points[0][1] = nan"),
    ] {
        let found = Plate::from_toml(&sampled(points)).expect_err(points).to_string();
        assert!(found.contains(wanted) && found.starts_with("line 10"), "{points}: {found}");
    }
    let million: String =
        (0..60_000).map(|i| format!("[{},{}],", f64::from(i) * 1e-5, 0.1 - f64::from(i) * 1e-6)).collect();
    let found = Plate::from_toml(&sampled(&format!("[{million}]"))).expect_err("too many points").to_string();
    assert!(found.contains("bytes: must be at most") || found.contains("must be 2 to 10000"), "{found}");
}

#[test]
fn a_huge_file_is_refused_before_it_is_parsed() {
    let huge = "a".repeat(2 << 20);
    assert!(matches!(Plate::from_toml(&huge), Err(PlateFileError::TooBig { .. })));
}

#[test]
fn a_sampled_exponential_is_the_exponential() {
    let plate = preset("al-bending").expect("a preset");
    let mut spec = plate.spec().clone();
    let points = (0..=34).map(|i| [f64::from(i) * 0.01, plate.half_width_m(f64::from(i) * 0.01)]).collect();
    spec.taper = slipline_plate::Taper::Sampled { points };
    let sampled = Plate::new(spec).expect("a valid plate");
    for frequency in [8e3, 20e3, 39e3] {
        let (a, b) = (sampled.turning_point_m(frequency), plate.turning_point_m(frequency));
        assert!((a.expect("enters") - b.expect("enters")).abs() < 1e-9);
    }
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<f64>(),
        -1.0..1.0,
        1e-6..1e6,
        Just(f64::NAN),
        Just(f64::INFINITY),
        Just(0.0),
        Just(-0.0),
        Just(f64::MIN_POSITIVE),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn no_numbers_make_a_plate_panic(
        values in prop::collection::vec(number(), 20), kind in 0..3_usize, model in 0..4_usize, end in 0..4_usize,
        measured in any::<bool>(),
    ) {
        let mut value = values.into_iter();
        let mut next = || value.next().map_or_else(|| "1.0".to_owned(), |v| if v.is_nan() { "nan".to_owned() } else { format!("{v:?}") });
        let taper = match kind {
            0 => format!("kind = \"exponential\"\nhalf_width_m = {}\nrate_per_m = {}", next(), next()),
            1 => format!("kind = \"linear\"\nhalf_width_m = {}\nend_half_width_m = {}", next(), next()),
            _ => format!("kind = \"sampled\"\npoints = [[0.0, {}], [{}, {}]]", next(), next(), next()),
        };
        let model = match model {
            0 => format!("kind = \"membrane\"\nwave_speed_m_per_s = {}\ntension_n_per_m = {}", next(), next()),
            1 => format!("kind = \"shear-horizontal\"\nshear_modulus_pa = {}\ndensity_kg_per_m3 = {}\nthickness_m = 0.01", next(), next()),
            2 => format!("kind = \"bending-clamped\"\nyoungs_modulus_pa = {}\npoisson_ratio = 0.3\ndensity_kg_per_m3 = 2700.0\nthickness_m = {}", next(), next()),
            _ => format!("kind = \"bending-supported\"\nyoungs_modulus_pa = 7e10\npoisson_ratio = {}\ndensity_kg_per_m3 = {}\nthickness_m = 0.002", next(), next()),
        };
        let plate = format!(
            "name = \"x\"\nlength_m = {}\nloss_factor = {}\nspan_start_m = {}\nspan_end_m = {}\n[taper]\n{taper}\n[model]\n{model}\n[drive]\n",
            next(), next(), next(), next()
        );
        let drive = match end {
            0 => "end = \"displacement\"\nslope = \"held\"".to_owned(),
            1 => format!("end = \"resistance\"\nratio = {}\nat_frequency_hz = {}", next(), next()),
            _ => format!(
                "end = \"source\"\nat_frequency_hz = {}\nresistance_n_s_per_m = {}\nmass_kg = {}\nstiffness_n_per_m = {}",
                next(), next(), next(), next()
            ),
        };
        let lead_in = if end == 3 {
            format!("\n[drive.lead_in]\nlength_m = {}\nloss_factor = {}\nend_resistance_n_s_per_m = {}", next(), next(), next())
        } else {
            String::new()
        };
        let actuator = if measured {
            format!("\n[actuator]\npoints = [[20.0, {}, {}], [{}, 0.0, 0.0]]\n", next(), next(), next())
        } else {
            String::new()
        };
        let text = format!("{plate}{drive}{lead_in}{actuator}");
        if let Ok(plate) = Plate::from_toml(&text) {
            let (low, high) = plate.band_hz();
            prop_assert!(low > 0.0 && high > low && high.is_finite());
            prop_assert_eq!(Plate::from_toml(&plate.to_toml()), Ok(plate));
        }
    }

    #[test]
    fn any_source_is_written_and_read_back_to_the_last_bit(
        impedance in (0.0..1e9_f64, 0.0..1e3_f64, 0.0..1e12_f64), held in any::<bool>(),
        lead_in in proptest::option::of((1e-3..10.0_f64, 0.0..2.0_f64, 0.0..1e9_f64)),
        points in proptest::option::of(prop::collection::vec((1e-3..1.0_f64, -200.0..200.0_f64, -36e3..36e3_f64), 2..9)),
    ) {
        let mut spec = preset("al-bending-displacement").expect("a preset").spec().clone();
        spec.drive_end = DriveEnd::Source(Source {
            impedance: Impedance {
                resistance_n_s_per_m: impedance.0,
                mass_kg: impedance.1,
                stiffness_n_per_m: impedance.2,
            },
            slope: Some(if held { EndSlope::Held } else { EndSlope::Free }),
            lead_in: lead_in.map(|(length_m, loss_factor, end_resistance_n_s_per_m)| {
                LeadIn { length_m, loss_factor, end_resistance_n_s_per_m }
            }),
            ..Source::soft(&spec.model, 28e3)
        });
        spec.actuator = points.map(|points| {
            let rising = points.into_iter().scan(0.0, |hertz, (step, gain_db, phase_deg)| {
                *hertz += 1.0 + 1e3 * step;
                Some([*hertz, gain_db, phase_deg])
            });
            Actuator::Measured(ResponseCurve { points: rising.collect() })
        });
        let plate = Plate::new(spec).expect("in range");
        prop_assert_eq!(Plate::from_toml(&plate.to_toml()), Ok(plate));
    }

    #[test]
    fn no_text_makes_the_reader_panic(text in "(name|taper|points|\\[|\\]|=|\"|[0-9.e-]|\n| ){0,60}") {
        let read: Result<Plate, PlateFileError> = Plate::from_toml(&text);
        prop_assert!(read.is_err());
    }
}

#[test]
fn errors_can_be_matched_by_field() {
    let mut spec = preset("membrane").expect("a preset").spec().clone();
    spec.loss_factor = 2.0;
    let error = Plate::new(spec).expect_err("too lossy");
    assert!(
        matches!(error, PlateError::OutOfRange { ref field, value, .. } if field == "loss_factor" && value == 2.0)
    );
}

#[test]
fn a_span_of_more_than_six_octaves_is_refused() {
    let mut spec = preset("membrane").expect("a preset").spec().clone();
    spec.taper = slipline_plate::Taper::Exponential { half_width_m: 0.5, rate_per_m: 30.0 };
    (spec.length_m, spec.span_start_m, spec.span_end_m) = (0.3, 0.01, 0.2);
    spec.drive_end = slipline_plate::DriveEnd::Displacement;
    spec.turning_width = slipline_plate::TurningWidth::Plain;
    let found = Plate::new(spec).expect_err("too wide a band").to_string();
    assert!(found.contains("span_start_m") && found.contains("1/64"), "{found}");
}

#[test]
fn a_band_is_checked_as_it_is_given_and_not_as_the_widest_span_would_need_it() {
    // 0.2 m/s on a half-width of 1 m: the cut-off is 0.05 Hz, so a span from the wide end would need less than 0.5 Hz.
    let slow = |low: f64, high: f64| {
        let span = format!("band_start_hz = {low:?}\nband_end_hz = {high:?}");
        let text = GOOD
            .replace("span_start_m = 0.08\nspan_end_m = 0.25", &format!("turning_width = \"plain\"\n{span}"))
            .replace("half_width_m = 0.05\nrate_per_m = 4.62", "half_width_m = 1.0\nrate_per_m = 20.0")
            .replace("wave_speed_m_per_s = 12.0", "wave_speed_m_per_s = 0.2");
        Plate::from_toml(&text)
    };
    let plate = slow(1.0, 8.0).expect("1 to 8 Hz turn on the plate");
    let (low_hz, high_hz) = plate.band_hz();
    assert!((low_hz - 1.0).abs() < 1e-9 && (high_hz - 8.0).abs() < 1e-9, "{low_hz} {high_hz}");
    let refused = slow(0.3, 8.0).expect_err("below 0.5 Hz").to_string();
    assert!(refused.contains("band_start_hz = 0.3: must be 0.5 to 1e7 Hz"), "{refused}");
}

#[test]
fn a_file_may_choose_the_turning_width_and_has_the_arc_without_a_choice() {
    let with = |line: &str| GOOD.replace("loss_factor = 0.01", &format!("loss_factor = 0.01\n{line}"));
    let read = |line: &str| Plate::from_toml(&with(line)).map(|plate| plate.spec().turning_width);
    assert_eq!(read(""), Ok(TurningWidth::Arc));
    assert_eq!(read("turning_width = \"arc\""), Ok(TurningWidth::Arc));
    assert_eq!(read("turning_width = \"plain\""), Ok(TurningWidth::Plain));
    for wrong in ["\"round\"", "3"] {
        let refused = read(&format!("turning_width = {wrong}")).expect_err("not a width").to_string();
        let wanted = format!("line 5: turning_width = {wrong}: must be one of \"arc\", \"plain\"");
        assert_eq!(refused, wanted);
    }
}

#[test]
fn no_control_character_of_a_file_gets_into_a_message() {
    for (from, to) in [
        ("length_m = 0.3", "length_m = 0.3\n\"\\u001b[2Jcolour\" = 3"),
        ("kind = \"membrane\"", "kind = \"mem\\u0007brane\""),
        ("name = \"mine\"", "name = \"mi\\u001bne\""),
    ] {
        let told = refusal(from, to);
        assert!(!told.chars().any(char::is_control), "{told:?}");
    }
    let told = refusal("name = \"mine\"", "name = \"mi\\u001bne\"");
    assert!(told.contains("line 2: name: its character 3 is U+001B, a control character"), "{told}");
}
