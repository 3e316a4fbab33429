//! FDTD on the grid of the sheet: rows of cells, advanced by leapfrog in time-skewed blocks; one band of rows per
//! thread.
//!
//! ```text
//!            driven column     cells 0, 1, 2, ..  (x grows)
//!  row 0     |d|o o o o o o o o o o o o o o o o|      mirrored at the centre line, or one edge of a whole sheet
//!  row 1     |d|o o o o o o o o o o o o e e e e|
//!  row 2     |d|o o o o o o o e e e e e|. . . .|      e: cells beside the edge, with a weight of their own
//!  row 3     |d|o o e e e e e|. . . . . . . . .|      .: outside, always zero
//! ```
//!
//! Two arrays hold the field at two times; a step overwrites the older one. Within a block of [`FdtdGrid::depth`] steps
//! a group of rows takes step s + 1 as soon as the next group has taken step s (a wavefront), so a row is advanced many
//! times while it is in the cache. With several threads, each owns a band of rows; the boundaries between the bands
//! move up and down with the blocks (time skewing, see [`super::block`]). The arithmetic for a cell is the same on
//! every thread, so the bits of the result do not depend on the number of threads.

use super::band::Band;
use super::block::Skew;
use super::halo::HaloExchange;
use super::kernel::Weights;
use super::row::Row;
use super::tiling::{Cells, Plan, plan_of};
use super::vector::LANES;
use std::ops::Range;
use std::sync::Mutex;
use std::thread::Builder;

/// Steps between two flushes of denormal numbers to zero; blocks never cross a multiple of it.
const FLUSH_EVERY: u64 = 64;

/// A field on a grid of rows that is advanced by the 5-point leapfrog scheme.
#[derive(Debug)]
pub struct FdtdGrid {
    plan: Plan,
    bands: Vec<Band>,
    clock: Clock,
}

impl FdtdGrid {
    /// A rectangle of `cells` x `rows` between fixed edges, without loss, at rest: the grid of the benchmark.
    ///
    /// `cells`, `rows` and `threads` are at least 1 (0 counts as 1); `courant_squared` is (c dt/h)^2, and up to 0.5 the
    /// scheme is stable. The update is v+ = 2 v - v- + courant_squared (left + right + above + below - 4 v).
    pub fn rectangle(cells: usize, rows: usize, courant_squared: f32, threads: usize) -> Self {
        let weights = Weights {
            own: 2.0 - 4.0 * courant_squared,
            past: 1.0,
            along: courant_squared,
            across: courant_squared,
        };
        let (cells, rows) = (cells.max(1), rows.max(1));
        let own = vec![vec![weights.own; cells]; rows];
        let reach = vec![cells; rows];
        let cells = Cells { reach: &reach, plain: &reach, own: &own, mirrored: false };
        let plan = plan_of(cells, weights, None, 0..0);
        Self::new(plan, threads)
    }

    pub(super) fn new(plan: Plan, threads: usize) -> Self {
        // There are no threads in a browser.
        let threads = if cfg!(target_family = "wasm") { 1 } else { threads };
        let fitting = cut(&plan.reach, threads, plan.depth).len();
        let threads = startable(fitting);
        let cuts = cut(&plan.reach, threads, plan.depth);
        let count = cuts.len();
        let bands = cuts.into_iter().enumerate().map(|(number, rows)| Band::new(&plan, rows, number, count));
        Self { bands: bands.collect(), plan, clock: Clock::default() }
    }

    /// Steps per block.
    pub fn depth(&self) -> usize {
        self.plan.depth
    }

    /// Number of threads that are used: at most as many as were asked for, and fewer if the grid has few rows.
    pub fn threads(&self) -> usize {
        self.bands.len()
    }

    /// Steps taken since the start.
    pub fn steps(&self) -> u64 {
        self.clock.steps
    }

    /// Goes on with other weights on the same cells.
    pub(super) fn reweigh(&mut self, plan: Plan) {
        self.plan = plan;
    }

