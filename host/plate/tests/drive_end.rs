//! Influence of the driven end on the level of the peak, and its compensation by a table.

use slipline_plate::{
    Actuator, DriveEnd, DriveTable, Equation, Plate, Progress, Resonator, Sensitivity, TurningWidth, airy,
    preset, presets, quantity::decibels, respond, sensitivity_per_percent, table_sensitivity,
};

fn peak(plate: &Plate, frequency: f64) -> f64 {
    let response = respond(plate, frequency, 601, Equation::Corrected).expect("enters");
    response
        .peak
        .map_or(response.amplitude_at_turning_point * airy::PEAK_VALUE / airy::ai(0.0), |peak| peak.amplitude)
}

fn variation(name: &str, loss: f64, end: impl Fn(DriveEnd) -> DriveEnd) -> Plate {
    let mut spec = preset(name).expect("a preset").spec().clone();
    spec.loss_factor = loss;
    spec.drive_end = end(spec.drive_end);
    Plate::new(spec).expect("a valid variation")
}

/// The end of a source of ratio `ratio` at `frequency`.
fn of_ratio(name: &str, loss: f64, ratio: f64, frequency: f64) -> Plate {
    variation(name, loss, |_| DriveEnd::Resistance { ratio, at_frequency_hz: frequency })
}

fn boundaries() -> impl Iterator<Item = f64> {
    (0..400).map(|i| 0.08 + 0.19 * f64::from(i) / 399.0)
}

fn swing(levels: &[f64]) -> f64 {
    decibels(
        levels.iter().copied().fold(0.0, f64::max) / levels.iter().copied().fold(f64::INFINITY, f64::min),
    )
}

#[test]
fn dragging_swings_the_raw_peak_by_36_db_with_a_held_end_and_by_6_db_with_a_matched_one() {
    for (loss, held_db, matched_db) in [(0.002, 36.5, 6.0), (0.01, 24.0, 5.0)] {
        let held = variation("al-bending-displacement", loss, |end| end);
        let levels: Vec<f64> = boundaries().map(|x| peak(&held, held.frequency_for_boundary_hz(x))).collect();
        assert!((swing(&levels) - held_db).abs() < 1.5, "held, loss {loss}: {}", swing(&levels));
        let levels: Vec<f64> = boundaries()
            .map(|x| {
                let frequency = held.frequency_for_boundary_hz(x);
                peak(&of_ratio("al-bending", loss, 1.0, frequency), frequency)
            })
            .collect();
        assert!((swing(&levels) - matched_db).abs() < 0.5, "matched, loss {loss}: {}", swing(&levels));
    }
}

#[test]
fn one_percent_of_wave_speed_costs_what_the_driven_end_lets_it() {
    let held = variation("al-bending-displacement", 0.002, |end| end);
    let cost = |ratio: Option<f64>| {
        boundaries()
            .map(|x| {
                let frequency = held.frequency_for_boundary_hz(x);
                let plate = ratio
                    .map_or_else(|| held.clone(), |ratio| of_ratio("al-bending", 0.002, ratio, frequency));
                let fast = plate.with_wave_speed(1.01).expect("in range");
                decibels(peak(&fast, frequency) / peak(&plate, frequency)).abs()
            })
            .fold(0.0, f64::max)
    };
    assert!((cost(None) - 25.0).abs() < 1.5, "held: {}", cost(None));
    assert!(cost(Some(1.0)) < 0.2, "matched: {}", cost(Some(1.0)));
    assert!((cost(Some(0.5)) - 4.8).abs() < 0.3, "r = 0.5: {}", cost(Some(0.5)));
    assert!((cost(Some(2.0)) - 4.8).abs() < 0.3, "r = 2: {}", cost(Some(2.0)));
    assert!((cost(Some(0.2)) - 11.0).abs() < 0.3, "r = 0.2: {}", cost(Some(0.2)));
}

