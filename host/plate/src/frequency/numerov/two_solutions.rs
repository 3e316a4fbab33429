//! Both solutions of the amplitude equation at one frequency, which compose the response to a force at any place.

use super::Swept;
use super::grid::{At, Grid};
use crate::definition::plate::Plate;
use crate::frequency::driven_end::DrivenEnd;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Two solutions of the equation at one frequency, in any scale, at the grid points on the plate. The response to a
/// force anywhere on the plate is composed of them.
pub(crate) struct TwoSolutions {
    pub(crate) step_m: f64,
    /// The one that meets the driven end's condition with the drive at rest; zero beyond the requested place.
    pub(crate) left: Vec<Complex64>,
    /// The one that decays beyond the turning point.
    pub(crate) right: Vec<Complex64>,
    /// Value and derivative (1/m) at x = 0 of `left` and of `right`.
    pub(crate) starts: [[Complex64; 2]; 2],
    /// left right' - left' right at the driven end, 1/m; S times it is the same everywhere.
    pub(crate) wronskian: Complex64,
    /// sqrt(S at 0 / S), with S of (S p')' + S k^2 p = -force per length.
    pub(crate) weight: Vec<Complex64>,
    /// S at the driven end, N: T W of a membrane, 2 K^2 D W of a supported plate. NaN if the plate file does not state it.
    pub(crate) stiffness_n: Complex64,
}

/// As [`super::solve`], and the two solutions, the left one as far as `to_m`.
pub(crate) fn solve_with_both(
    grid: &Grid,
    plate: &Plate,
    frequency_hz: f64,
    to_m: f64,
) -> (Vec<Complex64>, TwoSolutions) {
    let at = grid.at(plate, frequency_hz);
    let swept = Swept::of(grid, at);
    let end = DrivenEnd::of(plate, frequency_hz);
    let field = swept.clone().with_far_air(grid, at, frequency_hz).field(grid, at, &end);

    let mut weight: Vec<Complex64> = grid.scale.iter().map(|scale| Complex64::from(*scale)).collect();
    at.weigh(grid, &mut weight, 1, 0..grid.on_plate);
    let weighed = |g: &[Complex64]| g.iter().zip(&weight).map(|(g, weight)| g * weight).collect();
    let right: Vec<Complex64> = weighed(&swept.g[1..=grid.on_plate]);

    // alpha p(0) + beta p'(0) = 0, with p = g/sqrt(w/w0).
    let root_slope = grid.root_slope(at);
    let size = end.alpha.norm().max(end.beta.norm() / grid.step_m);
    let value = -end.beta / (size * grid.step_m);
    let slope = end.alpha / (size * grid.step_m) + root_slope * value;
    let starts = [[value, slope], [swept.g[1], swept.slope]].map(|[g, slope]| [g, slope - root_slope * g]);
    let last = (to_m / grid.step_m).ceil() as usize + 4;
    let left = weighed(&forward(grid, &swept.q, at, value, slope, last.min(grid.on_plate - 1)));

    // S k = omega Z, and S is proportional to 1/K^2 with loss. A force on the plate also moves its air: S holds the air's
    // share of the wave's power.
    let wavenumber = plate.width_mode(1).wavenumber_squared(0.0, frequency_hz).sqrt();
    // Along a membrane its weight holds that share, from none at the end on.
    let dilution = if grid.in_air.is_some() { 1.0 } else { plate.dilution(frequency_hz) };
    let impedance = plate.wave_impedance_n_s_per_m(frequency_hz).unwrap_or(f64::NAN);
    let stiffness_n = TAU * frequency_hz * impedance / wavenumber / dilution / plate.lossy(frequency_hz);
    let wronskian = value * swept.slope - slope * swept.g[1];
    (field, TwoSolutions { step_m: grid.step_m, left, right, starts, wronskian, weight, stiffness_n })
}

/// g at the points on the plate from its value and slope at 0, as far as point `last`; zero beyond it.
fn forward(
    grid: &Grid,
    q: &[Complex64],
    at: At<'_>,
    value: Complex64,
    slope: Complex64,
    last: usize,
) -> Vec<Complex64> {
    let h2 = grid.step_m * grid.step_m / 12.0;
    let p = |i: usize| 1.0 + h2 * q.get(i).copied().unwrap_or_else(|| grid.q(at, i));
    let middle = value * p(1);
    // y at points -1 and 1: their sum by Numerov's scheme, and the difference of 2 y - y/p by the slope (see `Swept`).
    let sum = (12.0 / p(1) - 10.0) * middle;
    let (before, after) = (2.0 - p(0).inv(), 2.0 - p(2).inv());
    let first = (2.0 * grid.step_m * slope + before * sum) / (before + after);
    let mut g = vec![Complex64::ZERO; grid.on_plate];
    let (mut y, mut previous) = (first, middle);
    g[0] = value;
    for (i, g) in g.iter_mut().enumerate().take(last + 1).skip(1) {
        let here = p(i + 1);
        *g = y / here;
        let next = (12.0 / here - 10.0) * y - previous;
        previous = y;
        y = next;
    }
    g
}
