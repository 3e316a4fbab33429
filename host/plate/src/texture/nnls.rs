//! Non-negative least squares by an active set: the x >= 0 that minimises |A x - b|.
//!
//! C. L. Lawson and R. J. Hanson, "Solving Least Squares Problems" (1974), chapter 23. A column enters the set of
//! positive unknowns where the gradient A'(b - A x) is largest, and leaves it where its unknown would fall below
//! zero. The columns of the set are stored as Q R. A column is added by Gram and Schmidt (twice, so that Q stays
//! orthogonal to rounding) and removed by Givens' rotations. So a step costs about rows x columns products for the
//! gradient and twice rows x (size of the set) for Q, and the condition number is that of A, not of A'A.

/// Gradients below this, relative to the largest entry of A'b with each column divided by its norm, count as zero.
const GRADIENT_TOLERANCE: f64 = 1e-12;

/// A column counts as a combination of the others if less than this fraction of its norm is orthogonal to them; it is
/// left out.
const INDEPENDENT: f64 = 1e-10;

/// The columns of A, all of the same length.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Columns {
    rows: usize,
    values: Vec<f64>,
}

impl Columns {
    /// An empty matrix with `rows` rows.
    pub fn new(rows: usize) -> Self {
        Self { rows, values: Vec::new() }
    }

    /// Adds a column. Excess entries are cut off, missing ones are zero.
    pub fn push(&mut self, column: impl IntoIterator<Item = f64>) {
        let end = self.values.len() + self.rows;
        self.values.extend(column.into_iter().take(self.rows));
        self.values.resize(end, 0.0);
    }

    /// Number of columns.
    pub fn count(&self) -> usize {
        self.values.len().checked_div(self.rows).unwrap_or(0)
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Column `index`.
    pub fn column(&self, index: usize) -> &[f64] {
        &self.values[index * self.rows..(index + 1) * self.rows]
    }

    /// The columns in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[f64]> {
        (0..self.count()).map(|index| self.column(index))
    }

    /// A x.
    pub fn times(&self, x: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; self.rows];
        for (column, &x) in self.iter().zip(x) {
            if x != 0.0 {
                add_times(&mut sum, x, column);
            }
        }
        sum
    }
}

/// The x >= 0 that minimises |A x - b|, for finite A and b.
///
/// Exact to rounding: where x is zero the gradient is not above zero, elsewhere it is zero. Columns that are
/// combinations of others, and columns of zeros, keep x = 0.
pub fn non_negative_least_squares(a: &Columns, b: &[f64]) -> Vec<f64> {
    let mut set = ActiveSet::new(a, b);
    set.solve();
    set.x
}

/// The result of [`non_negative_least_squares`], and a result with at most `most` unknowns above zero: the unknown
/// whose removal raises the error least is removed and the others are solved for again, until at most `most` remain.
/// (Finding the best set of a given size is combinatorial; this one is close to it where the columns change
/// smoothly.)
pub(crate) fn all_and_few(a: &Columns, b: &[f64], most: usize) -> (Vec<f64>, Vec<f64>) {
    let mut set = ActiveSet::new(a, b);
    set.solve();
    let all = set.x.clone();
    while set.free.len() > most {
        let Some(least) = set.least_missed() else { break };
        set.allowed[set.free[least]] = false;
        // The remaining unknowns are solved for from zero: a set of this size takes microseconds.
        for column in 0..a.count() {
            set.allowed[column] &= set.free.contains(&column);
        }
        set.restart();
        set.solve();
    }
    (all, set.x)
}

/// One run of the algorithm.
struct ActiveSet<'a> {
    a: &'a Columns,
    b: &'a [f64],
    /// Inverse norm of each column; zero for a column of zeros.
    inverse_norm: Vec<f64>,
    x: Vec<f64>,
    /// The columns whose unknowns may be above zero.
    allowed: Vec<bool>,
    /// The columns whose unknowns are free, in the order of `basis`.
    free: Vec<usize>,
    basis: Basis,
}

impl<'a> ActiveSet<'a> {
    fn new(a: &'a Columns, b: &'a [f64]) -> Self {
        let inverse = |column: &[f64]| {
            let norm = dot(column, column).sqrt();
            if norm > 0.0 { norm.recip() } else { 0.0 }
        };
        Self {
            a,
            b,
            inverse_norm: a.iter().map(inverse).collect(),
            x: vec![0.0; a.count()],
            allowed: vec![true; a.count()],
            free: Vec::new(),
            basis: Basis::default(),
        }
    }

