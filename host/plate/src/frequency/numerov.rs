//! Solves the amplitude equation on a grid by Numerov's method, of fourth order.
//!
//! With g = sqrt(W) f the equation f'' + (W'/W) f' + k^2 f = 0 becomes g'' + Q g = 0 with
//! Q = k^2 - (sqrt W)''/sqrt W (the paper's equation is g = f, Q = k^2). Between clamped edges k^2 = s/W^2 follows the
//! strip's exact law, and f = g/sqrt(W Omega) carries its power weight Omega. The derivatives of Omega do not enter Q:
//! against two-dimensional solutions with |W'| up to 0.1 the antinodes are right to 0.1 dB without them, and their places
//! three to ten times better than with them. (The paper's equation keeps the law near the cut-off.) Numerov's scheme for y = (1 + h^2 Q/12) g is
//! `y[i-1] = U[i] y[i] - y[i+1]`, U = 12/(1 + h^2 Q/12) - 10, with an error of h^4.
//!
//! Where the thickness changes, S = W h^2 takes the place of W and k^2 has h0/h of a K^2 (see `definition/thickness.rs`).
//!
//! The recursion runs from far beyond the turning point, where only the decaying solution is possible, toward the
//! driven end. In that direction the wanted solution grows, so the recursion is stable and needs no matrix. The
//! condition at the driven end then gives the scale; its derivative is of fourth order, too.

mod two_solutions;
#[cfg(test)]
pub(crate) mod work;

use crate::definition::plate::Plate;
use crate::definition::strip_table::StripTable;
use crate::frequency::axial::lossy_axial_squared;
use crate::frequency::driven_end::DrivenEnd;
use crate::frequency::equation::Equation;
use crate::frequency::strip_grid::StripGrid;
use crate::frequency::sweep::{Graded, LANES, Medium, Separable, Strip, Sweep};
use num_complex::Complex64;
use pulp::Arch;
use std::sync::Arc;

pub(crate) use two_solutions::{TwoSolutions, solve_with_both};

/// Most points of a refined grid. A plate that would need more has a tail so steep that its error is invisible.
const GRID_POINTS_MAX: usize = 400_000;
/// Exponents of decay after which the tail is set to zero: e^-60 is negligible.
const TAIL_EXPONENTS: f64 = 60.0;
/// Points from one to the next at which the decay is added up. As it grows along the tail, this adds up too little: the
/// sweep begins a few points further on.
const TAIL_STRIDE: usize = 8;
/// Exponents of decay over which the taper is continued beyond the plate's end, so that the condition at the end of the
/// grid has no effect.
const BEYOND_EXPONENTS: f64 = 14.0;

/// The frequency-independent part of the problem: one plate, one width mode, one equation, one grid.
#[derive(Debug, Clone)]
pub(crate) struct Grid {
    step_m: f64,
    /// Points on the plate (from 0 to its end).
    on_plate: usize,
    /// a (q/s)^2 + (sqrt W)''/sqrt W less the term of bent edges, at the grid points -1, 0, 1, ..; point i has the index
    /// i + 1. It continues beyond the plate's end. With the strip's law only the last two.
    barrier: Vec<f64>,
    /// Whether the barrier rises from point to point, as on most plates.
    is_rising: bool,
    /// a K^2 at each index of the barrier over that at the driven end: h0/h. Empty where the thickness is the same everywhere.
    local: Vec<f64>,
    /// 1/sqrt(W/W0) on the plate, with S for W where the thickness changes (1 for the paper's equation).
    scale: Vec<f64>,
    /// (sqrt W)'/sqrt W at 0, or that of S (0 for the paper's equation).
    root_slope: f64,
    mode: u32,
    /// The law of the clamped strip, where it takes the place of a K^2 (1 + j eta) - a (q/W)^2.
    strip: Option<StripGrid>,
}

