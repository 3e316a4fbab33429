//! Calibration by two and more touches, without a sensor: the error of the felt edge afterwards.

use super::rig::{Random, Rig, Solver, middle_and_worst};
use super::shunt;
use slipline_plate::calibrate::{CalibrateError, Priors, Touch, TouchedDrive, from_touches};
use slipline_plate::feeling::{Feeling, FeltTone};
use slipline_plate::{DriveEnd, Equation, Model, Peak, Plate, PlateSpec, respond_batch};

/// Level of the tones over the table's peak at full scale: vibration is felt from less than a micrometre.
fn level(name: &str) -> f64 {
    if name == "membrane" { 0.03 } else { 1.0 }
}

/// Knowledge of the drive before the touches.
#[derive(Debug, Clone, Copy)]
enum Drive {
    /// The drive is as the file states it.
    Stated,
    /// The levels vary by its mass, stiffness and actuator.
    Unknown,
    /// The same, with a measured current.
    Measured,
}

/// Largest distance of a mark from the felt edge, metres.
const MARK_M: f64 = 3e-3;

/// The predicted felt edge of a field whose peak is `peak_m`, metres.
fn stated_edge_m(plate: &Plate, frequency_hz: f64, peak_m: f64, feeling: &Feeling) -> Option<f64> {
    let spec = PlateSpec { drive_end: DriveEnd::Displacement, ..plate.spec().clone() };
    let plate = Plate::new(spec).expect("valid");
    let field = &respond_batch(&plate, &[frequency_hz], 601, Equation::Corrected).ok()?[0];
    let scale = peak_m / Peak::of(field, &plate, frequency_hz)?.amplitude;
    let squares: Vec<f64> = field.iter().map(|f| 0.5 * (f * scale).norm_sqr()).collect();
    let tone = FeltTone { frequency_hz, squares: &squares };
    Feeling::edge(&plate, &feeling.strength(&plate, &[tone])).place_m()
}

/// Result of the touches on one plate.
#[derive(Debug, Clone, Copy)]
struct Judged {
    /// Root mean square over the frequencies of the distance between the calibrated and the felt edge, mm: by the
    /// plain file and its table, and by the file after the touches and its table.
    off_mm: [f64; 2],
    /// Half of the stated 95 % interval of that distance, mm.
    stated_mm: f64,
    /// Whether the stated interval of the wave speed contains the true one.
    holds_speed: bool,
}

