//! Textures: what solid areas, profiles, stripes and beats reach.

use slipline_plate::feeling::{Feeling, FeltEdge};
use slipline_plate::texture::{
    CHORD_PERIOD, FLUTTER_WINDOW_S, Figures, PLACES, Palette, Target, Texture, TextureError, TextureTone,
    beat, least_largest_error, nnls, stripes, stripes_felt_db, stripes_m,
};
use slipline_plate::{Complex64, DriveTable, Plate, PlateSpec, Progress, TimeDomainLine, preset};
use std::f64::consts::TAU;

const SAMPLE_RATE_HZ: f64 = 400e3;

fn membrane() -> (Plate, DriveTable) {
    let plate = preset("membrane").expect("a preset");
    let table = DriveTable::build(&plate, SAMPLE_RATE_HZ, 257).expect("has a table");
    (plate, table)
}

fn solid(palette: &Palette<'_>, turning_point_m: f64, most: usize) -> (Texture, Target) {
    let target = Target::solid(palette, turning_point_m).expect("room for an area");
    (Texture::fit(palette, &target, most).expect("fits"), target)
}

#[test]
fn companion_tones_fill_the_nodes_of_a_solid_area() {
    let (plate, table) = membrane();
    let palette = Palette::new(&plate, &table);
    for turning_point_m in [0.22, 0.24, 0.26] {
        let (alone, _) = solid(&palette, turning_point_m, 1);
        assert!(alone.figures.ripple_db.expect("solid") > 8.0, "one tone has nodes: {:?}", alone.figures);
        let (together, _) = solid(&palette, turning_point_m, 8);
        let Figures { ripple_db, contrast_db, .. } = together.figures;
        assert!(ripple_db.expect("solid") <= 0.6, "{turning_point_m}: {ripple_db:?}");
        assert!(contrast_db.expect("solid") >= 40.0, "{turning_point_m}: {contrast_db:?}");
        let past_m = turning_point_m + 0.08;
        let level_db =
            |x: f64| 20.0 * together.rms_m[(x / plate.length_m() * (PLACES - 1) as f64) as usize].log10();
        assert!(past_m > plate.length_m() || level_db(past_m) - level_db(0.1) <= -24.0, "{turning_point_m}");
    }
}

#[test]
fn a_solid_area_stays_even_when_the_wave_speed_is_off_by_a_percent() {
    let (plate, table) = membrane();
    let palette = Palette::new(&plate, &table);
    let (texture, target) = solid(&palette, 0.26, 16);
    for factor in [0.99, 1.01] {
        let other = plate.with_wave_speed(factor).expect("in range");
        let ripple_db = texture.on(&other, &palette, &target).expect("answers").ripple_db.expect("solid");
        assert!(ripple_db <= 2.0, "{factor}: {ripple_db}");
    }
}

#[test]
fn the_worst_figures_are_those_over_the_tolerances() {
    let spec = PlateSpec { wave_speed_tolerance: 0.01, ..membrane().0.spec().clone() };
    let plate = Plate::new(spec).expect("valid");
    let table = DriveTable::build(&plate, SAMPLE_RATE_HZ, 65).expect("has a table");
    let palette = Palette::new(&plate, &table);
    let (texture, target) = solid(&palette, 0.24, 8);
    let worst = texture.worst(&palette, &target).expect("answers");
    for factor in [0.99, 1.0, 1.01] {
        let other = plate.with_wave_speed(factor).expect("in range");
        let figures = texture.on(&other, &palette, &target).expect("answers");
        assert!(figures.rms_error <= worst.rms_error + 1e-12 && figures.ripple_db <= worst.ripple_db);
        assert!(figures.contrast_db >= worst.contrast_db);
    }
    assert!(worst.rms_error > texture.figures.rms_error);
}

