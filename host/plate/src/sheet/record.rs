//! The recorded envelope: largest magnitude and sum of squares of every cell of the recorded rows.
//!
//! Squares are summed as `f32` over at most 64 steps, and these sums are added as `f64`. That takes two thirds of the
//! memory traffic of `f64` sums alone, with an error below 1e-5 of the sum.

use super::row::Row;
use super::vector::{LANES, Lanes, Line};
use std::ops::Range;

/// The recorded envelope of `rows`, stored in the same order as the field.
#[derive(Debug)]
pub(super) struct EnvelopeRecord {
    pub(super) rows: Range<usize>,
    /// Lines per row.
    stride: usize,
    maximum: Vec<Line>,
    /// Sums of squares since the last [`EnvelopeRecord::accumulate`].
    recent: Vec<Line>,
    /// Sums of squares before that.
    squares: Vec<[f64; LANES]>,
}

/// The recorded envelope of the rows that a band sends to its neighbour.
#[derive(Debug, Default)]
pub(super) struct RecordHalo {
    maximum: Vec<Line>,
    recent: Vec<Line>,
    squares: Vec<[f64; LANES]>,
}

impl EnvelopeRecord {
    /// An empty record of `rows`, each of `stride` lines.
    pub(super) fn new(rows: Range<usize>, stride: usize) -> Self {
        let count = rows.len() * stride;
        let zero = vec![[0.0; LANES]; count];
        Self { rows, stride, recent: zero.clone(), maximum: zero, squares: vec![[0.0; LANES]; count] }
    }

    /// The lines of those of `rows` that are recorded.
    #[inline(always)]
    fn lines(&self, rows: &Range<usize>) -> Range<usize> {
        let rows = overlap(rows, &self.rows);
        let at = |row: usize| (row - self.rows.start) * self.stride;
        at(rows.start)..at(rows.end)
    }

    /// Records one step of a row: its first lines, those with cells inside. Rows that are not recorded are ignored.
    #[inline(always)]
    pub(super) fn take<L: Lanes>(&mut self, lanes: L, row: usize, lines: &[Line]) {
        let range = self.lines(&(row..row + 1));
        let sums = self.maximum[range.clone()].iter_mut().zip(&mut self.recent[range]);
        for (line, (maximum, recent)) in lines.iter().zip(sums) {
            let value = lanes.load(line);
            lanes.store(lanes.larger_magnitude(value, lanes.load(maximum)), maximum);
            lanes.store(lanes.multiply_add(value, value, lanes.load(recent)), recent);
        }
    }

    /// Adds the recent squares of `rows` to the sums in `f64`.
    pub(super) fn accumulate(&mut self, rows: &Range<usize>) {
        let range = self.lines(rows);
        let squares = self.squares[range.clone()].as_flattened_mut();
        for (squares, recent) in squares.iter_mut().zip(self.recent[range].as_flattened_mut()) {
            *squares += f64::from(*recent);
            *recent = 0.0;
        }
    }

    pub(super) fn reset(&mut self) {
        self.maximum.fill([0.0; LANES]);
        self.recent.fill([0.0; LANES]);
        self.squares.fill([0.0; LANES]);
    }

    /// Largest magnitude and sum of squares along `row`, the driven column and `reach` cells; `None` if it is not
    /// recorded.
    pub(super) fn read(&self, row: usize, reach: usize) -> Option<impl Iterator<Item = (f32, f64)>> {
        let range = self.lines(&(row..row + 1));
        if range.is_empty() {
            return None;
        }
        let maximum = Row::new(&self.maximum[range.clone()], reach).numbers();
        let recent = Row::new(&self.recent[range.clone()], reach).numbers();
        let squares = Row::new(&self.squares[range], reach).numbers();
        let sums = squares.zip(recent).map(|(squares, recent)| squares + f64::from(recent));
        Some(maximum.zip(sums))
    }

    /// Copies the recorded part of `rows` into `extract`.
    pub(super) fn pack(&self, rows: &Range<usize>, extract: &mut RecordHalo) {
        let range = self.lines(rows);
        refill(&mut extract.maximum, &self.maximum[range.clone()]);
        refill(&mut extract.recent, &self.recent[range.clone()]);
        refill(&mut extract.squares, &self.squares[range]);
    }

    /// Replaces the recorded part of `rows` by the same rows that [`EnvelopeRecord::pack`] copied from another
    /// record.
    pub(super) fn unpack(&mut self, rows: &Range<usize>, extract: &RecordHalo) {
        let range = self.lines(rows);
        self.maximum[range.clone()].copy_from_slice(&extract.maximum);
        self.recent[range.clone()].copy_from_slice(&extract.recent);
        self.squares[range].copy_from_slice(&extract.squares);
    }
}

/// Makes a vector equal to a slice; reuses its memory.
pub(super) fn refill<T: Copy>(target: &mut Vec<T>, source: &[T]) {
    target.clear();
    target.extend_from_slice(source);
}

/// The intersection of two ranges. If it is empty, its position is still within the second range.
pub(super) fn overlap(one: &Range<usize>, other: &Range<usize>) -> Range<usize> {
    let start = one.start.clamp(other.start, other.end);
    start..one.end.clamp(start, other.end)
}
