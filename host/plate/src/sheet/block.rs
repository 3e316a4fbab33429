//! A block of steps of one band (time skewing): the rows that each step updates, and the order of the updates.
//!
//! ```text
//!            row       .. 57 58 59 60 61 62 63 | 64 65 66 ..      a rising block of 3 steps: at its start the boundary
//!  step 1           above's              a  |  b  b  b  below's   is before row 64; it moves up by one row per step.
//!  step 2                             a  |  b  b  b  b            The band above sends the rows that it cannot update
//!  step 3                          a  |  b  b  b  b  b            without its neighbour; the band below receives them.
//! ```
//!
//! So neighbours exchange one halo per block, and the sender never waits for the receiver's work: a rising block begins
//! at the band's lower boundary, where it sends, and ends at the upper one, where it receives. The next block is
//! falling: it does the same in the opposite direction and moves the boundaries back.

use super::kernel::{self, COLUMNS, Place, WeightVectors};
use super::record::EnvelopeRecord;
use super::tiling::{Extent, Plan};
use super::vector::{LANES, Lanes, Line, Work};
use crate::order;
use std::mem::replace;
use std::ops::Range;

/// The direction in which the boundaries between bands move during a block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Skew {
    /// Up, toward row 0.
    Rising,
    /// Down, toward the last row.
    Falling,
}

/// The order of the updates in a block.
#[derive(Debug)]
pub(super) struct Schedule {
    skew: Skew,
    /// Rows that each step updates.
    rows: Vec<Range<usize>>,
    /// Rows per group, and the group where the block begins.
    group: usize,
    origin: usize,
    /// Wavefronts of the whole block. In front f, step s (from 0) updates the group that is f - s away from the origin.
    fronts: usize,
    /// The halo transfers, each with the front that it precedes, in order.
    transfers: Vec<(usize, Transfer)>,
}

/// A halo transfer with a neighbour within a block.
#[derive(Debug)]
pub(super) enum Transfer {
    /// Sends rows, which are complete now, to one neighbour.
    Send(HaloRows),
    /// Receives rows, which are needed now, from the other.
    Receive(HaloRows),
}

/// Rows that one band sends and its neighbour receives.
#[derive(Debug)]
pub(super) struct HaloRows {
    pub(super) rows: Range<usize>,
    /// These rows and one more on the sender's side, which the update of the outermost row reads. Only its older
    /// field is needed.
    pub(super) with_support: Range<usize>,
}

impl HaloRows {
    /// One row per step, from the boundary's position at the start of the block.
    fn new(skew: Skew, boundary: usize, steps: usize) -> Self {
        match skew {
            Skew::Rising => {
                Self { rows: boundary - steps..boundary, with_support: boundary - steps - 1..boundary }
            }
            Skew::Falling => {
                Self { rows: boundary..boundary + steps, with_support: boundary..boundary + steps + 1 }
            }
        }
    }
}

