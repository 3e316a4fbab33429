//! One thread's share of a lattice: its rows, a halo of the neighbours' rows, and the wavefront over them.

use super::kernel::{self, Hush, Place, Spread};
use super::plan::{Extent, Plan};
use super::row::Row;
use super::vector::{LANES, Lanes, Line, Work};
use std::ops::Range;

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
    fn new(lines: usize) -> Self {
        let numbers = vec![0.0; (lines + 1) * LANES];
        let start = numbers.as_ptr().align_offset(size_of::<Line>()).min(LANES);
        Self { numbers, start }
    }

    #[inline(always)]
    fn lines(&self) -> &[Line] {
        self.numbers[self.start..].as_chunks().0
    }

    #[inline(always)]
    fn lines_mut(&mut self) -> &mut [Line] {
        self.numbers[self.start..].as_chunks_mut().0
    }
}

/// Envelope of the rows in `rows`, each `stride` lines, laid out as the field is.
#[derive(Debug)]
struct Record {
    rows: Range<usize>,
    maximum: Vec<f32>,
    squares: Vec<f64>,
}

impl Record {
    #[inline(always)]
    fn take(&mut self, row: usize, lines: &[Line]) {
        let to = (row - self.rows.start) * lines.len() * LANES;
        let range = to..to + lines.len() * LANES;
        kernel::record(lines.as_flattened(), &mut self.maximum[range.clone()], &mut self.squares[range]);
    }
}

impl Band {
    pub(super) fn new(plan: &Plan, owned: Range<usize>, depth: usize) -> Self {
        let stored = owned.start.saturating_sub(depth)..(owned.end + depth).min(plan.rows());
        // A row of zeros before and after: the edge's outer side, or what the outermost halo row leans on.
        let count = (stored.len() + 2) * plan.stride + 1;
        let rows = plan.recorded.start.max(owned.start)..plan.recorded.end.min(owned.end);
        let recorded = rows.len() * plan.stride * LANES;
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

    /// The first line of `row`: the one whose last lane is the driven column.
    fn line_of(&self, row: usize) -> usize {
        (row + 1 - self.stored.start) * self.stride
    }

    /// The rows that a step must take when `halo` more follow before the next exchange.
    fn needed(&self, halo: usize) -> Range<usize> {
        let from = self.owned.start.saturating_sub(halo).max(self.stored.start);
        from..(self.owned.end + halo).min(self.stored.end)
    }

    /// Advances the owned rows by one step for each number of `drive`.
    pub(super) fn block(&mut self, plan: &Plan, drive: &[f32], flipped: bool) {
        plan.width.run(Block { band: self, plan, drive, flipped });
    }

    pub(super) fn hush(&mut self, plan: &Plan) {
        let lines = self.line_of(self.owned.start)..self.line_of(self.owned.end);
        plan.width.run(Hush(&mut self.first.lines_mut()[lines.clone()]));
        plan.width.run(Hush(&mut self.second.lines_mut()[lines]));
    }

    pub(super) fn row(&self, plan: &Plan, row: usize, flipped: bool) -> Row<'_> {
        let at = self.line_of(row);
        let field = if flipped { self.second.lines() } else { self.first.lines() };
        Row::new(&field[at..at + self.stride], plan.reach[row])
    }

    pub(super) fn release(&mut self, plan: &Plan, shape: &impl Fn(usize, usize) -> f32) {
        for row in self.stored.clone() {
            let at = self.line_of(row) + 1;
            for cell in 0..plan.reach[row] {
                let value = shape(cell, row);
                let (line, lane) = kernel::place(cell);
                self.first.lines_mut()[at + line][lane] = value;
                self.second.lines_mut()[at + line][lane] = value;
            }
        }
    }

    /// Largest magnitude and sum of squares along `row`, if it is recorded.
    pub(super) fn envelope(&self, plan: &Plan, row: usize) -> Option<(Row<'_>, Row<'_, f64>)> {
        if !self.record.rows.contains(&row) {
            return None;
        }
        let from = (row - self.record.rows.start) * self.stride;
        let lines = from..from + self.stride;
        let reach = plan.reach[row];
        Some((
            Row::new(&self.record.maximum.as_chunks().0[lines.clone()], reach),
            Row::new(&self.record.squares.as_chunks().0[lines], reach),
        ))
    }

    pub(super) fn reset_envelope(&mut self) {
        self.record.maximum.fill(0.0);
        self.record.squares.fill(0.0);
    }

    /// Appends both fields of `rows`, which are stored here, to `parcel`.
    fn pack(&self, rows: Range<usize>, parcel: &mut Vec<Line>) {
        parcel.clear();
        let lines = self.line_of(rows.start)..self.line_of(rows.end);
        parcel.extend_from_slice(&self.first.lines()[lines.clone()]);
        parcel.extend_from_slice(&self.second.lines()[lines]);
    }

    fn unpack(&mut self, rows: Range<usize>, parcel: &[Line]) {
        let lines = self.line_of(rows.start)..self.line_of(rows.end);
        let (first, second) = parcel.split_at(lines.len());
        self.first.lines_mut()[lines.clone()].copy_from_slice(first);
        self.second.lines_mut()[lines].copy_from_slice(second);
    }