/// Touches a plate `count` times; `None` if the touches are refused.
fn judge(name: &str, seed: u64, drive: Drive, count: usize) -> Option<Judged> {
    let mut random = Random::new(seed);
    let rig = match drive {
        Drive::Stated => Rig::new(name, Solver::OneMode, &mut random).with_stated_drive(),
        Drive::Unknown => Rig::new(name, Solver::OneMode, &mut random),
        Drive::Measured => {
            let (mut rig, electrics, mut random) = shunt::rig(name, seed);
            let current = shunt::current(&rig, &electrics, &mut random);
            rig.nominal = shunt::calibrated(&rig, &electrics, &current).ok()?.plate;
            rig
        }
    };
    // The source's gain and this finger's threshold are unknown.
    let finger = Feeling { threshold: random.factor(0.5, 2.0), ..Feeling::default() };
    let gain = random.factor(0.7, 1.4);
    let (low, high) = rig.nominal.band_hz();
    let frequencies: Vec<f64> =
        (0..=20).map(|i| low * (high / low).powf(0.1 + 0.04 * f64::from(i))).collect();
    // The felt edge of each frequency with a plate's table, and the peak that this table predicts: at the level that
    // the plain file predicts for the stated threshold.
    let loud = level(name) * rig.table(&rig.nominal).peak_at_full_scale_m();
    let felt = |plate: &Plate, stated: &Feeling| -> Vec<(f64, f64, f64)> {
        let table = rig.table(plate);
        let level = (loud * stated.threshold / table.peak_at_full_scale_m()).min(1.0);
        let edge = |&hz: &f64| {
            let boundary_m = plate.turning_point_m(hz).expect("enters");
            let tone = rig.tone(hz, gain * level * table.gain(boundary_m));
            let squares: Vec<f64> = tone.iter().map(|w| 0.5 * w.norm_sqr()).collect();
            let strength = finger.strength(&rig.truth, &[FeltTone { frequency_hz: hz, squares: &squares }]);
            let edge_m = Feeling::edge(&rig.truth, &strength).place_m()?;
            Some((hz, edge_m, level * table.peak_m(boundary_m)))
        };
        frequencies.iter().filter_map(edge).collect()
    };
    let edges = felt(&rig.nominal, &Feeling::default());
    let touch = |i: usize| {
        let (frequency_hz, edge_m, peak_m) = edges[i * (edges.len() - 1) / (count - 1)];
        let mark_m = edge_m + random.within(-MARK_M, MARK_M);
        Touch { mark_m, tolerance_m: MARK_M / 3_f64.sqrt(), frequency_hz, peak_m }
    };
    let touches: Vec<Touch> = (0..count).map(touch).collect();
    let known = match drive {
        Drive::Stated => TouchedDrive::AsStated,
        Drive::Unknown | Drive::Measured => TouchedDrive::of(&rig.nominal),
    };
    let found = from_touches(&rig.nominal, &touches, &Feeling::default(), known, &Priors::default()).ok()?;
    let is_measured = found.plate.spec().calibration.as_ref().is_some_and(|it| it.correction.is_some());
    assert_eq!(is_measured, matches!(drive, Drive::Measured), "touches give no levels");
    let [speed, low, high] = found.speed;
    assert!(low < speed && speed < high && high < 1.3 * low, "{:?}", found.speed);
    let truly = numbers(&rig.truth) / numbers(&rig.nominal);
    let off = |plate: &Plate, feeling: &Feeling, edges: &[(f64, f64, f64)]| {
        let off = |&(hz, edge_m, peak_m): &(f64, f64, f64)| {
            let stated_m = stated_edge_m(plate, hz, peak_m, feeling).unwrap_or(plate.length_m());
            (1e3 * (stated_m - edge_m)).powi(2)
        };
        (edges.iter().map(off).sum::<f64>() / edges.len() as f64).sqrt()
    };
    Some(Judged {
        off_mm: [
            off(&rig.nominal, &Feeling::default(), &edges),
            off(&found.plate, &found.feeling, &felt(&found.plate, &found.feeling)),
        ],
        stated_mm: 1e3 * found.edge_tolerance_m,
        holds_speed: (low..=high).contains(&truly),
    })
}

/// The wave speed, or a quantity proportional to it.
fn numbers(plate: &Plate) -> f64 {
    match &plate.spec().model {
        Model::Membrane { wave_speed_m_per_s, .. } => *wave_speed_m_per_s,
        model => model.bending().expect("bending").youngs_modulus_pa.powf(0.25),
    }
}

/// Median and worst over the truths before and after, and the accepted ones.
fn truths(name: &str, drive: Drive, count: usize, truths: u64) -> ([(f64, f64); 2], Vec<Judged>) {
    let judged: Vec<Judged> = (0..truths).filter_map(|seed| judge(name, seed, drive, count)).collect();
    let figures = [0, 1].map(|i| middle_and_worst(judged.iter().map(|it| it.off_mm[i]).collect()));
    println!(
        "{name}, {drive:?}, {count} touches: {} of {truths}, felt edge off by (mm, median and worst) {figures:?}; stated {:?}, beyond it {}, speed held {}",
        judged.len(),
        middle_and_worst(judged.iter().map(|it| it.stated_mm).collect()),
        judged.iter().filter(|it| it.off_mm[1] > it.stated_mm).count(),
        judged.iter().filter(|it| it.holds_speed).count(),
    );
    (figures, judged)
}

#[test]
fn two_touches_put_the_felt_edges_of_the_first_plates_right() {
    let ([before, after], judged) = truths("membrane", Drive::Stated, 2, 2);
    assert_eq!(judged.len(), 2);
    assert!(after.1 <= 4.0 && after.0 < before.0, "{before:?} {after:?}");
    let held = judged.iter().filter(|it| it.off_mm[1] <= it.stated_mm && it.holds_speed).count();
    assert_eq!(held, 2, "{judged:?}");
}