#[test]
fn the_tones_fit_the_dac_together() {
    let (plate, table) = membrane();
    let palette = Palette::new(&plate, &table);
    for most in [1, 4, 16] {
        let (texture, _) = solid(&palette, 0.24, most);
        assert!(texture.tones.len() <= most);
        let sum: f64 = texture.tones.iter().map(|tone| tone.level * table.gain(tone.position_m)).sum();
        assert!(sum <= 1.0 && texture.tones.iter().all(|tone| tone.level <= 1.0), "{most}: {sum}");
        let full = texture.tones.iter().any(|tone| tone.level > 0.999) || sum > 0.998;
        assert!(full, "{most}: as loud as it can be, not {sum}");
        assert!(texture.tones.is_sorted_by(|one, other| one.frequency_hz < other.frequency_hz));
    }
}

#[test]
fn no_two_tones_beat_so_slowly_that_the_area_comes_and_goes() {
    for name in ["membrane", "al-bending", "al-bending-displacement"] {
        let plate = preset(name).expect("a preset");
        let table = DriveTable::build(&plate, SAMPLE_RATE_HZ, 257).expect("has a table");
        let palette = Palette::new(&plate, &table);
        let (start_m, end_m) = plate.span_m();
        for share in [0.5, 0.7, 0.9] {
            let (texture, target) = solid(&palette, start_m + share * (end_m - start_m), 16);
            let chord = texture.on_grid(&palette, &target).expect("answers").expect("has multiples").texture;
            for pair in texture.tones.windows(2).chain(chord.tones.windows(2)) {
                let beat_hz = pair[1].frequency_hz - pair[0].frequency_hz;
                let least_hz = if pair[1].frequency_hz < 20e3 { 5.0 } else { 1000.0 };
                assert!(beat_hz >= least_hz - 1e-6, "{name} {share}: {beat_hz} Hz below {:?}", pair[1]);
            }
        }
    }
}

#[test]
fn a_solid_area_ends_where_the_finger_feels_it_end() {
    let (plate, table) = membrane();
    let palette = Palette::new(&plate, &table);
    let feeling = Feeling::default();
    let solid_to = |felt_edge_m: f64, most: usize, feeling: &Feeling| {
        Texture::solid_to(&palette, felt_edge_m, most, feeling, &mut Progress::unwatched())
    };
    for (felt_edge_m, most) in [(0.25, 16), (0.27, 16), (0.3, 16), (0.25, 3), (0.28, 4), (0.3, 5)] {
        let (texture, _) = solid_to(felt_edge_m, most, &feeling).expect("in range");
        let FeltEdge::At(is_m) = texture.felt_edge(&palette, &feeling).expect("answers") else {
            panic!("an edge on the plate")
        };
        assert!((is_m - felt_edge_m).abs() < 1e-4, "{felt_edge_m} of {most} tones: {is_m}");
    }
    let refused = solid_to(0.05, 16, &feeling).expect_err("too near");
    assert!(matches!(refused, TextureError::OutOfRange(_)), "{refused}");
    let numb = Feeling { threshold: 1e6, ..feeling };
    let refused = solid_to(0.2, 16, &numb).expect_err("nothing is felt");
    assert_eq!(refused, TextureError::NotFelt { edge: FeltEdge::Nowhere });
}

/// Errors of two profiles that 16 tones leave: an even one can be reached, a rising one cannot.
#[test]
fn the_reach_shows_what_a_profile_cannot_have() {
    let (plate, table) = membrane();
    let palette = Palette::new(&plate, &table);
    let (start_m, end_m) = (0.01, 0.24);
    let fit = |points: &[(f64, f64)]| {
        let target = Target::profile(&palette, points).expect("valid");
        Texture::fit(&palette, &target, 16).expect("fits")
    };
    let flat = fit(&[(start_m, 1.0), (end_m, 1.0)]);
    assert!(flat.figures.rms_error < 0.02, "{:?}", flat.figures);
    let up = fit(&[(start_m, 0.0), (end_m, 1.0)]);
    assert!(
        (0.1..0.25).contains(&up.figures.rms_error),
        "every tone vibrates before its turning point: {:?}",
        up.figures
    );
    // Sixteen tones are as close as any number of tones.
    for texture in [&flat, &up] {
        assert!(texture.figures.rms_error < texture.reach.rms_error + 2e-3);
    }
    assert_eq!(flat.figures.ripple_db, None);
}

