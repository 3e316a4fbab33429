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
    /// The largest error of all samples.
    pub(super) fn worst(&self) -> f64 {
        largest_of(&self.error)
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

/// The least squares of the relative errors for the first n of some poles: one decomposition serves every n, because its
/// leading columns are the decomposition of the leading columns.
pub(super) struct LeastSquares {
    pole: Vec<Complex64>,
    /// Fields at the samples over the scale of their errors; one row per sample, one column per position.
    data: DMatrix<Complex64>,
    /// The basis with columns of equal size is `unitary` times `triangle`; the rows of the samples alone.
    unitary: DMatrix<Complex64>,
    triangle: DMatrix<Complex64>,
    /// What `unitary` finds in the data.
    found: DMatrix<Complex64>,
    /// Sizes of the columns of the basis.
    size: Vec<f64>,
}

impl LeastSquares {
    /// Prepares the fits by these poles; a fit by fewer poles leaves the first ones out.
    pub(super) fn new(samples: &[Sample], pole: Vec<Complex64>, places: usize) -> Self {
        let (rows, columns) = (samples.len(), QUASI_STATIC + pole.len());
        let data = DMatrix::from_fn(rows, places, |row, place| samples[row].field[place] / samples[row].top);
        let mut basis = DMatrix::from_fn(rows + columns, columns, |row, column| {
            let Some(sample) = samples.get(row) else { return Complex64::ZERO };
            let value = match column.checked_sub(QUASI_STATIC) {
                None => Complex64::from(sample.s.powi(column as i32)),
                Some(i) => 1.0 / (pole[i] - sample.s),
            };
            value / sample.top
        });
        // Columns are scaled to equal size, so that the ridge weighs the terms by their effect on the field. It keeps every
        // pivot above zero, so a solution exists.
        let size: Vec<f64> = basis.column_iter().map(|it| it.norm().max(f64::MIN_POSITIVE)).collect();
        for (column, size) in size.iter().enumerate() {
            basis.column_mut(column).unscale_mut(*size);
            basis[(rows + column, column)] = Complex64::from(RIDGE);
        }
        let (unitary, triangle) = basis.qr().unpack();
        let unitary = unitary.rows(0, rows).into_owned();
        let found = product(&unitary.adjoint(), &data);
        Self { pole, data, unitary, triangle, found, size }
    }

    /// The largest error at each sample with the first `count` poles, relative to the largest amplitude at its frequency.
    fn error(&self, count: usize) -> Vec<f64> {
        let columns = QUASI_STATIC + count;
        let unitary = self.unitary.columns(0, columns).into_owned();
        let left = product(&unitary, &self.found.rows(0, columns).into_owned()) - &self.data;
        left.row_iter().map(|row| samples::largest(row.iter())).collect()
    }

    /// The least number of poles, of the first ones, with an error below the tolerance; all if none is.
    pub(super) fn fewest(&self, tolerance: f64) -> usize {
        let (mut few, mut enough) = (0, self.pole.len());
        while enough - few > 1 {
            let count = usize::midpoint(few, enough);
            if largest_of(&self.error(count)) < tolerance {
                enough = count;
            } else {
                few = count;
            }
        }
        enough
    }

    /// The fit by the first `count` poles.
    pub(super) fn fit(&self, count: usize) -> PartialFractions {
        let columns = QUASI_STATIC + count;
        let mut term = self.found.rows(0, columns).into_owned();
        self.triangle.view((0, 0), (columns, columns)).solve_upper_triangular_mut(&mut term);
        for (mut row, size) in term.row_iter_mut().zip(&self.size) {
            row.unscale_mut(*size);
        }
        PartialFractions { pole: self.pole[..count].to_vec(), term, error: self.error(count) }
    }
}

/// The largest of some errors.
fn largest_of(error: &[f64]) -> f64 {
    error.iter().copied().fold(0.0, f64::max)
}

/// A product of complex matrices by four products of real ones, which is many times faster.
fn product(left: &DMatrix<Complex64>, right: &DMatrix<Complex64>) -> DMatrix<Complex64> {
    let (a, b) = (left.map(|it| it.re), left.map(|it| it.im));
    let (c, d) = (right.map(|it| it.re), right.map(|it| it.im));
    (&a * &c - &b * &d).zip_map(&(a * d + b * c), Complex64::new)
}
