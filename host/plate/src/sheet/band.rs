//! One thread's share of a lattice: its rows, a halo of the neighbours' rows, and the wavefront over them.

use super::kernel::{self, Around, LANES};
use super::lattice::Plan;
use std::ops::Range;

/// Numbers in a cache line.
const LINE: usize = 16;

/// The rows `owned`, with up to `depth` rows of halo on either side.
#[derive(Debug)]
pub(super) struct Band {
    pub(super) owned: Range<usize>,
    /// All rows that are stored: `owned` and the halos.
    stored: Range<usize>,
    stride: usize,
    first: Field,
    second: Field,
    record: Record,
}

/// The field at one time, in memory that starts on a cache line.
#[derive(Debug)]
struct Field {
    numbers: Vec<f32>,
    start: usize,
}

impl Field {
    fn new(count: usize) -> Self {
        let numbers = vec![0.0; count + LINE];
        let start = numbers.as_ptr().align_offset(LINE * size_of::<f32>()).min(LINE);
        Self { numbers, start }
    }

    fn all(&self) -> &[f32] {
        &self.numbers[self.start..]
    }

    fn all_mut(&mut self) -> &mut [f32] {
        &mut self.numbers[self.start..]
    }
}

/// Envelope of the rows in `rows`, each `stride` numbers, laid out as the field is.
#[derive(Debug)]
struct Record {
    rows: Range<usize>,
    maximum: Vec<f32>,
    squares: Vec<f64>,
}

impl Band {
    pub(super) fn new(plan: &Plan, owned: Range<usize>, depth: usize) -> Self {
        let stored = owned.start.saturating_sub(depth)..(owned.end + depth).min(plan.rows());
        // A row of zeros before and after: the edge's outer side, or what the outermost halo row leans on.
        let count = (stored.len() + 2) * plan.stride;
        let rows = plan.recorded.start.max(owned.start)..plan.recorded.end.min(owned.end);
        let recorded = rows.len() * plan.stride;
        let record = Record { rows, maximum: vec![0.0; recorded], squares: vec![0.0; recorded] };
        Self {
            owned,
            stored,
            stride: plan.stride,
            first: Field::new(count),
            second: Field::new(count),
            record,
        }
    }

    /// Where cell 0 of `row` is.
    fn cell_zero(&self, row: usize) -> usize {
        (row + 1 - self.stored.start) * self.stride + LANES
    }

    /// Advances the owned rows by one step for each number of `drive`.
    ///
    /// Row r takes step s + 1 soon after row r + 1 took step s. Rows of the halo are computed only as far as the
    /// owned rows still depend on them.
    pub(super) fn block(&mut self, plan: &Plan, drive: &[f32], flipped: bool) {
        let steps = drive.len();
        let (mut ranges, last_row) = (Vec::with_capacity(steps), self.stored.end);
        for step in 0..steps {
            let halo = steps - 1 - step;
            let from = self.owned.start.saturating_sub(halo).max(self.stored.start);
            ranges.push(from..(self.owned.end + halo).min(last_row));
        }
        // In pairs: the update of two neighbouring rows shares half of its reading.
        for front in self.stored.start / 2..last_row.div_ceil(2) + steps {
            for (step, rows) in ranges.iter().enumerate() {
                let Some(pair) = front.checked_sub(step) else { break };
                let (upper, lower) = (2 * pair, 2 * pair + 1);
                let flipped = flipped ^ (step % 2 == 1);
                let mut from = 0;
                if rows.contains(&upper) && rows.contains(&lower) {
                    from = self.step_pair(plan, upper, flipped);
                }
                for row in [upper, lower] {
                    if rows.contains(&row) && (from < plan.padded(row) || plan.column.is_some()) {
                        self.step_row(plan, row, from, drive[step], flipped);
                    }
                }
            }
        }
    }

    /// The rows being overwritten and the rows that are read.
    fn fields(&mut self, flipped: bool) -> (&mut [f32], &[f32]) {
        if flipped {
            (self.first.all_mut(), self.second.all())
        } else {
            (self.second.all_mut(), self.first.all())
        }
    }

    /// Advances the cells that rows `row` and `row` + 1 both have and that take the common weight; says how many.
    fn step_pair(&mut self, plan: &Plan, row: usize, flipped: bool) -> usize {
        let cells = plan.plain[row].min(plan.plain[row + 1]);
        let (at, stride) = (self.cell_zero(row), self.stride);
        let above = if row == 0 && plan.mirrored { at + stride } else { at - stride };
        let (past, now) = self.fields(flipped);
        let line = |from: usize| &now[from..from + cells];
        let with_margins = |from: usize| &now[from - LANES..from + cells + LANES];
        let (upper, lower) = past[at..].split_at_mut(stride);
        kernel::advance_pair(
            plan.width,
            [&mut upper[..cells], &mut lower[..cells]],
            Around {
                above: line(above),
                first: with_margins(at),
                second: with_margins(at + stride),
                below: line(at + 2 * stride),
            },
            plan.weights,
        );
        cells
    }