    fn solve(&mut self) {
        let largest = self.gradient().into_iter().map(f64::abs).fold(0.0, f64::max);
        let tolerance = GRADIENT_TOLERANCE * largest;
        // Each step lowers the error, so no set is repeated and the loop ends; rounding may reduce a step to nothing,
        // so the steps are counted as well.
        let mut refused = vec![false; self.a.count()];
        for _ in 0..10 * self.a.count() {
            let Some(enters) = self.steepest(&refused, tolerance) else { break };
            if self.enter(enters) {
                refused.iter_mut().for_each(|refused| *refused = false);
            } else {
                refused[enters] = true;
            }
        }
    }

    /// A'(b - A x), each entry over the norm of its column.
    fn gradient(&self) -> Vec<f64> {
        let mut rest = self.b.to_vec();
        for &column in &self.free {
            add_times(&mut rest, -self.x[column], self.a.column(column));
        }
        self.a.iter().zip(&self.inverse_norm).map(|(column, inverse)| dot(column, &rest) * inverse).collect()
    }

    /// The column with the largest gradient among those that are not free; `None` if none is above the tolerance.
    fn steepest(&self, refused: &[bool], tolerance: f64) -> Option<usize> {
        let gradient = self.gradient();
        (0..self.a.count())
            .filter(|&column| {
                gradient[column] > tolerance
                    && self.allowed[column]
                    && !refused[column]
                    && !self.free.contains(&column)
            })
            .max_by(|&one, &other| gradient[one].total_cmp(&gradient[other]))
    }

    /// Frees a column and minimises the error with all unknowns at or above zero. False if the error does not fall:
    /// the column is a combination of the others, or its gradient is rounding error.
    fn enter(&mut self, column: usize) -> bool {
        let inverse = self.inverse_norm[column];
        if !self.basis.push(self.a.column(column).iter().map(|value| value * inverse).collect(), self.b) {
            return false;
        }
        self.free.push(column);
        let mut wanted = self.basis.solution();
        if wanted.last().is_some_and(|&last| last <= 0.0) {
            self.leave(self.free.len() - 1);
            return false;
        }
        while let Some(stop) = self.first_to_vanish(&wanted) {
            let (share, _) = stop;
            for (&column, &wanted) in self.free.iter().zip(&wanted) {
                let wanted = wanted * self.inverse_norm[column];
                self.x[column] += share * (wanted - self.x[column]);
            }
            let (_, position) = stop;
            self.leave(position);
            wanted = self.basis.solution();
        }
        for (&column, &wanted) in self.free.iter().zip(&wanted) {
            self.x[column] = wanted * self.inverse_norm[column];
        }
        true
    }

    /// The fraction of the way to `wanted` at which the first unknown reaches zero, and its position; `None` if all
    /// are above zero at `wanted`.
    fn first_to_vanish(&self, wanted: &[f64]) -> Option<(f64, usize)> {
        let share = |(position, (&column, &wanted)): (usize, (&usize, &f64))| {
            let now = self.x[column];
            let wanted = wanted * self.inverse_norm[column];
            (wanted <= 0.0).then(|| (if now > 0.0 { now / (now - wanted) } else { 0.0 }, position))
        };
        self.free
            .iter()
            .zip(wanted)
            .enumerate()
            .filter_map(share)
            .min_by(|(one, _), (other, _)| one.total_cmp(other))
    }

    /// Position in the set of the unknown whose removal raises the error least: by x^2 over its diagonal entry of
    /// (A'A)^-1.
    fn least_missed(&self) -> Option<usize> {
        let raise = |(position, &column): (usize, &usize)| {
            let x = self.x[column] / self.inverse_norm[column];
            (position, x * x / self.basis.inverse_diagonal(position))
        };
        let raises = self.free.iter().enumerate().map(raise);
        raises.min_by(|(_, one), (_, other)| one.total_cmp(other)).map(|(position, _)| position)
    }

    /// Resets x to 0.
    fn restart(&mut self) {
        self.free.clear();
        self.basis = Basis::default();
        self.x.fill(0.0);
    }

    /// Holds a free unknown at zero.
    fn leave(&mut self, position: usize) {
        let column = self.free.remove(position);
        self.x[column] = 0.0;
        self.basis.remove(position);
    }
}

/// The free columns as Q R, and the component of b along each column of Q.
#[derive(Default)]
struct Basis {
    /// Orthonormal columns.
    q: Vec<Vec<f64>>,
    /// The columns of the upper triangle.
    r: Vec<Vec<f64>>,
    along: Vec<f64>,
}

