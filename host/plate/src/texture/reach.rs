//! The smallest largest error that any number of tones can have: a linear program.
//!
//! minimise e with -e <= (A p)_i - b_i <= e, p >= 0. Solved by the interior-point method of S. Mehrotra ("On the
//! implementation of a primal-dual interior point method", SIAM J. Optim. 2 (1992) 575). With x = (p, e), the
//! constraints as G x + s = h, and a price z of each, it follows the path s_i z_i = mu to mu = 0. A step solves one
//! dense symmetric system of the size of p, G' diag(z/s) G, twice: to predict the reachable mu, and for the step
//! itself.

use super::error::TextureError;
use super::nnls::Columns;
use super::palette::Palette;
use super::selection::candidates_m;
use super::target::Target;
use nalgebra::linalg::Cholesky;
use nalgebra::{DMatrix, DVector};

/// Steps after which the solver fails; fifteen are usual.
const STEPS: usize = 100;
/// Limit of a solution: of mu, and of the errors of the constraints and of their prices, for b scaled to a maximum of
/// 1.
const EXACT: f64 = 1e-10;
/// Limit that is still accepted where rounding stops the iteration before [`EXACT`].
const CLOSE: f64 = 1e-8;
/// Fraction of the distance to the boundary of s > 0 and z > 0 that a step uses.
const INSIDE: f64 = 0.995;

/// The smallest largest error of the mean square over the places that count, over the largest wanted value: no tones
/// of the table have a smaller error at every place. Takes tens of milliseconds.
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

/// The minimum of max |A p - b| over all p >= 0, and its p; `None` if the solver finds none (A or b is not finite).
pub fn least_largest_error(a: &Columns, b: &[f64]) -> Option<(f64, Vec<f64>)> {
    let scale = b.iter().map(|b| b.abs()).fold(0.0, f64::max);
    if !(scale > 0.0 && scale.is_finite()) {
        return None;
    }
    // The unknowns are p times each column's largest entry, over the largest of b.
    let norms: Vec<f64> = a
        .iter()
        .map(|column| column.iter().map(|v| v.abs()).fold(0.0, f64::max).max(f64::MIN_POSITIVE))
        .collect();
    let scaled = DMatrix::from_fn(a.rows(), a.count(), |row, column| a.column(column)[row] / norms[column]);
    let powers = Program::new(scaled, b.iter().map(|b| b / scale)).solve()?;
    let powers: Vec<f64> = powers.iter().zip(&norms).map(|(p, norm)| p.max(0.0) * scale / norm).collect();
    let error = a.times(&powers).iter().zip(b).map(|(is, wanted)| (is - wanted).abs()).fold(0.0, f64::max);
    Some((error, powers))
}

/// The linear program, its point x, and the slack and price of each constraint: A p - e <= b, -A p - e <= -b, -p <= 0.
struct Program {
    a: DMatrix<f64>,
    limits: DVector<f64>,
    x: DVector<f64>,
    slack: DVector<f64>,
    price: DVector<f64>,
}

impl Program {
    fn new(a: DMatrix<f64>, b: impl Iterator<Item = f64> + Clone) -> Self {
        let (rows, count) = a.shape();
        let most = 2 * rows + count;
        let above = b.clone().chain(b.map(|b| -b)).chain(std::iter::repeat_n(0.0, count));
        let mut x = DVector::zeros(count + 1);
        // Feasible start: no tones, and an error of 2.
        x[count] = 2.0;
        Self {
            limits: DVector::from_iterator(most, above),
            slack: DVector::repeat(most, 1.0),
            price: DVector::repeat(most, 1.0),
            a,
            x,
        }
    }

    /// G v.
    fn constrain(&self, v: &DVector<f64>) -> DVector<f64> {
        let (rows, count) = self.a.shape();
        let (p, e) = (v.rows(0, count), v[count]);
        let is = &self.a * p;
        let mut all = DVector::zeros(2 * rows + count);
        all.rows_mut(0, rows).copy_from(&is.add_scalar(-e));
        all.rows_mut(rows, rows).copy_from(&(-is).add_scalar(-e));
        all.rows_mut(2 * rows, count).copy_from(&-p);
        all
    }

