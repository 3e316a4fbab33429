//! A clamped plate in bending in two dimensions: a check of the one-dimensional model, without its assumption of one
//! width mode.
//!
//! Kirchhoff's equation lap lap w = kb^4 w on the tapered plate with w = dw/dn = 0 at z = +-W(x), in the weak form
//! integral of (lap w)(lap v) - kb^4 w v = 0 for every admissible v. (With clamped edges the integral of the Gaussian
//! curvature vanishes.) With b = z/W(x) and w = sum f_m(x) (1 - b^2)^2 P_2m(b) the clamped edges hold exactly, and
//!
//! lap w = f'' p - 2 s f' b p' + f ((b^2 s^2 + 1/W^2) p'' + (s^2 - s') b p'),  s = W'/W.
//!
//! The f_m are cubic Hermite elements along x, so the matrix has a narrow band and the solution takes a few
//! milliseconds.

mod band_matrix;
mod shape;

use crate::frequency::error::RespondError;
use crate::frequency::peak::{self, Peak};
use crate::spec::model::Model;
use crate::spec::plate::Plate;
use crate::spec::taper::LogWidth;
use band_matrix::BandMatrix;
use num_complex::Complex64;
use shape::{Jet, across, along, gauss};
use std::f64::consts::TAU;

/// Elements per wavelength of the free plate, for an error below 1e-5.
const ELEMENTS_PER_WAVELENGTH: f64 = 12.0;
/// Polynomials across the half-width.
const ORDERS: usize = 5;
/// Positions per element at which the centre line is reported.
const PLACES: usize = 8;
/// Most elements, whatever the plate.
const ELEMENTS_MAX: usize = 5000;

/// Deflection on the centre line of a clamped plate.
#[derive(Debug, Clone, PartialEq)]
pub struct CentreLine {
    /// Uniform positions from 0 to the plate's end, metres.
    pub position_m: Vec<f64>,
    /// Complex deflection at each position, relative to the deflection of the centre of the driven end.
    pub deflection: Vec<Complex64>,
    /// The turning-point peak, if there is one.
    pub peak: Option<Peak>,
}

/// Solves the plate at `frequency_hz`: driven at x = 0 by the deflection (1 - (z/W0)^2)^2 with a free slope, clamped
/// at the far end and at both edges.
///
/// The plate's drive end and actuator are not used. `None` if the plate is not a plate in bending with clamped edges.
///
/// # Errors
/// [`RespondError::CannotEnter`] below the cut-off; [`RespondError::Frequency`] for a frequency that is not above 0, or
/// above four times the one that turns at the plate's end.
pub fn respond(plate: &Plate, frequency_hz: f64) -> Option<Result<CentreLine, RespondError>> {
    let Model::BendingClamped(_) = plate.spec().model else { return None };
    Some(solve(plate, frequency_hz, ELEMENTS_PER_WAVELENGTH, ORDERS))
}