impl Basis {
    /// Adds a column of norm 1; false if it is a combination of the others.
    fn push(&mut self, mut column: Vec<f64>, b: &[f64]) -> bool {
        let mut upper = vec![0.0; self.q.len()];
        for _ in 0..2 {
            for (q, upper) in self.q.iter().zip(&mut upper) {
                let part = dot(q, &column);
                *upper += part;
                add_times(&mut column, -part, q);
            }
        }
        let outside = dot(&column, &column).sqrt();
        if outside <= INDEPENDENT || outside.is_nan() {
            return false;
        }
        column.iter_mut().for_each(|value| *value /= outside);
        upper.push(outside);
        self.along.push(dot(&column, b));
        self.q.push(column);
        self.r.push(upper);
        true
    }

    /// Removes a column. The triangle then has one entry below its diagonal in each later column, which a rotation of
    /// two columns of Q eliminates.
    fn remove(&mut self, position: usize) {
        self.r.remove(position);
        for lower in position..self.r.len() {
            let (one, other) = (self.r[lower][lower], self.r[lower][lower + 1]);
            let length = one.hypot(other);
            let (cos, sin) = (one / length, other / length);
            let turn = |one: &mut f64, other: &mut f64| {
                (*one, *other) = (cos * *one + sin * *other, cos * *other - sin * *one);
            };
            for column in &mut self.r[lower..] {
                if let [one, other, ..] = &mut column[lower..] {
                    turn(one, other);
                }
            }
            if let [one, other, ..] = &mut self.q[lower..] {
                one.iter_mut().zip(other).for_each(|(one, other)| turn(one, other));
            }
            if let [one, other, ..] = &mut self.along[lower..] {
                turn(one, other);
            }
            self.r[lower].truncate(lower + 1);
        }
        self.q.truncate(self.r.len());
        self.along.truncate(self.r.len());
    }

    /// The unknowns of least error, by back substitution.
    fn solution(&self) -> Vec<f64> {
        let mut x = self.along.clone();
        for column in (0..x.len()).rev() {
            let (above, diagonal) = self.r[column].split_at(column);
            let value = x[column] / diagonal[0];
            x[column] = value;
            add_times(&mut x[..column], -value, above);
        }
        x
    }
}

impl Basis {
    /// Diagonal entry of (A'A)^-1 = R^-1 R^-T: the square of a row of R^-1, which is a column of R^-T and is found by
    /// forward substitution.
    fn inverse_diagonal(&self, position: usize) -> f64 {
        let mut row = vec![0.0; self.r.len()];
        for (at, column) in self.r.iter().enumerate().skip(position) {
            let known = if at == position { 1.0 } else { 0.0 };
            row[at] = (known - dot(&column[..at], &row[..at])) / column[at];
        }
        dot(&row, &row)
    }
}

/// Eight partial sums, so that the compiler uses vector registers.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (a_chunks, b_chunks) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = a_chunks.remainder().iter().zip(b_chunks.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a_chunks.zip(b_chunks) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    sums.iter().sum::<f64>() + rest
}

