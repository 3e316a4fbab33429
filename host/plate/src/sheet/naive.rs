//! A reference implementation of the sheet's steps as plain loops over rows of cells. Every memory layout, tiling,
//! vector width and number of threads must give the same bits.

use super::contact::{Load, TouchedCells};
use super::fdtd::FdtdGrid;
use super::kernel::Weights;
use super::tiling::{Cells, Column, ColumnPoint, plan_at};
use super::vector::Width;
use crate::fused::Fused;
use proptest::prelude::*;

/// Steps between two flushes of denormal numbers, as in the grid.
const FLUSH_EVERY: u64 = 64;

/// An FDTD grid as plain loops: station 0 of a row is the driven column.
struct Naive {
    case: Case,
    now: Vec<Vec<f32>>,
    past: Vec<Vec<f32>>,
    maximum: Vec<Vec<f32>>,
    squares: Vec<Vec<f64>>,
    steps: u64,
}

impl Naive {
    fn new(case: Case) -> Self {
        let wide = case.reach.iter().copied().max().unwrap_or(0) + 2;
        let blank = vec![vec![0.0; wide]; case.reach.len()];
        let squares = vec![vec![0.0; wide]; case.reach.len()];
        Self { case, now: blank.clone(), past: blank.clone(), maximum: blank, squares, steps: 0 }
    }

    /// As [`FdtdGrid::release`].
    fn release(&mut self, shape: impl Fn(usize, usize) -> f32) {
        for (row, &reach) in self.case.reach.iter().enumerate() {
            for cell in 0..reach {
                self.now[row][cell + 1] = shape(cell, row);
                self.past[row][cell + 1] = shape(cell, row);
            }
        }
    }

    fn step(&mut self, drive: f32) {
        let (case, weights) = (&self.case, self.case.weights);
        let (rows, zero) = (case.reach.len(), vec![0.0; self.now[0].len()]);
        let mut next = vec![zero.clone(); rows];
        for (row, next) in next.iter_mut().enumerate() {
            let line = |row: usize| self.now.get(row).unwrap_or(&zero);
            let above = match row {
                0 if case.mirrored => line(1),
                0 => &zero,
                _ => line(row - 1),
            };
            let (below, v) = (line(row + 1), line(row));
            let mut past = self.past[row].clone();
            for station in 1..=case.reach[row] {
                let load = case.load(row, station - 1);
                let more = ((load.mass - load.loss) / (1.0 - case.loss)) as f32;
                let now = (2.0 * load.mass / (1.0 - case.loss)) as f32;
                if load != Load::default() {
                    past[station] = (past[station] + more * past[station]) - now * v[station];
                }
                let across = above[station] + below[station];
                let rest = if weights.past == 1.0 {
                    weights.across.fused(across, -past[station])
                } else {
                    (-weights.past).fused(past[station], weights.across * across)
                };
                let others = weights.along.fused(v[station - 1] + v[station + 1], rest);
                next[station] = case.own[row][station - 1].fused(v[station], others);
                let inertia = 1.0 + case.loss;
                next[station] *= (inertia / (inertia + load.mass + load.loss)) as f32;
            }
            if let Some(column) = &case.column {
                let point = column.points[row];
                next[0] = (point.own * v[0] - point.past * past[0])
                    + (point.inward * v[1] + point.across * (above[0] + below[0]))
                    + point.profile * drive;
            }
            for (station, value) in next.iter().enumerate().take(case.reach[row] + 1) {
                self.maximum[row][station] = self.maximum[row][station].max(value.abs());
                self.squares[row][station] += f64::from(*value) * f64::from(*value);
            }
        }
        self.past = std::mem::replace(&mut self.now, next);
        self.steps += 1;
        if self.steps.is_multiple_of(FLUSH_EVERY) {
            let vanishing = |value: &&mut f32| value.abs() < 1e-30;
            self.now
                .iter_mut()
                .chain(&mut self.past)
                .flatten()
                .filter(vanishing)
                .for_each(|value| *value = 0.0);
        }
    }