/// On this plate eleven tones at places of their own are nearer to the profile than the best powers of many tones on a grid.
#[test]
fn any_number_of_tones_is_as_near_as_the_tones_of_the_texture() {
    let plate = preset("tungsten-membrane").expect("a preset");
    let table = DriveTable::build(&plate, 400e3, 129).expect("has a table");
    let palette = Palette::new(&plate, &table);
    let target =
        Target::profile(&palette, &[(0.0, 1.0), (0.15, 1.0), (0.205, 0.0), (0.32, 0.0)]).expect("valid");
    for most in [4, 16] {
        let fitted = Texture::fit(&palette, &target, most).expect("fits");
        let chord = fitted.on_grid(&palette, &target).expect("answers").map(|chord| chord.texture);
        for texture in std::iter::once(&fitted).chain(&chord) {
            assert!(texture.reach.rms_error <= texture.figures.rms_error, "{most} tones: {texture:?}");
        }
    }
}

#[test]
fn no_powers_have_a_smaller_largest_error_than_the_linear_programs() {
    let (plate, table) = membrane();
    let palette = Palette::new(&plate, &table);
    let positions: Vec<f64> = (0..40).map(|i| 0.08 + 0.18 * f64::from(i) / 39.0).collect();
    let columns = palette.squares(&positions).expect("answers");
    let wanted: Vec<f64> = palette.places_m().iter().map(|&x| if x < 0.2 { 1.0 } else { 0.0 }).collect();
    let largest = |powers: &[f64]| {
        let is = columns.times(powers);
        is.iter().zip(&wanted).map(|(is, wanted)| (is - wanted).abs()).fold(0.0, f64::max)
    };
    let (error, powers) = least_largest_error(&columns, &wanted).expect("solves");
    assert!((largest(&powers) - error).abs() < 1e-6, "{error}");
    let squares = nnls::non_negative_least_squares(&columns, &wanted);
    assert!(error <= largest(&squares));
    for tone in 0..positions.len() {
        for factor in [0.99, 1.01] {
            let mut others = powers.clone();
            others[tone] *= factor;
            assert!(largest(&others) >= error - 1e-6);
        }
    }
    assert_eq!(least_largest_error(&columns, &vec![f64::NAN; PLACES]), None);
}

#[test]
fn bad_breakpoints_are_named() {
    let (plate, table) = membrane();
    let palette = Palette::new(&plate, &table);
    let cases: [(&[(f64, f64)], usize); 6] = [
        (&[(0.1, 1.0)], 2),
        (&[(0.1, 1.0), (0.1, 0.5)], 2),
        (&[(0.1, 1.0), (0.2, -0.5)], 2),
        (&[(f64::NAN, 1.0), (0.2, 0.5)], 1),
        (&[(0.1, 0.0), (0.2, 0.0)], 1),
        (&[(0.1, 1.0), (0.1001, 1.0)], 1),
    ];
    for (points, number) in cases {
        let error = Target::profile(&palette, points).expect_err("refused");
        assert!(
            matches!(error, TextureError::Profile { number: found, .. } if found == number),
            "{points:?}: {error}"
        );
    }
    for most in [0, 17] {
        let target = Target::solid(&palette, 0.2).expect("valid");
        let error = Texture::fit(&palette, &target, most).expect_err("refused").to_string();
        assert!(error.contains("1 to 16"), "{error}");
    }
    assert!(Target::solid(&palette, 0.3).expect_err("off the span").to_string().contains("0.08 to 0.28 m"));
}

