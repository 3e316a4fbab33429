//! The search for the best coordinates, under the ratio of two places and under plate and source together: a scan over wave
//! speed and loss, then Gauss and Newton's method from the lowest valleys to the bottom.

use super::acceptance::CHI2_PER_N_MAX;
use super::least_squares::{self, Fit, Problem, minima, slope};
use super::response::wave::{COARSE, FINE};
use super::unknowns::{OF_PLATE, of_plate, steps, with_speed};
use crate::definition::PlateSpec;
use crate::order;

/// Model error during the scan: it widens the valleys, so that fewer places must be tried, and beside a node little is to be
/// learnt as long as the plate is wrong.
pub(crate) const SCAN_ERROR: f64 = 0.2;
/// Most frequencies of the scan.
pub(crate) const SCAN_FREQUENCIES: usize = 60;
/// Way over which the derivative by a place is taken, metres.
pub(crate) const PLACE_STEP_M: f64 = 1e-7;
/// Loss factors over the file's that are tried.
const LOSSES: [f64; 3] = [0.5, 1.0, 2.2];
/// A bottom with no more chi^2 per number is that of the plate: the other valleys need not be followed.
const ENOUGH: f64 = 1.5;
/// When a fit ends, as a share of the standard deviations: among the valleys, and at last.
const STILL: (f64, f64) = (1e-2, 1e-5);

/// A problem whose first coordinates are the plate's.
pub(crate) trait Searched: Sized {
    /// Wave speeds that are tried first, and then, as the logarithm over the file's.
    const SPEEDS: &'static [(f64, f64)];
    /// Model errors from fit to fit on the way to the bottom of a valley. With each, the most chi^2 per number, beyond that of the noise
    /// alone, from which a fit of [`CHI2_PER_N_MAX`] may still be reached: others are left.
    const ERRORS: &'static [(f64, f64)];
    /// Most steps of each of these fits.
    const STEPS_MAX: usize;
    /// Whether every valley is followed, because another plate may fit nearly as well.
    const ALL: bool;

    /// The plate of the file.
    fn nominal(&self) -> &PlateSpec;
    /// Number of data, for chi^2 per number.
    fn count(&self) -> f64;
    /// chi^2 per number that noise alone leaves with this model error: where an answer is noise, none hides it.
    fn of_noise(&self, model_error: f64) -> f64;
    /// Starts in the lowest valleys of a scan over these speeds.
    fn starts(&self, speeds: (f64, f64)) -> Vec<Vec<Vec<f64>>>;
    /// The residuals on a grid of `radians`; see [`Problem::residuals`].
    fn residuals(&self, at: &[f64], radians: f64, model_error: f64) -> Option<Vec<f64>>;
    /// The columns of J by the coordinates after the plate's.
    fn columns(&self, at: &[f64], radians: f64, model_error: f64) -> Option<Vec<Vec<f64>>>;

    /// Number of the plate's coordinates.
    fn of_plate(&self) -> usize {
        of_plate(self.nominal())
    }

