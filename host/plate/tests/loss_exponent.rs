//! A loss factor that varies with the frequency as a power law about the middle of the band.

use super::calibration::rig::{Random, Rig, Solver};
use super::calibration::{calibrated, within};
use super::time_line::assert_answers_tones;
use slipline_plate::calibrate::{Calibrated, Placing, SensorPlaces};
use slipline_plate::{
    Air, AirMounting, Equation, Faces, Film, Gas, Model, Plate, PlateSpec, Thickness, plane, preset, respond,
    respond_batch,
};

fn changed(name: &str, change: impl FnOnce(&mut PlateSpec)) -> Plate {
    let mut spec = preset(name).expect("a preset").spec().clone();
    change(&mut spec);
    Plate::new(spec).expect("a valid plate")
}

fn around(mounting: AirMounting) -> Option<Air> {
    Some(Air::Around { gas: Gas::ROOM, mounting, gap_m: None })
}

/// A plate of each law that has a loss of its own.
fn plates() -> Vec<(&'static str, Plate)> {
    let in_baffle = around(AirMounting::Baffle { faces: Faces::Two });
    let film = Film { youngs_modulus_pa: 4.5e9, poisson_ratio: 0.38, thickness_m: 50e-6 };
    let of_film = Model::Membrane {
        wave_speed_m_per_s: 12.0,
        tension_n_per_m: Some(1390.0 * 50e-6 * 144.0),
        film: Some(film),
    };
    vec![
        ("membrane", changed("membrane", |_| {})),
        ("in a bare frame", changed("latex-membrane", |spec| spec.air = Some(Air::ROOM))),
        ("in a baffle", changed("membrane", |spec| spec.air = in_baffle)),
        ("film", changed("membrane", |spec| spec.model = of_film)),
        ("shear", changed("al-sh", |_| {})),
        ("bending", changed("al-bending", |_| {})),
        (
            "graded",
            changed("al-bending-displacement", |spec| {
                spec.thickness = Some(Thickness::Exponential { rate_per_m: 0.4 });
            }),
        ),
    ]
}

/// The same plate with this loss factor and course.
fn lossy(plate: &Plate, loss_factor: f64, loss_exponent: Option<f64>) -> Plate {
    Plate::new(PlateSpec { loss_factor, loss_exponent, ..plate.spec().clone() }).expect("valid")
}

/// At each frequency alone a power law is a loss factor that does not vary.
#[test]
fn every_law_has_at_a_frequency_the_loss_of_that_frequency() {
    for (kind, plate) in plates() {
        let (low_hz, high_hz) = plate.band_hz();
        let middle_hz = (low_hz * high_hz).sqrt();
        let eta = plate.spec().loss_factor.max(1e-3);
        let power = lossy(&plate, eta, Some(1.3));
        let frequencies_hz = [1.02 * low_hz, middle_hz, 0.98 * high_hz];
        let together = respond_batch(&power, &frequencies_hz, 129, Equation::Corrected).expect("in band");
        for (i, &hz) in frequencies_hz.iter().enumerate() {
            let here = eta * (hz / middle_hz).powf(1.3);
            assert!((power.loss_factor_at(hz) / here - 1.0).abs() < 1e-12, "{kind} {hz}");
            let alone = lossy(&plate, here, None);
            let alone_together =
                respond_batch(&alone, &frequencies_hz, 129, Equation::Corrected).expect("in band");
            let wanted = respond(&alone, hz, 129, Equation::Corrected).expect("in band").amplitude;
            let found = respond(&power, hz, 129, Equation::Corrected).expect("in band").amplitude;
            let largest = wanted.iter().map(|f| f.norm()).fold(0.0, f64::max);
            for (wanted, found) in wanted.iter().zip(&found).chain(alone_together[i].iter().zip(&together[i]))
            {
                assert!((wanted - found).norm() < 1e-9 * largest, "{kind} {hz}: {found} {wanted}");
            }
        }
        // Another exponent is another field.
        let flat = respond(&lossy(&plate, eta, None), frequencies_hz[0], 129, Equation::Corrected);
        let off = flat.expect("in band").height()
            / respond(&power, frequencies_hz[0], 129, Equation::Corrected).expect("in band").height();
        assert!((off - 1.0).abs() > 1e-4, "{kind}: {off}");
    }
}

#[test]
fn the_sheet_in_two_dimensions_has_the_loss_exponent_too() {
    for (kind, plate) in
        plates().into_iter().filter(|(kind, _)| ["membrane", "in a baffle", "bending"].contains(kind))
    {
        let (low_hz, high_hz) = plate.band_hz();
        let (hz, middle_hz) = (1.05 * low_hz, (low_hz * high_hz).sqrt());
        let eta = plate.spec().loss_factor.max(1e-3);
        let field = |plate: &Plate| {
            plane::respond(plate, hz, 65, &plane::Setup::of(plate)).expect("in band").amplitude
        };
        let found = field(&lossy(&plate, eta, Some(-1.0)));
        let wanted = field(&lossy(&plate, eta * middle_hz / hz, None));
        let largest = wanted.iter().map(|f| f.norm()).fold(0.0, f64::max);
        for (found, wanted) in found.iter().zip(&wanted) {
            assert!((found - wanted).norm() < 1e-6 * largest, "{kind}: {found} {wanted}");
        }
    }
}