#[test]
fn the_table_holds_the_level_within_1_db_for_every_preset_at_the_knots_and_between() {
    for entry in presets() {
        let plate = entry.plate().expect("a preset");
        let table = DriveTable::build(&plate, 400e3, 1025).expect("a table");
        assert!(table.worst_error_db() < 1.0, "{}: {} dB", entry.name, table.worst_error_db());
        let knots = table.knots();
        assert!(knots.windows(2).all(|pair| pair[0].frequency_hz < pair[1].frequency_hz), "{}", entry.name);
        assert!(
            knots.iter().all(|knot| knot.gain > 0.0 && knot.gain <= 1.0 && knot.frequency_hz < 0.45 * 400e3)
        );
        assert_eq!(knots.iter().map(|knot| knot.gain).fold(0.0, f64::max), 1.0);
        let edge = plate.edge_width_m(plate.band_hz().1).expect("enters");
        assert!(table.worst_shift_m() < edge / 100.0, "{}: {} m", entry.name, table.worst_shift_m());
        // Independently of the table's own check: at other places than the knots, peak times gain is the stated
        // level.
        let level = table.peak_at_full_scale_m() / plate.spec().full_scale_m;
        for i in 0..97 {
            let x = table.span_m().0 + (table.span_m().1 - table.span_m().0) * (f64::from(i) + 0.37) / 97.0;
            let frequency = table.frequency_hz(x);
            let turn = std::f64::consts::PI * frequency / 400e3;
            let error = decibels(peak(&plate, frequency) * table.gain(x) * turn.sin() / turn / level);
            assert!(error.abs() < 1.0, "{} at {x}: {error} dB", entry.name);
        }
    }
}

#[test]
fn the_table_undoes_the_hold_and_the_actuator() {
    let mut spec = preset("al-bending").expect("a preset").spec().clone();
    spec.wave_speed_tolerance = 0.0;
    let bare = Plate::new(spec.clone()).expect("a valid plate");
    spec.actuator = Some(Actuator::Resonator(Resonator { resonance_hz: 28e3, quality: 8.0, travel: None }));
    let plate = Plate::new(spec).expect("a valid plate");
    let table = DriveTable::build(&plate, 100e3, 1025).expect("a table");
    assert!(table.worst_error_db() < 0.5, "{}", table.worst_error_db());
    let fast = DriveTable::build(&bare, 10e6, 1025).expect("a table");
    let bare = DriveTable::build(&bare, 100e3, 1025).expect("a table");
    let ratio = |x: f64| (table.gain(x) / bare.gain(x)) / (table.gain(0.2) / bare.gain(0.2));
    let x = 0.22;
    let response =
        |x: f64| plate.spec().actuator.as_ref().expect("set").response(table.frequency_hz(x)).norm();
    assert!((ratio(x) * response(x) / response(0.2) - 1.0).abs() < 0.01);
    // At 100 kS/s the hold lowers 40 kHz by 2.4 dB against 0 Hz; at 10 MS/s by nothing.
    let between = |x: f64| bare.gain(x) / fast.gain(x);
    let droop = |x: f64| {
        let turn = std::f64::consts::PI * bare.frequency_hz(x) / 100e3;
        turn.sin() / turn
    };
    let undone = between(0.27) / between(0.2) * droop(0.27) / droop(0.2);
    assert!((undone - 1.0).abs() < 1e-3 && droop(0.27) < 0.82, "{undone}");
}

/// The table with 1025 knots, and its sensitivity.
fn finest(plate: &Plate) -> (DriveTable, Sensitivity) {
    let table = DriveTable::build(plate, 400e3, 1025).expect("a table");
    let sensitivity = sensitivity_per_percent(&table, plate, &mut Progress::unwatched());
    (table, sensitivity.expect("answers"))
}

#[test]
fn the_sensitivity_separates_a_matched_plate_from_a_held_one() {
    let of = |name: &str| finest(&preset(name).expect("a preset")).1;
    let membrane = of("membrane");
    assert!(membrane.worst_db < 0.25, "{membrane:?}");
    let matched = of("al-bending");
    assert!(matched.worst_db < 0.92, "a lead-in over an octave: {matched:?}");
    let held = of("al-bending-displacement");
    assert!(held.worst_db > 20.0, "{held:?}");
    let plate = preset("membrane").expect("a preset");
    let table = finest(&plate).0;
    assert!(table_sensitivity(&table, &plate, &plate).expect("answers").worst_db < 0.01);
}