#[test]
fn stripes_are_as_far_apart_as_the_nodes_of_the_field() {
    let (plate, table) = membrane();
    let palette = Palette::new(&plate, &table);
    let tone = stripes(&palette, 0.05).expect("in range");
    assert!((stripes_m(&plate, tone.frequency_hz).expect("enters") - 0.05).abs() < 1e-6);
    let field = palette.squares(&[tone.position_m]).expect("answers");
    let field = field.column(0);
    let step_m = plate.length_m() / (PLACES - 1) as f64;
    let nodes: Vec<f64> = (1..PLACES - 1)
        .filter(|&i| field[i] < field[i - 1] && field[i] <= field[i + 1])
        .map(|i| i as f64 * step_m)
        .filter(|&x| x < tone.position_m)
        .collect();
    let middle_m = 0.5 * plate.turning_point_m(tone.frequency_hz).expect("enters");
    let after = nodes.iter().position(|&node| node > middle_m).expect("nodes on both sides");
    let apart_m = nodes[after] - nodes[after - 1];
    assert!((apart_m - 0.05).abs() < 0.006, "{apart_m}");
    let error = stripes(&palette, 0.001).expect_err("too fine").to_string();
    assert!(error.starts_with("stripes = 0.001 m"), "{error}");
}

#[test]
fn two_tones_beat_at_the_requested_frequency_and_place() {
    let plate = preset("al-sh").expect("a preset");
    let table = DriveTable::build(&plate, SAMPLE_RATE_HZ, 1025).expect("has a table");
    let palette = Palette::new(&plate, &table);
    let [low, high] = beat(&palette, 0.3, 180.0).expect("in range");
    assert!((high.frequency_hz - low.frequency_hz - 180.0).abs() < 1e-3);
    let peaks = [low, high].map(|tone| plate.airy_peak_m(tone.frequency_hz).expect("enters"));
    assert!(peaks[0] < 0.3 && 0.3 < peaks[1] && peaks[1] - peaks[0] < 0.01, "{peaks:?}");
    assert_eq!(low.level, high.level);
    let sum: f64 = [low, high].iter().map(|tone| tone.level * table.gain(tone.position_m)).sum();
    assert!(sum <= 1.0);
    for (place_m, beat_hz, field) in
        [(0.3, 0.5, "beat frequency"), (0.3, f64::NAN, "beat frequency"), (5.0, 180.0, "beat = 5")]
    {
        let error = beat(&palette, place_m, beat_hz).expect_err("refused").to_string();
        assert!(error.starts_with(field), "{error}");
    }
}

#[test]
fn a_texture_on_the_grid_of_a_chord_is_louder_and_reports_the_cost_of_the_grid() {
    let base_hz = SAMPLE_RATE_HZ / f64::from(CHORD_PERIOD);
    for (name, is_fine_enough) in [("al-bending", true), ("membrane", false)] {
        let plate = preset(name).expect("a preset");
        let table = DriveTable::build(&plate, SAMPLE_RATE_HZ, 257).expect("has a table");
        let palette = Palette::new(&plate, &table);
        let (start_m, end_m) = plate.span_m();
        for share in [0.5, 0.7, 0.9] {
            let (free, target) = solid(&palette, start_m + share * (end_m - start_m), 16);
            let chord = free.on_grid(&palette, &target).expect("answers").expect("has multiples");
            let (texture, harmonics) = (&chord.texture, &chord.harmonics);
            // A grid of 24 Hz is coarse between 88 and 200 Hz, and fine between 19 and 37 kHz.
            assert_eq!(chord.is_as_good_as(&free), is_fine_enough, "{name} {share}: {:?}", texture.figures);
            let ripple_db = |texture: &Texture| texture.figures.ripple_db.expect("solid");
            assert!(is_fine_enough || ripple_db(texture) > ripple_db(&free) + 3.0);
            assert!(
                harmonics.is_sorted_by(|one, other| one < other) && harmonics.len() == texture.tones.len()
            );
            for (tone, &harmonic) in texture.tones.iter().zip(harmonics) {
                assert!((tone.frequency_hz - f64::from(harmonic) * base_hz).abs() < 1e-6);
            }
            let amplitude = |tone: &TextureTone| tone.level * table.gain(tone.position_m);
            let sum: f64 = texture.tones.iter().map(amplitude).sum();
            assert!(sum <= 1.0 && chord.gain_db >= 0.0, "{name} {share}: {sum} {}", chord.gain_db);
            // The chord is as loud as possible: its peak is full scale, or the level of one tone is.
            let louder = 10f64.powf(chord.gain_db / 20.0);
            let value = |n: u32| -> f64 {
                let turn = |harmonic: u32| f64::from(harmonic * n % CHORD_PERIOD) / f64::from(CHORD_PERIOD);
                let tones = texture.tones.iter().zip(harmonics);
                tones
                    .map(|(tone, &m)| louder * amplitude(tone) * (TAU * (turn(m) + tone.phase_turns)).sin())
                    .sum()
            };
            let peak = (0..CHORD_PERIOD).map(|n| value(n).abs()).fold(0.0, f64::max);
            let loudest = texture.tones.iter().map(|tone| tone.level * louder).fold(0.0, f64::max);
            assert!(peak < 1.0 && loudest < 1.0 + 1e-9, "{name} {share}: {peak} {loudest}");
            assert!(peak > 0.998 || loudest > 0.999, "{name} {share}: {peak} {loudest}");
        }
    }
}

