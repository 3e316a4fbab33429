//! Two touches, without any sensor: where the edge is felt afterwards.

use crate::rig::{Random, Rig, Solver, middle_and_worst};
use crate::shunt;
use slipline_plate::calibrate::{CalibrateError, Priors, Touch, from_touches};
use slipline_plate::feeling::{Feeling, FeltTone};
use slipline_plate::{DriveEnd, Equation, Peak, Plate, PlateSpec, respond_batch};

/// Share of the table's peak at full scale that is played: a vibration is felt from less than a micrometre on.
fn level(name: &str) -> f64 {
    if name == "membrane" { 0.03 } else { 1.0 }
}

/// What is known of the drive before anybody touches the plate.
#[derive(Clone, Copy)]
enum Drive {
    /// It is as the file tells it.
    Told,
    /// Its mass, spring and actuator make the levels swing.
    Unknown,
    /// The same, and its current was measured.
    Measured,
}

/// How far a felt edge may be from its mark, metres.
const MARK_M: f64 = 3e-3;

/// The felt edge of a field whose peak is `peak_m`, metres.
fn told_edge_m(plate: &Plate, frequency_hz: f64, peak_m: f64, feeling: &Feeling) -> Option<f64> {
    let spec = PlateSpec { drive_end: DriveEnd::Displacement, ..plate.spec().clone() };
    let plate = Plate::new(spec).expect("valid");
    let field = &respond_batch(&plate, &[frequency_hz], 601, Equation::Corrected).ok()?[0];
    let scale = peak_m / Peak::of(field, &plate, frequency_hz)?.amplitude;
    let squares: Vec<f64> = field.iter().map(|f| 0.5 * (f * scale).norm_sqr()).collect();
    let tone = FeltTone { frequency_hz, squares: &squares };
    Feeling::edge(&plate, &feeling.strength(&plate, &[tone])).place_m()
}

/// Distance of the told and the felt edge over the frequencies, mm: root of the mean square by the plain file and after
/// two touches. `None` if the touches are refused.
fn before_and_after(name: &str, seed: u64, drive: Drive, count: usize) -> Option<[f64; 2]> {
    let mut random = Random::new(seed);
    let rig = match drive {
        Drive::Told => Rig::new(name, Solver::OneMode, &mut random).with_told_drive(),
        Drive::Unknown => Rig::new(name, Solver::OneMode, &mut random),
        Drive::Measured => {
            let (mut rig, electrics, mut random) = shunt::rig(name, seed);
            let current = shunt::current(&rig, &electrics, &mut random);
            rig.nominal = shunt::calibrated(&rig, &electrics, &current).ok()?.plate;
            rig
        }
    };
    let table = rig.table(&rig.nominal);
    let peak_m = level(name) * table.peak_at_full_scale_m;
    // Nobody knows the source's gain nor this finger's threshold.
    let finger = Feeling { threshold: random.factor(0.5, 2.0), ..Feeling::default() };
    let gain = random.factor(0.7, 1.4);
    let felt = |frequency_hz: f64| {
        let tone = rig.tone(frequency_hz, gain * level(name) * rig.gain_at(&table, frequency_hz));
        let squares: Vec<f64> = tone.iter().map(|w| 0.5 * w.norm_sqr()).collect();
        let tone = FeltTone { frequency_hz, squares: &squares };
        Feeling::edge(&rig.truth, &finger.strength(&rig.truth, &[tone])).place_m()
    };
    let (low, high) = rig.nominal.band_hz();
    let frequencies = (0..=20).map(|i| low * (high / low).powf(0.1 + 0.04 * f64::from(i)));
    let edges: Vec<(f64, f64)> = frequencies.filter_map(|hz| felt(hz).map(|edge_m| (hz, edge_m))).collect();
    let touch = |i: usize| {
        let (frequency_hz, edge_m) = edges[i * (edges.len() - 1) / (count - 1)];
        let mark_m = edge_m + random.within(-MARK_M, MARK_M);
        Touch { mark_m, tolerance_m: MARK_M / 3_f64.sqrt(), frequency_hz }
    };
    let touches: Vec<Touch> = (0..count).map(touch).collect();
    let found = from_touches(&rig.nominal, &touches, peak_m, &Feeling::default(), &Priors::default()).ok()?;
    assert!(found.plate.spec().calibration.as_ref().is_some_and(|it| it.correction.is_none()), "no levels");
    let [speed, low, high] = found.speed;
    assert!(low < speed && speed < high && high < 1.3 * low, "{:?}", found.speed);
    let off = |plate: &Plate, feeling: &Feeling| {
        let off = |(hz, edge_m): &(f64, f64)| {
            let told_m = told_edge_m(plate, *hz, peak_m, feeling);
            told_m.map_or(f64::INFINITY, |told_m| (1e3 * (told_m - edge_m)).powi(2))
        };
        (edges.iter().map(off).sum::<f64>() / edges.len() as f64).sqrt()
    };
    Some([off(&rig.nominal, &Feeling::default()), off(&found.plate, &found.feeling)])
}

