//! The band of rows of one thread: its part of the field, and the halos that it sends and receives.

use super::block::{HaloRows, Schedule, Skew, Transfer, Wavefronts};
use super::halo::{Halo, HaloExchange};
use super::kernel::{self, FlushDenormals};
use super::record::{EnvelopeRecord, overlap, refill};
use super::row::Row;
use super::tiling::Plan;
use super::vector::{LANES, Line};
use std::ops::Range;

/// A band of rows of one thread. The rows that it owns change with every block.
#[derive(Debug)]
pub(super) struct Band {
    pub(super) owned: Range<usize>,
    /// All stored rows: every row owned at any time, and one more at each boundary, which the update reads.
    stored: Range<usize>,
    /// Index of the band, and the number of bands.
    number: usize,
    bands: usize,
    stride: usize,
    first: AlignedField,
    second: AlignedField,
    record: EnvelopeRecord,
}

/// The field at one time, aligned to cache lines.
#[derive(Debug)]
struct AlignedField {
    numbers: Vec<f32>,
    start: usize,
}

impl AlignedField {
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

impl Band {
    /// The band `number` of `bands`, which owns the rows `owned` before a rising block.
    pub(super) fn new(plan: &Plan, owned: Range<usize>, number: usize, bands: usize) -> Self {
        let stored = owned.start.saturating_sub(plan.depth + 1)..(owned.end + 1).min(plan.rows());
        // One more row before and after the stored rows: beyond an edge it is zero, elsewhere it is never read.
        let count = (stored.len() + 2) * plan.stride + 1;
        let record = EnvelopeRecord::new(overlap(&plan.recorded, &stored), plan.stride);
        Self {
            owned,
            stored,
            number,
            bands,
            stride: plan.stride,
            first: AlignedField::new(count),
            second: AlignedField::new(count),
            record,
        }
    }

    /// The first line of `row`; its last lane is the driven column.
    fn line_of(&self, row: usize) -> usize {
        (row + 1 - self.stored.start) * self.stride
    }

    /// Advances the band by one step for each number of `drive`; the boundaries move in the direction of `skew`.
    pub(super) fn block(
        &mut self,
        plan: &Plan,
        drive: &[f32],
        flipped: bool,
        skew: Skew,
        exchange: &HaloExchange,
    ) {
        let (steps, boundaries) = (drive.len(), [self.number > 0, self.number + 1 < self.bands]);
        let schedule = Schedule::new(skew, steps, &self.owned, boundaries, plan.group);
        let flipped_then = flipped ^ (steps % 2 == 1);
        for (fronts, transfer) in schedule.parts() {
            let first_row = self.stored.start;
            let (newest, older, record) = self.parts(flipped);
            let schedule = &schedule;
            plan.width.run(Wavefronts { plan, schedule, fronts, newest, older, first_row, drive, record });
            match transfer {
                Some(Transfer::Send(rows)) => {
                    exchange.send(self.number, skew, |halo| self.pack(rows, flipped_then, halo));
                }
                Some(Transfer::Receive(rows)) => {
                    exchange.receive(self.number, skew, |halo| self.unpack(rows, flipped_then, halo));
                }
                None => {}
            }
        }
        self.owned = schedule.end();
    }

    /// Flushes denormal numbers to zero and accumulates the record.
    pub(super) fn flush(&mut self, plan: &Plan) {
        self.record.accumulate(&self.owned);
        let lines = self.line_of(self.owned.start)..self.line_of(self.owned.end);
        plan.width.run(FlushDenormals(&mut self.first.lines_mut()[lines.clone()]));
        plan.width.run(FlushDenormals(&mut self.second.lines_mut()[lines]));
    }

    pub(super) fn row(&self, plan: &Plan, row: usize, flipped: bool) -> Row<'_> {
        let at = self.line_of(row);
        let field = if flipped { self.second.lines() } else { self.first.lines() };
        Row::new(&field[at..at + self.stride], plan.reach[row])
    }

    pub(super) fn release(&mut self, plan: &Plan, shape: &impl Fn(usize, usize) -> f32) {
        for row in self.owned.clone() {
            let at = self.line_of(row) + 1;
            for cell in 0..plan.reach[row] {
                let value = shape(cell, row);
                let (line, lane) = kernel::place(cell);
                self.first.lines_mut()[at + line][lane] = value;
                self.second.lines_mut()[at + line][lane] = value;
            }
        }
    }

    /// As [`EnvelopeRecord::read`].
    pub(super) fn envelope(&self, plan: &Plan, row: usize) -> Option<impl Iterator<Item = (f32, f64)>> {
        self.record.read(row, plan.reach[row])
    }

    pub(super) fn reset_envelope(&mut self) {
        self.record.reset();
    }

    /// Copies the rows for the neighbour: both fields and the recorded envelope.
    fn pack(&self, halo_rows: &HaloRows, flipped: bool, halo: &mut Halo) {
        let (newest, older) = if flipped { (&self.second, &self.first) } else { (&self.first, &self.second) };
        refill(&mut halo.newest, &newest.lines()[self.lines_of(&halo_rows.rows)]);
        refill(&mut halo.older, &older.lines()[self.lines_of(&halo_rows.with_support)]);
        self.record.pack(&halo_rows.rows, &mut halo.record);
    }

    fn unpack(&mut self, halo_rows: &HaloRows, flipped: bool, halo: &Halo) {
        let (rows, with_support) = (self.lines_of(&halo_rows.rows), self.lines_of(&halo_rows.with_support));
        let (newest, older, record) = self.parts(flipped);
        newest[rows].copy_from_slice(&halo.newest);
        older[with_support].copy_from_slice(&halo.older);
        record.unpack(&halo_rows.rows, &halo.record);
    }

    fn lines_of(&self, rows: &Range<usize>) -> Range<usize> {
        self.line_of(rows.start)..self.line_of(rows.end)
    }

    /// The newest field, the field one step before, and the record.
    fn parts(&mut self, flipped: bool) -> (&mut [Line], &mut [Line], &mut EnvelopeRecord) {
        let (first, second) = (self.first.lines_mut(), self.second.lines_mut());
        let (newest, older) = if flipped { (second, first) } else { (first, second) };
        (newest, older, &mut self.record)
    }
}
