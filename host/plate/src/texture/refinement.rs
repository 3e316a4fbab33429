//! Moves a few tones from the candidates' places to the best places.
//!
//! Levenberg and Marquardt's method in the tones' places; each step solves for the powers (variable projection:
//! G. Golub and V. Pereyra, SIAM J. Numer. Anal. 10, 413, 1973).

use super::error::TextureError;
use super::nnls::{Columns, non_negative_least_squares};
use super::palette::Palette;
use super::selection::{right_hand_side, weighted};
use super::target::Target;
use nalgebra::{DMatrix, DVector};

/// Largest number of steps.
const STEPS: usize = 12;
/// A relative reduction of the error below this ends the search.
const WORTH_IT: f64 = 1e-3;
/// Step of a place for a difference quotient, over the length of the allowed places.
const SLOPE_STEP: f64 = 1e-4;

/// Turning points, powers, and their squared error.
pub(super) struct Placed {
    pub(super) positions_m: Vec<f64>,
    pub(super) powers: Vec<f64>,
    /// The tones' fields, weighted.
    fields: Columns,
    error: f64,
}

/// The best powers at these places.
fn place(palette: &Palette<'_>, target: &Target, positions_m: Vec<f64>) -> Result<Placed, TextureError> {
    let columns = weighted(&palette.squares(&positions_m)?, target);
    let wanted = right_hand_side(target);
    let powers = non_negative_least_squares(&columns, &wanted);
    let error = columns.times(&powers).iter().zip(&wanted).map(|(is, wanted)| (wanted - is).powi(2)).sum();
    Ok(Placed { positions_m, powers, fields: columns, error })
}

/// The best powers of tones at these places.
pub(super) fn powers_at(
    palette: &Palette<'_>,
    target: &Target,
    positions_m: &[f64],
) -> Result<Vec<f64>, TextureError> {
    place(palette, target, positions_m.to_vec()).map(|placed| placed.powers)
}

/// Moves the tones at `positions_m` within the allowed places of the target.
pub(super) fn refine(
    palette: &Palette<'_>,
    target: &Target,
    positions_m: Vec<f64>,
) -> Result<Placed, TextureError> {
    let mut now = place(palette, target, positions_m)?;
    let mut damping = 1e-3;
    for _ in 0..STEPS {
        let (gradient, curvature) = slopes(palette, target, &now)?;
        // Tones with zero power have no slope.
        if gradient.amax() == 0.0 {
            break;
        }
        let mut better = None;
        while damping < 1e6 && better.is_none() {
            let next = place(palette, target, stepped(&now, target, &gradient, &curvature, damping))?;
            if next.error < now.error {
                damping *= 0.1;
                better = Some(next);
            } else {
                damping *= 10.0;
            }
        }
        let Some(next) = better else { break };
        let gained = now.error - next.error;
        let done = gained < WORTH_IT * now.error;
        now = next;
        if done {
            break;
        }
    }
    Ok(now)
}

/// J'r and J'J of the residual r = b - A(x) p with respect to the places x, without the components along the columns
/// of sounding tones, which the powers compensate.
fn slopes(
    palette: &Palette<'_>,
    target: &Target,
    now: &Placed,
) -> Result<(DVector<f64>, DMatrix<f64>), TextureError> {
    let (start, end) = target.allowed_m;
    let step_m = SLOPE_STEP * (end - start);
    // Towards the side with room.
    let aside: Vec<f64> =
        now.positions_m.iter().map(|&x| if x + step_m <= end { x + step_m } else { x - step_m }).collect();
    let here = &now.fields;
    let there = weighted(&palette.squares(&aside)?, target);
    let rest: Vec<f64> =
        right_hand_side(target).iter().zip(here.times(&now.powers)).map(|(wanted, is)| wanted - is).collect();
    let rows = here.rows();
    let fields = DMatrix::from_iterator(rows, here.count(), here.iter().flatten().copied());
    let slope = |tone: usize| {
        let per_metre = now.powers[tone] / (aside[tone] - now.positions_m[tone]);
        let (here, there) = (here.column(tone), there.column(tone));
        here.iter().zip(there).map(move |(here, there)| (there - here) * per_metre).collect::<Vec<_>>()
    };
    let mut jacobian = DMatrix::from_iterator(rows, here.count(), (0..here.count()).flat_map(slope));
    let basis = sounding(&fields, &now.powers).qr().q();
    jacobian -= &basis * basis.tr_mul(&jacobian);
    let rest = DVector::from_vec(rest);
    Ok((jacobian.tr_mul(&rest), jacobian.tr_mul(&jacobian)))
}

/// The columns of the tones with power.
fn sounding(fields: &DMatrix<f64>, powers: &[f64]) -> DMatrix<f64> {
    let columns: Vec<_> =
        (0..powers.len()).filter(|&tone| powers[tone] > 0.0).map(|tone| fields.column(tone)).collect();
    if columns.is_empty() { DMatrix::zeros(fields.nrows(), 1) } else { DMatrix::from_columns(&columns) }
}

/// The places after one damped step, clamped to the allowed places.
fn stepped(
    now: &Placed,
    target: &Target,
    gradient: &DVector<f64>,
    curvature: &DMatrix<f64>,
    damping: f64,
) -> Vec<f64> {
    let mut damped = curvature.clone();
    let floor = 1e-12 * curvature.diagonal().amax();
    for i in 0..damped.nrows() {
        damped[(i, i)] += damping * curvature[(i, i)] + floor;
    }
    let step = damped.lu().solve(gradient).unwrap_or_else(|| DVector::zeros(gradient.len()));
    let (start, end) = target.allowed_m;
    now.positions_m.iter().zip(step.iter()).map(|(x, step)| (x + step).clamp(start, end)).collect()
}
