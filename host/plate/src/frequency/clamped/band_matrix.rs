//! A complex band matrix, solved by Gaussian elimination with partial pivoting.

use num_complex::Complex64;

/// A square matrix whose elements are zero farther than `half_band` from the diagonal.
#[derive(Debug, Clone)]
pub(super) struct BandMatrix {
    order: usize,
    half_band: usize,
    /// Row by row, `3 half_band + 1` numbers each: column c of row r is at c - r + half_band. The last third holds the
    /// fill-in of the row exchanges.
    rows: Vec<Complex64>,
}

impl BandMatrix {
    pub(super) fn new(order: usize, half_band: usize) -> Self {
        Self { order, half_band, rows: vec![Complex64::ZERO; order * (3 * half_band + 1)] }
    }

    fn at(&self, row: usize, column: usize) -> usize {
        row * (3 * self.half_band + 1) + column + self.half_band - row
    }

    /// Adds to an element inside the band.
    pub(super) fn add(&mut self, row: usize, column: usize, value: Complex64) {
        let at = self.at(row, column);
        self.rows[at] += value;
    }

    /// Replaces the equation of `row` by "unknown = right-hand side": a prescribed value.
    pub(super) fn prescribe(&mut self, row: usize) {
        let width = 3 * self.half_band + 1;
        self.rows[row * width..(row + 1) * width].fill(Complex64::ZERO);
        let at = self.at(row, row);
        self.rows[at] = Complex64::ONE;
    }

    /// Solves the system; `right` is the right-hand side and becomes the solution.
    ///
    /// A singular matrix (exactly at a resonance without loss) gives numbers that are not finite.
    pub(super) fn solve(mut self, right: &mut [Complex64]) {
        let (order, band) = (self.order, self.half_band);
        for pivot in 0..order {
            let last_row = (pivot + band).min(order - 1);
            let last_column = (pivot + 2 * band).min(order - 1);
            let size = |row: usize| self.rows[self.at(row, pivot)].norm_sqr();
            let largest = (pivot..=last_row).max_by(|&a, &b| size(a).total_cmp(&size(b))).unwrap_or(pivot);
            if largest != pivot {
                for column in pivot..=last_column {
                    let (a, b) = (self.at(pivot, column), self.at(largest, column));
                    self.rows.swap(a, b);
                }
                right.swap(pivot, largest);
            }
            let inverse = self.rows[self.at(pivot, pivot)].inv();
            for row in pivot + 1..=last_row {
                let factor = self.rows[self.at(row, pivot)] * inverse;
                if factor == Complex64::ZERO {
                    continue;
                }
                for column in pivot + 1..=last_column {
                    let (from, to) = (self.at(pivot, column), self.at(row, column));
                    let taken = self.rows[from] * factor;
                    self.rows[to] -= taken;
                }
                let taken = right[pivot] * factor;
                right[row] -= taken;
            }
        }
        for row in (0..order).rev() {
            let mut value = right[row];
            let last_column = (row + 2 * band).min(order - 1);
            let beside = &self.rows[self.at(row, row) + 1..=self.at(row, last_column)];
            for (element, found) in beside.iter().zip(&right[row + 1..]) {
                value -= element * found;
            }
            right[row] = value / self.rows[self.at(row, row)];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_banded_system_is_solved_also_where_the_diagonal_is_zero() {
        let (order, band) = (40, 3);
        let element = |row: usize, column: usize| {
            let number = (row * 31 + column * 17) % 23;
            let zero = row == column && row.is_multiple_of(5);
            if zero {
                Complex64::ZERO
            } else {
                Complex64::new(number as f64 - 11.0, (number % 7) as f64 - 3.0)
            }
        };
        let solution: Vec<Complex64> =
            (0..order).map(|i| Complex64::new((i as f64).sin(), (2.0 * i as f64).cos())).collect();
        let mut matrix = BandMatrix::new(order, band);
        let mut right = vec![Complex64::ZERO; order];
        for (row, right) in right.iter_mut().enumerate() {
            for (column, solution) in solution.iter().enumerate() {
                if row.abs_diff(column) <= band {
                    matrix.add(row, column, element(row, column));
                    *right += element(row, column) * solution;
                }
            }
        }
        matrix.solve(&mut right);
        for (found, wanted) in right.iter().zip(&solution) {
            assert!((found - wanted).norm() < 1e-9, "{found} against {wanted}");
        }
    }
}