impl Schedule {
    /// The schedule of `steps` steps of the rows `owned`, with or without a band above and below.
    pub(super) fn new(
        skew: Skew,
        steps: usize,
        owned: &Range<usize>,
        [above, below]: [bool; 2],
        group: usize,
    ) -> Self {
        let moved = |row: usize, by: usize, is_boundary: bool| match (is_boundary, skew) {
            (false, _) => row,
            (true, Skew::Rising) => row - by,
            (true, Skew::Falling) => row + by,
        };
        let rows: Vec<Range<usize>> =
            (1..=steps).map(|by| moved(owned.start, by, above)..moved(owned.end, by, below)).collect();
        let (first, last) = (&rows[0], &rows[steps - 1]);
        let (lowest, highest) = (first.start.min(last.start) / group, (first.end.max(last.end) - 1) / group);
        let origin = if skew == Skew::Rising { highest } else { lowest };
        let place_of = |row: usize| origin.abs_diff(row / group);
        // A block sends at the boundary where it begins and receives at the boundary where it ends.
        let (upper, lower) = (above.then_some(owned.start), below.then_some(owned.end));
        let (sent_at, received_at) = if skew == Skew::Rising { (lower, upper) } else { (upper, lower) };
        let mut transfers = Vec::with_capacity(2);
        if let Some(boundary) = sent_at {
            let halo_rows = HaloRows::new(skew, boundary, steps);
            // The field of the supporting row before the last step is needed; it is complete one front before the last.
            let support = if skew == Skew::Rising { boundary - steps - 1 } else { boundary + steps };
            transfers.push((place_of(support) + steps - 1, Transfer::Send(halo_rows)));
        }
        if let Some(boundary) = received_at {
            let halo_rows = HaloRows::new(skew, boundary, steps);
            // The band's row next to the boundary reads the first received row from the first step on.
            let reader = if skew == Skew::Rising { boundary } else { boundary - 1 };
            transfers.push((place_of(reader), Transfer::Receive(halo_rows)));
        }
        order::sort_by_key(&mut transfers, |transfer| transfer.0);
        Self { skew, rows, group, origin, fronts: highest - lowest + steps, transfers }
    }

    /// The rows that are owned after the block.
    pub(super) fn end(&self) -> Range<usize> {
        self.rows[self.rows.len() - 1].clone()
    }

    /// All fronts in order, split at the transfers, with the transfer that follows each part.
    pub(super) fn parts(&self) -> impl Iterator<Item = (Range<usize>, Option<&Transfer>)> {
        let ends = self.transfers.iter().map(|(front, transfer)| ((*front).min(self.fronts), Some(transfer)));
        ends.chain([(self.fronts, None)])
            .scan(0, |from, (to, transfer)| Some((replace(from, to)..to, transfer)))
    }

    /// The rows that a step updates in the group at distance `place` from the origin; `None` if there are none.
    #[inline(always)]
    fn rows_at(&self, place: usize, step: usize) -> Option<Range<usize>> {
        let group = match self.skew {
            Skew::Rising => self.origin.checked_sub(place)?,
            Skew::Falling => self.origin + place,
        };
        let rows = &self.rows[step];
        let (from, to) = ((group * self.group).max(rows.start), ((group + 1) * self.group).min(rows.end));
        (from < to).then_some(from..to)
    }

    /// Whether a step has no rows at distance `place` from the origin or farther.
    #[inline(always)]
    fn is_passed(&self, place: usize, step: usize) -> bool {
        match self.skew {
            Skew::Rising => {
                self.origin < place || (self.origin - place + 1) * self.group <= self.rows[step].start
            }
            Skew::Falling => (self.origin + place) * self.group >= self.rows[step].end,
        }
    }
}

/// Some wavefronts of a block.
pub(super) struct Wavefronts<'a> {
    pub(super) plan: &'a Plan,
    pub(super) schedule: &'a Schedule,
    pub(super) fronts: Range<usize>,
    /// The newest field at the start of the block, and the field one step before.
    pub(super) newest: &'a mut [Line],
    pub(super) older: &'a mut [Line],
    /// The first row in the fields. Before it there is space for one row, which is zero or never read.
    pub(super) first_row: usize,
    pub(super) drive: &'a [f32],
    pub(super) record: &'a mut EnvelopeRecord,
}

impl Work for Wavefronts<'_> {
    #[inline(always)]
    fn with<L: Lanes>(self, lanes: L) {
        match (self.plan.group, self.plan.weights.is_lossless()) {
            (4, true) => self.sweep::<L, 4, true>(lanes),
            (4, false) => self.sweep::<L, 4, false>(lanes),
            (_, true) => self.sweep::<L, 2, true>(lanes),
            (_, false) => self.sweep::<L, 2, false>(lanes),
        }
    }
}