/// Equal stripes with nodes of zero amplitude are felt (1 + S)/(1 - S) deep, S = sin(pi c/d)/(pi c/d).
fn equal_stripes_felt_db(stripes_m: f64, contact_m: f64) -> f64 {
    let angle = TAU / 2.0 * contact_m / stripes_m;
    let left = (angle.sin() / angle).abs();
    10.0 * ((1.0 + left) / (1.0 - left)).log10()
}

#[test]
fn stripes_are_felt_as_deep_as_the_plate_makes_them() {
    let (plate, table) = membrane();
    let palette = Palette::new(&plate, &table);
    let felt_db = |plate: &Plate, tone: &TextureTone, contact_m: f64| {
        let feeling = Feeling { contact_m, ..Feeling::default() };
        stripes_felt_db(plate, tone, &feeling).expect("answers")
    };
    // Two stripes, the nearer one at the driven end: equal stripes would be felt 16.4 dB deep.
    let wide = stripes(&palette, 0.06).expect("in range");
    let found_db = felt_db(&plate, &wide, 0.01);
    assert!((found_db - 11.4).abs() < 0.3, "{found_db}");
    assert!((equal_stripes_felt_db(0.06, 0.01) - 16.4).abs() < 0.05);
    for stripes_m in [0.05, 0.045] {
        let tone = stripes(&palette, stripes_m).expect("in range");
        println!("{stripes_m}: {} {}", felt_db(&plate, &tone, 0.01), equal_stripes_felt_db(stripes_m, 0.01));
    }
    // A plate that is moved by its end and loses next to nothing has nodes of zero amplitude; its stripes differ by little where
    // there are many of them.
    let moved = preset("al-bending-displacement").expect("a preset");
    let moved = Plate::new(PlateSpec { loss_factor: 1e-5, ..moved.spec().clone() }).expect("valid");
    let table = DriveTable::build(&moved, SAMPLE_RATE_HZ, 257).expect("has a table");
    let palette = Palette::new(&moved, &table);
    for stripes_m in [0.02, 0.018, 0.016] {
        let tone = stripes(&palette, stripes_m).expect("in range");
        for contact_m in [0.005, 0.01] {
            let (found_db, equal_db) =
                (felt_db(&moved, &tone, contact_m), equal_stripes_felt_db(stripes_m, contact_m));
            println!("{stripes_m} {contact_m}: {found_db} {equal_db}");
            assert!((found_db - equal_db).abs() < 1.0, "{stripes_m} {contact_m}: {found_db} {equal_db}");
        }
    }
}