    fn assert_equals(&self, fdtd: &FdtdGrid) {
        for (row, &reach) in self.case.reach.iter().enumerate() {
            let bits = |numbers: &mut dyn Iterator<Item = f32>| -> Vec<u32> {
                // Both zeros (+0 and -0) are the same displacement.
                numbers.map(|value| (value + 0.0).to_bits()).collect()
            };
            let expected = |field: &[Vec<f32>]| bits(&mut field[row][..=reach].iter().copied());
            assert_eq!(bits(&mut fdtd.row(row)), expected(&self.now), "newest field, row {row}");
            assert_eq!(
                bits(&mut fdtd.row_before(row).numbers()),
                expected(&self.past),
                "field before, row {row}"
            );
            let Some(recorded) = fdtd.envelope(row) else { panic!("row {row} is recorded") };
            let (maximum, squares): (Vec<f32>, Vec<f64>) = recorded.unzip();
            assert_eq!(bits(&mut maximum.into_iter()), expected(&self.maximum), "maximum, row {row}");
            assert_eq!(squares.len(), reach + 1);
            for (got, want) in squares.iter().zip(&self.squares[row]) {
                // Squares below the smallest normal number are not accurate.
                assert!((got - want).abs() <= 1e-5 * want + 1e-37, "squares, row {row}: {got} {want}");
            }
        }
    }
}

/// The cells and weights of a test grid.
#[derive(Debug, Clone)]
struct Case {
    reach: Vec<usize>,
    plain: Vec<usize>,
    own: Vec<Vec<f32>>,
    mirrored: bool,
    weights: Weights,
    /// r dt/2.
    loss: f64,
    column: Option<Column>,
    is_touched: bool,
}

/// A pseudo-random number from 0 to 1 for each `place` and `purpose`.
fn scattered(place: usize, purpose: usize) -> f32 {
    let mixed = (place as u32).wrapping_mul(2_654_435_761) ^ (purpose as u32).wrapping_mul(0x9e37_79b9);
    (mixed.wrapping_mul(0x85eb_ca6b) >> 8) as f32 / (1 << 24) as f32
}

impl Case {
    /// `rows` rows: the longest has `cells` cells, and the others become shorter, the outermost by `taper` (0 to 1) of
    /// it.
    fn new(
        cells: usize,
        rows: usize,
        taper: f64,
        [mirrored, is_lossy, is_driven, is_touched]: [bool; 4],
    ) -> Self {
        let middle = if mirrored { 0 } else { rows / 2 };
        let reach_of = |row: usize| cells as f64 * (1.0 - taper * row.abs_diff(middle) as f64 / rows as f64);
        let reach: Vec<usize> = (0..rows).map(|row| reach_of(row) as usize).collect();
        let loss = if is_lossy { 0.01 } else { 0.0 };
        let divisor = 1.0 + loss as f32;
        let weights = Weights {
            own: (2.0 - 2.0 * 0.21 - 2.0 * 0.17) / divisor,
            past: (1.0 - loss as f32) / divisor,
            along: 0.21 / divisor,
            across: 0.17 / divisor,
        };
        let plain: Vec<usize> =
            reach.iter().enumerate().map(|(row, &reach)| reach.saturating_sub(row % 40)).collect();
        let own_at = |row: usize, cell: usize| {
            if cell < plain[row] { weights.own } else { weights.own - 0.3 * scattered(row * 4096 + cell, 0) }
        };
        let own = (0..rows).map(|row| (0..reach[row]).map(|cell| own_at(row, cell)).collect()).collect();
        let point = |row: usize| ColumnPoint {
            own: 0.5 + 0.5 * scattered(row, 1),
            past: 0.4,
            inward: 0.1,
            across: 0.05,
            profile: scattered(row, 2),
        };
        let column = is_driven.then(|| Column { points: (0..rows).map(point).collect() });
        Self { reach, plain, own, mirrored, weights, loss, column, is_touched }
    }

    /// Load of a finger on a cell: mass and loss of 1e-4 to 100 on a tenth of the cells, none on the others.
    fn load(&self, row: usize, cell: usize) -> Load {
        let number = row * 4096 + cell;
        if !self.is_touched || scattered(number, 6) > 0.1 {
            return Load::default();
        }
        let size = |purpose: usize| 10f64.powf(6.0 * f64::from(scattered(number, purpose)) - 4.0);
        Load { mass: size(7), loss: size(8) }
    }

