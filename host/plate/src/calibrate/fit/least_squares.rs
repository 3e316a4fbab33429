//! Non-linear least squares by Levenberg and Marquardt, for a handful of parameters.
//!
//! The step solves (J^T J + lambda diag(J^T J)) step = -J^T r (Marquardt 1963); lambda falls by 10 after a step that
//! lowers |r|^2 and rises by 10 after one that does not.

use nalgebra::{DMatrix, DVector};

/// Largest number of iterations, each with its own lambda; a fit that has not converged by then fails.
pub(crate) const STEPS_MAX: usize = 60;
/// Largest lambda: the parameters no longer move with it.
const LAMBDA_MAX: f64 = 1e12;

/// Residuals as a function of parameters.
pub(crate) trait Problem {
    /// r, each of variance 1; `None` where the parameters are not valid. Such a step is not taken.
    fn residuals(&self, at: &[f64]) -> Option<Vec<f64>>;
    /// The columns of J = dr/dparameters at the point where the residuals are `r`.
    fn slopes(&self, at: &[f64], r: &[f64]) -> Option<Vec<Vec<f64>>>;
}

/// A column of J: the difference of the residuals at two points over the difference of the parameter.
pub(crate) fn slope(there: &[f64], here: &[f64], way: f64) -> Vec<f64> {
    there.iter().zip(here).map(|(there, here)| (there - here) / way).collect()
}

/// The parameters at which |r|^2 is least.
#[derive(Debug, Clone)]
pub(crate) struct Fit {
    pub(crate) parameters: Vec<f64>,
    /// |r|^2 at these parameters.
    pub(crate) chi2: f64,
    /// (J^T J)^-1: the covariance of the parameters.
    pub(crate) covariance: DMatrix<f64>,
}

/// Minimises |r|^2 from `start`, until no parameter moves by more than the fraction `still` of its standard
/// deviation, in at most `steps` iterations. `None` if the start has no residuals, or if a parameter has no effect.
pub(crate) fn fit(problem: &impl Problem, start: &[f64], still: f64, steps: usize) -> Option<Fit> {
    let mut at = DVector::from_column_slice(start);
    let mut r = DVector::from_vec(problem.residuals(start)?);
    let mut lambda = 1e-3;
    let mut normal = Normal::at(problem, &at, &r)?;
    for _ in 0..steps {
        let Some(step) = normal.step(lambda) else {
            lambda *= 10.0;
            continue;
        };
        let next = &at + &step;
        let found = problem.residuals(next.as_slice()).map(DVector::from_vec);
        match found.filter(|found| found.norm_squared() <= r.norm_squared()) {
            Some(found) => {
                (at, r) = (next, found);
                let is_still = normal.is_still(&step, still);
                normal = Normal::at(problem, &at, &r)?;
                lambda = (lambda * 0.1).max(1e-12);
                if is_still {
                    break;
                }
            }
            None if lambda > LAMBDA_MAX || normal.is_still(&step, still) => break,
            None => lambda *= 10.0,
        }
    }
    let covariance = normal.squares.cholesky()?.inverse();
    Some(Fit { parameters: at.as_slice().to_vec(), chi2: r.norm_squared(), covariance })
}

/// J^T J and J^T r.
struct Normal {
    squares: DMatrix<f64>,
    gradient: DVector<f64>,
}

impl Normal {
    fn at(problem: &impl Problem, at: &DVector<f64>, r: &DVector<f64>) -> Option<Self> {
        let columns = problem.slopes(at.as_slice(), r.as_slice())?;
        let columns: Vec<DVector<f64>> = columns.into_iter().map(DVector::from_vec).collect();
        let jacobian = DMatrix::from_columns(&columns);
        let squares = jacobian.tr_mul(&jacobian);
        let gradient = jacobian.tr_mul(r);
        let is_usable = (0..at.len()).all(|i| squares[(i, i)].is_finite() && squares[(i, i)] > 0.0);
        is_usable.then_some(Self { squares, gradient })
    }

