//! The least largest error that any number of tones can have: a linear program.
//!
//! minimise e with -e <= w_i ((A p)_i - b_i) <= e, p >= 0. Solved by an interior-point method (the crate `clarabel`).

use super::error::TextureError;
use super::nnls::Columns;
use super::palette::Palette;
use super::selection::candidates_m;
use super::target::Target;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus};

/// The least largest error of the mean square over the places that count, over the largest wanted: no tones of the table
/// do better at every place. It takes tens of milliseconds.
///
/// # Errors
/// [`TextureError::Silent`] if the plate does not answer, or the linear program has no solution.
pub fn least_largest_square_error(palette: &Palette<'_>, target: &Target) -> Result<f64, TextureError> {
    let squares = palette.squares(&candidates_m(target))?;
    let counting: Vec<usize> = (0..squares.rows()).filter(|&place| target.weight[place] > 0.0).collect();
    let mut columns = Columns::new(counting.len());
    for column in squares.iter() {
        columns.push(counting.iter().map(|&place| column[place]));
    }
    let wanted: Vec<f64> = counting.iter().map(|&place| target.wanted[place].powi(2)).collect();
    least_largest_error(&columns, &wanted).map(|(error, _)| error).ok_or(TextureError::Silent)
}

/// The least largest error max |A p - b| over all p >= 0, and the p that has it; `None` if the solver finds none (A or b
/// is not finite).
pub fn least_largest_error(a: &Columns, b: &[f64]) -> Option<(f64, Vec<f64>)> {
    let (rows, count) = (a.rows(), a.count());
    let scale = b.iter().map(|b| b.abs()).fold(0.0, f64::max);
    if !(scale > 0.0 && scale.is_finite()) {
        return None;
    }
    let norms: Vec<f64> = a
        .iter()
        .map(|column| column.iter().map(|v| v.abs()).fold(0.0, f64::max).max(f64::MIN_POSITIVE))
        .collect();
    // The unknowns are p times each column's norm, over b's, and e over b's. Rows: A p - e <= b, -A p - e <= -b, -p <= 0.
    let (mut starts, mut indices, mut values) = (vec![0], Vec::new(), Vec::new());
    for (number, column) in a.iter().enumerate() {
        for (sign, first) in [(1.0, 0), (-1.0, rows)] {
            for (row, value) in column.iter().enumerate().filter(|(_, value)| **value != 0.0) {
                indices.push(first + row);
                values.push(sign * value / norms[number]);
            }
        }
        indices.push(2 * rows + number);
        values.push(-1.0);
        starts.push(indices.len());
    }
    indices.extend(0..2 * rows);
    values.extend(std::iter::repeat_n(-1.0, 2 * rows));
    starts.push(indices.len());
    let constraints = CscMatrix::new(2 * rows + count, count + 1, starts, indices, values);
    let limits: Vec<f64> = b
        .iter()
        .map(|b| b / scale)
        .chain(b.iter().map(|b| -b / scale))
        .chain(std::iter::repeat_n(0.0, count))
        .collect();
    let mut cost = vec![0.0; count];
    cost.push(1.0);
    let settings = DefaultSettings { verbose: false, ..DefaultSettings::default() };
    let cones = [NonnegativeConeT(2 * rows + count)];
    let nothing = CscMatrix::zeros((count + 1, count + 1));
    let mut solver = DefaultSolver::new(&nothing, &cost, &constraints, &limits, &cones, settings).ok()?;
    solver.solve();
    let solved = matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved);
    let (error, powers) = solver.solution.x.split_last()?;
    solved.then(|| {
        let powers = powers.iter().zip(&norms).map(|(p, norm)| p.max(0.0) * scale / norm).collect();
        (error * scale, powers)
    })
}