#[test]
fn a_line_in_time_answers_a_tone_with_the_loss_of_its_frequency() {
    let plate = changed("membrane", |spec| (spec.loss_factor, spec.loss_exponent) = (0.02, Some(1.0)));
    let (low_hz, high_hz) = plate.band_hz();
    assert_answers_tones(&plate, 20e3, &[1.05 * low_hz, 0.95 * high_hz], 2e-3);
}

#[test]
fn a_course_of_the_loss_is_read_written_and_refused_by_name() {
    let plate = changed("membrane", |spec| {
        (spec.loss_exponent, spec.loss_exponent_tolerance) = (Some(0.3), Some(0.5));
    });
    let text = plate.to_toml();
    assert!(text.contains("loss_exponent = 0.3"), "{text}");
    assert_eq!(Plate::from_toml(&text).expect("its own text"), plate);
    let refused =
        |from: &str, to: &str| Plate::from_toml(&text.replace(from, to)).expect_err("refused").to_string();
    let error = refused("loss_exponent = 0.3", "loss_exponent = 2.5");
    assert!(error.contains("loss_exponent = 2.5: must be -2 to 2"), "{error}");
    let error = refused("loss_exponent_tolerance = 0.5", "loss_exponent_tolerance = -1");
    assert!(error.contains("loss_exponent_tolerance = -1: must be 0 to 2"), "{error}");
    let mut spec = preset("al-bending").expect("a preset").spec().clone();
    spec.model = Model::BendingClamped(spec.model.bending().expect("bending").clone());
    spec.loss_exponent = Some(0.5);
    let error = Plate::new(spec).expect_err("clamped").to_string();
    assert!(error.contains("the law between clamped edges has one loss"), "{error}");
    // Nothing has a higher loss than a plate may have.
    let wild = changed("membrane", |spec| (spec.loss_factor, spec.loss_exponent) = (0.4, Some(2.0)));
    assert!((wild.loss_factor_at(2.0 * wild.band_hz().1) - 0.5).abs() < 1e-12);
}

/// What becomes of a plate whose loss has the course `exponent`, for a file that knows it to +-`known`.
fn outcome(name: &str, exponent: f64, known: Option<f64>, seed: u64) -> (Calibrated, f64, f64) {
    let mut random = Random::new(seed);
    let mut rig = Rig::new(name, Solver::OneMode, &mut random);
    let truth = PlateSpec { loss_exponent: Some(exponent), ..rig.truth.spec().clone() };
    rig.truth = Plate::new(truth).expect("a plate");
    let file = PlateSpec { loss_exponent_tolerance: known, ..rig.nominal.spec().clone() };
    rig.nominal = Plate::new(file).expect("a plate");
    let placing = Placing { points: 100, ..Placing::default() };
    let places_m = SensorPlaces::of(&rig.nominal, &placing).expect("places").best.places_m;
    let sensors = rig.measure(places_m, 100, &mut random);
    let found = calibrated(&rig, &sensors).unwrap_or_else(|error| panic!("{name} {exponent}: {error}"));
    let (boundary_m, levels_db) = rig.errors(&found.plate);
    let level_db = levels_db.iter().copied().fold(0.0, f64::max);
    println!(
        "{name} {exponent} ({known:?}): exponent {:.3?} +- {:.3?}, boundary {:.2} ({:.2}) mm, level {level_db:.2} ({:.2}) dB, chi2/n {:.2}",
        found.plate.spec().loss_exponent,
        found.plate.spec().loss_exponent_tolerance,
        1e3 * boundary_m,
        1e3 * found.boundary_tolerance_m,
        found.level_tolerance_db,
        found.chi2_per_n
    );
    (found, boundary_m, level_db)
}

#[test]
fn a_calibration_finds_the_exponent_or_leaves_it_in_its_intervals() {
    for (number, (name, exponent)) in
        (8300..).zip([("membrane", 1.0), ("membrane", -0.5), ("al-bending", 1.0)])
    {
        let (found, boundary_m, level_db) = outcome(name, exponent, Some(2.0), number);
        assert!(within(&found, "loss_exponent", exponent), "{name}: {:?}", found.parameters);
        assert!(boundary_m < 1.2 * found.boundary_tolerance_m, "{name}: {boundary_m}");
        assert!(level_db < 1.2 * found.level_tolerance_db, "{name}: {level_db}");
        let plate = Plate::from_toml(&found.plate.to_toml()).expect("an ordinary plate file");
        assert_eq!(plate, found.plate);
        assert!(plate.spec().loss_exponent_tolerance.expect("stated") <= 2.0);
    }
}

/// A file that does not state how well it knows the exponent has no such unknown.
#[test]
fn a_file_without_the_field_is_calibrated_without_the_unknown() {
    let (held, ..) = outcome("membrane", 0.0, None, 8310);
    assert_eq!(held.plate.spec().loss_exponent, None);
    assert!(held.parameters.iter().all(|it| it.name != "loss_exponent"));
    let (sure, ..) = outcome("membrane", 0.0, Some(0.0), 8310);
    assert_eq!(sure.parameters, held.parameters);
    let (open, ..) = outcome("membrane", 0.0, Some(2.0), 8310);
    assert_eq!(open.parameters.len(), held.parameters.len() + 1);
    assert!(open.boundary_tolerance_m > held.boundary_tolerance_m);
}