    pub(super) fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Advances the field by one step for each number of `drive`, the source of the driven column. A rectangle has no
    /// driven column and ignores the numbers.
    ///
    /// # Panics
    /// If the system cannot start as many threads as when the grid was made. The grid cannot be used after that.
    #[cfg_attr(
        not(test),
        expect(
            clippy::disallowed_methods,
            reason = "threads are started for two and more bands only; on wasm there is one"
        )
    )]
    pub fn advance(&mut self, drive: &[f32]) {
        if drive.is_empty() {
            return;
        }
        let exchange = HaloExchange::new(self.bands.len());
        let (plan, clock) = (&self.plan, self.clock);
        if let Some((first, others)) = self.bands.split_first_mut() {
            std::thread::scope(|scope| {
                // Releases the other bands if the first one panics or a thread cannot be started.
                let _guard = exchange.guard();
                for band in others {
                    let exchange = &exchange;
                    scope.spawn(move || {
                        let _guard = exchange.guard();
                        run(band, plan, drive, clock, exchange);
                    });
                }
                self.clock = run(first, plan, drive, clock, &exchange);
            });
        }
    }

    /// The newest field along `row`: the driven column, then the cells inside the plate.
    ///
    /// # Panics
    /// If `row` is not below [`FdtdGrid::rows`].
    pub fn row(&self, row: usize) -> impl Iterator<Item = f32> {
        self.newest(row).numbers()
    }

    /// As [`FdtdGrid::row`], for access by station.
    pub(super) fn newest(&self, row: usize) -> Row<'_> {
        self.band_of(row).row(&self.plan, row, self.clock.flipped)
    }

    /// The field one step before [`FdtdGrid::row`].
    #[cfg(test)]
    pub(super) fn row_before(&self, row: usize) -> Row<'_> {
        self.band_of(row).row(&self.plan, row, !self.clock.flipped)
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.plan.rows()
    }

    /// Sets the newest field and the one before it to `shape(cell, row)`: a sheet released from rest.
    pub fn release(&mut self, shape: impl Fn(usize, usize) -> f32) {
        for band in &mut self.bands {
            band.release(&self.plan, &shape);
        }
    }

    /// Largest magnitude and sum of squares of each cell of `row`, in the order of [`FdtdGrid::row`]; `None` if the row
    /// is not recorded.
    pub(super) fn envelope(&self, row: usize) -> Option<impl Iterator<Item = (f32, f64)>> {
        self.band_of(row).envelope(&self.plan, row)
    }

    pub(super) fn reset_envelope(&mut self) {
        for band in &mut self.bands {
            band.reset_envelope();
        }
    }

    #[cfg(test)]
    pub(super) fn use_width(&mut self, width: super::vector::Width) {
        self.plan.width = width;
    }

    fn band_of(&self, row: usize) -> &Band {
        let band = self.bands.partition_point(|band| band.owned.end <= row);
        &self.bands[band]
    }
}

/// The time of the grid.
#[derive(Debug, Clone, Copy, Default)]
struct Clock {
    steps: u64,
    /// Whether the newest field is in the bands' second array.
    flipped: bool,
    /// Number of rows by which the boundaries between bands are shifted up now: 0 to the depth.
    shift: usize,
}

impl Clock {
    /// The next block if `left` steps remain: its number of steps and the direction of the boundaries.
    fn block(self, left: usize, depth: usize) -> (usize, Skew) {
        let to_flush = (FLUSH_EVERY - self.steps % FLUSH_EVERY) as usize;
        let steps = left.min(depth).min(to_flush);
        if self.shift == 0 { (steps, Skew::Rising) } else { (steps.min(self.shift), Skew::Falling) }
    }

    fn pass(&mut self, steps: usize, skew: Skew) {
        self.steps += steps as u64;
        self.flipped ^= steps % 2 == 1;
        match skew {
            Skew::Rising => self.shift += steps,
            Skew::Falling => self.shift -= steps,
        }
    }
}

/// Advances one band by all steps of `drive`, from the time `clock` to the time that it returns.
fn run(band: &mut Band, plan: &Plan, drive: &[f32], mut clock: Clock, exchange: &HaloExchange) -> Clock {
    let mut rest = drive;
    while !rest.is_empty() {
        let (steps, skew) = clock.block(rest.len(), plan.depth);
        let (now, later) = rest.split_at(steps);
        band.block(plan, now, clock.flipped, skew, exchange);
        clock.pass(steps, skew);
        if clock.steps.is_multiple_of(FLUSH_EVERY) {
            band.flush(plan);
        }
        rest = later;
    }
    clock
}

/// How many of these threads the system runs at once; the caller's is one of them.
#[cfg_attr(
    not(test),
    expect(
        clippy::disallowed_methods,
        reason = "threads are started for two and more bands only; on wasm there is one"
    )
)]
fn startable(wanted: usize) -> usize {
    let gate = Mutex::new(());
    std::thread::scope(|scope| {
        let shut = gate.lock();
        let wait = || drop(gate.lock());
        let started = (1..wanted).take_while(|_| Builder::new().spawn_scoped(scope, wait).is_ok()).count();
        drop(shut);
        1 + started
    })
}

/// Divides the rows into bands of about equal work, for blocks of `depth` steps. A band needs `depth` + 2 rows; with
/// 2 `depth` + 2 rows it can send its halo before it has received one.
fn cut(reach: &[usize], threads: usize, depth: usize) -> Vec<Range<usize>> {
    let (rows, fewest) = (reach.len(), 2 * depth + 2);
    let bands = threads.clamp(1, (rows / fewest).max(1));
    let work: usize = reach.iter().map(|cells| cells + LANES).sum();
    let mut edges = vec![0];
    let (mut row, mut sum) = (0, 0);
    for band in 1..bands {
        while row < rows && sum * bands < work * band {
            sum += reach[row] + LANES;
            row += 1;
        }
        // The boundary is shifted up by `depth` rows half of the time. Leave enough rows for the bands on both sides.
        let least = edges[band - 1] + fewest;
        let most = rows - fewest * (bands - band);
        edges.push((row + depth / 2).clamp(least, most));
    }
    edges.push(rows);
    edges.windows(2).map(|pair| pair[0]..pair[1]).collect()
}
