//! The amplitude equation for many frequencies, eight at a time in vector registers.

use super::grid::{At, Grid};
use super::{Start, Swept, tail_start};
use crate::definition::plate::Plate;
use crate::frequency::axial::lossy_axial_squared;
use crate::frequency::driven_end::DrivenEnd;
use crate::frequency::medium::{Graded, InAir, LANES, Medium, Separable, Strip};
use crate::frequency::strip_grid::{self, StripGrid};
use crate::frequency::sweep::{Ends, Sweep};
use num_complex::Complex64;
use pulp::Arch;
use std::ops::Range;

/// Grid points whose eight values are copied to the eight fields together: 8 KiB, which fits in the first-level cache.
const STRETCH: usize = 64;

/// As [`super::solve`] for many frequencies, eight at a time; `visit` gets the index of each frequency and its field.
pub(crate) fn solve_each(
    grid: &Grid,
    plate: &Plate,
    frequencies_hz: &[f64],
    visit: impl FnMut(usize, &[Complex64]),
) {
    solve_each_apart(grid, plate, frequencies_hz, 1, visit);
}

/// As [`solve_each`], with the fields at the points of these parts of the plate alone: what lies between them is swept, but holds
/// nothing of the field.
pub(crate) fn solve_each_in(
    grid: &Grid,
    plate: &Plate,
    frequencies_hz: &[f64],
    parts: &[Range<usize>],
    visit: impl FnMut(usize, &[Complex64]),
) {
    solve_parts(grid, plate, frequencies_hz, (1, parts), visit);
}

/// As [`solve_each`], with the fields at each `every`-th (1 and more) point of the grid alone: what lies between them is
/// swept, but not scaled, and has no near field.
pub(crate) fn solve_each_apart(
    grid: &Grid,
    plate: &Plate,
    frequencies_hz: &[f64],
    every: usize,
    visit: impl FnMut(usize, &[Complex64]),
) {
    let whole = 0..grid.on_plate.div_ceil(every);
    solve_parts(grid, plate, frequencies_hz, (every, &[whole]), visit);
}

/// The fields at each `every`-th point of the grid, in `parts` of these points.
fn solve_parts(
    grid: &Grid,
    plate: &Plate,
    frequencies_hz: &[f64],
    (every, parts): (usize, &[Range<usize>]),
    mut visit: impl FnMut(usize, &[Complex64]),
) {
    let arch = Arch::new();
    let medium = Scaled::of(grid);
    let mut g_re = vec![[0.0; LANES]; grid.barrier.len()];
    let mut g_im = vec![[0.0; LANES]; grid.barrier.len()];
    let scale: Vec<f64> = grid.scale.iter().step_by(every).copied().collect();
    let mut fields = vec![vec![Complex64::ZERO; scale.len()]; LANES];
    for (group, frequencies) in frequencies_hz.chunks(LANES).enumerate() {
        #[cfg(test)]
        super::work::count(|work| work.sweeps += 1);
        // A last group that is not full repeats its last frequency.
        let frequency: [f64; LANES] =
            std::array::from_fn(|lane| frequencies[lane.min(frequencies.len() - 1)]);
        let at = frequency.map(|frequency_hz| grid.at(plate, frequency_hz));
        let tail = Tail::of(grid, &at);
        let rows = (&mut g_re[..], &mut g_im[..]);
        let ends = medium.sweep(arch, (plate, grid), frequency, &tail, rows);
        let driven = frequency.map(|frequency_hz| DrivenEnd::of(plate, frequency_hz));
        let starts: [Start; LANES] = std::array::from_fn(|lane| {
            let difference = Complex64::new(ends.difference_re[lane], ends.difference_im[lane]);
            let mut slope = difference / (2.0 * grid.step_m);
            let mut g = Complex64::new(ends.g_re[lane], ends.g_im[lane]);
            if grid.far_air.is_some() {
                let rows = g_re.iter().zip(&g_im);
                let wave = rows.map(|(re, im)| Complex64::new(re[lane], im[lane])).collect();
                let q = (0..=tail.start[lane].max(2)).map(|i| grid.q(at[lane], i)).collect();
                let swept = Swept { g: wave, q, slope }.with_far_air(grid, at[lane], frequency[lane]);
                for (i, value) in swept.g.iter().enumerate() {
                    (g_re[i][lane], g_im[i][lane]) = (value.re, value.im);
                }
                (g, slope) = (swept.g[1], swept.slope);
            }
            Start::of(&driven[lane], grid.root_slope(at[lane]), g, slope)
        });
        // The requested values move together; the next sweep writes every row again.
        if every > 1 {
            for place in 1..scale.len() {
                g_re[1 + place] = g_re[1 + place * every];
                g_im[1 + place] = g_im[1 + place * every];
            }
        }
        // A stretch of points at a time, so that all lanes read the same cache lines.
        let stretches =
            parts.iter().flat_map(|part| part.clone().step_by(STRETCH).map(|from| (from, part.end)));
        for (from, end) in stretches {
            let to = (from + STRETCH).min(end);
            for ((lane, field), start) in fields.iter_mut().enumerate().zip(&starts) {
                let rows = g_re[from + 1..=to].iter().zip(&g_im[from + 1..=to]).zip(&scale[from..to]);
                for (f, ((re, im), scale)) in field[from..to].iter_mut().zip(rows) {
                    *f = Complex64::new(re[lane], im[lane]) * start.gain * *scale;
                }
            }
        }
        for (lane, field) in fields.iter_mut().enumerate().take(frequencies.len()) {
            let start = &starts[lane];
            parts.iter().for_each(|part| at[lane].weigh(grid, field, every, part.clone()));
            driven[lane].near.add(field, every, &grid.scale, grid.step_m, start.value, start.slope);
            visit(group * LANES + lane, field);
        }
    }
}

