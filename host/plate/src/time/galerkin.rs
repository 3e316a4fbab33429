//! The eigenfunctions of the plate, by a spectral Galerkin method.
//!
//! The amplitude equation is A f = a K^2 (1 + j eta) f with the operator
//! A f = -(1/W) (W f')' + a (q/s)^2 f - b W''/(2 W) f (s is the turning half-width, b the weight of curved edges).
//! A is projected on Legendre polynomials over the plate and over the part of the continued taper that the tail of
//! the wave needs. Eigenfunctions with a free driven end (f'(0) = 0) describe the response to a force, those with a
//! held end (f(0) = 0) the response to a displacement. A does not depend on loss or frequency, so the functions are
//! real and are computed once.

use crate::definition::plate::EdgeBend;
use crate::definition::width_mode::WidthMode;
use crate::special::gauss::gauss;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Decay, in nepers, over which the taper is continued beyond the plate's end. A wave reflected there has decayed
/// twice, by e^-14.
const BEYOND_EXPONENTS: f64 = 7.0;

/// Eigenfunctions of the plate for one kind of driven end, at the output positions.
pub(crate) struct EigenFunctions {
    /// Eigenvalues lambda of A, 1/m^2, rising.
    pub(crate) eigenvalue: Vec<f64>,
    /// Excitation of each function by the drive: -phi(0) for a force, see [`held`] for a displacement.
    pub(crate) excitation: Vec<f64>,
    /// Value of each function at the driven end.
    pub(crate) at_drive: Vec<f64>,
    /// Values at the output positions: one row per position, one column per function.
    pub(crate) shape: DMatrix<f64>,
    /// The part of the field that follows the drive without delay, one entry per position; zero for a free end.
    pub(crate) direct: DVector<f64>,
}

/// Matrices of A and of the weight W on Legendre polynomials, and the polynomials at the output positions.
struct Projection {
    stiffness: DMatrix<f64>,
    mass: DMatrix<f64>,
    at_places: DMatrix<f64>,
    at_drive: DVector<f64>,
}

/// Number of polynomials for waves up to `frequency_hz`, and the length of the continued taper in metres.
fn size(width_mode: &WidthMode<'_>, frequency_hz: f64) -> (usize, f64) {
    let plate = width_mode.plate;
    let length = plate.length_m();
    let step = length / 400.0;
    let slowest = width_mode.width_term(length);
    let (mut reach, mut exponents) = (length, 0.0);
    while exponents < BEYOND_EXPONENTS && reach < 3.0 * length && reach + step < 0.97 * plate.width.reach_m()
    {
        reach += step;
        exponents += (width_mode.width_term(reach) - slowest).max(0.0).sqrt() * step;
    }
    // Legendre polynomials resolve a wave with more than pi terms per wavelength. The cube root and the constant are a
    // margin for spectral convergence; the last term resolves the steepness of (q/s)^2.
    let wavenumber = width_mode.wavenumber_squared(0.0, frequency_hz).max(0.0).sqrt();
    let waves = 0.5 * wavenumber * reach;
    let count = waves + 6.0 * waves.cbrt() + 16.0 + 2.0 * plate.narrowing_per_m(0.0).abs() * reach;
    (count.ceil() as usize, reach)
}

fn project(width_mode: &WidthMode<'_>, frequency_hz: f64, places_m: &[f64]) -> Projection {
    let (count, reach) = size(width_mode, frequency_hz);
    let width = &width_mode.plate.width;
    let log_start = width.at(0.0).value;
    let mut stiffness = DMatrix::zeros(count, count);
    let mut mass = DMatrix::zeros(count, count);
    for (share, weight) in gauss(2 * count + 24) {
        let x = reach * share;
        let (value, slope) = legendre(2.0 * share - 1.0, count, reach);
        let local = reach * weight * (width.at(x).value - log_start).exp();
        let barrier = local * width_mode.width_term(x);
        mass.ger(local, &value, &value, 1.0);
        stiffness.ger(local, &slope, &slope, 1.0);
        stiffness.ger(barrier, &value, &value, 1.0);
        // -b W''/2 f h by parts, because W'' may jump: b W'/2 (f h)', and b W'/2 f h at the two ends.
        let EdgeBend { slope_term, .. } = width_mode.plate.edge_bend(x);
        stiffness.ger(local * slope_term, &value, &slope, 1.0);
        stiffness.ger(local * slope_term, &slope, &value, 1.0);
    }
    for (xi, x, outward) in [(-1.0, 0.0, -1.0), (1.0, reach, 1.0)] {
        let (value, _) = legendre(xi, count, reach);
        let weight = (width.at(x).value - log_start).exp();
        stiffness.ger(-outward * weight * width_mode.plate.edge_bend(x).slope_term, &value, &value, 1.0);
    }
    let mut at_places = DMatrix::zeros(places_m.len(), count);
    for (row, x) in places_m.iter().enumerate() {
        let (value, _) = legendre(2.0 * x / reach - 1.0, count, reach);
        at_places.set_row(row, &value.transpose());
    }
    let (at_drive, _) = legendre(-1.0, count, reach);
    Projection { stiffness, mass, at_places, at_drive }
}