    fn step(&self, lambda: f64) -> Option<DVector<f64>> {
        let mut damped = self.squares.clone();
        for i in 0..damped.nrows() {
            damped[(i, i)] *= 1.0 + lambda;
        }
        Some(-damped.cholesky()?.solve(&self.gradient))
    }

    /// Whether a step moves every parameter by less than the fraction `still` of its standard deviation with the
    /// others held.
    fn is_still(&self, step: &DVector<f64>, still: f64) -> bool {
        step.iter().enumerate().all(|(i, step)| step.abs() * self.squares[(i, i)].sqrt() < still)
    }
}

/// The finite local minima of a scan, with their indices.
pub(crate) fn minima(along: &[f64]) -> impl Iterator<Item = (usize, f64)> + '_ {
    along.iter().copied().enumerate().filter(|&(i, here)| {
        let is_higher = |at: Option<usize>| at.and_then(|at| along.get(at)).is_none_or(|it| *it >= here);
        here.is_finite() && is_higher(i.checked_sub(1)) && is_higher(Some(i + 1))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Residuals with derivatives by small differences.
    struct Numeric<F>(F);

    impl<F: Fn(&[f64]) -> Option<Vec<f64>>> Problem for Numeric<F> {
        fn residuals(&self, at: &[f64]) -> Option<Vec<f64>> {
            self.0(at)
        }

        fn slopes(&self, at: &[f64], r: &[f64]) -> Option<Vec<Vec<f64>>> {
            let column = |i: usize| {
                let mut beside = at.to_vec();
                beside[i] += 1e-7;
                Some(slope(&self.0(&beside)?, r, 1e-7))
            };
            (0..at.len()).map(column).collect()
        }
    }

    fn fitted(start: &[f64], residuals: impl Fn(&[f64]) -> Option<Vec<f64>>) -> Option<Fit> {
        fit(&Numeric(residuals), start, 1e-6, STEPS_MAX)
    }

    #[test]
    fn a_line_has_the_textbooks_parameters_and_variances() {
        // y = a + b x at x = 0, 1, 2, 3 with variance 1.
        let y = [1.0, 2.5, 2.0, 4.5];
        let line = |p: &[f64]| Some((0..4).map(|x| p[0] + p[1] * f64::from(x) - y[x as usize]).collect());
        let found = fitted(&[0.0, 0.0], line).expect("a fit");
        assert!((found.parameters[0] - 1.0).abs() < 1e-6 && (found.parameters[1] - 1.0).abs() < 1e-6);
        assert!((found.chi2 - 1.5).abs() < 1e-9, "{}", found.chi2);
        // Variances sum x^2/(n sum x^2 - (sum x)^2) = 14/20 and n/20; covariance -6/20.
        let wanted = [[0.7, -0.3], [-0.3, 0.2]];
        for (i, row) in wanted.iter().enumerate() {
            for (j, wanted) in row.iter().enumerate() {
                assert!((found.covariance[(i, j)] - wanted).abs() < 1e-6, "{}", found.covariance);
            }
        }
    }

    #[test]
    fn the_valley_of_rosenbrock_is_followed_to_its_end() {
        let valley = |p: &[f64]| Some(vec![10.0 * (p[1] - p[0] * p[0]), 1.0 - p[0]]);
        let found = fitted(&[-1.2, 1.0], valley).expect("a fit");
        assert!((found.parameters[0] - 1.0).abs() < 1e-5 && (found.parameters[1] - 1.0).abs() < 1e-5);
    }

    #[test]
    fn a_parameter_without_effect_and_a_start_without_meaning_have_no_fit() {
        assert!(fitted(&[1.0, 1.0], |p| Some(vec![p[0], p[0] - 2.0])).is_none());
        assert!(fitted(&[1.0], |_| None).is_none());
    }

    #[test]
    fn a_step_beyond_what_has_a_meaning_is_not_taken() {
        let root = |p: &[f64]| (p[0] > 0.0).then(|| vec![p[0].ln()]);
        let found = fitted(&[8.0], root).expect("a fit");
        assert!((found.parameters[0] - 1.0).abs() < 1e-6);
    }
}
