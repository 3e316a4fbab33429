//! Levinson's recursion for a Hermitian Toeplitz system: entries depend on the distance from the diagonal alone.

use num_complex::Complex64;

/// Solves sum over k of t(k - i) x_k = y_i for a positive definite matrix, with t(d) = `lag[d]` and t(-d) its conjugate.
/// `lag` is as long as `right`.
///
/// `first` solves the system of the leading n rows for the first unit vector. Its conjugate in reverse order solves
/// it for the last unit vector. From both, the solution of n + 1 rows follows in n steps.
pub(super) fn solve(lag: &[Complex64], right: &[Complex64]) -> Vec<Complex64> {
    let (Some(diagonal), Some(y)) = (lag.first(), right.first()) else { return Vec::new() };
    let mut first = vec![diagonal.inv()];
    let mut solution = vec![y / diagonal];
    for (n, y) in right.iter().enumerate().skip(1) {
        // Row n of the matrix has t(k - n) = conj(lag[n - k]) at k.
        let row = |vector: &[Complex64]| -> Complex64 {
            vector.iter().zip(lag[1..=n].iter().rev()).map(|(value, lag)| value * lag.conj()).sum()
        };
        let over = row(&first);
        let scale = 1.0 / (1.0 - over.norm_sqr());
        let last: Vec<Complex64> = first.iter().rev().map(Complex64::conj).collect();
        first.push(Complex64::ZERO);
        for (value, last) in first[1..].iter_mut().zip(&last) {
            *value -= over * last;
        }
        first.iter_mut().for_each(|value| *value *= scale);
        let missing = y - row(&solution);
        solution.push(Complex64::ZERO);
        for (value, first) in solution.iter_mut().zip(first.iter().rev()) {
            *value += missing * first.conj();
        }
    }
    solution
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_solution_has_the_right_side_that_was_given() {
        // Positive definite: a sum of tones and a diagonal.
        let tone = |d: usize, turn: f64| Complex64::cis(turn * d as f64);
        let lag: Vec<Complex64> =
            (0..40).map(|d| 3.0 * tone(d, 0.3) + tone(d, -1.1) + if d == 0 { 0.1 } else { 0.0 }).collect();
        let right: Vec<Complex64> =
            (0..40).map(|i| Complex64::new(f64::from(i).sin(), 0.02 * f64::from(i))).collect();
        let solution = solve(&lag, &right);
        for (i, right) in right.iter().enumerate() {
            let entry = |k: usize| if k >= i { lag[k - i] } else { lag[i - k].conj() };
            let sum: Complex64 = solution.iter().enumerate().map(|(k, x)| entry(k) * x).sum();
            assert!((sum - right).norm() < 1e-10, "{i}: {sum} for {right}");
        }
        assert!(solve(&[], &[]).is_empty());
    }
}
