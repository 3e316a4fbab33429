//! Solves the amplitude equation on a grid by Numerov's method, of fourth order.
//!
//! With g = sqrt(W) f the equation f'' + (W'/W) f' + k^2 f = 0 becomes g'' + Q g = 0 with
//! Q = k^2 - (sqrt W)''/sqrt W (the paper's equation is g = f, Q = k^2). Between clamped edges k^2 = s/W^2 follows the
//! strip's exact law, and f = g/sqrt(W Omega) carries its power weight Omega. The derivatives of Omega do not enter Q:
//! against two-dimensional solutions with |W'| up to 0.1 the antinodes are right to 0.1 dB without them, and their places
//! three to ten times better than with them. (The paper's equation keeps the law near the cut-off.) Numerov's scheme for y = (1 + h^2 Q/12) g is
//! `y[i-1] = U[i] y[i] - y[i+1]`, U = 12/(1 + h^2 Q/12) - 10, with an error of h^4.
//!
//! Where the thickness changes, S = W h^2 takes the place of W and k^2 has h0/h of a K^2 (see `definition/thickness.rs`). On a
//! membrane in air K and Omega change along it (`definition/air_along.rs`); the derivatives of Omega are left out there, too, and
//! what a baffle adds follows as a correction (`far_air.rs`).
//!
//! The recursion runs from far beyond the turning point, where only the decaying solution is possible, toward the
//! driven end. In that direction the wanted solution grows, so the recursion is stable and needs no matrix. The
//! condition at the driven end then gives the scale; its derivative is of fourth order, too.

mod breaks;
mod grid;
mod together;
mod two_solutions;
#[cfg(test)]
pub(crate) mod work;

pub(crate) use grid::Grid;
pub(crate) use together::{solve_each, solve_each_apart, solve_each_in};
pub(crate) use two_solutions::{TwoSolutions, solve_with_both};

use crate::definition::plate::Plate;
use crate::frequency::driven_end::DrivenEnd;
use crate::frequency::far_air::OnGrid;
use grid::At;
use num_complex::Complex64;

/// Most points of a refined grid. A plate that would need more has a tail so steep that its error is invisible.
const GRID_POINTS_MAX: usize = 400_000;
/// Exponents of decay after which the tail is set to zero: e^-60 is negligible.
const TAIL_EXPONENTS: f64 = 60.0;
/// Points from one to the next at which the decay is added up. As it grows along the tail, this adds up too little: the
/// sweep begins a few points further on.
const TAIL_STRIDE: usize = 8;

/// The factor by which the grid must be finer than `step_m` for an error of about 1e-9 at `frequency_hz`.
pub(crate) fn refinement(plate: &Plate, frequency_hz: f64, step_m: f64) -> usize {
    refinement_for(plate, frequency_hz, step_m, 1e-9)
}

/// As [`refinement`], for an error of about `error`.
pub(crate) fn refinement_for(plate: &Plate, frequency_hz: f64, step_m: f64, error: f64) -> usize {
    let width_mode = plate.width_mode(1);
    let wavenumber = width_mode.wavenumber_squared(0.0, frequency_hz).max(0.0).sqrt();
    let kappa = plate.kappa_per_m(frequency_hz).unwrap_or(0.0);
    // Numerov's phase error is (kh)^4/480 per radian. The steepest decay on the plate counts with half of its rate.
    let phase = width_mode.phase_to(plate.length_m(), frequency_hz).max(1.0);
    let tail = (-width_mode.wavenumber_squared(plate.length_m(), frequency_hz)).max(0.0).sqrt();
    // Where the plate grows thinner, the wave may be shortest before its turning point.
    let shortest = if plate.is_graded() { shortest_between(plate, frequency_hz) } else { wavenumber };
    let steepest = shortest.max(kappa).max(0.5 * tail);
    let wanted = (480.0 * error / phase).sqrt().sqrt() / steepest.max(1e-9);
    let most = (GRID_POINTS_MAX as f64 * step_m / plate.length_m()).max(1.0);
    (step_m / wanted).ceil().clamp(1.0, most) as usize
}

