//! The grid of the sheet and the order in which it is advanced: rows, wavefront, bands for threads.
//!
//! ```text
//!            driven column     cells 0, 1, 2, ..  (x grows)
//!  row 0     |d|o o o o o o o o o o o o o o o o|      mirrored at the centre line, or one edge of a whole sheet
//!  row 1     |d|o o o o o o o o o o o o e e e e|
//!  row 2     |d|o o o o o o o e e e e e|. . . .|      e: cells beside the edge, with a weight of their own
//!  row 3     |d|o o e e e e e|. . . . . . . . .|      .: outside, always zero
//! ```
//!
//! Two arrays hold the field at two times; a step overwrites the older one. Within a block of [`Lattice::depth`]
//! steps row r takes step s + 1 as soon as row r + 1 has taken step s (a wavefront), so a row is advanced many
//! times while it is in the cache. With more threads each owns a band of rows and, for each block, also computes a
//! shrinking halo of its neighbours' rows; then the bands exchange halos. Whichever thread computes a cell does
//! the same arithmetic, so the result does not depend on the number of threads, to the bit.

use super::band::Band;
use super::exchange::Exchange;
use super::kernel::Weights;
use super::plan::{Plan, plan_of};
use super::row::Row;
use super::vector::LANES;
use std::ops::Range;

/// Steps after which vanishing numbers are set to zero; blocks never cross a multiple of it.
const HUSH_EVERY: u64 = 64;
/// A field on a grid of rows that is advanced by the 5-point leapfrog scheme.
#[derive(Debug)]
pub struct Lattice {
    plan: Plan,
    bands: Vec<Band>,
    steps: u64,
    /// Whether the newest field is in the bands' second array.
    flipped: bool,
}

impl Lattice {
    /// A rectangle of `cells` x `rows` between fixed edges, without loss, at rest: the benchmark's problem.
    ///
    /// `courant_squared` is (c dt/h)^2, stable up to 0.5; `threads` from 1. The update is
    /// v+ = 2 v - v- + courant_squared (left + right + above + below - 4 v).
    pub fn rectangle(cells: usize, rows: usize, courant_squared: f32, threads: usize) -> Self {
        let weights = Weights {
            own: 2.0 - 4.0 * courant_squared,
            past: 1.0,
            along: courant_squared,
            across: courant_squared,
        };
        let own = vec![vec![weights.own; cells]; rows];
        let plan = plan_of(&vec![cells; rows], &vec![cells; rows], &own, false, weights, None, 0..0);
        Self::new(plan, threads)
    }

    pub(super) fn new(plan: Plan, threads: usize) -> Self {
        let bands = cut(&plan.reach, threads, plan.depth)
            .into_iter()
            .map(|owned| Band::new(&plan, owned, plan.depth))
            .collect();
        Self { plan, bands, steps: 0, flipped: false }
    }

    /// Steps per block.
    pub fn depth(&self) -> usize {
        self.plan.depth
    }

    /// Threads that are used.
    pub fn threads(&self) -> usize {
        self.bands.len()
    }

    /// Steps taken since the start.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    pub(super) fn plan(&self) -> &Plan {
        &self.plan
    }

    /// One step for each number of `drive`, which goes to the driven column (a rectangle has none).
    pub fn advance(&mut self, drive: &[f32]) {
        if drive.is_empty() {
            return;
        }
        let exchange = Exchange::new(self.bands.len());
        let (plan, depth, start, flipped) = (&self.plan, self.plan.depth, self.steps, self.flipped);
        if let Some((first, others)) = self.bands.split_first_mut() {
            std::thread::scope(|scope| {
                for (number, band) in others.iter_mut().enumerate() {
                    let exchange = &exchange;
                    scope.spawn(move || {
                        run(band, number + 1, plan, depth, drive, (start, flipped), exchange);
                    });
                }
                run(first, 0, plan, depth, drive, (start, flipped), &exchange);
            });
        }
        self.steps += drive.len() as u64;
        self.flipped ^= drive.len() % 2 == 1;
    }

    /// The newest field along `row`: the driven column, then the cells that are inside.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn row(&self, row: usize) -> impl Iterator<Item = f32> {
        self.newest(row).numbers()
    }

    /// As [`Lattice::row`], by station.
    pub(super) fn newest(&self, row: usize) -> Row<'_> {
        self.band_of(row).row(&self.plan, row, self.flipped)
    }

    /// The field one step before [`Lattice::row`].
    pub(super) fn row_before(&self, row: usize) -> Row<'_> {
        self.band_of(row).row(&self.plan, row, !self.flipped)
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.plan.rows()
    }

    /// Sets the newest field and the one before it from a shape `v(cell, row)`: a sheet let go from rest.
    pub fn release(&mut self, shape: impl Fn(usize, usize) -> f32) {
        for band in &mut self.bands {
            band.release(&self.plan, &shape);
        }
    }

    /// Largest magnitude and sum of squares of each cell of a recorded row (as [`Lattice::row`] is laid out).
    pub(super) fn envelope(&self, row: usize) -> Option<(Row<'_>, Row<'_, f64>)> {
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

/// Runs one band through all steps, exchanging halos after each block.
fn run(
    band: &mut Band,
    number: usize,
    plan: &Plan,
    depth: usize,
    drive: &[f32],
    (start, mut flipped): (u64, bool),
    exchange: &Exchange,
) {
    let mut done = 0;
    let mut meeting = exchange.meeting();
    while done < drive.len() {
        let to_hush = HUSH_EVERY - (start + done as u64) % HUSH_EVERY;
        let count = depth.min(drive.len() - done).min(to_hush as usize);
        band.block(plan, &drive[done..done + count], flipped);
        flipped ^= count % 2 == 1;
        done += count;
        if (start + done as u64).is_multiple_of(HUSH_EVERY) {
            band.hush(plan);
        }
        exchange.halos(band, number, depth, &mut meeting);
    }
}

/// Cuts the rows into bands of about equal work, none thinner than `depth` rows.
fn cut(reach: &[usize], threads: usize, depth: usize) -> Vec<Range<usize>> {
    let rows = reach.len();
    let bands = threads.clamp(1, (rows / depth).max(1));
    let work: usize = reach.iter().map(|cells| cells + LANES).sum();
    let mut edges = vec![0];
    let (mut row, mut sum) = (0, 0);
    for band in 1..bands {
        while row < rows && sum * bands < work * band {
            sum += reach[row] + LANES;
            row += 1;
        }
        // Leave enough rows for the bands on either side.
        let least = edges[band - 1] + depth;
        let most = rows - depth * (bands - band);
        edges.push(row.clamp(least, most));
    }
    edges.push(rows);
    edges.windows(2).map(|pair| pair[0]..pair[1]).collect()
}
