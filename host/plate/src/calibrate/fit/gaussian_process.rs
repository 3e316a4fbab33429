//! Gaussian process regression on a line with Matérn's covariance of order 3/2 and a constant mean with a flat prior.
//! The covariance is s^2 (1 + r) e^(-r) with r = sqrt(3) |x - x'|/l.
//!
//! The process is the first component of a Markov process with two (the value, and the slope over sqrt(3)/l), so
//! Kalman's filter and the smoother of Rauch, Tung and Striebel give the exact posterior in a time linear in the
//! number of points (Hartikainen and Sarkka 2010). In u = sqrt(3) dx/l the transition is
//! e^(-u) [[1 + u, u], [-u, 1 - u]], and both components have the variance s^2. Both passes are linear in the values:
//! those of a column of ones give the mean and its variance.

use crate::order::median;
use nalgebra::{Matrix2, Vector2};

/// Search ranges: the standard deviation s in the unit of the values (0.009 to 26 dB for nepers); the correlation
/// length l, at least this times the median distance of two points and at most this times the length of all; and
/// steps in each.
const SIZES: (f64, f64) = (1e-3, 3.0);
const LENGTHS: (f64, f64) = (1.0, 2.0);
const TRIED: usize = 9;
/// Halvings of the step about the best value.
const HALVINGS: usize = 4;
/// Least variance of a value: two different values at nearly one place must not contradict each other.
const VARIANCE_MIN: f64 = 1e-10;

/// Matérn's covariance with its hyperparameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Process {
    /// s, in the unit of the values.
    pub(crate) size: f64,
    /// l, in the unit of the places.
    pub(crate) length: f64,
}

/// Places in rising order with the variances of their values; infinite where a place has no value.
#[derive(Debug, Clone)]
pub(crate) struct Places {
    pub(crate) at: Vec<f64>,
    pub(crate) variances: Vec<f64>,
}

/// The posterior at all places of a [`Places`].
#[derive(Debug, Clone)]
pub(crate) struct Posterior {
    /// Posterior mean of the first column of values, and the other columns smoothed with the same weights.
    pub(crate) means: Vec<Vec<f64>>,
    /// Posterior variances of the first column.
    pub(crate) variances: Vec<f64>,
}

impl Process {
    /// The hyperparameters of largest marginal likelihood of `values`.
    pub(crate) fn likeliest(places: &Places, values: &[f64]) -> Option<Self> {
        let known: Vec<f64> = places
            .at
            .iter()
            .zip(&places.variances)
            .filter(|(_, v)| v.is_finite())
            .map(|(at, _)| *at)
            .collect();
        let whole = known.last()? - known.first()?;
        let shortest = LENGTHS.0 * median(known.windows(2).map(|pair| pair[1] - pair[0]).collect())?;
        let ranges = [SIZES, (shortest, (LENGTHS.1 * whole).max(shortest))].map(|(a, b)| (a.ln(), b.ln()));
        let likelihood = |[size, length]: [f64; 2]| {
            let process = Self { size: size.exp(), length: length.exp() };
            process.likelihood(places, values).unwrap_or(f64::NEG_INFINITY)
        };
        let mut step = ranges.map(|(low, high)| (high - low) / (TRIED - 1) as f64);
        let on_grid = |i: usize, number: usize| ranges[i].0 + step[i] * number as f64;
        let mut best = ([0.0; 2], f64::NEG_INFINITY);
        for number in 0..TRIED * TRIED {
            let at = [on_grid(0, number / TRIED), on_grid(1, number % TRIED)];
            let here = likelihood(at);
            if here > best.1 {
                best = (at, here);
            }
        }
        for _ in 0..HALVINGS {
            step = step.map(|step| 0.5 * step);
            let middle = best.0;
            for number in 0..9_i8 {
                let way = [number / 3 - 1, number % 3 - 1].map(f64::from);
                let at = [0, 1].map(|i| (middle[i] + way[i] * step[i]).clamp(ranges[i].0, ranges[i].1));
                let here = likelihood(at);
                if here > best.1 {
                    best = (at, here);
                }
            }
        }
        let ([size, length], likelihood) = best;
        likelihood.is_finite().then(|| Self { size: size.exp(), length: length.exp() })
    }

    /// Logarithm of the marginal likelihood, up to a constant, with the mean integrated out.
    fn likelihood(&self, places: &Places, values: &[f64]) -> Option<f64> {
        let filtered = Filtered::new(self, places, &[values])?;
        let mean = filtered.mean_of(0);
        let square = filtered.products(0, 0) - mean * mean * filtered.ones();
        Some(-0.5 * (filtered.log_variances + filtered.ones().ln() + square))
    }