impl Wavefronts<'_> {
    #[inline(always)]
    fn sweep<L: Lanes, const N: usize, const LOSSLESS: bool>(self, lanes: L) {
        let Self { plan, schedule, fronts, newest, older, first_row, drive, record } = self;
        let (steps, stride) = (drive.len(), plan.stride);
        let weights = WeightVectors::new(lanes, plan.weights);
        // Rows before the first are not stored, so the offset may be negative: it wraps, and the sum wraps back.
        let offset = stride.wrapping_sub(first_row * stride);
        // The first `passed` steps are already beyond the last group; the last steps have not reached the first
        // group.
        let mut passed = 0;
        for front in fronts {
            while passed < steps && passed <= front && schedule.is_passed(front - passed, passed) {
                passed += 1;
            }
            for (step, &drive) in drive.iter().enumerate().skip(passed) {
                let Some(place) = front.checked_sub(step) else { break };
                let Some(rows) = schedule.rows_at(place, step) else { break };
                let (past, now): (&mut [Line], &[Line]) =
                    if step % 2 == 0 { (&mut *older, &*newest) } else { (&mut *newest, &*older) };
                let mut stage = StepRows { plan, past, now, stride, offset, drive };
                if rows.len() == N {
                    stage.advance::<L, N, LOSSLESS>(lanes, weights, rows.start);
                } else {
                    for row in rows.clone() {
                        stage.advance::<L, 1, LOSSLESS>(lanes, weights, row);
                    }
                }
                for row in rows {
                    if record.rows.contains(&row) {
                        let at = (row + 1 - first_row) * stride;
                        let lines = 1 + COLUMNS * plan.extent::<1>(row).chunks as usize;
                        record.take(lanes, row, &past[at..at + lines]);
                    }
                }
            }
        }
    }
}

/// One time step of some rows.
struct StepRows<'a> {
    plan: &'a Plan,
    /// The field that is overwritten.
    past: &'a mut [Line],
    /// The field that is read.
    now: &'a [Line],
    stride: usize,
    /// Offset, wrapping, from a row's position in a field of all rows to its position in this field.
    offset: usize,
    drive: f32,
}

impl StepRows<'_> {
    /// Advances `N` rows, starting at `row`.
    #[inline(always)]
    fn advance<L: Lanes, const N: usize, const LOSSLESS: bool>(
        &mut self,
        lanes: L,
        weights: WeightVectors<L::Vector>,
        row: usize,
    ) {
        let Self { plan, past, now, stride, offset, drive } = self;
        let (stride, offset, drive) = (*stride, *offset, *drive);
        let Extent { line, chunks, ghosts } = plan.extent::<N>(row);
        let at = line.wrapping_add(offset);
        // The row above a mirrored first row is the mirror image of the row below it.
        let above_at = if row == 0 && plan.mirrored { at + stride } else { at - stride };
        let place = Place { at, above_at, stride, chunks, ghosts };
        if let Some(touched) = &plan.touched {
            for (row, at) in (row..row + N).zip((at..).step_by(stride)) {
                touched.before(row, &mut past[at + 1..], &now[at + 1..]);
            }
        }
        kernel::advance::<L, N, LOSSLESS>(lanes, weights, (past, now), place);
        if let Some(touched) = &plan.touched {
            for (row, at) in (row..row + N).zip((at..).step_by(stride)) {
                touched.after(row, &mut past[at + 1..]);
            }
        }
        let Some(column) = &plan.column else { return };
        let lane = |line: usize| now[line][LANES - 1];
        for (row, at) in (row..row + N).zip((at..).step_by(stride)) {
            let above = if row == 0 && plan.mirrored { at + stride } else { at - stride };
            let past = &mut past[at][LANES - 1];
            let point = &column.points[row];
            *past = (point.own * lane(at) - point.past * *past)
                + (point.inward * now[at + 1][0] + point.across * (lane(above) + lane(at + stride)))
                + point.profile * drive;
        }
    }
}
