//! Builds the bank of one width mode: poles and residues of the plate, its driven end and its actuator.

use super::bank::ModalBank;
use super::coupling::{Uncoupled, couple};
use crate::definition::actuator::Actuator;
use crate::definition::drive::DriveEnd;
use crate::definition::model::{Bending, Model};
use crate::definition::plate::Plate;
use crate::definition::width_mode::WidthMode;
use crate::time::galerkin;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Partial fractions of 1/(lambda - a K^2 (1 + j eta)) for one eigenvalue lambda: a sum of c/(p - omega).
struct Terms {
    /// Pairs (p, c).
    own: Vec<(Complex64, Complex64)>,
    /// Residue at the far pole that all eigenvalues share; it corrects the remaining error in mid-band.
    shared: Complex64,
}

/// The pole, far from the band, of the correction terms of a thick plate.
fn shared_pole(centre: f64) -> Complex64 {
    Complex64::new(-2.0 * centre, -0.5 * centre)
}

/// Whether the eigenfunctions describe this width mode well: exactly for a thin plate in bending, exactly at each
/// resonance for a membrane or SH waves.
///
/// The dispersion of a thick plate (Mindlin), of a film, of a plate with air and of a plate whose thickness changes has
/// no exact partial fractions: the bank would have errors of 3 % and more. The same is true of the strip's law between
/// clamped edges for the first width mode; higher ones follow the tangent of that law, which has them. The near field
/// and the impedance of a source are not among the eigenfunctions.
pub(crate) fn fits(plate: &Plate, mode: u32) -> bool {
    let spec = plate.spec();
    let is_thick = spec.model.bending().is_some_and(|bending| bending.thick_plate);
    let has_end = match spec.drive_end {
        DriveEnd::Displacement | DriveEnd::Force { .. } | DriveEnd::Resistance { .. } => true,
        DriveEnd::DisplacementAndSlope { .. } | DriveEnd::Source(_) => false,
    };
    let is_film = spec.model.film().is_some();
    has_end
        && !is_thick
        && !is_film
        && !plate.is_graded()
        && !plate.carries_air()
        && plate.width_mode(mode).strip.is_none()
}

/// Builds the bank of one width mode for waves up to `top_hz`; `centre_hz` is the middle of the band, and `places_m`
/// are the positions of the field, metres.
///
/// The plate's drive end must be a displacement, a force or a resistance, see [`fits`].
pub(crate) fn build(plate: &Plate, mode: u32, top_hz: f64, centre_hz: f64, places_m: &[f64]) -> ModalBank {
    let width_mode = plate.width_mode(mode);
    let resistance = resistance_over_tension(plate);
    let osc = match plate.spec().drive_end {
        DriveEnd::Displacement => galerkin::held(&width_mode, top_hz, places_m),
        _ => galerkin::free(&width_mode, top_hz, places_m),
    };
    let centre = TAU * centre_hz;
    let mut pole = Vec::new();
    let mut owner = Vec::new();
    let mut weight = Vec::new();
    let mut shared = Vec::new();
    for (n, &eigenvalue) in osc.eigenvalue.iter().enumerate() {
        let terms = terms(&width_mode, eigenvalue, centre);
        for (p, c) in terms.own {
            pole.push(p);
            owner.push(n);
            weight.push(c * osc.excitation[n]);
        }
        shared.push(terms.shared * osc.excitation[n]);
    }
    let mut shape =
        DMatrix::from_fn(places_m.len(), pole.len(), |row, i| weight[i] * osc.shape[(row, owner[i])]);
    let mut at_drive: Vec<Complex64> = (0..pole.len()).map(|i| weight[i] * osc.at_drive[owner[i]]).collect();
    if shared.iter().any(|residue| *residue != Complex64::ZERO) {
        let column = osc.shape.map(Complex64::from) * DVector::from_column_slice(&shared);
        let last = shape.ncols();
        shape = shape.insert_column(last, Complex64::ZERO);
        shape.set_column(last, &column);
        at_drive.push(shared.iter().zip(&osc.at_drive).map(|(residue, value)| residue * value).sum());
        pole.push(shared_pole(centre));
    }
    let direct = osc.direct.map(Complex64::from);
    let scale = match plate.spec().drive_end {
        DriveEnd::Force { at_frequency_hz } => {
            -plate.width_mode(1).wavenumber_squared(0.0, at_frequency_hz).max(0.0).sqrt()
        }
        _ => 1.0,
    };
    let resonator = plate.spec().actuator.as_ref().and_then(Actuator::resonator).copied();
    couple(&Uncoupled { pole, shape, direct, at_drive, scale }, resistance, resonator)
}

/// R/T of the source's resistance, s/m; `None` for the other driven ends.
fn resistance_over_tension(plate: &Plate) -> Option<f64> {
    match plate.spec().drive_end {
        DriveEnd::Resistance { ratio, at_frequency_hz } => {
            let k0 = plate.width_mode(1).wavenumber_squared(0.0, at_frequency_hz).max(0.0).sqrt();
            Some(ratio * k0 / (TAU * at_frequency_hz))
        }
        _ => None,
    }
}