    /// The posterior for the values of the first column; further columns are smoothed with the same weights.
    pub(crate) fn posterior(&self, places: &Places, columns: &[&[f64]]) -> Option<Posterior> {
        let filtered = Filtered::new(self, places, columns)?;
        let (smoothed, variances) = filtered.smoothed();
        let ones = columns.len();
        let means = (0..ones).map(|column| {
            let mean = filtered.mean_of(column);
            let at = |i: usize| mean + smoothed[i][column] - mean * smoothed[i][ones];
            (0..places.at.len()).map(at).collect()
        });
        // The variance that the unknown mean adds.
        let open =
            |(variance, row): (&f64, &Vec<f64>)| variance + (1.0 - row[ones]).powi(2) / filtered.ones();
        let variances = variances.iter().zip(&smoothed).map(open).collect();
        Some(Posterior { means: means.collect(), variances })
    }
}

/// Kalman's filter over all places: the state before and after each value.
struct Filtered {
    /// Transition to each place from the one before it.
    transitions: Vec<Matrix2<f64>>,
    before: Vec<Matrix2<f64>>,
    after: Vec<Matrix2<f64>>,
    /// For each column, and for ones.
    states: Vec<Vec<(Vector2<f64>, Vector2<f64>)>>,
    /// Sums of the products of two columns' innovations over their variance.
    sums: Vec<Vec<f64>>,
    /// Sum of the logarithms of the innovations' variances.
    log_variances: f64,
}

impl Filtered {
    /// `None` where no place has a value.
    fn new(process: &Process, places: &Places, columns: &[&[f64]]) -> Option<Self> {
        let count = columns.len() + 1;
        let stationary = Matrix2::identity() * process.size.powi(2);
        let mut filtered = Self {
            transitions: Vec::with_capacity(places.at.len()),
            before: Vec::with_capacity(places.at.len()),
            after: Vec::with_capacity(places.at.len()),
            states: Vec::with_capacity(places.at.len()),
            sums: vec![vec![0.0; count]; count],
            log_variances: 0.0,
        };
        let mut covariance = stationary;
        let mut states = vec![Vector2::zeros(); count];
        let mut last = *places.at.first()?;
        for (i, (&at, &variance)) in places.at.iter().zip(&places.variances).enumerate() {
            let u = 3_f64.sqrt() * (at - last) / process.length;
            let transition = Matrix2::new(1.0 + u, u, -u, 1.0 - u) * (-u).exp();
            last = at;
            let before = stationary + transition * (covariance - stationary) * transition.transpose();
            let predicted: Vec<Vector2<f64>> = states.iter().map(|state| transition * state).collect();
            let (mut after, mut updated) = (before, predicted.clone());
            if variance.is_finite() {
                let of_innovation = before[(0, 0)] + variance.max(VARIANCE_MIN);
                let gain = before.column(0) / of_innovation;
                let value = |column: usize| columns.get(column).map_or(1.0, |column| column[i]);
                let innovations: Vec<f64> = (0..count).map(|c| value(c) - predicted[c].x).collect();
                updated.iter_mut().zip(&innovations).for_each(|(state, left)| *state += gain * *left);
                after -= gain * before.row(0);
                filtered.log_variances += of_innovation.ln();
                for (row, a) in filtered.sums.iter_mut().zip(&innovations) {
                    row.iter_mut().zip(&innovations).for_each(|(sum, b)| *sum += a * b / of_innovation);
                }
            }
            filtered.transitions.push(transition);
            filtered.before.push(before);
            filtered.after.push(after);
            (covariance, states) = (after, updated.clone());
            filtered.states.push(predicted.into_iter().zip(updated).collect());
        }
        (filtered.ones() > 0.0).then_some(filtered)
    }

    fn products(&self, a: usize, b: usize) -> f64 {
        self.sums[a][b]
    }

    /// The weight of the mean: the inverse of its variance.
    fn ones(&self) -> f64 {
        let last = self.sums.len() - 1;
        self.products(last, last)
    }

    /// The most likely mean of a column.
    fn mean_of(&self, column: usize) -> f64 {
        self.products(column, self.sums.len() - 1) / self.ones()
    }