    fn fdtd(&self, tiling: (usize, usize), threads: usize, width: Width) -> FdtdGrid {
        let cells = Cells { reach: &self.reach, plain: &self.plain, own: &self.own, mirrored: self.mirrored };
        let mut plan = plan_at(tiling, cells, self.weights, self.column.clone(), 0..self.reach.len());
        let load = |row: usize, cell: usize| self.load(row, cell);
        plan.touched = self.is_touched.then(|| TouchedCells::new(&self.reach, self.loss, load));
        let mut fdtd = FdtdGrid::new(plan, threads);
        fdtd.use_width(width);
        fdtd
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 120, ..ProptestConfig::default() })]

    #[test]
    fn any_grid_equals_the_plain_loops_to_the_bit(
        cells in prop_oneof![1usize..20, 60usize..70, 120usize..200, 250usize..265],
        spare_rows in 0usize..9,
        (bands, group, depth) in (1usize..5, prop_oneof![Just(2), Just(4)], prop_oneof![Just(1), Just(4), Just(8), Just(16)]),
        taper in 0.0..1.0,
        flags in any::<[bool; 4]>(),
        width in 0usize..3,
        scale in prop_oneof![Just(1.0f32), Just(1e-29)],
        calls in prop::collection::vec(0usize..80, 1..5),
    ) {
        let rows = bands * (2 * depth + 2) + spare_rows;
        let case = Case::new(cells, rows, taper, flags);
        let widths = Width::all();
        let mut fdtd = case.fdtd((group, depth), bands, widths[width % widths.len()]);
        prop_assert_eq!(fdtd.threads(), bands);
        let start = |cell: usize, row: usize| scale * (scattered(row * 4096 + cell, 3) - 0.5);
        fdtd.release(start);
        let mut naive = Naive::new(case);
        naive.release(start);
        let mut sent = 0;
        for steps in calls {
            let drive: Vec<f32> = (sent..sent + steps).map(|n| scale * (scattered(n, 4) - 0.5)).collect();
            sent += steps;
            fdtd.advance(&drive);
            drive.iter().for_each(|&drive| naive.step(drive));
            naive.assert_equals(&fdtd);
        }
    }
}

#[test]
fn a_rectangle_equals_the_plain_loops_at_every_tiling_it_chooses() {
    // Sizes near the limits of lines, chunks and caches, with the resulting tiling and number of bands.
    for (cells, rows, threads, tiling, bands) in [
        (1, 1, 1, (4, 16), 1),
        (64, 70, 2, (4, 16), 2),
        (65, 40, 2, (4, 8), 2),
        (128, 32, 2, (4, 8), 1),
        (300, 40, 3, (2, 4), 3),
        (700, 110, 3, (2, 16), 3),
    ] {
        let mut fdtd = FdtdGrid::rectangle(cells, rows, 0.25, threads);
        assert_eq!((fdtd.plan().group, fdtd.depth()), tiling, "{cells} x {rows}");
        assert_eq!(fdtd.threads(), bands, "{cells} x {rows}");
        let start = |cell: usize, row: usize| scattered(row * 4096 + cell, 5) - 0.5;
        fdtd.release(start);
        fdtd.advance(&[0.0; 150]);
        let weights = Weights { own: 1.0, past: 1.0, along: 0.25, across: 0.25 };
        let own = vec![vec![1.0; cells]; rows];
        let reach = vec![cells; rows];
        let case = Case {
            reach: reach.clone(),
            plain: reach,
            own,
            mirrored: false,
            weights,
            loss: 0.0,
            column: None,
            is_touched: false,
        };
        let mut naive = Naive::new(case);
        naive.release(start);
        (0..150).for_each(|_| naive.step(0.0));
        for row in 0..rows {
            assert!(
                fdtd.row(row).eq(naive.now[row][..=cells].iter().copied()),
                "{cells} x {rows}: row {row}"
            );
        }
    }
}

#[test]
fn a_band_that_panics_ends_the_call_instead_of_hanging_it() {
    let mut case = Case::new(64, 60, 0.0, [false, false, true, false]);
    if let Some(column) = &mut case.column {
        // A deliberate bug: the band in the middle has no driven points for its rows.
        column.points.truncate(30);
    }
    let mut fdtd = case.fdtd((2, 4), 3, Width::detect());
    assert_eq!(fdtd.threads(), 3);
    let ended = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| fdtd.advance(&[0.0; 100])));
    assert!(ended.is_err());
}