/// The largest k of some places on the plate, 1/m.
fn shortest_between(plate: &Plate, frequency_hz: f64) -> f64 {
    let width_mode = plate.width_mode(1);
    let places = (0..=32).map(|i| plate.length_m() * f64::from(i) / 32.0);
    places.map(|x| width_mode.wavenumber_squared(x, frequency_hz).max(0.0).sqrt()).fold(0.0, f64::max)
}

/// f at the grid points on the plate, relative to the drive.
pub(crate) fn solve(grid: &Grid, plate: &Plate, frequency_hz: f64) -> Vec<Complex64> {
    let at = grid.at(plate, frequency_hz);
    let swept = Swept::of(grid, at).with_far_air(grid, at, frequency_hz);
    swept.field(grid, at, &DrivenEnd::of(plate, frequency_hz))
}

/// The solution of a sweep from beyond the turning point to the driven end, in any scale.
#[derive(Clone)]
struct Swept {
    /// g at the points of the grid; point -1 has the index 0.
    g: Vec<Complex64>,
    /// Q at the same points, as far as the sweep began and at least at the first three.
    q: Vec<Complex64>,
    /// g'(0), 1/m.
    slope: Complex64,
}

impl Swept {
    fn of(grid: &Grid, at: At<'_>) -> Self {
        #[cfg(test)]
        work::count(|work| work.single += 1);
        let h2 = grid.step_m * grid.step_m / 12.0;
        let start = tail_start(grid, at);
        let q: Vec<Complex64> = (0..=start.max(2)).map(|i| grid.q(at, i)).collect();
        // Index i of `grid.barrier` is grid point i - 1; `y` uses the same index.
        let mut y = vec![Complex64::ZERO; grid.barrier.len()];
        let decay = (-q[start]).sqrt() * grid.step_m;
        y[start] = Complex64::new(1e-30, 0.0);
        let mut next = y[start] * (-decay).exp();
        for i in (1..=start).rev() {
            let u = 12.0 / (1.0 + h2 * q[i]) - 10.0;
            let before = u * y[i] - next;
            next = y[i];
            y[i - 1] = before;
        }
        // From y to g. Then the derivative at the driven end, of fourth order, because g''' = -(Q g)'.
        for (value, q) in y.iter_mut().zip(&q).take(start + 1) {
            *value /= 1.0 + h2 * q;
        }
        let side = |i: usize| y[i] * (1.0 + 2.0 * h2 * q[i]);
        let slope = (side(2) - side(0)) / (2.0 * grid.step_m);
        Self { g: y, q, slope }
    }

    /// The same with the air at a distance.
    fn with_far_air(mut self, grid: &Grid, at: At<'_>, frequency_hz: f64) -> Self {
        if let (Some(far_air), At::Air(width_square, air, _)) = (&grid.far_air, at) {
            let wave = OnGrid { g: &mut self.g, q: &self.q, width_square, scale: &grid.scale };
            self.slope += far_air.add(&air, frequency_hz, wave);
        }
        self
    }

    /// f on the plate: scaled to meet the driven end's condition, with its near field.
    fn field(&self, grid: &Grid, at: At<'_>, end: &DrivenEnd) -> Vec<Complex64> {
        let start = Start::of(end, grid.root_slope(at), self.g[1], self.slope);
        let on_plate = self.g[1..=grid.on_plate].iter().zip(&grid.scale);
        let mut field: Vec<Complex64> = on_plate.map(|(g, scale)| g * start.gain * *scale).collect();
        at.weigh(grid, &mut field, 1, 0..grid.on_plate);
        end.near.add(&mut field, 1, &grid.scale, grid.step_m, start.value, start.slope);
        field
    }
}

/// The wave at the driven end, scaled to meet the condition there.
struct Start {
    /// The factor by which the swept solution is scaled.
    gain: Complex64,
    /// p(0) and p'(0).
    value: Complex64,
    slope: Complex64,
}