    /// The smoothed values of all columns and of ones at each place, for a mean of 0, and their variances.
    fn smoothed(&self) -> (Vec<Vec<f64>>, Vec<f64>) {
        let count = self.after.len();
        let (mut values, mut variances) = (vec![Vec::new(); count], vec![0.0; count]);
        let mut later: Option<(Matrix2<f64>, Vec<Vector2<f64>>)> = None;
        for i in (0..count).rev() {
            let updated = self.states[i].iter().map(|(_, after)| *after);
            let (covariance, states): (_, Vec<Vector2<f64>>) = match later {
                None => (self.after[i], updated.collect()),
                Some((there, smoothed)) => {
                    let before = self.before[i + 1];
                    let gain = self.after[i] * self.transitions[i + 1].transpose();
                    let gain = before.try_inverse().map_or_else(Matrix2::zeros, |inverse| gain * inverse);
                    let moved =
                        smoothed.iter().zip(&self.states[i + 1]).map(|(now, (was, _))| gain * (now - was));
                    let covariance = self.after[i] + gain * (there - before) * gain.transpose();
                    (covariance, updated.zip(moved).map(|(state, moved)| state + moved).collect())
                }
            };
            values[i] = states.iter().map(|state| state.x).collect();
            variances[i] = covariance[(0, 0)].max(0.0);
            later = Some((covariance, states));
        }
        (values, variances)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// The textbook formulas with full matrices, the mean as a coordinate of its own.
    fn direct(process: &Process, places: &Places, values: &[f64]) -> (Vec<f64>, Vec<f64>, f64) {
        let covariance = |a: f64, b: f64| {
            let r = 3_f64.sqrt() * (a - b).abs() / process.length;
            process.size.powi(2) * (1.0 + r) * (-r).exp()
        };
        let known: Vec<usize> = (0..places.at.len()).filter(|&i| places.variances[i].is_finite()).collect();
        let n = known.len();
        let own = DMatrix::from_fn(n, n, |i, j| {
            let noise = if i == j { places.variances[known[i]] } else { 0.0 };
            covariance(places.at[known[i]], places.at[known[j]]) + noise
        });
        let (ones, y) = (DVector::from_element(n, 1.0), DVector::from_fn(n, |i, _| values[known[i]]));
        let factor = own.clone().cholesky().expect("positive");
        let weight = ones.dot(&factor.solve(&ones));
        let mean = ones.dot(&factor.solve(&y)) / weight;
        let left = y - ones.clone() * mean;
        let likelihood = -0.5 * (own.determinant().ln() + weight.ln() + left.dot(&factor.solve(&left)));
        let at = |x: f64| {
            let k = DVector::from_fn(n, |i, _| covariance(x, places.at[known[i]]));
            let solved = factor.solve(&k);
            let variance = process.size.powi(2) - k.dot(&solved) + (1.0 - ones.dot(&solved)).powi(2) / weight;
            (mean + solved.dot(&left), variance)
        };
        let (means, variances) = places.at.iter().map(|&x| at(x)).unzip();
        (means, variances, likelihood)
    }

    fn example() -> (Places, Vec<f64>) {
        let at: Vec<f64> = (0..24).map(|i| 0.05 * f64::from(i) + 0.01 * f64::from(i * i % 5)).collect();
        let variance =
            |i: usize| if i % 7 == 3 || i > 20 { f64::INFINITY } else { 1e-3 * (1 + i % 3) as f64 };
        let variances = (0..24).map(variance).collect();
        let values = at.iter().enumerate().map(|(i, x)| 2.0 + (5.0 * x).sin() + 0.02 * (i as f64).cos());
        let values = values.collect();
        (Places { at, variances }, values)
    }

    #[test]
    fn filter_and_smoother_give_the_posterior_of_whole_matrices() {
        let (places, values) = example();
        for process in [Process { size: 0.7, length: 0.4 }, Process { size: 0.05, length: 3.0 }] {
            let (means, variances, likelihood) = direct(&process, &places, &values);
            let found = process.posterior(&places, &[&values]).expect("values");
            for i in 0..places.at.len() {
                assert!(
                    (found.means[0][i] - means[i]).abs() < 1e-8,
                    "{i}: {} {}",
                    found.means[0][i],
                    means[i]
                );
                assert!((found.variances[i] / variances[i] - 1.0).abs() < 1e-7, "{i}: {}", variances[i]);
            }
            let there = process.likelihood(&places, &values).expect("values");
            assert!((there - likelihood).abs() < 1e-8, "{there} {likelihood}");
        }
    }

    #[test]
    fn the_likeliest_process_is_no_less_likely_than_its_neighbours_and_a_constant_needs_none() {
        let (places, values) = example();
        let best = Process::likeliest(&places, &values).expect("values");
        let here = best.likelihood(&places, &values);
        for (size, length) in [(0.7, 1.0), (1.4, 1.0), (1.0, 0.7), (1.0, 1.4)] {
            let other = Process { size: size * best.size, length: length * best.length };
            assert!(other.likelihood(&places, &values) < here, "{size} {length} {best:?}");
        }
        let constant = vec![0.3; values.len()];
        let flat = Process::likeliest(&places, &constant).expect("values");
        let found = flat.posterior(&places, &[&constant]).expect("values");
        assert!(found.means[0].iter().all(|mean| (mean - 0.3).abs() < 1e-6), "{:?}", found.means);
    }

    #[test]
    fn without_a_value_there_is_no_posterior() {
        let places = Places { at: vec![0.0, 1.0], variances: vec![f64::INFINITY; 2] };
        let process = Process { size: 1.0, length: 1.0 };
        assert!(process.posterior(&places, &[&[0.0, 0.0]]).is_none());
        assert!(Process::likeliest(&places, &[0.0, 0.0]).is_none());
    }
}