#[test]
fn the_closed_form_gives_the_drive_to_peak_gain_within_two_percent() {
    // peak/drive = 0.5357 sqrt(pi k0/kappa) sqrt(W0/W) / sqrt(sin^2(Phi + pi/4) + sinh^2 I).
    let plate = variation("al-bending-displacement", 0.01, |end| end).with_turning_width(TurningWidth::Plain);
    let (d, q) = (4.62, std::f64::consts::FRAC_PI_2);
    let mut worst: f64 = 0.0;
    for x in (0..40).map(|i| 0.15 + 0.12 * f64::from(i) / 39.0) {
        let frequency = plate.frequency_for_boundary_hz(x);
        let k = plate.spec().model.wavenumber_squared(std::f64::consts::TAU * frequency).sqrt();
        let (nu, s0) = (k / d, q / (0.02 * d));
        let nu = (nu * nu - 0.25).sqrt();
        let phase = nu * (nu / s0).acosh() - (nu * nu - s0 * s0).sqrt();
        let loss = 0.5 * plate.wave_loss() * nu * (nu / s0).acosh();
        let k0 = (k * k - (q / 0.02_f64).powi(2)).sqrt();
        let kappa = plate.kappa_per_m(frequency).expect("enters");
        let x_peak = plate.airy_peak_m(frequency).expect("enters");
        let root = ((phase + 0.25 * std::f64::consts::PI).sin().powi(2) + loss.sinh().powi(2)).sqrt();
        let closed =
            0.5357 * (std::f64::consts::PI * k0 / kappa).sqrt() * (0.02 / plate.half_width_m(x_peak)).sqrt()
                / root;
        worst = worst.max((closed / peak(&plate, frequency) - 1.0).abs());
    }
    assert!(worst < 0.03, "{worst}");
}

#[test]
fn a_lossy_plate_has_no_peak_and_says_so() {
    // I = (eta/2) nu acosh(nu/s0): at I of about 6 the standing wave has vanished.
    let faint = variation("al-bending-displacement", 0.5, |end| end);
    let response = respond(&faint, 39e3, 601, Equation::Corrected).expect("enters");
    assert!(response.peak.is_none_or(|peak| !peak.is_largest), "{:?}", response.peak);
    let table = DriveTable::build(&faint, 400e3, 257).expect("a table");
    assert!(table.knots().iter().any(|knot| !knot.peak_present) == (table.knots_without_peak() > 0));
    let clear = variation("al-bending-displacement", 0.002, |end| end);
    assert!(
        respond(&clear, 39e3, 601, Equation::Corrected).expect("enters").peak.expect("a peak").is_largest
    );
}

#[test]
fn a_plate_one_percent_faster_than_its_table_stays_within_1_db_when_matched_and_not_when_held() {
    let worst = |name: &str| {
        let plate = preset(name).expect("a preset");
        let fast = plate.with_wave_speed(1.01).expect("in range");
        let table = DriveTable::build(&plate, 400e3, 1025).expect("a table");
        let level = table.peak_at_full_scale_m() / plate.spec().full_scale_m;
        let (start, end) = table.span_m();
        (0..300)
            .map(|i| start + (end - start) * f64::from(i) / 299.0)
            .map(|x| {
                let frequency = table.frequency_hz(x);
                let turn = std::f64::consts::PI * frequency / 400e3;
                decibels(peak(&fast, frequency) * table.gain(x) * turn.sin() / turn / level).abs()
            })
            .fold(0.0, f64::max)
    };
    assert!(worst("membrane") < 0.25, "{}", worst("membrane"));
    assert!(worst("al-sh") < 0.3, "{}", worst("al-sh"));
    assert!(worst("al-bending") < 0.9, "{}", worst("al-bending"));
    assert!(worst("al-bending-displacement") > 20.0);
}