/// A grid's equation at one frequency.
#[derive(Clone, Copy)]
enum At<'g> {
    /// a K^2 (1 + j eta), from which the barrier is taken.
    Separable(Complex64),
    /// The same at the driven end, and over the barrier what it is elsewhere over that.
    Graded(Complex64, &'g [f64]),
    /// The law of the strip, and ln K^2 without loss.
    Strip(&'g StripGrid, f64),
}

impl Grid {
    pub(crate) fn new(
        plate: &Plate,
        mode: u32,
        equation: Equation,
        points: usize,
        refinement: usize,
    ) -> Self {
        let law = plate.width_mode(mode).strip.filter(|_| equation == Equation::Corrected);
        Self::with_law(plate, mode, equation, points, refinement, law)
    }

    /// As [`Grid::new`] with `Equation::Corrected`, but between clamped edges with the tangent of the strip's law at the
    /// cut-off, to which a figure compares that law.
    pub(crate) fn tangent(plate: &Plate, mode: u32, points: usize, refinement: usize) -> Self {
        Self::with_law(plate, mode, Equation::Corrected, points, refinement, None)
    }

    fn with_law(
        plate: &Plate,
        mode: u32,
        equation: Equation,
        points: usize,
        refinement: usize,
        law: Option<&Arc<StripTable>>,
    ) -> Self {
        #[cfg(test)]
        work::count(|work| work.grids += 1);
        let width_mode = plate.width_mode(mode);
        let on_plate = (points - 1) * refinement + 1;
        let step_m = plate.length_m() / (on_plate - 1) as f64;
        let barrier_at = |x: f64| match equation {
            Equation::Corrected => {
                let across = if law.is_some() { 0.0 } else { width_mode.width_term(x) };
                across + plate.weight_at(x).root_curvature() - plate.edge_bend(x).term
            }
            Equation::Paper => width_mode.width_term(x),
        };
        let mut barrier: Vec<f64> = Vec::with_capacity(on_plate + 64);
        barrier.push(barrier_at(-step_m));
        barrier.extend((0..on_plate).map(|i| barrier_at(i as f64 * step_m)));
        // Of all waves that turn on the plate, the one that turns at its end decays slowest beyond it.
        let end_term = width_mode.width_term(plate.length_m());
        let end_hz = width_mode.cut_off_hz(plate.length_m());
        let (mut exponents, mut i) = (0.0, on_plate);
        while exponents < BEYOND_EXPONENTS && barrier.len() < 4 * on_plate + 64 {
            let x = i as f64 * step_m;
            if x > 0.98 * plate.width.reach_m() {
                break;
            }
            let decay = match law {
                Some(_) => -width_mode.wavenumber_squared(x, end_hz),
                None if plate.is_graded() => -width_mode.wavenumber_squared(x, end_hz),
                None => width_mode.width_term(x) - end_term,
            };
            exponents += decay.max(0.0).sqrt() * step_m;
            barrier.push(barrier_at(x));
            i += 1;
        }
        let log_width = plate.weight_at(0.0);
        let (scale, root_slope) = match equation {
            Equation::Corrected => (
                (0..on_plate)
                    .map(|i| (0.5 * (log_width.value - plate.weight_at(i as f64 * step_m).value)).exp())
                    .collect(),
                0.5 * log_width.slope,
            ),
            Equation::Paper => (vec![1.0; on_plate], 0.0),
        };
        let is_rising = barrier.is_sorted();
        let local = if plate.is_graded() {
            (0..barrier.len()).map(|index| width_mode.local((index as f64 - 1.0) * step_m)).collect()
        } else {
            Vec::new()
        };
        let strip = law.map(|law| StripGrid::new(&width_mode, law, step_m, barrier.len()));
        Self { step_m, on_plate, barrier, is_rising, local, scale, root_slope, mode, strip }
    }

    fn at(&self, plate: &Plate, frequency_hz: f64) -> At<'_> {
        let axial = || lossy_axial_squared(&plate.width_mode(self.mode), frequency_hz);
        match &self.strip {
            Some(strip) => At::Strip(strip, plate.wavenumber_squared(frequency_hz).ln()),
            None if self.local.is_empty() => At::Separable(axial()),
            None => At::Graded(axial(), &self.local),
        }
    }

    /// Q at the index `i` of the barrier.
    fn q(&self, at: At<'_>, i: usize) -> Complex64 {
        match at {
            At::Separable(axial) => axial - self.barrier[i],
            At::Graded(axial, local) => axial * local[i] - self.barrier[i],
            At::Strip(strip, log_wavenumber) => strip.wavenumber_squared(i, log_wavenumber) - self.barrier[i],
        }
    }

    /// The first index at which Q may be negative.
    fn turn(&self, at: At<'_>) -> usize {
        match at {
            At::Separable(axial) if self.is_rising => {
                self.barrier.partition_point(|&barrier| barrier <= axial.re)
            }
            At::Separable(_) | At::Graded(..) => 1,
            At::Strip(strip, log_wavenumber) => strip.turn(log_wavenumber),
        }
    }

    /// (sqrt w)'/sqrt w at 0, 1/m, with w = W, or W Omega by the strip's law.
    fn root_slope(&self, at: At<'_>) -> Complex64 {
        match at {
            At::Separable(_) | At::Graded(..) => Complex64::from(self.root_slope),
            At::Strip(strip, log_wavenumber) => self.root_slope + strip.weight_slope(log_wavenumber),
        }
    }
}

