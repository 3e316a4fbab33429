//! The field as a sum over known poles: residues and quasi-static terms by least squares.

use super::samples::{self, Sample};
use nalgebra::DMatrix;
use num_complex::Complex64;

/// The quasi-static terms: 1, s and s^2.
pub(super) const QUASI_STATIC: usize = 3;
/// Weight of the terms' own size against the error. It suppresses large terms that cancel each other, because the
/// time steps add them in single precision.
const RIDGE: f64 = 1e-6;

/// field(s) = c_0 + c_1 s + c_2 s^2 + sum over i of r_i/(p_i - s), in the fit's own scale.
pub(super) struct PartialFractions {
    pub(super) pole: Vec<Complex64>,
    /// One row per term, the quasi-static terms first; one column per position.
    pub(super) term: DMatrix<Complex64>,
    /// Largest error at each sample, relative to the largest amplitude at its frequency.
    pub(super) error: Vec<f64>,
}

impl PartialFractions {
    /// The terms for these poles, by least squares of the relative errors.
    pub(super) fn new(samples: &[Sample], pole: Vec<Complex64>, places: usize) -> Self {
        let (rows, columns) = (samples.len(), QUASI_STATIC + pole.len());
        let data = DMatrix::from_fn(rows, places, |row, place| samples[row].field[place] / samples[row].top);
        let basis = DMatrix::from_fn(rows, columns, |row, column| {
            let s = samples[row].s;
            let value = match column.checked_sub(QUASI_STATIC) {
                None => Complex64::from(s.powi(column as i32)),
                Some(i) => 1.0 / (pole[i] - s),
            };
            value / samples[row].top
        });
        let term = product(&inverse(&basis), &data);
        let left = product(&basis, &term) - data;
        let error = (0..rows).map(|row| samples::largest(left.row(row).iter())).collect();
        Self { pole, term, error }
    }

    /// The largest error of all samples.
    pub(super) fn worst(&self) -> f64 {
        self.error.iter().copied().fold(0.0, f64::max)
    }

    /// The largest contribution of each pole to the field of a sample, relative to the largest amplitude at its
    /// frequency.
    pub(super) fn effect(&self, samples: &[Sample]) -> Vec<f64> {
        let parts = self.pole.iter().enumerate().map(|(i, pole)| {
            let gain = samples.iter().map(|it| 1.0 / ((pole - it.s).norm() * it.top)).fold(0.0, f64::max);
            gain * samples::largest(self.term.row(QUASI_STATIC + i).iter())
        });
        parts.collect()
    }
}

/// The matrix that solves the least squares of `basis`, with the ridge.
fn inverse(basis: &DMatrix<Complex64>) -> DMatrix<Complex64> {
    let (rows, columns) = basis.shape();
    let mut matrix = basis.clone().insert_rows(rows, columns, Complex64::ZERO);
    // Columns are scaled to equal size, so that the ridge weighs the terms by their effect on the field.
    let size: Vec<f64> = matrix.column_iter().map(|column| column.norm().max(f64::MIN_POSITIVE)).collect();
    for (column, size) in size.iter().enumerate() {
        matrix.column_mut(column).unscale_mut(*size);
        matrix[(rows + column, column)] = Complex64::from(RIDGE);
    }
    let (unitary, triangle) = matrix.qr().unpack();
    let mut inverse = unitary.rows(0, rows).adjoint();
    // The ridge keeps every pivot above zero, so a solution exists.
    triangle.solve_upper_triangular_mut(&mut inverse);
    for (mut row, size) in inverse.row_iter_mut().zip(size) {
        row.unscale_mut(size);
    }
    inverse
}

/// A product of complex matrices by four products of real ones, which is many times faster.
fn product(left: &DMatrix<Complex64>, right: &DMatrix<Complex64>) -> DMatrix<Complex64> {
    let (a, b) = (left.map(|it| it.re), left.map(|it| it.im));
    let (c, d) = (right.map(|it| it.re), right.map(|it| it.im));
    (&a * &c - &b * &d).zip_map(&(a * d + b * c), Complex64::new)
}