impl Start {
    /// Scales a solution with `g` and g' = `slope` at 0; `root_slope` is that of [`Grid::root_slope`].
    fn of(end: &DrivenEnd, root_slope: Complex64, g: Complex64, slope: Complex64) -> Self {
        // p = g/sqrt(w/w0): p(0) = g, p'(0) = g' - (sqrt w)'/sqrt w g.
        let gain = end.drive / (end.beta * slope + (end.alpha - end.beta * root_slope) * g);
        Self { gain, value: gain * g, slope: gain * (slope - root_slope * g) }
    }
}

/// Index at which the recursion may begin: so far beyond the turning point that the amplitude there is below e^-60.
fn tail_start(grid: &Grid, at: At<'_>) -> usize {
    let last = grid.barrier.len() - 1;
    let mut exponents = 0.0;
    let apart_m = TAIL_STRIDE as f64 * grid.step_m;
    // Only the tail needs square roots. Over the whole grid they would take as long as the recursion.
    for i in (grid.turn(at).max(1)..last).step_by(TAIL_STRIDE) {
        exponents += (-grid.q(at, i).re).max(0.0).sqrt() * apart_m;
        if exponents > TAIL_EXPONENTS {
            return i;
        }
    }
    last
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definition::model::Model;
    use crate::definition::presets::presets;
    use crate::frequency::equation::Equation;

    /// Every preset, and the bending ones between clamped edges, some with much loss.
    fn plates() -> Vec<Plate> {
        let clamped = |plate: &Plate| {
            let mut spec = plate.spec().clone();
            spec.model = Model::BendingClamped(spec.model.bending()?.clone());
            (spec.span_start_m, spec.span_end_m) = (0.1, 0.24);
            spec.loss_factor *= 10.0;
            Plate::new(spec).ok()
        };
        let all: Vec<Plate> = presets().iter().map(|preset| preset.plate().expect("a preset")).collect();
        let clamped: Vec<Plate> = all.iter().filter_map(clamped).collect();
        assert!(!clamped.is_empty());
        all.into_iter().chain(clamped).collect()
    }

    #[test]
    fn eight_frequencies_at_once_are_the_same_as_one_at_a_time() {
        for plate in plates() {
            let (low, high) = plate.band_hz();
            let grid = Grid::new(&plate, Equation::Corrected, 301, 2);
            // Eleven frequencies: one whole group and a part of one, far apart in their tails.
            let frequencies: Vec<f64> = (0..11).map(|i| low + (high - low) * f64::from(i) / 10.0).collect();
            let mut seen = 0;
            solve_each(&grid, &plate, &frequencies, |number, field| {
                assert_eq!(number, seen);
                seen += 1;
                for (a, b) in field.iter().zip(solve(&grid, &plate, frequencies[number])) {
                    assert!((a - b).norm() < 1e-9 * b.norm().max(1e-3), "{} {number}", plate.name());
                }
            });
            assert_eq!(seen, 11);
        }
    }

    #[test]
    fn fields_at_points_apart_match_all_points() {
        for plate in plates() {
            let (low, high) = plate.band_hz();
            // A multiple of the spacing between whose points a request for all points interpolates a near field.
            let every = 32;
            let grid = Grid::new(&plate, Equation::Corrected, 301, every);
            let frequencies: Vec<f64> = (0..11).map(|i| low + (high - low) * f64::from(i) / 10.0).collect();
            let mut all = Vec::new();
            solve_each(&grid, &plate, &frequencies, |_, field| all.push(field.to_vec()));
            let mut seen = 0;
            solve_each_apart(&grid, &plate, &frequencies, every, |number, field| {
                seen += 1;
                assert_eq!(field.len(), 301);
                let largest = field.iter().map(|f| f.norm()).fold(0.0, f64::max);
                for (a, b) in field.iter().zip(all[number].iter().step_by(every)) {
                    assert!((a - b).norm() < 2e-7 * largest, "{} {number}: {a} for {b}", plate.name());
                }
            });
            assert_eq!(seen, 11);
        }
    }
}