    /// Advances what remains of a row: the driven column, the cells after the first `from`, those beside the edge.
    fn step_row(&mut self, plan: &Plan, row: usize, from: usize, drive: f32, flipped: bool) {
        let at = self.cell_zero(row);
        let below = at + self.stride;
        let above = if row == 0 && plan.mirrored { below } else { at - self.stride };
        let (past, now) = self.fields(flipped);
        if let Some(column) = &plan.column {
            past[at - 1] = (column.own[row] * now[at - 1] - column.past * past[at - 1])
                + (column.inward * now[at] + column.across * (now[above - 1] + now[below - 1]))
                + column.profile[row] * drive;
        }
        let (plain, cells, padded) = (plan.plain[row], plan.reach[row], plan.padded(row));
        if plain > from {
            kernel::advance(
                plan.width,
                &mut past[at + from..at + plain],
                &now[at + from - 1..at + plain + 1],
                &now[above + from..above + plain],
                &now[below + from..below + plain],
                plan.weights,
            );
        }
        if padded > plain {
            kernel::advance_edge(
                plan.width,
                &mut past[at + plain..at + padded],
                &now[at + plain - 1..at + padded + 1],
                &now[above + plain..above + padded],
                &now[below + plain..below + padded],
                &plan.edge_own[plan.edge_start[row]..],
                plan.weights,
            );
            past[at + cells..at + padded].fill(0.0);
        }
        if self.record.rows.contains(&row) {
            let to = (row - self.record.rows.start) * self.stride;
            let field = if flipped { self.first.all() } else { self.second.all() };
            kernel::record(
                plan.width,
                &field[at - 1..at + cells],
                &mut self.record.maximum[to..to + cells + 1],
                &mut self.record.squares[to..to + cells + 1],
            );
        }
    }

    pub(super) fn hush(&mut self, plan: &Plan) {
        let from = self.cell_zero(self.owned.start) - LANES;
        let to = from + self.owned.len() * self.stride;
        kernel::hush(plan.width, &mut self.first.all_mut()[from..to]);
        kernel::hush(plan.width, &mut self.second.all_mut()[from..to]);
    }

    pub(super) fn row(&self, plan: &Plan, row: usize, flipped: bool) -> &[f32] {
        let at = self.cell_zero(row);
        let field = if flipped { self.second.all() } else { self.first.all() };
        &field[at - 1..at + plan.reach[row]]
    }

    pub(super) fn release(&mut self, plan: &Plan, shape: &impl Fn(usize, usize) -> f32) {
        for row in self.stored.clone() {
            let at = self.cell_zero(row);
            for cell in 0..plan.reach[row] {
                let value = shape(cell, row);
                self.first.all_mut()[at + cell] = value;
                self.second.all_mut()[at + cell] = value;
            }
        }
    }

    pub(super) fn envelope(&self, plan: &Plan, row: usize) -> Option<(&[f32], &[f64])> {
        if !self.record.rows.contains(&row) {
            return None;
        }
        let from = (row - self.record.rows.start) * self.stride;
        let to = from + plan.reach[row] + 1;
        Some((&self.record.maximum[from..to], &self.record.squares[from..to]))
    }

    pub(super) fn reset_envelope(&mut self) {
        self.record.maximum.fill(0.0);
        self.record.squares.fill(0.0);
    }

    /// Appends both fields of `rows`, which are stored here, to `parcel`.
    fn pack(&self, rows: Range<usize>, parcel: &mut Vec<f32>) {
        parcel.clear();
        let (from, to) = self.span(&rows);
        parcel.extend_from_slice(&self.first.all()[from..to]);
        parcel.extend_from_slice(&self.second.all()[from..to]);
    }

    fn unpack(&mut self, rows: Range<usize>, parcel: &[f32]) {
        let (from, to) = self.span(&rows);
        let (first, second) = parcel.split_at(to - from);
        self.first.all_mut()[from..to].copy_from_slice(first);
        self.second.all_mut()[from..to].copy_from_slice(second);
    }

    fn span(&self, rows: &Range<usize>) -> (usize, usize) {
        let from = self.cell_zero(rows.start) - LANES;
        (from, from + rows.len() * self.stride)
    }

    /// Packs the first (last) `depth` owned rows, which are the halo of the band before (after).
    pub(super) fn pack_for_before(&self, depth: usize, parcel: &mut Vec<f32>) {
        self.pack(self.owned.start..self.owned.start + depth, parcel);
    }

    pub(super) fn pack_for_after(&self, depth: usize, parcel: &mut Vec<f32>) {
        self.pack(self.owned.end - depth..self.owned.end, parcel);
    }

    /// Takes the halo rows that the band before (after) packed.
    pub(super) fn unpack_from_before(&mut self, parcel: &[f32]) {
        self.unpack(self.stored.start..self.owned.start, parcel);
    }

    pub(super) fn unpack_from_after(&mut self, parcel: &[f32]) {
        self.unpack(self.owned.end..self.stored.end, parcel);
    }
}