fn solve(
    plate: &Plate,
    frequency_hz: f64,
    per_wavelength: f64,
    orders: usize,
) -> Result<CentreLine, RespondError> {
    let high = 4.0 * plate.frequency_for_boundary_hz(plate.length_m());
    let cut_off_hz = plate.cut_off_hz();
    if !(frequency_hz > 0.0 && frequency_hz <= high) {
        return Err(RespondError::frequency(frequency_hz, cut_off_hz, high));
    }
    let (Some(turning_point_m), Some(kappa)) =
        (plate.turning_point_m(frequency_hz), plate.kappa_per_m(frequency_hz))
    else {
        return Err(RespondError::cannot_enter(plate, frequency_hz));
    };
    let wavenumber_squared = plate.spec().model.wavenumber_squared(TAU * frequency_hz);
    let wavelengths = plate.length_m() * wavenumber_squared.sqrt() / TAU;
    let elements = ((wavelengths * per_wavelength).ceil() as usize).clamp(32, ELEMENTS_MAX);
    // The modulus is E (1 - j eta), so kb^4 is (1 + j eta) times the one without loss.
    let kb4 = wavenumber_squared.powi(2) * Complex64::new(1.0, plate.spec().loss_factor);

    let per_node = 2 * orders;
    let unknowns = per_node * (elements + 1);
    let mut matrix = BandMatrix::new(unknowns, 2 * per_node - 1);
    let h = plate.length_m() / elements as f64;
    for element in 0..elements {
        add_element(&mut matrix, plate, element, h, orders, kb4);
    }
    let mut right = vec![Complex64::ZERO; unknowns];
    for order in 0..orders {
        // The deflection of the driven end is the first polynomial alone; its slope is free.
        matrix.prescribe(2 * order);
        let end = elements * per_node + 2 * order;
        matrix.prescribe(end);
        matrix.prescribe(end + 1);
    }
    right[0] = Complex64::ONE;
    matrix.solve(&mut right);

    let centre: Vec<f64> = (0..orders).map(|order| across(order, 0.0).value).collect();
    let count = elements * PLACES + 1;
    let step = h / PLACES as f64;
    let deflection: Vec<Complex64> = (0..count)
        .map(|place| {
            let element = (place / PLACES).min(elements - 1);
            let t = (place - element * PLACES) as f64 / PLACES as f64;
            let cubics = along(t, h);
            let mut sum = Complex64::ZERO;
            for (order, centre) in centre.iter().enumerate() {
                for (number, cubic) in cubics.iter().enumerate() {
                    sum += right[unknown(element, number, order, per_node)] * (cubic.value * centre);
                }
            }
            sum
        })
        .collect();
    Ok(CentreLine {
        position_m: (0..count).map(|place| place as f64 * step).collect(),
        peak: peak::find(&deflection, step, turning_point_m, kappa),
        deflection,
    })
}

/// Index of the unknown of the cubic `number` of an element: 0, 1 are value and slope at its start, 2, 3 at its end.
fn unknown(element: usize, number: usize, order: usize, per_node: usize) -> usize {
    (element + number / 2) * per_node + 2 * order + number % 2
}

/// Adds the integrals over one element by Gauss's rule in x and in b = z/W; by symmetry over one half of the width.
fn add_element(
    matrix: &mut BandMatrix,
    plate: &Plate,
    element: usize,
    h: f64,
    orders: usize,
    kb4: Complex64,
) {
    let per_node = 2 * orders;
    let polynomials: Vec<(f64, f64, Vec<Jet>)> = gauss(2 * orders + 4)
        .into_iter()
        .map(|(b, weight)| (b, weight, (0..orders).map(|order| across(order, b)).collect()))
        .collect();
    let count = 4 * orders;
    let (mut stiffness, mut mass) = (vec![0.0; count * count], vec![0.0; count * count]);
    let (mut value, mut laplacian) = (vec![0.0; count], vec![0.0; count]);
    for (t, weight_x) in gauss(5) {
        let law = plate.width.at((element as f64 + t) * h);
        let width = law.value.exp();
        let cubics = along(t, h);
        for (b, weight_b, jets) in &polynomials {
            for (order, p) in jets.iter().enumerate() {
                for (number, cubic) in cubics.iter().enumerate() {
                    let at = number * orders + order;
                    value[at] = cubic.value * p.value;
                    laplacian[at] = laplacian_of(*cubic, *p, *b, law);
                }
            }
            let area = h * weight_x * weight_b * width;
            for row in 0..count {
                for column in 0..count {
                    stiffness[row * count + column] += area * laplacian[row] * laplacian[column];
                    mass[row * count + column] += area * value[row] * value[column];
                }
            }
        }
    }
    let index = |at: usize| unknown(element, at / orders, at % orders, per_node);
    for row in 0..count {
        for column in 0..count {
            let term = stiffness[row * count + column] - kb4 * mass[row * count + column];
            matrix.add(index(row), index(column), term);
        }
    }
}

