//! A complex band matrix, factored once by Gaussian elimination with pivoting and solved for any right-hand side.

use num_complex::Complex64;

/// The diagonal stays the pivot unless an element below it is this many times as large. The matrices here are
/// symmetric and rarely need an exchange of rows, and without exchanges the band does not widen.
const EXCHANGE_RATIO: f64 = 10.0;

/// A square matrix whose elements are zero farther than `half_band` from the diagonal.
#[derive(Debug, Clone)]
pub(super) struct BandMatrix {
    order: usize,
    half_band: usize,
    /// Row by row, `3 half_band + 1` numbers each: column c of row r is at c - r + half_band. The last third holds the
    /// fill-in of the row exchanges.
    rows: Vec<Complex64>,
}

/// A [`BandMatrix`] after its elimination.
#[derive(Debug, Clone)]
pub(super) struct Factored {
    /// The upper triangle in place; below the diagonal the multipliers of the elimination.
    matrix: BandMatrix,
    /// The row that was exchanged with each pivot row.
    exchanged: Vec<usize>,
    /// The last column of each row of the upper triangle that may differ from zero.
    reach: Vec<usize>,
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

    /// Adds `factor` times one row to another. The elements of the source row must lie in the other's band.
    pub(super) fn add_row(&mut self, source: usize, target: usize, factor: f64) {
        let low = source.saturating_sub(self.half_band);
        let high = (source + self.half_band).min(self.order - 1);
        for column in low..=high {
            let value = self.rows[self.at(source, column)] * factor;
            if value != Complex64::ZERO {
                self.add(target, column, value);
            }
        }
    }

    /// Replaces the equation of `row` by "unknown = right-hand side": a prescribed value.
    pub(super) fn prescribe(&mut self, row: usize) {
        let width = 3 * self.half_band + 1;
        self.rows[row * width..(row + 1) * width].fill(Complex64::ZERO);
        let at = self.at(row, row);
        self.rows[at] = Complex64::ONE;
    }

    /// The matrix times a vector.
    pub(super) fn times(&self, vector: &[Complex64]) -> Vec<Complex64> {
        let columns =
            |row: usize| row.saturating_sub(self.half_band)..(row + self.half_band + 1).min(self.order);
        (0..self.order)
            .map(|row| columns(row).map(|column| self.rows[self.at(row, column)] * vector[column]).sum())
            .collect()
    }

    /// Eliminates. A singular matrix (exactly at a resonance without loss) gives solutions that are not finite.
    pub(super) fn factor(mut self) -> Factored {
        let (order, band) = (self.order, self.half_band);
        let width = 3 * band + 1;
        let (mut exchanged, mut reaches) = (Vec::with_capacity(order), Vec::with_capacity(order));
        let mut reach = 0;
        for pivot in 0..order {
            let last_row = (pivot + band).min(order - 1);
            let size = |row: usize| self.rows[self.at(row, pivot)].norm_sqr();
            let largest = (pivot..=last_row).max_by(|&a, &b| size(a).total_cmp(&size(b))).unwrap_or(pivot);
            let chosen = if size(largest) > size(pivot) * EXCHANGE_RATIO.powi(2) { largest } else { pivot };
            reach = (chosen + band).min(order - 1).max(reach);
            if chosen != pivot {
                for column in pivot..=reach {
                    let (a, b) = (self.at(pivot, column), self.at(chosen, column));
                    self.rows.swap(a, b);
                }
            }
            let inverse = self.rows[self.at(pivot, pivot)].inv();
            // Row r begins at column r - half_band: relative to the pivot row the columns shift by one per row.
            let (above, below) = self.rows.split_at_mut((pivot + 1) * width);
            let beside = &above[pivot * width + band + 1..][..reach - pivot];
            for (down, row) in below.chunks_exact_mut(width).take(last_row - pivot).enumerate() {
                let start = band - 1 - down;
                let factor = row[start] * inverse;
                row[start] = factor;
                if factor != Complex64::ZERO {
                    for (to, from) in row[start + 1..].iter_mut().zip(beside) {
                        *to -= from * factor;
                    }
                }
            }
            exchanged.push(chosen);
            reaches.push(reach);
        }
        Factored { matrix: self, exchanged, reach: reaches }
    }
}

impl Factored {
    /// Solves the system; `right` is the right-hand side and becomes the solution.
    pub(super) fn solve(&self, right: &mut [Complex64]) {
        let Self { matrix, exchanged, reach } = self;
        let last = matrix.order - 1;
        for (pivot, &chosen) in exchanged.iter().enumerate() {
            right.swap(pivot, chosen);
            let value = right[pivot];
            let below = &mut right[pivot + 1..=(pivot + matrix.half_band).min(last)];
            for (row, right) in (pivot + 1..).zip(below) {
                *right -= matrix.rows[matrix.at(row, pivot)] * value;
            }
        }
        for (row, &reach) in reach.iter().enumerate().rev() {
            let start = matrix.at(row, row);
            let beside = &matrix.rows[start + 1..][..reach - row];
            let mut value = right[row];
            for (element, found) in beside.iter().zip(&right[row + 1..]) {
                value -= element * found;
            }
            right[row] = value / matrix.rows[start];
        }
    }
}

#[cfg(test)]
impl BandMatrix {
    pub(super) fn order(&self) -> usize {
        self.order
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
        let mut matrix = BandMatrix::new(order, band);
        for row in 0..order {
            for column in row.saturating_sub(band)..(row + band + 1).min(order) {
                matrix.add(row, column, element(row, column));
            }
        }
        let factored = matrix.factor();
        assert!(factored.exchanged.iter().enumerate().any(|(pivot, &chosen)| pivot != chosen));
        // Two right-hand sides from one elimination.
        for shift in [0.0, 0.7] {
            let solution: Vec<Complex64> = (0..order)
                .map(|i| Complex64::new((i as f64 + shift).sin(), (2.0 * i as f64 - shift).cos()))
                .collect();
            let mut right: Vec<Complex64> = (0..order)
                .map(|row| {
                    (row.saturating_sub(band)..(row + band + 1).min(order))
                        .map(|column| element(row, column) * solution[column])
                        .sum()
                })
                .collect();
            factored.solve(&mut right);
            for (found, wanted) in right.iter().zip(&solution) {
                assert!((found - wanted).norm() < 1e-8, "{found} against {wanted}");
            }
        }
    }
}