/// Ratio of the largest to the smallest RMS over 30 ms within a second at each place that is even, dB; by the plate in
/// time.
fn swings_db(palette: &Palette<'_>, texture: &Texture, even_m: (f64, f64)) -> Vec<f64> {
    let table = palette.table();
    let rate_hz = table.sample_rate_hz();
    let mut line = TimeDomainLine::new(palette.plate(), rate_hz, PLACES).expect("a line");
    let code = |n: usize| -> f32 {
        let tone = |tone: &TextureTone| {
            let turns = (tone.frequency_hz * n as f64 / rate_hz).fract() + tone.phase_turns;
            tone.level * table.gain(tone.position_m) * (TAU * turns).sin()
        };
        texture.tones.iter().map(tone).sum::<f64>() as f32
    };
    let settle = (line.settle_time_s() * rate_hz) as usize;
    line.push(&(0..settle).map(code).collect::<Vec<f32>>());
    let mut field = vec![Complex64::ZERO; PLACES];
    let step = (rate_hz / line.step_rate_hz()).round() as usize;
    let mut squares: Vec<Vec<f64>> = Vec::new();
    for n in (settle..settle + (1.03 * rate_hz) as usize).step_by(step) {
        line.push(&(n..n + step).map(code).collect::<Vec<f32>>());
        line.analytic_m(&mut field);
        squares.push(field.iter().map(|f| f.norm_sqr()).collect());
    }
    let window = (FLUTTER_WINDOW_S * line.step_rate_hz()).round() as usize;
    let step_m = palette.plate().length_m() / (PLACES - 1) as f64;
    let even = (0..PLACES).filter(|&place| (even_m.0..=even_m.1).contains(&(place as f64 * step_m)));
    even.map(|place| {
        let means = squares.windows(window).map(|rows| rows.iter().map(|row| row[place]).sum::<f64>());
        let (low, high) = means.fold((f64::INFINITY, 0.0_f64), |(low, high), it| (low.min(it), high.max(it)));
        10.0 * (high / low).log10()
    })
    .collect()
}

#[test]
fn ultrasonic_tones_are_too_far_apart_to_flutter() {
    let plate = preset("al-bending").expect("a preset");
    let table = DriveTable::build(&plate, SAMPLE_RATE_HZ, 257).expect("has a table");
    let palette = Palette::new(&plate, &table);
    let (texture, target) = solid(&palette, 0.26, 16);
    let flutter = texture.flutter(&palette, &target).expect("answers").expect("an area");
    assert!((0.01..0.1).contains(&flutter.swing_db), "{flutter:?}");
    let profile = Target::profile(&palette, &[(0.01, 1.0), (0.2, 0.5)]).expect("valid");
    assert_eq!(texture.flutter(&palette, &profile), Ok(None));
}

#[test]
fn a_solid_area_flutters_as_the_plate_in_time_does() {
    let plate = preset("membrane").expect("a preset");
    let table = DriveTable::build(&plate, 4000.0, 257).expect("has a table");
    let palette = Palette::new(&plate, &table);
    for (turning_point_m, most) in [(0.2, 16), (0.24, 16), (0.26, 8), (0.28, 16)] {
        let (texture, target) = solid(&palette, turning_point_m, most);
        let flutter = texture.flutter(&palette, &target).expect("answers").expect("an area");
        let edge_m = plate.edge_width_m(table.frequency_hz(turning_point_m)).expect("enters");
        let mut swings = swings_db(&palette, &texture, (0.01, turning_point_m - 1.3 * edge_m));
        swings.sort_by(f64::total_cmp);
        let median = swings[swings.len() / 2];
        assert!((median - flutter.swing_db).abs() < 0.6, "{turning_point_m}: {median} {flutter:?}");
        // The mean is even, but the amplitude swings.
        assert!((0.4..0.9).contains(&texture.figures.ripple_db.expect("solid")), "{:?}", texture.figures);
        assert!((5.8..7.2).contains(&flutter.swing_db), "{turning_point_m}: {flutter:?}");
        assert!((21.0..23.0).contains(&flutter.frequency_hz), "{turning_point_m}: {flutter:?}");
        let largest = swings[swings.len() - 1];
        assert!(swings[0] > 3.6 && largest < 13.4, "{turning_point_m}: {swings:?}");
        // The place where it swings farthest is stated as well as the median; another second of the beats may have it farther.
        println!("{turning_point_m}: {largest} {flutter:?}");
        let stated_db = flutter.largest_db;
        assert!((largest - 1.0..18.0).contains(&stated_db), "{turning_point_m}: {largest} {flutter:?}");
        assert!(stated_db > median + 2.0 && (0.01..turning_point_m).contains(&flutter.largest_at_m));
    }
}
