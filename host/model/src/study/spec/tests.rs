use super::*;
use proptest::prelude::*;
use slipline_plate::preset;

const TEXT: &str = r#"plate = "membrane"
seed = 7
count = 10000
turning_point_m = [0.12, 0.18, 0.24]

[vary]
"model.wave_speed_m_per_s" = { normal = 0.01 }
loss_factor = { log_normal = 0.3 }
"taper.rate_per_m" = { uniform = 0.02 }
"#;

fn spec_of(text: &str) -> Result<Spec, SpecError> {
    let draft = Draft::parse(text)?;
    let named = draft.plate_name().and_then(preset);
    draft.finish(named)
}

#[test]
fn a_specification_reads_back_from_its_own_text_which_names_no_file() {
    let spec = spec_of(TEXT).unwrap();
    let columns: Vec<String> = spec.varied().iter().map(Varied::column).collect();
    assert_eq!(columns, ["vary_loss_factor", "vary_model_wave_speed_m_per_s", "vary_taper_rate_per_m"]);
    assert_eq!((spec.seed(), spec.count(), spec.turning_point_m()), (7, 10_000, &[0.12, 0.18, 0.24][..]));
    let text = spec.to_toml();
    let draft = Draft::parse(&text).unwrap();
    assert_eq!(draft.plate_name(), None);
    let again = draft.finish(None).unwrap();
    assert_eq!(again, spec);
    assert_eq!(again.to_toml(), text);
    for preset in slipline_plate::presets() {
        let place_m = preset.plate().unwrap().span_m().0;
        let vary = "[vary]\nlength_m = { uniform = 1e-3 }";
        let text = format!(
            "plate = {:?}\nseed = 0\ncount = 1\nturning_point_m = [{place_m:?}]\n{vary}",
            preset.name
        );
        let spec = spec_of(&text).unwrap();
        assert_eq!(spec_of(&spec.to_toml()).unwrap(), spec, "{}", preset.name);
    }
}

#[test]
fn edges_give_by_an_offset_also_where_the_file_leaves_them_out() {
    let vary = "[vary]\nedge_give_m = { offset = 3e-4 }";
    let text = format!("plate = \"membrane\"\nseed = 7\ncount = 400\nturning_point_m = [0.16]\n{vary}");
    let spec = spec_of(&text).unwrap();
    assert_eq!(spec_of(&spec.to_toml()).unwrap(), spec);
    assert_eq!((spec.varied()[0].nominal, spec.varied()[0].column().as_str()), (0.0, "vary_edge_give_m"));
    let study = crate::study::Study::new(spec, &mut slipline_plate::Progress::unwatched()).unwrap();
    let chunk = study.run_range(0..400);
    let (mut shift, mut give, mut square) = (0.0, 0.0, 0.0_f64);
    for (give_m, shift_m) in chunk.varied.iter().zip(&chunk.results[0]) {
        shift += give_m * shift_m;
        give += give_m * give_m;
        square += give_m * give_m / 400.0;
    }
    // delta/(W d) with W = 23.9 mm at 160 mm; the arc changes it by a hundredth.
    let per_metre = 1.0 / (4.62 * 0.05 * (-4.62_f64 * 0.16).exp());
    assert!((shift / give / per_metre - 1.0).abs() < 0.02, "{} {per_metre}", shift / give);
    assert!((square.sqrt() / 3e-4 - 1.0).abs() < 0.1, "{}", square.sqrt());
    let text = text.replace("offset", "normal");
    assert!(spec_of(&text).unwrap_err().to_string().contains("use offset"));
}

#[test]
fn the_text_does_not_depend_on_how_the_specification_was_written() {
    let canonical = spec_of(TEXT).unwrap().to_toml();
    let turned = r#"
        count = 10_000
        turning_point_m = [0.120, 18e-2, 0.24] # places
        plate = "membrane"
        seed = 0x7
        [vary.loss_factor]
        log_normal = 0.3
        [vary]
        "taper.rate_per_m" = { uniform = 2e-2 }
        "model.wave_speed_m_per_s" = { normal = 0.01 }
    "#;
    assert_eq!(spec_of(turned).unwrap().to_toml(), canonical);
    for (from, to) in
        [("seed = 7", "seed = 8"), ("0.24]", "0.25]"), ("0.3", "0.31"), ("membrane", "membrane-heavy")]
    {
        assert_ne!(spec_of(&TEXT.replacen(from, to, 1)).unwrap().to_toml(), canonical, "{to}");
    }
}

