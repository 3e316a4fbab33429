//! Poles by the set-valued AAA algorithm (Nakatsukasa, Sete and Trefethen 2018; Lietaert and others 2022).
//!
//! A rational function with the values F(s_k) at its support points s_k is
//! r(s) = sum of w_k F(s_k)/(s - s_k) over sum of w_k/(s - s_k), for any weights w_k. The chosen weights minimise the
//! linear residual sum of w_k (F(s_i) - F(s_k))/(s_i - s_k) over all samples s_i: they are the last right singular
//! vector of that matrix. All sums of positions share the weights, so they share the poles.

use super::samples::{SUMS, Sample, largest};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;

/// Rational functions with common poles, one per sum of positions.
pub(super) struct Barycentric {
    s: Vec<f64>,
    value: Vec<[Complex64; SUMS]>,
    weight: Vec<Complex64>,
}

impl Barycentric {
    /// The best weights for the support points: those samples for which `is_support` is true.
    pub(super) fn new(samples: &[Sample], is_support: &[bool]) -> Self {
        let all = || samples.iter().zip(is_support);
        let support: Vec<&Sample> = all().filter(|(_, is)| **is).map(|(sample, _)| sample).collect();
        let other: Vec<&Sample> = all().filter(|(_, is)| !**is).map(|(sample, _)| sample).collect();
        let matrix = DMatrix::from_fn(other.len() * SUMS, support.len(), |row, k| {
            let (sample, support) = (other[row / SUMS], support[k]);
            (sample.sum[row % SUMS] - support.sum[row % SUMS]) / (sample.s - support.s) * sample.weight
        });
        Self {
            s: support.iter().map(|it| it.s).collect(),
            value: support.iter().map(|it| it.sum).collect(),
            weight: last_singular_vector(matrix),
        }
    }

    /// Largest error at a sample that is not a support point, relative to its largest sum, times its weight.
    pub(super) fn error(&self, sample: &Sample) -> f64 {
        let mut above = [Complex64::ZERO; SUMS];
        let mut below = Complex64::ZERO;
        for ((support, value), weight) in self.s.iter().zip(&self.value).zip(&self.weight) {
            let part = weight / (sample.s - support);
            below += part;
            for (above, value) in above.iter_mut().zip(value) {
                *above += part * value;
            }
        }
        let left: [Complex64; SUMS] = std::array::from_fn(|j| above[j] / below - sample.sum[j]);
        let error = largest(&left) / largest(&sample.sum) * sample.weight;
        // The denominator may vanish at a sample.
        if left.iter().all(|it| it.is_finite()) { error } else { f64::INFINITY }
    }

    /// The zeros of sum of w_k/(s - s_k).
    pub(super) fn poles(&self) -> Vec<Complex64> {
        // With t = s - origin they are the eigenvalues of D (I - w e^T/(e^T w)), where D is the diagonal of the t_k,
        // plus an additional one, t = 0. The origin is far from the band, so that no pole of the band is near t = 0.
        let origin = Complex64::new(0.0, -ORIGIN);
        let total: Complex64 = self.weight.iter().sum();
        let count = self.s.len();
        let t = |k: usize| self.s[k] - origin;
        let matrix = DMatrix::from_fn(count, count, |row, column| {
            let diagonal = if row == column { t(row) } else { Complex64::ZERO };
            diagonal - t(row) * self.weight[row] / total
        });
        if count == 0 || !matrix.iter().all(|value| value.is_finite()) {
            return Vec::new();
        }
        let Some(schur) = nalgebra::Schur::try_new(matrix, f64::EPSILON, SWEEPS_MAX * count) else {
            return Vec::new();
        };
        let eigenvalues = schur.unpack().1.diagonal();
        let additional = eigenvalues.iter().map(|t| t.norm()).fold(f64::INFINITY, f64::min);
        eigenvalues.iter().filter(|t| t.norm() > additional).map(|t| t + origin).collect()
    }
}

/// Largest number of QR sweeps per eigenvalue; two or three are usual.
const SWEEPS_MAX: usize = 100;
/// Distance of the additional eigenvalue of [`Barycentric::poles`] from the middle of the band, in half bands.
const ORIGIN: f64 = 8.0;

/// The right singular vector of the least singular value, by inverse iteration with the triangle of a QR
/// decomposition.
fn last_singular_vector(matrix: DMatrix<Complex64>) -> Vec<Complex64> {
    let columns = matrix.ncols();
    if columns == 0 {
        return Vec::new();
    }
    let missing = columns.saturating_sub(matrix.nrows());
    let rows = matrix.nrows();
    let mut triangle = matrix.insert_rows(rows, missing, Complex64::ZERO).qr().r();
    // A zero pivot would stop the iteration. A pivot at the level of rounding keeps it going and changes nothing.
    let smallest = 1e-15 * largest(triangle.iter()).max(f64::MIN_POSITIVE);
    for k in 0..columns {
        if triangle[(k, k)].norm() < smallest {
            triangle[(k, k)] = Complex64::from(smallest);
        }
    }
    let mut vector = DVector::from_element(columns, Complex64::ONE);
    for _ in 0..4 {
        let solved = triangle.ad_solve_upper_triangular(&vector);
        let Some(solved) = solved.and_then(|it| triangle.solve_upper_triangular(&it)) else { break };
        let size = solved.norm();
        if !size.is_normal() {
            break;
        }
        vector = solved.unscale(size);
    }
    vector.iter().copied().collect()
}