fn terms(width_mode: &WidthMode<'_>, eigenvalue: f64, centre: f64) -> Terms {
    let lossy = Complex64::new(1.0, width_mode.plate.wave_loss()) * width_mode.slope;
    let alone = |own| Terms { own, shared: Complex64::ZERO };
    match &width_mode.plate.spec().model {
        Model::BendingSupported(bending) | Model::BendingClamped(bending) if bending.thick_plate => {
            thick(bending, eigenvalue, lossy, centre)
        }
        Model::BendingSupported(bending) | Model::BendingClamped(bending) => {
            // a K^2 = omega lossy/spread: one pole, exact.
            let rate = bending.spread_m2_per_s() / lossy;
            alone(vec![(eigenvalue * rate, rate)])
        }
        model @ (Model::Membrane { .. } | Model::ShearHorizontal { .. }) => {
            let speed = model.wave_speed_m_per_s().unwrap_or(f64::NAN);
            let square = speed * speed / lossy;
            let p = (eigenvalue * square).sqrt();
            let c = square / (2.0 * p);
            // The second pole, -p, would be an oscillation that grows. It is replaced by its mirror image -p*, which
            // decays, with a residue for which both terms are equal in mid-band.
            let mirror = -p.conj();
            alone(vec![(p, c), (mirror, -c * (p.conj() + centre) / (p + centre))])
        }
    }
}

/// Mindlin's dispersion: one pole for each eigenvalue, and a residue at the shared far pole that corrects the error in
/// mid-band.
fn thick(bending: &Bending, eigenvalue: f64, lossy: Complex64, centre: f64) -> Terms {
    let wanted = eigenvalue / lossy;
    // The branch is smooth and the loss small, so finite differences along the real axis and a Taylor series in the
    // imaginary part give the pole and the derivative.
    let h = 1e-4 * wanted.re;
    let real = |k2: f64| bending.angular_frequency(k2);
    let first = (real(wanted.re + h) - real(wanted.re - h)) / (2.0 * h);
    let second = (real(wanted.re + h) - 2.0 * real(wanted.re) + real(wanted.re - h)) / (h * h);
    let aside = wanted - wanted.re;
    let pole = real(wanted.re) + first * aside + 0.5 * second * aside * aside;
    let residue = (first + second * aside) / lossy;
    let left_over = |omega: f64| {
        1.0 / (eigenvalue - lossy * bending.wavenumber_squared(omega)) - residue / (pole - omega)
    };
    // Close to the pole this is the difference of two large numbers and loses precision, so the mean is taken at two
    // frequencies 5 % below and above mid-band.
    let away = 0.05 * centre;
    let rest = 0.5 * (left_over(centre + away) + left_over(centre - away));
    Terms { own: vec![(pole, residue)], shared: rest * (shared_pole(centre) - centre) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definition::presets::{preset, presets};
    use crate::frequency::equation::Equation;
    use crate::frequency::respond::respond;
    use crate::time::fit;

    #[test]
    fn the_bank_of_every_preset_that_has_one_answers_as_the_frequency_domain_solver() {
        let plates: Vec<Plate> = presets().iter().map(|preset| preset.plate().expect("a preset")).collect();
        // All presets but the one with a lead-in and the one with air.
        assert_eq!(plates.iter().filter(|plate| !fits(plate, 1)).count(), 2);
        for plate in plates.iter().filter(|plate| fits(plate, 1)) {
            let (low, high) = plate.band_hz();
            let places: Vec<f64> = (0..65).map(|i| plate.length_m() * f64::from(i) / 64.0).collect();
            let bank = build(plate, 1, 1.2 * high, (low * high).sqrt(), &places);
            assert!(bank.pole.iter().all(|p| p.im <= 0.0), "{}: an oscillation that grows", plate.name());
            let mut worst: f64 = 0.0;
            for i in 0..=10 {
                let frequency = low + (high - low) * f64::from(i) / 10.0;
                let exact = respond(plate, frequency, 65, Equation::Corrected).expect("in band");
                let peak = exact.amplitude.iter().map(|f| f.norm()).fold(0.0, f64::max);
                for (a, b) in exact.amplitude.iter().zip(bank.steady(frequency)) {
                    worst = worst.max((a - b).norm() / peak);
                }
            }
            assert!(
                worst < if plate.spec().loss_factor > 0.05 { 3e-3 } else { 1e-3 },
                "{}: {worst}",
                plate.name()
            );
        }
    }

    #[test]
    fn between_clamped_edges_bank_and_fit_answer_as_the_tangent_of_the_law() {
        let mut spec = preset("al-bending-displacement").expect("a preset").spec().clone();
        spec.model = Model::BendingClamped(spec.model.bending().expect("bending").clone());
        (spec.span_start_m, spec.span_end_m, spec.loss_factor) = (0.15, 0.22, 0.02);
        let plate = Plate::new(spec).expect("a valid plate");
        // The first width mode has the exact law.
        assert!(!fits(&plate, 1) && fits(&plate, 3));
        let (low, high) = plate.band_hz();
        let places: Vec<f64> = (0..65).map(|i| plate.length_m() * f64::from(i) / 64.0).collect();
        let bank = build(&plate, 3, 1.2 * high, (low * high).sqrt(), &places);
        let frequencies = [low, (low * high).sqrt(), high];
        let fields = fit::response(&plate, 3, 65, high)(&frequencies);
        for (frequency_hz, field) in frequencies.into_iter().zip(fields) {
            let largest = field.iter().map(|f| f.norm()).fold(0.0, f64::max);
            for (a, b) in field.iter().zip(bank.steady(frequency_hz)) {
                assert!((a - b).norm() < 1e-3 * largest, "{frequency_hz}: {a} {b}");
            }
        }
    }
}