fn add_times(sum: &mut [f64], factor: f64, column: &[f64]) {
    for (sum, value) in sum.iter_mut().zip(column) {
        *sum += factor * value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pseudo-random numbers from 0 to 1, the same at every run.
    struct Numbers(u64);

    impl Numbers {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        }
    }

    /// Adjacent humps of different widths: neighbours are nearly alike, like the fields of neighbouring tones.
    fn humps(numbers: &mut Numbers, rows: usize, count: usize) -> Columns {
        let mut columns = Columns::new(rows);
        for hump in 0..count {
            let (middle, width) = (hump as f64 / count as f64, 0.02 + 0.1 * numbers.next());
            columns.push((0..rows).map(|row| (-((row as f64 / rows as f64 - middle) / width).powi(2)).exp()));
        }
        columns
    }

    fn error(a: &Columns, x: &[f64], b: &[f64]) -> f64 {
        a.times(x).iter().zip(b).map(|(is, wanted)| (is - wanted).powi(2)).sum()
    }

    /// The largest violation of the conditions of Karush, Kuhn and Tucker, over the largest entry of A'b: a gradient
    /// above zero where x is zero, any gradient where it is not, an x below zero.
    fn breach(a: &Columns, x: &[f64], b: &[f64]) -> f64 {
        let rest: Vec<f64> = b.iter().zip(a.times(x)).map(|(b, is)| b - is).collect();
        let largest = a.iter().map(|column| dot(column, b).abs()).fold(0.0, f64::max);
        let breaches = a.iter().zip(x).map(|(column, &x)| {
            let gradient = dot(column, &rest);
            if x < 0.0 {
                f64::INFINITY
            } else if x > 0.0 {
                gradient.abs()
            } else {
                gradient.max(0.0)
            }
        });
        breaches.fold(0.0, f64::max) / largest
    }

    #[test]
    fn a_thousand_random_targets_are_met_to_rounding() {
        let mut numbers = Numbers(1);
        for round in 0..1000 {
            let a = humps(&mut numbers, 40, 30);
            let steps = 1 + round % 9;
            let heights: Vec<f64> = (0..=steps).map(|_| numbers.next()).collect();
            let b: Vec<f64> = (0..40).map(|row| heights[row * steps / 40]).collect();
            let x = non_negative_least_squares(&a, &b);
            let breach = breach(&a, &x, &b);
            assert!(breach <= 1e-8, "target {round}: {breach:e}");
        }
    }

    #[test]
    fn two_hundred_candidates_at_two_hundred_places_are_met_to_rounding() {
        let mut numbers = Numbers(2);
        for _ in 0..5 {
            let a = humps(&mut numbers, 200, 200);
            let b: Vec<f64> =
                (0..200).map(|row| numbers.next() + if row < 100 { 1.0 } else { 0.0 }).collect();
            assert!(breach(&a, &non_negative_least_squares(&a, &b), &b) <= 1e-8);
        }
    }

    #[test]
    fn the_error_is_the_least_of_all_sets_of_columns() {
        let mut numbers = Numbers(3);
        for _ in 0..50 {
            let mut a = Columns::new(7);
            (0..6).for_each(|_| a.push((0..7).map(|_| numbers.next() - 0.3).collect::<Vec<_>>()));
            let b: Vec<f64> = (0..7).map(|_| numbers.next() - 0.5).collect();
            let least =
                (0..1_u32 << 6).filter_map(|set| error_of_set(&a, set, &b)).fold(f64::INFINITY, f64::min);
            let found = error(&a, &non_negative_least_squares(&a, &b), &b);
            assert!((found - least).abs() <= 1e-12 * least.max(1e-3), "{found} {least}");
        }
    }

    /// The least error with these columns alone, by the normal equations; `None` if an unknown is below zero.
    fn error_of_set(a: &Columns, set: u32, b: &[f64]) -> Option<f64> {
        let members: Vec<&[f64]> = a
            .iter()
            .enumerate()
            .filter(|(column, _)| set >> column & 1 == 1)
            .map(|(_, column)| column)
            .collect();
        if members.is_empty() {
            return Some(dot(b, b));
        }
        let matrix = nalgebra::DMatrix::from_fn(a.rows(), members.len(), |row, column| members[column][row]);
        let wanted = nalgebra::DVector::from_column_slice(b);
        let x = (matrix.tr_mul(&matrix)).lu().solve(&matrix.tr_mul(&wanted))?;
        (x.iter().all(|&x| x >= 0.0)).then(|| (wanted - matrix * x).norm_squared())
    }

    #[test]
    fn columns_that_add_nothing_stay_at_zero() {
        let mut a = Columns::new(3);
        a.push([1.0, 0.0, 0.0]);
        a.push([0.0; 3]);
        a.push([2.0, 0.0, 0.0]);
        a.push([-1.0, -1.0, 0.0]);
        let x = non_negative_least_squares(&a, &[4.0, 1.0, 0.0]);
        assert!((x[0] + 2.0 * x[2] - 4.0).abs() < 1e-12, "{x:?}");
        assert_eq!((x[0].min(x[2]), x[1], x[3]), (0.0, 0.0, 0.0));
        assert_eq!(non_negative_least_squares(&a, &[-1.0, 0.0, 0.0])[..3], [0.0; 3]);
        assert!(non_negative_least_squares(&Columns::new(3), &[1.0; 3]).is_empty());
    }

    #[test]
    fn few_columns_are_chosen_where_few_matter() {
        let mut numbers = Numbers(4);
        let a = humps(&mut numbers, 120, 60);
        let wanted = [(7, 1.0), (25, 0.4), (44, 2.0)];
        let mut x = vec![0.0; 60];
        for (column, value) in wanted {
            x[column] = value;
        }
        let b: Vec<f64> = a.times(&x).iter().map(|value| value + 1e-4 * numbers.next()).collect();
        let (all, few) = all_and_few(&a, &b, 3);
        assert_eq!(all, non_negative_least_squares(&a, &b));
        for (column, value) in wanted {
            assert!((few[column] - value).abs() < 1e-2, "{column}: {}", few[column]);
        }
        assert_eq!(few.iter().filter(|&&x| x > 0.0).count(), 3);
    }
}