#[test]
fn kind_and_results_have_one_text_and_the_usual_ones_none() {
    let usual = spec_of(TEXT).unwrap();
    assert_eq!((usual.kind(), usual.results()), (Kind::OneMode, &StudyResult::ALL[..2]));
    // The lines before the first section: the plate has kinds, too.
    let names = |spec: &Spec| {
        let text = spec.to_toml();
        let own = text.split("\n[").next().unwrap();
        ["kind = ", "results = "].map(|name| own.contains(name))
    };
    assert_eq!(names(&usual), [false, false], "as before there was a choice");
    let with = |lines: &str| spec_of(&TEXT.replace("seed = 7", &format!("seed = 7\n{lines}"))).unwrap();
    assert_eq!(
        with("kind = \"1d\"\nresults = [\"level_db\", \"turning_point_shift_m\", \"level_db\"]"),
        usual
    );
    let in_plane = with("kind = \"2d\"");
    assert_eq!(in_plane.results(), [StudyResult::Level, StudyResult::PeakShift]);
    assert_eq!(names(&in_plane), [true, false]);
    let all = StudyResult::ALL.map(StudyResult::name);
    let all = with(&format!("results = {all:?}"));
    assert_eq!(all.results(), StudyResult::ALL);
    for spec in [in_plane, all] {
        assert_eq!(spec_of(&spec.to_toml()).unwrap(), spec);
    }
}

#[test]
fn a_refusal_names_the_wrong_value_and_the_allowed_ones() {
    let cases = [
        ("seed = 7", "seed = -1", "seed = -1: must be 0 to"),
        ("seed = 7", "seed = 7.5", "line 2: "),
        ("seed = 7\n", "", "missing field `seed`"),
        ("seed", "sead", "unknown field `sead`"),
        ("count = 10000", "count = 0", "count = 0: must be 1 to 1000000"),
        ("count = 10000", "count = 1000001", "must be 1 to 1000000"),
        ("[0.12, 0.18, 0.24]", "[]", "turning_point_m has 0 points: must be 1 to 64"),
        ("0.18", "0.29", "turning_point_m[1] = 0.29: must be 0.08 to 0.28 m, the plate's span"),
        ("0.18", "nan", "turning_point_m[1]"),
        ("0.18", "\"a\"", "line 4: "),
        ("normal = 0.01", "normal = 1.5", "vary.\"model.wave_speed_m_per_s\".normal = 1.5: must be 0 to 1"),
        ("normal = 0.01", "normal = -0.1", "must be 0 to 1"),
        ("log_normal = 0.3", "log_normal = 3.5", "must be 0 to 3"),
        ("uniform = 0.02", "uniform = nan", "must be 0 to 1"),
        ("{ normal = 0.01 }", "{ gaussian = 0.01 }", "line 7: unknown variant `gaussian`"),
        ("{ normal = 0.01 }", "{ normal = 0.01, uniform = 0.1 }", "line 7: "),
        ("\"taper.rate_per_m\"", "taper.rate_per_m", "stands in quotes"),
        ("rate_per_m", "rate", "did you mean taper.rate_per_m?"),
        ("loss_factor", "\"drive.mass_kg\"", "the numbers of this plate are length_m, "),
        ("loss_factor", "wave_speed_tolerance", "it is 0 on the nominal plate"),
        ("loss_factor", "name", "does not belong here"),
        ("seed = 7", "seed = 7\nkind = \"3d\"", "kind = \"3d\": must be one of 1d, 2d; did you mean"),
        ("seed = 7", "seed = 7\nresults = []", "results has 0 fields: must be 1 to 64"),
        (
            "seed = 7",
            "seed = 7\nresults = [\"level_db\", \"felt_edge\"]",
            "results[1] = \"felt_edge\": must be one of turning_point_shift_m, level_db, peak_shift_m, felt_edge_m, \
             contrast_db, ripple_db, crest_db; did you mean felt_edge_m?",
        ),
        (
            "seed = 7",
            "seed = 7\nkind = \"2d\"\nresults = [\"ripple_db\"]",
            "results[0] = \"ripple_db\": must be one of turning_point_shift_m, level_db, peak_shift_m, felt_edge_m, crest_db",
        ),
        ("\"membrane\"", "3", "plate = 3: must be a preset's name"),
        ("\"membrane\"", "\"none\"", "plate is missing"),
        ("\"membrane\"", "{ name = \"x\" }", "plate: length_m is missing"),
    ];
    for (from, to, want) in cases {
        assert!(TEXT.contains(from), "{from}");
        let error = spec_of(&TEXT.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(error.contains(want), "{to}: {error}");
    }
    let nothing = spec_of(TEXT.split("\"model").next().unwrap()).unwrap_err().to_string();
    assert!(nothing.contains("vary has 0 fields: must be 1 to 32"), "{nothing}");
    assert!(matches!(Draft::parse(&" ".repeat(SPEC_BYTES_MAX + 1)), Err(SpecError::TooBig(_))));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn damaged_specifications_never_panic(at in 0usize..900, byte in 0u8..128, cut in 0usize..900) {
        let mut bytes = spec_of(TEXT).unwrap().to_toml().into_bytes();
        let length = bytes.len();
        bytes[at % length] = byte;
        bytes.truncate(length - cut % length);
        let _ = spec_of(&String::from_utf8_lossy(&bytes));
    }
}