/// The coefficients along the grid, times h^2/12.
enum Scaled<'g> {
    /// The barrier.
    Separable(Vec<f64>),
    /// The barrier and h0/h.
    Graded(Vec<f64>, Vec<f64>),
    Strip(&'g StripGrid, strip_grid::Scaled),
    /// (q/s)^2 as it is, 1 less the barrier, and h^2/12.
    Air(&'g [f64], Vec<f64>, f64),
}

impl<'g> Scaled<'g> {
    fn of(grid: &'g Grid) -> Self {
        let h2 = grid.step_m * grid.step_m / 12.0;
        let times = |values: &[f64]| -> Vec<f64> { values.iter().map(|value| value * h2).collect() };
        let barrier = times(&grid.barrier);
        match (&grid.strip, &grid.in_air) {
            (Some(strip), _) => Self::Strip(strip, strip.scaled(&barrier, h2)),
            (None, Some(width_square)) => {
                Self::Air(width_square, barrier.iter().map(|barrier| 1.0 - barrier).collect(), h2)
            }
            (None, None) if grid.local.is_empty() => Self::Separable(barrier),
            (None, None) => Self::Graded(barrier, times(&grid.local)),
        }
    }

    /// Sweeps eight frequencies, Hz.
    fn sweep(
        &self,
        arch: Arch,
        (plate, grid): (&Plate, &Grid),
        frequency: [f64; LANES],
        tail: &Tail,
        rows: (&mut [[f64; LANES]], &mut [[f64; LANES]]),
    ) -> Ends {
        let width_mode = plate.width_mode(1);
        let axial = || frequency.map(|frequency_hz| lossy_axial_squared(&width_mode, frequency_hz));
        match self {
            Self::Separable(barrier) => {
                let (axial, h2) = (axial(), grid.step_m * grid.step_m / 12.0);
                let medium = Separable {
                    barrier,
                    axial_re: axial.map(|axial| 1.0 + h2 * axial.re),
                    axial_im: axial.map(|axial| h2 * axial.im),
                };
                arch.dispatch(tail.sweep(medium, rows))
            }
            Self::Graded(barrier, local) => {
                let axial = axial();
                let medium = Graded {
                    barrier,
                    local,
                    axial_re: axial.map(|axial| axial.re),
                    axial_im: axial.map(|axial| axial.im),
                };
                arch.dispatch(tail.sweep(medium, rows))
            }
            Self::Strip(strip, scaled) => {
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
            Self::Air(width_square, rest, scale) => {
                let medium = InAir {
                    width_square,
                    rest,
                    scale: *scale,
                    loss: frequency.map(|frequency_hz| plate.stiffness_loss_at(frequency_hz)),
                    air: frequency.map(|frequency_hz| width_mode.air_or_uniform(frequency_hz)),
                };
                arch.dispatch(tail.sweep(medium, rows))
            }
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