impl At<'_> {
    /// Multiplies a field g/sqrt W at each `every`-th point on the plate by what the power weight of the strip's law adds,
    /// 1 at 0.
    fn weigh(self, field: &mut [Complex64], every: usize) {
        if let At::Strip(strip, log_wavenumber) = self {
            strip.weigh(log_wavenumber, field, every);
        }
    }
}

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
    let swept = Swept::of(grid, at);
    swept.field(grid, at, &DrivenEnd::of(plate, frequency_hz))
}

/// The solution of a sweep from beyond the turning point to the driven end, in any scale.
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

    /// f on the plate: scaled to meet the driven end's condition, with its near field.
    fn field(&self, grid: &Grid, at: At<'_>, end: &DrivenEnd) -> Vec<Complex64> {
        let start = Start::of(end, grid.root_slope(at), self.g[1], self.slope);
        let on_plate = self.g[1..=grid.on_plate].iter().zip(&grid.scale);
        let mut field: Vec<Complex64> = on_plate.map(|(g, scale)| g * start.gain * *scale).collect();
        at.weigh(&mut field, 1);
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

/// Grid points whose eight values are copied to the eight fields together: 8 KiB, which fits in the first-level cache.
const STRETCH: usize = 64;

/// As [`solve`] for many frequencies, eight at a time; `visit` gets the index of each frequency and its field.
pub(crate) fn solve_each(
    grid: &Grid,
    plate: &Plate,
    frequencies_hz: &[f64],
    visit: impl FnMut(usize, &[Complex64]),
) {
    solve_each_apart(grid, plate, frequencies_hz, 1, visit);
}

/// As [`solve_each`], with the fields at each `every`-th (1 and more) point of the grid alone: what lies between them is
/// swept, but not scaled, and has no near field.
pub(crate) fn solve_each_apart(
    grid: &Grid,
    plate: &Plate,
    frequencies_hz: &[f64],
    every: usize,
    mut visit: impl FnMut(usize, &[Complex64]),
) {
    let arch = Arch::new();
    let width_mode = plate.width_mode(grid.mode);
    let h2 = grid.step_m * grid.step_m / 12.0;
    let barrier: Vec<f64> = grid.barrier.iter().map(|barrier| barrier * h2).collect();
    let strip = grid.strip.as_ref().map(|strip| (strip, strip.scaled(&barrier, h2)));
    let local: Vec<f64> = grid.local.iter().map(|local| local * h2).collect();
    let mut g_re = vec![[0.0; LANES]; barrier.len()];
    let mut g_im = vec![[0.0; LANES]; barrier.len()];
    let scale: Vec<f64> = grid.scale.iter().step_by(every).copied().collect();
    let mut fields = vec![vec![Complex64::ZERO; scale.len()]; LANES];
    for (group, frequencies) in frequencies_hz.chunks(LANES).enumerate() {
        #[cfg(test)]
        work::count(|work| work.sweeps += 1);
        // A last group that is not full repeats its last frequency.
        let frequency: [f64; LANES] =
            std::array::from_fn(|lane| frequencies[lane.min(frequencies.len() - 1)]);
        let at = frequency.map(|frequency_hz| grid.at(plate, frequency_hz));
        let tail = Tail::of(grid, &at);
        let rows = (&mut g_re[..], &mut g_im[..]);
        let ends = match &strip {
            None if !local.is_empty() => {
                let axial = frequency.map(|frequency_hz| lossy_axial_squared(&width_mode, frequency_hz));
                let medium = Graded {
                    barrier: &barrier,
                    local: &local,
                    axial_re: axial.map(|axial| axial.re),
                    axial_im: axial.map(|axial| axial.im),
                };
                arch.dispatch(tail.sweep(medium, rows))
            }
            None => {
                let axial = frequency.map(|frequency_hz| lossy_axial_squared(&width_mode, frequency_hz));
                let medium = Separable {
                    barrier: &barrier,
                    axial_re: axial.map(|axial| 1.0 + h2 * axial.re),
                    axial_im: axial.map(|axial| h2 * axial.im),
                };
                arch.dispatch(tail.sweep(medium, rows))
            }
            Some((strip, scaled)) => {
                let squared = |frequency_hz: f64| plate.wavenumber_squared(frequency_hz);
                let medium = Strip {
                    law: &strip.law,
                    log_square: &strip.log_square,
                    inverse_square: &scaled.inverse_square,
                    rest: &scaled.rest,
                    log_wavenumber: frequency.map(|frequency_hz| squared(frequency_hz).ln()),
                };
                arch.dispatch(tail.sweep(medium, rows))
            }
        };
        let driven = frequency.map(|frequency_hz| DrivenEnd::of(plate, frequency_hz));
        let starts: [Start; LANES] = std::array::from_fn(|lane| {
            let g = Complex64::new(ends.g_re[lane], ends.g_im[lane]);
            let difference = Complex64::new(ends.difference_re[lane], ends.difference_im[lane]);
            Start::of(&driven[lane], grid.root_slope(at[lane]), g, difference / (2.0 * grid.step_m))
        });
        // What was asked for moves together; the next sweep writes every row anew.
        if every > 1 {
            for place in 1..scale.len() {
                g_re[1 + place] = g_re[1 + place * every];
                g_im[1 + place] = g_im[1 + place * every];
            }
        }
        // A stretch of points at a time, so that all lanes read the same cache lines.
        for from in (0..scale.len()).step_by(STRETCH) {
            let to = (from + STRETCH).min(scale.len());
            for ((lane, field), start) in fields.iter_mut().enumerate().zip(&starts) {
                let rows = g_re[from + 1..=to].iter().zip(&g_im[from + 1..=to]).zip(&scale[from..to]);
                for (f, ((re, im), scale)) in field[from..to].iter_mut().zip(rows) {
                    *f = Complex64::new(re[lane], im[lane]) * start.gain * *scale;
                }
            }
        }
        for (lane, field) in fields.iter_mut().enumerate().take(frequencies.len()) {
            let start = &starts[lane];
            at[lane].weigh(field, every);
            driven[lane].near.add(field, every, &grid.scale, grid.step_m, start.value, start.slope);
            visit(group * LANES + lane, field);
        }
    }
}

/// Where the sweeps of eight frequencies begin, and the ratio of their first two values.
struct Tail {
    start: [usize; LANES],
    ratio: [Complex64; LANES],
}

impl Tail {
    fn of(grid: &Grid, at: &[At<'_>; LANES]) -> Self {
        let start = at.map(|at| tail_start(grid, at));
        let ratio = std::array::from_fn(|lane| {
            let q = grid.q(at[lane], start[lane]);
            (-(-q).sqrt() * grid.step_m).exp()
        });
        Self { start, ratio }
    }

    fn sweep<'a, M: Medium>(
        &self,
        medium: M,
        (g_re, g_im): (&'a mut [[f64; LANES]], &'a mut [[f64; LANES]]),
    ) -> Sweep<'a, M> {
        Sweep {
            medium,
            start: self.start,
            ratio_re: self.ratio.map(|ratio| ratio.re),
            ratio_im: self.ratio.map(|ratio| ratio.im),
            g_re,
            g_im,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definition::model::Model;
    use crate::definition::presets::presets;

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
            let grid = Grid::new(&plate, 1, Equation::Corrected, 301, 2);
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
    fn fields_at_points_apart_are_those_of_all_points() {
        for plate in plates() {
            let (low, high) = plate.band_hz();
            // A multiple of the points between which a near field's logarithm goes linearly where all are asked for.
            let every = 32;
            let grid = Grid::new(&plate, 1, Equation::Corrected, 301, every);
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