#[test]
fn the_held_plate_resonates_where_the_closed_form_says() {
    // Phi + pi/4 = n pi with Phi = nu acosh(nu/s0) - sqrt(nu^2 - s0^2).
    let plate =
        variation("al-bending-displacement", 0.002, |end| end).with_turning_width(TurningWidth::Plain);
    let s0 = std::f64::consts::FRAC_PI_2 / (0.02 * 4.62);
    let phase = |frequency: f64| {
        let k = plate.spec().model.wavenumber_squared(std::f64::consts::TAU * frequency).sqrt();
        let nu = ((k / 4.62).powi(2) - 0.25).sqrt();
        nu * (nu / s0).acosh() - (nu * nu - s0 * s0).sqrt()
    };
    for n in [6, 9, 12] {
        let wanted = f64::from(n) * std::f64::consts::PI - std::f64::consts::FRAC_PI_4;
        let (mut low, mut high) = (plate.cut_off_hz() * 1.01, 45e3);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if phase(middle) < wanted { low = middle } else { high = middle }
        }
        let near = (-60..=60).map(|i| low * (1.0 + 1.5e-4 * f64::from(i)));
        let found = near.max_by(|a, b| peak(&plate, *a).total_cmp(&peak(&plate, *b))).expect("places");
        assert!((found / low - 1.0).abs() < 1e-3, "resonance {n}: {found} Hz for {low} Hz");
    }
}

#[test]
fn a_tolerance_halves_what_a_wrong_wave_speed_costs_and_is_not_exact_where_it_is_right() {
    let known = preset("al-bending").expect("a preset");
    let mut spec = known.spec().clone();
    spec.wave_speed_tolerance = 0.0;
    let nominal = Plate::new(spec).expect("a valid plate");
    let cost = |plate: &Plate| finest(plate).1.worst_db;
    assert!((1.1..1.6).contains(&cost(&nominal)), "levelled for one speed: {} dB", cost(&nominal));
    assert!(cost(&known) < 0.7 * cost(&nominal), "levelled for all within 1 %: {} dB", cost(&known));
    let error = |plate: &Plate| DriveTable::build(plate, 400e3, 1025).expect("a table").worst_error_db();
    assert!(error(&nominal) < 0.01, "{}", error(&nominal));
    assert!((0.4..0.75).contains(&error(&known)), "{}", error(&known));
}

#[test]
fn the_sensitivity_is_the_same_from_a_table_with_fewer_knots() {
    let plate = preset("al-bending").expect("a preset");
    let fresh = finest(&plate).1;
    let table = DriveTable::build(&plate, 400e3, 33).expect("a table");
    assert_eq!(sensitivity_per_percent(&table, &plate, &mut Progress::unwatched()), Ok(fresh));
}

#[test]
fn a_plate_too_flat_for_a_table_is_refused_with_its_band_and_what_helps() {
    let mut spec = preset("membrane").expect("a preset").spec().clone();
    let flat = |end_m: f64| vec![[0.0, 0.05], [0.16, 0.5 * (0.05 + end_m)], [0.32, end_m]];
    spec.drive_end = DriveEnd::Displacement;
    spec.taper = slipline_plate::Taper::Sampled { points: flat(0.049_999_98) };
    let nearly = Plate::new(spec.clone()).expect("it narrows");
    let refused = DriveTable::build(&nearly, 400e3, 1025).expect_err("too flat").to_string();
    assert!(
        refused.starts_with("the plate is nearly flat: from 0.08 to 0.28 m its boundary needs 60"),
        "{refused}"
    );
    assert!(refused.contains("1025 knots") && refused.ends_with("or the span be longer"), "{refused}");
    spec.taper = slipline_plate::Taper::Sampled { points: flat(0.0498) };
    let table =
        DriveTable::build(&Plate::new(spec).expect("it narrows"), 400e3, 1025).expect("a band of 0.1 Hz");
    assert!(table.knots().windows(2).all(|pair| pair[1].frequency_hz > pair[0].frequency_hz));
}