#[test]
#[ignore = "many plates: .ci/run statistics"]
fn touches_on_an_unknown_drive_put_the_felt_edge_nearly_as_right_as_anything_can() {
    // The limit for any method on average is in PHYSICS.md, by the example `felt_edges`.
    for (count, most_mm) in [(2, 4.5), (6, 2.0)] {
        let ([before, after], judged) = truths("membrane", Drive::Unknown, count, 20);
        assert_eq!(judged.len(), 20, "none is refused");
        assert!(after.0 <= most_mm && after.0 < 0.4 * before.0, "{count}: {before:?} {after:?}");
        // The stated intervals of edge and speed must hold for 95 % of all: almost surely for 17 of 20.
        let within = judged.iter().filter(|it| it.off_mm[1] <= it.stated_mm).count();
        let held = judged.iter().filter(|it| it.holds_speed).count();
        assert!(within >= 17 && held >= 17, "{count}: {within} {held}");
    }
}

#[test]
#[ignore = "many plates: .ci/run statistics"]
fn two_touches_put_the_felt_edge_right_where_the_drive_is_known_or_matters_less() {
    for (name, drive, most_mm) in [
        ("membrane", Drive::Stated, 2.0),
        ("al-bending", Drive::Stated, 2.0),
        ("al-bending", Drive::Unknown, 2.5),
        ("membrane", Drive::Measured, 2.5),
    ] {
        let ([before, after], judged) = truths(name, drive, 2, 10);
        assert_eq!(judged.len(), 10, "{name} {drive:?}");
        assert!(after.0 <= most_mm && after.0 < 0.6 * before.0, "{name} {drive:?}: {before:?} {after:?}");
    }
}

#[test]
fn an_implausible_threshold_is_refused_with_its_reason() {
    let mut random = Random::new(1);
    let plate = Rig::new("membrane", Solver::OneMode, &mut random).nominal;
    let found = |threshold: f64| {
        let finger = Feeling { threshold, ..Feeling::default() };
        let touch = |frequency_hz: f64| {
            let mark_m = stated_edge_m(&plate, frequency_hz, 1e-4, &finger).expect("felt");
            Touch { mark_m, tolerance_m: 5e-4, frequency_hz, peak_m: 1e-4 }
        };
        let touches = [100.0, 140.0].map(touch);
        let drive = TouchedDrive::AsStated;
        from_touches(&plate, &touches, &Feeling::default(), drive, &Priors::default())
    };
    let threshold = found(8.0).expect("plausible").feeling.threshold;
    assert!((threshold / 8.0).ln().abs() < 0.2, "{threshold}");
    let refusal = found(50.0).expect_err("refused");
    assert!(matches!(refusal, CalibrateError::ImplausibleFeeling { share, .. } if share > 20.0), "{refusal}");
    assert!(refusal.to_string().contains("0.05 to 20 times are plausible"), "{refusal}");
}

#[test]
fn touches_that_determine_nothing_are_refused() {
    let mut random = Random::new(1);
    let plate = Rig::new("membrane", Solver::OneMode, &mut random).nominal;
    let refused = |marks: &[(f64, f64)], peak_m: f64| {
        let touches: Vec<Touch> = marks
            .iter()
            .map(|&(mark_m, frequency_hz)| Touch { mark_m, tolerance_m: 2e-3, frequency_hz, peak_m })
            .collect();
        from_touches(&plate, &touches, &Feeling::default(), TouchedDrive::AsStated, &Priors::default())
            .expect_err("refused")
    };
    let one = refused(&[(0.15, 120.0)], 5e-6);
    assert!(matches!(one, CalibrateError::CloseMarks { count: 1, .. }), "{one}");
    let close = refused(&[(0.15, 120.0), (0.16, 125.0)], 5e-6);
    assert!(matches!(close, CalibrateError::CloseMarks { count: 2, .. }), "{close}");
    let silent = refused(&[(0.15, 120.0), (0.2, 150.0)], 1e-12);
    assert!(matches!(silent, CalibrateError::NoEdge), "{silent}");
    // A higher frequency has its edge farther from the drive.
    let exchanged = refused(&[(0.25, 120.0), (0.12, 150.0)], 5e-6);
    let is_refused = matches!(exchanged, CalibrateError::EdgesUnlike { .. } | CalibrateError::NoEdge);
    assert!(is_refused, "{exchanged}");
    let off = refused(&[(0.5, 120.0), (0.12, 170.0)], 5e-6);
    assert!(off.to_string().starts_with("mark_m = 0.5 m"), "{off}");
}