/// Eigenfunctions with a free driven end, excited by f'(0): f = -f'(0) sum phi(0) phi(x)/(lambda - a K^2).
pub(crate) fn free(width_mode: &WidthMode<'_>, frequency_hz: f64, places_m: &[f64]) -> EigenFunctions {
    let projection = project(width_mode, frequency_hz, places_m);
    let (eigenvalue, vector) = eigen(&projection.stiffness, &projection.mass);
    let at_drive = vector.tr_mul(&projection.at_drive);
    EigenFunctions {
        eigenvalue,
        excitation: at_drive.iter().map(|value| -value).collect(),
        at_drive: at_drive.iter().copied().collect(),
        shape: &projection.at_places * vector,
        direct: DVector::zeros(places_m.len()),
    }
}

/// Eigenfunctions with a held driven end, excited by f(0) = s.
///
/// With f = s (1 + h), h(0) = 0: h = -sum phi (m + (k - lambda m)/(lambda - a K^2)), where k and m are the
/// projections of A 1 and of 1. The part with m follows the drive without delay (`direct`); the rest oscillates.
pub(crate) fn held(width_mode: &WidthMode<'_>, frequency_hz: f64, places_m: &[f64]) -> EigenFunctions {
    let projection = project(width_mode, frequency_hz, places_m);
    let count = projection.at_drive.len();
    // Columns P[n]/P[n](x = 0) - P[n-1]/P[n-1](x = 0): each vanishes at the driven end.
    let mut basis = DMatrix::zeros(count, count - 1);
    for n in 1..count {
        basis[(n, n - 1)] = 1.0 / projection.at_drive[n];
        basis[(n - 1, n - 1)] = -1.0 / projection.at_drive[n - 1];
    }
    let stiffness = basis.transpose() * &projection.stiffness * &basis;
    let mass = basis.transpose() * &projection.mass * &basis;
    let (eigenvalue, vector) = eigen(&stiffness, &mass);
    let vector = basis * vector;
    let mut lift = DVector::zeros(count);
    lift[0] = 1.0 / projection.at_drive[0];
    let m = vector.tr_mul(&(&projection.mass * &lift));
    let k = vector.tr_mul(&(&projection.stiffness * &lift));
    let shape = &projection.at_places * &vector;
    let direct = &projection.at_places * &lift - &shape * &m;
    EigenFunctions {
        excitation: (0..eigenvalue.len()).map(|n| eigenvalue[n] * m[n] - k[n]).collect(),
        at_drive: vec![0.0; eigenvalue.len()],
        eigenvalue,
        shape,
        direct,
    }
}

/// Solves the generalised symmetric eigenproblem: eigenvalues rising, vectors v normalised to v^T mass v = 1.
fn eigen(stiffness: &DMatrix<f64>, mass: &DMatrix<f64>) -> (Vec<f64>, DMatrix<f64>) {
    let count = mass.nrows();
    // The mass matrix is positive definite because W is positive; the factorisation fails only for a width of zero.
    let Some(root) = mass.clone().cholesky() else {
        return (Vec::new(), DMatrix::zeros(count, 0));
    };
    let lower = root.l();
    let mut half = stiffness.clone();
    lower.solve_lower_triangular_mut(&mut half);
    let mut whole = half.transpose();
    lower.solve_lower_triangular_mut(&mut whole);
    let symmetric = (&whole + whole.transpose()) * 0.5;
    let solved = SymmetricEigen::new(symmetric);
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&a, &b| solved.eigenvalues[a].total_cmp(&solved.eigenvalues[b]));
    let sorted = DMatrix::from_fn(count, count, |row, column| solved.eigenvectors[(row, order[column])]);
    let mut vector = sorted;
    lower.tr_solve_lower_triangular_mut(&mut vector);
    (order.iter().map(|&n| solved.eigenvalues[n]).collect(), vector)
}

/// Legendre polynomials of order 0..count at `xi` in -1..1, normalised on an interval of length `reach` in x, and their
/// derivatives with respect to x.
fn legendre(xi: f64, count: usize, reach: f64) -> (DVector<f64>, DVector<f64>) {
    let mut value = DVector::zeros(count);
    let mut slope = DVector::zeros(count);
    let (mut before, mut now, mut slope_before, mut slope_now) = (0.0, 1.0, 0.0, 0.0);
    for n in 0..count {
        let order = n as f64;
        let scale = ((2.0 * order + 1.0) / reach).sqrt();
        value[n] = scale * now;
        slope[n] = scale * slope_now * 2.0 / reach;
        let next = ((2.0 * order + 1.0) * xi * now - order * before) / (order + 1.0);
        let slope_next = slope_before + (2.0 * order + 1.0) * now;
        (before, now, slope_before, slope_now) = (now, next, slope_now, slope_next);
    }
    (value, slope)
}
