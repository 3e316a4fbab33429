//! Selection of tones: the best powers of all candidates, then the fewest tones that come close to them.

use super::nnls::{Columns, all_and_few};
use super::target::Target;
use crate::special::ramp::ramp;

/// Candidate turning points of a fit, uniform over the allowed ones.
pub(super) const CANDIDATES: usize = 200;

/// The target as the right-hand side of the least squares: the wanted mean squares, each times the root of its weight.
pub(super) fn right_hand_side(target: &Target) -> Vec<f64> {
    target.wanted.iter().zip(&target.weight).map(|(wanted, weight)| wanted * wanted * weight.sqrt()).collect()
}

/// Each row of `squares` times the root of its weight.
pub(super) fn weighted(squares: &Columns, target: &Target) -> Columns {
    let mut columns = Columns::new(squares.rows());
    for column in squares.iter() {
        columns.push(column.iter().zip(&target.weight).map(|(square, weight)| square * weight.sqrt()));
    }
    columns
}

/// Candidate turning points, uniform over those that the target allows, metres.
pub(super) fn candidates_m(target: &Target) -> Vec<f64> {
    let (start, end) = target.allowed_m;
    ramp(start, end, CANDIDATES).collect()
}

/// The powers of all candidates that are nearest to the target, and at most `most` candidates that come nearly as
/// close; `squares` are the candidates' fields.
pub(super) fn best_and_few(squares: &Columns, target: &Target, most: usize) -> (Vec<f64>, Vec<usize>) {
    let (best, few) = all_and_few(&weighted(squares, target), &right_hand_side(target), most);
    let sounding = few.iter().enumerate().filter(|&(_, &power)| power > 0.0).map(|(candidate, _)| candidate);
    (best, sounding.collect())
}