    /// G' v.
    fn weigh(&self, v: &DVector<f64>) -> DVector<f64> {
        let (rows, count) = self.a.shape();
        let (above, below) = (v.rows(0, rows), v.rows(rows, rows));
        let mut all = DVector::zeros(count + 1);
        all.rows_mut(0, count).copy_from(&(self.a.tr_mul(&(above - below)) - v.rows(2 * rows, count)));
        all[count] = -above.sum() - below.sum();
        all
    }

    /// G' diag(weight) G, as its Cholesky factor.
    fn system(&self, weight: &DVector<f64>) -> Option<Cholesky<f64, nalgebra::Dyn>> {
        let (rows, count) = self.a.shape();
        let (above, below) = (weight.rows(0, rows), weight.rows(rows, rows));
        let both = above + below;
        let mut weighted = self.a.clone();
        for mut column in weighted.column_iter_mut() {
            column.component_mul_assign(&both);
        }
        let mut system = DMatrix::zeros(count + 1, count + 1);
        system.view_mut((0, 0), (count, count)).copy_from(&self.a.tr_mul(&weighted));
        let mixed = self.a.tr_mul(&(below - above));
        system.view_mut((0, count), (count, 1)).copy_from(&mixed);
        system.view_mut((count, 0), (1, count)).copy_from(&mixed.transpose());
        system[(count, count)] = both.sum();
        for tone in 0..count {
            system[(tone, tone)] += weight[2 * rows + tone];
        }
        Cholesky::new(system)
    }

    /// The p of the least e; `None` without convergence.
    fn solve(mut self) -> Option<Vec<f64>> {
        let count = self.a.ncols();
        let most = self.slack.len() as f64;
        let mut best = f64::INFINITY;
        for _ in 0..STEPS {
            // The errors of the constraints and of their prices.
            let outside = self.constrain(&self.x) + &self.slack - &self.limits;
            let mut unpaid = self.weigh(&self.price);
            unpaid[count] += 1.0;
            let mu = self.slack.dot(&self.price) / most;
            best = mu.max(outside.amax()).max(unpaid.amax());
            if best <= EXACT || !best.is_finite() {
                break;
            }
            let Some(system) = self.system(&self.price.component_div(&self.slack)) else { break };
            // The Newton step to s z = `left`.
            let step = |left: &DVector<f64>| {
                let product = self.slack.component_mul(&self.price) - left;
                let owed = (self.price.component_mul(&outside) - &product).component_div(&self.slack);
                let x = system.solve(&(-&unpaid - self.weigh(&owed)));
                let moved = self.constrain(&x);
                let slack = -&outside - &moved;
                let price = owed + self.price.component_mul(&moved).component_div(&self.slack);
                (x, slack, price)
            };
            let (_, slack, price) = step(&DVector::zeros(self.slack.len()));
            let (far, dear) = (allowed(&self.slack, &slack, 1.0), allowed(&self.price, &price, 1.0));
            let then = (&self.slack + &slack * far).dot(&(&self.price + &price * dear)) / most;
            // Not smaller than necessary: the smaller mu, the larger the rounding error of the system.
            let left = ((then / mu).powi(3) * mu).max(0.1 * EXACT);
            let (x, slack, price) = step(&slack.component_mul(&price).map(|product| left - product));
            let (far, dear) = (allowed(&self.slack, &slack, INSIDE), allowed(&self.price, &price, INSIDE));
            self.x += x * far;
            self.slack += slack * far;
            self.price += price * dear;
        }
        (best <= CLOSE).then(|| self.x.iter().take(count).copied().collect())
    }
}

/// The fraction of `step` from `from` that covers `part` of the way to its first zero, at most 1.
fn allowed(from: &DVector<f64>, step: &DVector<f64>, part: f64) -> f64 {
    let zero = |(from, step): (&f64, &f64)| if *step < 0.0 { -from / step } else { f64::INFINITY };
    (part * from.iter().zip(step).map(zero).fold(f64::INFINITY, f64::min)).min(1.0)
}