    /// The bottom of the lowest valley, and the bottoms of all valleys that were followed; first of all that of `known`, a
    /// place that is known to be near a bottom.
    fn lowest(&self, known: Option<&[f64]>) -> Option<(Fit, Vec<Fit>)> {
        let mut bottoms: Vec<Fit> = known.and_then(|known| self.bottom(known)).into_iter().collect();
        if let Some(bottom) = bottoms.first().filter(|bottom| !Self::ALL && self.is_below(bottom, ENOUGH)) {
            return Some((bottom.clone(), bottoms));
        }
        'scans: for &speeds in Self::SPEEDS {
            for starts in self.starts(speeds) {
                for bottom in starts.iter().filter_map(|start| self.bottom(start)) {
                    let is_enough = self.is_below(&bottom, ENOUGH);
                    bottoms.push(bottom);
                    if is_enough && Self::ALL {
                        break;
                    }
                    if is_enough {
                        break 'scans;
                    }
                }
            }
            if bottoms.iter().any(|bottom| self.is_below(bottom, CHI2_PER_N_MAX)) {
                break;
            }
        }
        let best = bottoms.iter().min_by(|a, b| a.chi2.total_cmp(&b.chi2))?.clone();
        Some((best, bottoms))
    }

    /// The bottom of the valley that begins at `start`.
    fn bottom(&self, start: &[f64]) -> Option<Fit> {
        let mut found: Option<Fit> = None;
        for &(model_error, most) in Self::ERRORS {
            let from = found.as_ref().map_or(start, |found| &found.parameters);
            let problem = OnGrid { searched: self, radians: COARSE, model_error };
            let fit = least_squares::fit(&problem, from, STILL.0, Self::STEPS_MAX);
            found = Some(fit.filter(|fit| self.is_below(fit, most + self.of_noise(model_error)))?);
        }
        found
    }

    /// The bottom on the fine grid with the last model error.
    fn refined(&self, from: &Fit) -> Option<Fit> {
        let (model_error, _) = *Self::ERRORS.last()?;
        let problem = OnGrid { searched: self, radians: FINE, model_error };
        least_squares::fit(&problem, &from.parameters, STILL.1, least_squares::STEPS_MAX)
    }

    fn is_below(&self, fit: &Fit, chi2_per_n: f64) -> bool {
        fit.chi2 <= chi2_per_n * self.count()
    }
}

/// A problem on a grid of a given fineness.
struct OnGrid<'s, S> {
    searched: &'s S,
    radians: f64,
    model_error: f64,
}

impl<S: Searched> Problem for OnGrid<'_, S> {
    fn residuals(&self, at: &[f64]) -> Option<Vec<f64>> {
        self.searched.residuals(at, self.radians, self.model_error)
    }

    fn slopes(&self, at: &[f64], r: &[f64]) -> Option<Vec<Vec<f64>>> {
        let of_plate = steps(self.searched.nominal()).into_iter().enumerate().map(|(i, step)| {
            let above = self.residuals(&beside(at, i, step))?;
            if self.radians > FINE {
                return Some(slope(&above, r, step));
            }
            // Changes of speed, width and places nearly cancel each other, which magnifies the error of a one-sided
            // difference to 2e-3 of the interval.
            Some(slope(&above, &self.residuals(&beside(at, i, -step))?, 2.0 * step))
        });
        let mut columns: Vec<Vec<f64>> = of_plate.collect::<Option<_>>()?;
        columns.extend(self.searched.columns(at, self.radians, self.model_error)?);
        Some(columns)
    }
}

/// The coordinates `at` with one of them moved.
fn beside(at: &[f64], i: usize, step: f64) -> Vec<f64> {
    let mut beside = at.to_vec();
    beside[i] += step;
    beside
}

/// The column of J by coordinate `i`, from the residuals above (0) and below (1).
pub(crate) fn column(
    at: &[f64],
    i: usize,
    step: f64,
    residuals: impl Fn(&[f64], usize) -> Vec<f64>,
) -> Vec<f64> {
    let [above, below] = [residuals(&beside(at, i, step), 0), residuals(&beside(at, i, -step), 1)];
    slope(&above, &below, 2.0 * step)
}

/// The minima of chi^2 over wave speed and loss from `slowest` to `fastest`, the lowest first, and the step of the speed. The
/// phase of the wave changes by at most `radians` of `turns` in one step.
pub(crate) fn scan(
    (slowest, fastest): (f64, f64),
    turns: f64,
    radians: f64,
    chi2: impl Fn([f64; OF_PLATE]) -> Option<f64>,
) -> (Vec<(f64, [f64; 2])>, f64) {
    let count = ((fastest - slowest) * turns.max(1.0) / radians).ceil();
    let speed = |i: usize| slowest + (fastest - slowest) * i as f64 / count;
    let mut found = Vec::new();
    for loss in LOSSES.map(f64::ln) {
        let chi2 = |i: usize| chi2(with_speed(speed(i), loss)).unwrap_or(f64::INFINITY);
        let along: Vec<f64> = (0..=count as usize).map(chi2).collect();
        found.extend(minima(&along).map(|(i, here)| (here, [speed(i), loss])));
    }
    order::sort_by(&mut found, |a, b| a.0.total_cmp(&b.0));
    (found, (fastest - slowest) / count)
}
