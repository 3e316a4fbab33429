//! One thread's share of a lattice: its rows, and those that it takes over and leaves again.

use super::block::{Course, Handover, Slant, Stretch, Turn};
use super::exchange::{Exchange, Parcel};
use super::kernel::{self, Hush};
use super::plan::Plan;
use super::record::{Record, overlap, refill};
use super::row::Row;
use super::vector::{LANES, Line};
use std::ops::Range;

/// The rows `owned`; where they end changes with every block.
#[derive(Debug)]
pub(super) struct Band {
    pub(super) owned: Range<usize>,
    /// All rows that are stored: those that are ever owned, and one that they lean on at each seam.
    stored: Range<usize>,
    /// Number of the band, and how many there are.
    number: usize,
    bands: usize,
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

impl Band {
    /// The band `number` of `bands`, which owns the rows `owned` before a rising block.
    pub(super) fn new(plan: &Plan, owned: Range<usize>, number: usize, bands: usize) -> Self {
        let stored = owned.start.saturating_sub(plan.depth + 1)..(owned.end + 1).min(plan.rows());
        // Room for a row before and one after: the edge's outer side, which is zero, or never read.
        let count = (stored.len() + 2) * plan.stride + 1;
        let record = Record::new(overlap(&plan.recorded, &stored), plan.stride);
        Self {
            owned,
            stored,
            number,
            bands,
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

    /// Advances the band by one step for each number of `drive`, the seams going as `slant` says.
    pub(super) fn block(
        &mut self,
        plan: &Plan,
        drive: &[f32],
        flipped: bool,
        slant: Slant,
        exchange: &Exchange,
    ) {
        let (steps, seams) = (drive.len(), [self.number > 0, self.number + 1 < self.bands]);
        let course = Course::new(slant, steps, &self.owned, seams, plan.group);
        let flipped_then = flipped ^ (steps % 2 == 1);
        for (fronts, turn) in course.parts() {
            let first_row = self.stored.start;
            let (newest, older, record) = self.parts(flipped);
            let course = &course;
            plan.width.run(Stretch { plan, course, fronts, newest, older, first_row, drive, record });
            match turn {
                Some(Turn::Leave(rows)) => {
                    exchange.leave(self.number, slant, |parcel| self.pack(rows, flipped_then, parcel));
                }
                Some(Turn::TakeOver(rows)) => {
                    exchange.take(self.number, slant, |parcel| self.unpack(rows, flipped_then, parcel));
                }
                None => {}
            }
        }
        self.owned = course.end();
    }

    /// What is due every some tens of steps: vanishing numbers become zero, and the record is summed up.
    pub(super) fn tidy(&mut self, plan: &Plan) {
        self.record.settle(&self.owned);
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

    /// As [`Record::read`].
    pub(super) fn envelope(&self, plan: &Plan, row: usize) -> Option<impl Iterator<Item = (f32, f64)>> {
        self.record.read(row, plan.reach[row])
    }

    pub(super) fn reset_envelope(&mut self) {
        self.record.reset();
    }

    /// Packs rows that change hands: both fields, and the envelope where it is recorded.
    fn pack(&self, handover: &Handover, flipped: bool, parcel: &mut Parcel) {
        let (newest, older) = if flipped { (&self.second, &self.first) } else { (&self.first, &self.second) };
        refill(&mut parcel.newest, &newest.lines()[self.lines_of(&handover.rows)]);
        refill(&mut parcel.older, &older.lines()[self.lines_of(&handover.with_support)]);
        self.record.pack(&handover.rows, &mut parcel.record);
    }

    fn unpack(&mut self, handover: &Handover, flipped: bool, parcel: &Parcel) {
        let (rows, with_support) = (self.lines_of(&handover.rows), self.lines_of(&handover.with_support));
        let (newest, older, record) = self.parts(flipped);
        newest[rows].copy_from_slice(&parcel.newest);
        older[with_support].copy_from_slice(&parcel.older);
        record.unpack(&handover.rows, &parcel.record);
    }

    fn lines_of(&self, rows: &Range<usize>) -> Range<usize> {
        self.line_of(rows.start)..self.line_of(rows.end)
    }

    /// The newest field, the one a step before, and the record.
    fn parts(&mut self, flipped: bool) -> (&mut [Line], &mut [Line], &mut Record) {
        let (first, second) = (self.first.lines_mut(), self.second.lines_mut());
        let (newest, older) = if flipped { (second, first) } else { (first, second) };
        (newest, older, &mut self.record)
    }
}