/// lap (f(x) p(b)) at b = z/W(x), by the formula at the top of this file.
fn laplacian_of(f: Jet, p: Jet, b: f64, law: LogWidth) -> f64 {
    let (width, s) = (law.value.exp(), law.slope);
    let constant = (b * b * s * s + width.powi(-2)) * p.bend + (s * s - law.curvature) * b * p.slope;
    f.bend * p.value - 2.0 * s * f.slope * b * p.slope + f.value * constant
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Bending, DriveEnd, PlateSpec, Taper};

    fn aluminium() -> Plate {
        Plate::new(PlateSpec {
            name: "clamped aluminium".to_owned(),
            description: String::new(),
            taper: Taper::Exponential { half_width_m: 0.02, rate_per_m: 4.62 },
            length_m: 0.34,
            model: Model::BendingClamped(Bending {
                youngs_modulus_pa: 70e9,
                poisson_ratio: 0.33,
                density_kg_per_m3: 2700.0,
                thickness_m: 0.002,
                thick_plate: false,
            }),
            loss_factor: 0.002,
            wave_speed_tolerance: 0.0,
            drive_end: DriveEnd::Displacement,
            actuator: None,
            full_scale_m: 1e-6,
            span_start_m: 0.1,
            span_end_m: 0.25,
        })
        .unwrap()
    }

    #[test]
    fn the_clamped_taper_peaks_at_180_7_mm_where_the_width_mode_says_180_5() {
        let plate = aluminium();
        let adiabatic = plate.airy_peak_m(40e3).unwrap();
        let line = respond(&plate, 40e3).unwrap().unwrap();
        let peak = line.peak.unwrap();
        assert!((adiabatic - 0.1805).abs() < 1e-4, "{adiabatic}");
        assert!((peak.position_m - 0.1807).abs() < 1e-4, "{}", peak.position_m);
    }

    #[test]
    fn the_mapped_laplacian_is_that_of_the_plane() {
        // A steep linear taper, where every term counts.
        let mut spec = aluminium().spec().clone();
        spec.taper = Taper::Linear { half_width_m: 0.3, end_half_width_m: 0.02 };
        let plate = Plate::new(spec).unwrap();
        let (x0, h) = (0.1, 0.1);
        let f = |x: f64| along((x - x0) / h, h)[2];
        let w = |x: f64, z: f64| f(x).value * across(2, z / plate.half_width_m(x)).value;
        let (x, z, step) = (0.163, 0.08, 1e-4);
        let around = w(x - step, z) + w(x + step, z) + w(x, z - step) + w(x, z + step);
        let plane = (around - 4.0 * w(x, z)) / (step * step);
        let b = z / plate.half_width_m(x);
        let mapped = laplacian_of(f(x), across(2, b), b, plate.width.at(x));
        assert!((mapped / plane - 1.0).abs() < 1e-4, "{mapped} against {plane}");
    }

    #[test]
    fn the_peak_does_not_depend_on_the_resolution() {
        let plate = aluminium();
        let peak = |per_wavelength: f64, orders: usize| {
            solve(&plate, 40e3, per_wavelength, orders).unwrap().peak.unwrap()
        };
        let (coarse, fine) = (peak(12.0, 5), peak(24.0, 8));
        assert!((coarse.position_m - fine.position_m).abs() < 2e-6, "{coarse:?} against {fine:?}");
        assert!((coarse.amplitude / fine.amplitude - 1.0).abs() < 1e-3, "{coarse:?} against {fine:?}");
    }

    #[test]
    fn only_clamped_plates_are_solved_and_only_where_the_wave_enters() {
        assert!(respond(&crate::preset("al-bending").unwrap(), 40e3).is_none());
        let plate = aluminium();
        assert!(matches!(respond(&plate, 5e3).unwrap(), Err(RespondError::CannotEnter { .. })));
        assert!(matches!(respond(&plate, f64::NAN).unwrap(), Err(RespondError::Frequency(..))));
        assert!(matches!(respond(&plate, 1e9).unwrap(), Err(RespondError::Frequency(..))));
    }
}