    /// Packs the first (last) `depth` owned rows, which are the halo of the band before (after).
    pub(super) fn pack_for_before(&self, depth: usize, parcel: &mut Vec<Line>) {
        self.pack(self.owned.start..self.owned.start + depth, parcel);
    }

    pub(super) fn pack_for_after(&self, depth: usize, parcel: &mut Vec<Line>) {
        self.pack(self.owned.end - depth..self.owned.end, parcel);
    }

    /// Takes the halo rows that the band before (after) packed.
    pub(super) fn unpack_from_before(&mut self, parcel: &[Line]) {
        self.unpack(self.stored.start..self.owned.start, parcel);
    }

    pub(super) fn unpack_from_after(&mut self, parcel: &[Line]) {
        self.unpack(self.owned.end..self.stored.end, parcel);
    }
}

/// Some steps of a band.
///
/// Row r takes step s + 1 soon after row r + 1 took step s. Rows of the halo are computed only as far as the owned
/// rows still depend on them.
struct Block<'a> {
    band: &'a mut Band,
    plan: &'a Plan,
    drive: &'a [f32],
    flipped: bool,
}

impl Work for Block<'_> {
    #[inline(always)]
    fn with<L: Lanes>(self, lanes: L) {
        match (self.plan.group, self.plan.weights.keep_all()) {
            (4, true) => self.sweep::<L, 4, true>(lanes),
            (4, false) => self.sweep::<L, 4, false>(lanes),
            (_, true) => self.sweep::<L, 2, true>(lanes),
            (_, false) => self.sweep::<L, 2, false>(lanes),
        }
    }
}

impl Block<'_> {
    #[inline(always)]
    fn sweep<L: Lanes, const N: usize, const KEEP_ALL: bool>(self, lanes: L) {
        let Self { band, plan, drive, flipped } = self;
        let (stored, steps) = (band.stored.clone(), drive.len());
        let ranges: Vec<Range<usize>> = (1..=steps).map(|step| band.needed(steps - step)).collect();
        let (first, second) = (band.first.lines_mut(), band.second.lines_mut());
        let (stride, record) = (band.stride, &mut band.record);
        let spread = Spread::new(lanes, plan.weights);
        // Rows above the band are not stored: this may be "negative".
        let offset = stride.wrapping_sub(stored.start * stride);
        // In groups: neighbouring rows share what they read. The first steps have passed the last row (`passed` counts
        // them), the last ones have not reached the first.
        let mut passed = 0;
        for front in stored.start / N..stored.end.div_ceil(N) + steps {
            while passed < steps && N * (front - passed) >= ranges[passed].end {
                passed += 1;
            }
            for step in passed..steps {
                let Some(group) = front.checked_sub(step) else { break };
                let from = (N * group).max(ranges[step].start);
                let to = (N * (group + 1)).min(ranges[step].end);
                if from >= to {
                    break;
                }
                let (past, now): (&mut [Line], &[Line]) =
                    if flipped ^ (step % 2 == 1) { (&mut *first, &*second) } else { (&mut *second, &*first) };
                let mut stage = Stage { plan, past, now, stride, offset, drive: drive[step] };
                if to - from == N {
                    stage.advance::<L, N, KEEP_ALL>(lanes, spread, from);
                } else {
                    for row in from..to {
                        stage.advance::<L, 1, KEEP_ALL>(lanes, spread, row);
                    }
                }
                for row in from..to {
                    if record.rows.contains(&row) {
                        let at = (row + 1 - stored.start) * stride;
                        record.take(row, &past[at..at + stride]);
                    }
                }
            }
        }
    }
}

/// One step of some rows.
struct Stage<'a> {
    plan: &'a Plan,
    /// The field that is overwritten.
    past: &'a mut [Line],
    /// The field that is read.
    now: &'a [Line],
    stride: usize,
    /// From where a row would begin, had the field all rows, to where it does.
    offset: usize,
    drive: f32,
}

impl Stage<'_> {
    /// Advances `N` rows from `row` on.
    #[inline(always)]
    fn advance<L: Lanes, const N: usize, const KEEP_ALL: bool>(
        &mut self,
        lanes: L,
        spread: Spread<L::Vector>,
        row: usize,
    ) {
        let Self { plan, past, now, stride, offset, drive } = self;
        let (stride, offset, drive) = (*stride, *offset, *drive);
        let Extent { line, chunks, fringe } = plan.extent::<N>(row);
        let at = line.wrapping_add(offset);
        // A mirrored first row has its neighbour below above it, too.
        let over = if row == 0 && plan.mirrored { at + stride } else { at - stride };
        let place = Place { at, over, stride, chunks, fringe };
        kernel::advance::<L, N, KEEP_ALL>(lanes, spread, (past, now), place);
        let Some(column) = &plan.column else { return };
        let lane = |line: usize| now[line][LANES - 1];
        for (row, at) in (row..row + N).zip((at..).step_by(stride)) {
            let above = if row == 0 && plan.mirrored { at + stride } else { at - stride };
            let past = &mut past[at][LANES - 1];
            *past = (column.own[row] * lane(at) - column.past * *past)
                + (column.inward * now[at + 1][0] + column.across * (lane(above) + lane(at + stride)))
                + column.profile[row] * drive;
        }
    }
}
