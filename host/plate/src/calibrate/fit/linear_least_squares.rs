//! Linear least squares with real coefficients and complex equations.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;

/// Columns of complex equations sum_k x_k a_k = b with real x, prepared for many right-hand sides b.
pub(crate) struct Columns {
    /// Each scaled to a length of 1.
    columns: Vec<Vec<Complex64>>,
    lengths: Vec<f64>,
    factor: nalgebra::Cholesky<f64, nalgebra::Dyn>,
}

impl Columns {
    /// `None` if the columns are linearly dependent.
    pub(crate) fn new(mut columns: Vec<Vec<Complex64>>) -> Option<Self> {
        let lengths: Vec<f64> =
            columns.iter().map(|c| c.iter().map(Complex64::norm_sqr).sum::<f64>().sqrt()).collect();
        for (column, length) in columns.iter_mut().zip(&lengths) {
            column.iter_mut().for_each(|value| *value /= length);
        }
        let inner = |i: usize, j: usize| -> f64 {
            columns[i].iter().zip(&columns[j]).map(|(a, b)| a.re * b.re + a.im * b.im).sum()
        };
        let count = columns.len();
        // Rounding can make dependent columns look independent. The diagonal gets 1e-12, which is negligible for
        // independent ones.
        let gram = DMatrix::from_fn(count, count, |i, j| inner(i, j) + if i == j { 1e-12 } else { 0.0 });
        Some(Self { factor: gram.cholesky()?, columns, lengths })
    }

    /// x, and the sum of the squared residuals.
    pub(crate) fn solve(&self, b: &[Complex64]) -> (Vec<f64>, f64) {
        let products = self
            .columns
            .iter()
            .map(|column| -> f64 { column.iter().zip(b).map(|(a, b)| a.re * b.re + a.im * b.im).sum() });
        let products = DVector::from_iterator(self.columns.len(), products);
        let x = self.factor.solve(&products);
        let left = b.iter().map(Complex64::norm_sqr).sum::<f64>() - products.dot(&x);
        let x = x.iter().zip(&self.lengths).map(|(x, length)| x / length).collect();
        (x, left.max(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn real_coefficients_of_complex_columns_and_the_residual_are_found() {
        let column =
            |k: f64| -> Vec<Complex64> { (0..20).map(|i| Complex64::cis(k * f64::from(i)) * k).collect() };
        let columns = vec![column(0.3), column(1.1), column(2.0)];
        let wanted = [2.0, -0.5, 7.0];
        let sum = |i: usize| -> Complex64 { columns.iter().zip(wanted).map(|(c, x)| c[i] * x).sum() };
        let b: Vec<Complex64> = (0..20).map(sum).collect();
        let prepared = Columns::new(columns.clone()).expect("independent");
        let (x, left) = prepared.solve(&b);
        assert!(x.iter().zip(wanted).all(|(x, wanted)| (x - wanted).abs() < 1e-9), "{x:?}");
        assert!(left < 1e-7, "{left}");
        // For real coefficients, j times a column is independent of the column.
        let turned: Vec<Complex64> = columns[0].iter().map(|a| a * Complex64::I).collect();
        let (x, left) = Columns::new(vec![columns[0].clone()]).expect("one").solve(&turned);
        assert!(x[0].abs() < 1e-12 && (left - 20.0 * 0.09).abs() < 1e-9, "{x:?} {left}");
    }
}
