//! One truth: the stage, its figure, its CSV, and what the command line and Python compute, state the same numbers for the same
//! moment; what is fitted is called fitted.

use crate::session::{Session, membrane};
use slipline_instrument::requests::SimulateRequest;
use slipline_instrument::rig::secret;
use slipline_instrument::{MeasureIntent, Shown};
use slipline_model::export::figures::Format;
use slipline_model::export::figures::plate::{FigureJob, work};
use slipline_model::field::simulation::{SAMPLE_RATE_HZ, Simulated, Solver, table_for};
use slipline_model::field::steady_field::{POINTS, interpolate};
use slipline_model::jobs::Task;
use slipline_model::setup::{Setup, ToneSetup};
use slipline_plate::{Plate, Progress, preset, presets};
use std::f64::consts::SQRT_2;

/// Places and displacements, in metres; in a figure both in its points.
type Envelope = Vec<(f64, f64)>;

/// The curve and the rings on the stage.
fn on_stage(shown: &Shown<'_>) -> (Envelope, Envelope) {
    let length_m = shown.predicted.length_m;
    let x_m = |i: usize| i as f64 / (POINTS - 1) as f64 * length_m;
    let curve = shown.predicted.drawn_m().into_iter().enumerate().map(|(i, metres)| (x_m(i), metres));
    let rings = shown.measured.iter().flat_map(|rings| rings.field.points());
    (curve.collect(), rings.collect())
}

/// The same, read from the CSV: of one tone the largest displacement, of several the mean.
fn in_csv(shown: &Shown<'_>) -> (Envelope, Envelope) {
    let text = shown.envelope_csv().unwrap();
    let rows = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    let mut both = (Vec::new(), Vec::new());
    for row in rows {
        let cells: Vec<Option<f64>> = row.split(',').map(|cell| cell.parse().ok()).collect();
        let value = |maximum: Option<f64>, rms: Option<f64>| {
            if shown.setup.tones.len() > 1 { rms.map(|rms| rms * SQRT_2) } else { maximum }
        };
        let x_m = cells[0].unwrap();
        both.0.extend(value(cells[1], cells[2]).map(|metres| (x_m, metres)));
        both.1.extend(value(cells[3], cells[4]).map(|metres| (x_m, metres)));
    }
    both
}

/// The same on the figure, in its points.
fn on_figure(shown: &Shown<'_>, magnification: f64) -> (Envelope, Envelope, String) {
    let subject = shown.figure(magnification, false).unwrap();
    let file = work(&FigureJob { subject, format: Format::Svg }, &Task::default()).unwrap().unwrap();
    let text = String::from_utf8(file.bytes).unwrap();
    let paths = || text.split(" d=\"").skip(1).filter_map(|rest| rest.split('"').next());
    let place = |text: &str| {
        let (x, y) = text.split_once(' ')?;
        Some((x.parse().ok()?, y.parse().ok()?))
    };
    let curve = paths().find(|path| path.matches('L').count() == POINTS - 1).unwrap();
    let curve = curve.split(['M', 'L']).filter_map(place).collect();
    // A ring begins at its left.
    let rings = paths().filter_map(|path| place(path.strip_prefix('M')?.split_once("a1.4 1.4 ")?.0));
    (curve, rings.collect(), text.clone())
}

/// All that are exported have the numbers of the stage, the figure at this magnification.
fn exports_agree(session: &Session, magnification: f64, case: &str) {
    let shown = session.instrument.shown();
    let stage = on_stage(&shown);
    let csv = in_csv(&shown);
    for (name, stage, csv) in [("curve", &stage.0, &csv.0), ("rings", &stage.1, &csv.1)] {
        assert_eq!(stage.len(), csv.len(), "{case}: {name}");
        let is_same = |(at, read): (&(f64, f64), &(f64, f64))| (at.0 - read.0).abs() < 1e-6 && at.1 == read.1;
        assert!(stage.iter().zip(csv).all(is_same), "{case}: {name}");
    }
    let full_peak_m = shown.full_peak_m.unwrap();
    let (curve, rings, svg) = on_figure(&shown, magnification);
    let by_height = |a: &usize, b: &usize| stage.0[*a].1.total_cmp(&stage.0[*b].1);
    // Within the scale nothing is cut.
    let within = |i: &usize| stage.0[*i].1 * magnification < full_peak_m;
    let high = (0..POINTS).filter(within).max_by(by_height).unwrap();
    let low = (0..POINTS).min_by(by_height).unwrap();
    let per_m = (curve[low].1 - curve[high].1) / (stage.0[high].1 - stage.0[low].1);
    let metres = |y: f64| stage.0[low].1 + (curve[low].1 - y) / per_m;
    let pairs = curve.iter().zip(&stage.0).chain(rings.iter().zip(&stage.1));
    let off = pairs.map(|(drawn, at)| (metres(drawn.1) - at.1).abs()).fold(0.0, f64::max);
    // A figure's coordinates have two decimals: each point is off by half of one, and so are the two that state the scale.
    assert!(off * per_m < 0.04, "{case}: {off} m, at {per_m} points a metre");
    // One more is in the legend.
    assert_eq!(rings.len(), stage.1.len() + usize::from(shown.measured.is_some()), "{case}");
    let name = shown.measured.as_ref().map(|rings| rings.name());
    let csv = shown.envelope_csv().unwrap();
    assert!(name.is_none_or(|name| svg.contains(name) && csv.contains(name)), "{case}: {name:?}");
}