#[test]
fn two_touches_put_the_felt_edge_right_where_the_drive_is_as_told() {
    for name in ["membrane", "al-bending"] {
        let judged: Vec<[f64; 2]> =
            (0..20).filter_map(|seed| before_and_after(name, seed, Drive::Told, 2)).collect();
        let [before, after] = [0, 1].map(|i| middle_and_worst(judged.iter().map(|both| both[i]).collect()));
        println!(
            "{name}: {} truths, felt edge off by (mm, median and worst) {before:?} -> {after:?}",
            judged.len()
        );
        assert!(judged.len() >= 19, "{name}: {} accepted", judged.len());
        assert!(after.0 <= 2.5 && after.0 < 0.6 * before.0, "{name}: {before:?} {after:?}");
    }
}

#[test]
fn touches_on_a_drive_whose_levels_swing_are_often_refused_and_else_better_than_nothing() {
    let judged: Vec<[f64; 2]> =
        (0..20).filter_map(|seed| before_and_after("membrane", seed, Drive::Unknown, 2)).collect();
    assert!(judged.len() <= 15, "{judged:?}");
    let [before, after] = [0, 1].map(|i| middle_and_worst(judged.iter().map(|both| both[i]).collect()));
    println!("{} truths, felt edge off by (mm, median and worst) {before:?} -> {after:?}", judged.len());
    assert!(after.0 < 0.6 * before.0 && after.1 < 10.0, "{before:?} {after:?}");
}

#[test]
fn two_touches_serve_an_unknown_drive_of_aluminium_and_a_measured_one_of_a_membrane() {
    for (name, drive) in [("al-bending", Drive::Unknown), ("membrane", Drive::Measured)] {
        let judged: Vec<[f64; 2]> =
            (0..20).filter_map(|seed| before_and_after(name, seed, drive, 2)).collect();
        let [before, after] = [0, 1].map(|i| middle_and_worst(judged.iter().map(|both| both[i]).collect()));
        println!("{name}: {} truths, felt edge off by (mm) {before:?} -> {after:?}", judged.len());
        assert!(judged.len() >= 16, "{name}: {} accepted", judged.len());
        assert!(after.0 <= 2.5 && after.1 <= 4.0, "{name}: {before:?} {after:?}");
    }
}

#[test]
fn touches_that_tell_nothing_are_refused() {
    let mut random = Random::new(1);
    let plate = Rig::new("membrane", Solver::OneMode, &mut random).nominal;
    let refused = |marks: &[(f64, f64)], peak_m: f64| {
        let touches: Vec<Touch> = marks
            .iter()
            .map(|&(mark_m, frequency_hz)| Touch { mark_m, tolerance_m: 2e-3, frequency_hz })
            .collect();
        from_touches(&plate, &touches, peak_m, &Feeling::default(), &Priors::default()).expect_err("refused")
    };
    let one = refused(&[(0.15, 120.0)], 5e-6);
    assert!(matches!(one, CalibrateError::CloseMarks { count: 1, .. }), "{one}");
    let close = refused(&[(0.15, 120.0), (0.16, 125.0)], 5e-6);
    assert!(matches!(close, CalibrateError::CloseMarks { count: 2, .. }), "{close}");
    let silent = refused(&[(0.15, 120.0), (0.2, 150.0)], 1e-12);
    assert!(matches!(silent, CalibrateError::NoEdge), "{silent}");
    // A higher frequency has its edge farther away.
    let exchanged = refused(&[(0.25, 120.0), (0.12, 150.0)], 5e-6);
    let is_told = matches!(exchanged, CalibrateError::EdgesUnlike { .. } | CalibrateError::NoEdge);
    assert!(is_told, "{exchanged}");
    let off = refused(&[(0.5, 120.0), (0.12, 170.0)], 5e-6);
    assert!(off.to_string().starts_with("mark_m = 0.5 m"), "{off}");
}