/// What the command line and Python compute of this setup, on the actual plate if that is another.
fn computed(setup: &Setup, actual: Option<Plate>) -> Simulated {
    let (table, _) = table_for(&setup.plate, SAMPLE_RATE_HZ).unwrap();
    let (plate, solver) = (setup.plate.clone(), Solver::Line);
    let request = SimulateRequest { plate, actual, has_gains: true, seconds: None, solver, finger: None };
    request.plan(setup.clone(), None, &table).unwrap().run(&mut Progress::unwatched()).unwrap()
}

/// The largest difference of RMS displacements at these places from computed ones over the whole length, as a share of the
/// highest.
fn off_by(places_m: &[f64], rms_m: &[f64], (length_m, computed_m): (f64, &[f64])) -> f64 {
    let top_m = computed_m.iter().copied().fold(0.0, f64::max);
    let off = |(x_m, rms): (&f64, &f64)| (interpolate(computed_m, x_m / length_m) - rms).abs() / top_m;
    places_m.iter().zip(rms_m).map(off).fold(0.0, f64::max)
}

/// The command line and Python state the curve of the stage; on the actual plate, before any fit of its level, the rings.
fn computations_agree(session: &Session, actual: Option<Plate>, case: &str) {
    let shown = session.instrument.shown();
    let length_m = shown.predicted.length_m;
    let result = computed(shown.setup, actual.clone());
    let full_peak_m = shown.full_peak_m.unwrap();
    assert!((result.peak_at_full_scale_m / full_peak_m - 1.0).abs() < 1e-9, "{case}");
    if actual.is_none() {
        let predicted = (length_m, shown.predicted.rms_m.as_slice());
        let off = off_by(&result.position_m, &result.predicted_rms_m, predicted);
        // The stage has a value at 401 places; between them a wave's crests are higher than the straight line.
        assert!(off < 0.04, "{case}: predicted, {off}");
    }
    let Some(rings) = &shown.measured else { return };
    let computed_m: Vec<f64> = result.rms_m.iter().map(|&rms_m| f64::from(rms_m)).collect();
    let factor = rings.fitted.unwrap_or(1.0);
    let own_m: Vec<f64> = rings.field.rms_m.iter().map(|rms_m| rms_m / factor).collect();
    let off = off_by(&rings.field.position_m, &own_m, (length_m, &computed_m));
    assert!(off < 0.05, "{case}: simulated, {off}");
}

/// Two tones of this level in the plate's span.
fn two_tones(plate: Plate, level: f64) -> Setup {
    let (start_m, end_m) = plate.span_m();
    let mut setup = Setup::new(plate.into());
    let tone = |slot: u8, share: f64| ToneSetup {
        slot,
        position_m: start_m + share * (end_m - start_m),
        level,
        phase_turns: 0.0,
    };
    setup.tones = vec![tone(0, 0.3), tone(1, 0.7)];
    setup
}

#[test]
fn stage_figure_and_csv_of_every_preset_have_the_same_numbers() {
    for of in presets() {
        let plate = of.plate().unwrap();
        for setup in [Setup::new(plate.clone().into()), two_tones(plate.clone(), 0.05)] {
            let case = format!("{}, {} tones", of.name, setup.tones.len());
            let magnification = if setup.tones.len() > 1 { 5.0 } else { 1.0 };
            exports_agree(&Session::simulated(setup), magnification, &case);
        }
    }
}

#[test]
fn the_command_line_and_python_compute_what_is_on_the_stage() {
    for name in ["membrane", "al-bending"] {
        let plate = preset(name).unwrap();
        for setup in [Setup::new(plate.clone().into()), two_tones(plate.clone(), 0.05)] {
            let case = format!("{name}, {} tones", setup.tones.len());
            let session = Session::simulated(setup);
            assert!(session.instrument.shown().measured.is_some(), "{case}");
            computations_agree(&session, None, &case);
        }
    }
}

#[test]
fn a_hidden_plates_fitted_level_is_the_same_everywhere_and_is_called_fitted() {
    let mut session = Session::simulated(Setup::new(membrane(1.0).into()));
    session.instrument.perform_measure(MeasureIntent::Secret(true));
    session.measure(None);
    session.drive_on();
    let truth = secret(&session.instrument.desk.setup().plate, 1).unwrap();
    let fitted = |session: &Session| {
        let shown = session.instrument.shown();
        let rings = shown.measured.as_ref().unwrap();
        assert_eq!(rings.name(), "hidden test plate, level fitted");
        assert!(
            shown
                .envelope_csv()
                .unwrap()
                .contains(&format!("all multiplied by {:.4}", rings.fitted.unwrap()))
        );
        rings.fitted.unwrap()
    };
    assert!((fitted(&session) - 1.0).abs() > 0.01, "a plate with other numbers has another level");
    exports_agree(&session, 1.0, "hidden");
    computations_agree(&session, Some(truth.clone()), "hidden");
    session.calibrate_by_measuring();
    session.drive_on();
    fitted(&session);
    exports_agree(&session, 5.0, "calibrated");
    computations_agree(&session, Some(truth), "calibrated");
}
