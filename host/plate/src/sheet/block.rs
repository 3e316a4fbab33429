//! A block of steps of one band: which rows each step takes, and in which order.
//!
//! ```text
//!            row       .. 57 58 59 60 61 62 63 | 64 65 66 ..      a rising block of 3 steps: the seam, which was
//!  step 1           above's              a  |  b  b  b  below's   before row 64, goes up by a row a step. The band
//!  step 2                             a  |  b  b  b  b            above leaves what it cannot compute without its
//!  step 3                          a  |  b  b  b  b  b            neighbour, and the band below takes it over.
//! ```
//!
//! So neighbours need nothing of each other but the rows that one of them leaves, at a time when it has left them: a
//! rising block begins at the band's lower seam, where rows are left, and ends at the upper one, where they are taken
//! over. The next block is a falling one, the other way round, and brings the seams back.

use super::kernel::{self, COLUMNS, Place, Spread};
use super::plan::{Extent, Plan};
use super::record::Record;
use super::vector::{LANES, Lanes, Line, Work};
use std::mem::replace;
use std::ops::Range;

/// Which way the seams go during a block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Slant {
    /// Up, towards row 0.
    Rising,
    Falling,
}

/// The order of a block.
#[derive(Debug)]
pub(super) struct Course {
    slant: Slant,
    /// Rows that each step takes.
    rows: Vec<Range<usize>>,
    /// Rows in a group, and the group in which the block begins.
    group: usize,
    origin: usize,
    /// Fronts of the whole block. In front f step s (from 0) takes the group that is f - s away from the origin.
    fronts: usize,
    /// What is done with the neighbours, each before a front, in their order.
    turns: Vec<(usize, Turn)>,
}

/// What a band does with its neighbours in the course of a block.
#[derive(Debug)]
pub(super) enum Turn {
    /// Leaves rows, which are complete now, to one neighbour.
    Leave(Handover),
    /// Takes over rows, which are needed now, from the other.
    TakeOver(Handover),
}

/// Rows that change hands.
#[derive(Debug)]
pub(super) struct Handover {
    pub(super) rows: Range<usize>,
    /// These and the row that the one furthest from the seam leans on; of that row only the older field is needed.
    pub(super) with_support: Range<usize>,
}

impl Handover {
    /// As many rows as there are `steps`, from where the seam is when the block begins.
    fn new(slant: Slant, seam: usize, steps: usize) -> Self {
        match slant {
            Slant::Rising => Self { rows: seam - steps..seam, with_support: seam - steps - 1..seam },
            Slant::Falling => Self { rows: seam..seam + steps, with_support: seam..seam + steps + 1 },
        }
    }
}

impl Course {
    /// Of `steps` steps of the rows `owned`, with seams above and below them or not.
    pub(super) fn new(
        slant: Slant,
        steps: usize,
        owned: &Range<usize>,
        [above, below]: [bool; 2],
        group: usize,
    ) -> Self {
        let moved = |row: usize, by: usize, is_seam: bool| match (is_seam, slant) {
            (false, _) => row,
            (true, Slant::Rising) => row - by,
            (true, Slant::Falling) => row + by,
        };
        let rows: Vec<Range<usize>> =
            (1..=steps).map(|by| moved(owned.start, by, above)..moved(owned.end, by, below)).collect();
        let (first, last) = (&rows[0], &rows[steps - 1]);
        let (lowest, highest) = (first.start.min(last.start) / group, (first.end.max(last.end) - 1) / group);
        let origin = if slant == Slant::Rising { highest } else { lowest };
        let place_of = |row: usize| origin.abs_diff(row / group);
        // Rows are left at the seam where the block begins, and taken over at the one where it ends.
        let (upper, lower) = (above.then_some(owned.start), below.then_some(owned.end));
        let (left_at, taken_at) = if slant == Slant::Rising { (lower, upper) } else { (upper, lower) };
        let mut turns = Vec::with_capacity(2);
        if let Some(seam) = left_at {
            let handover = Handover::new(slant, seam, steps);
            // Of the supporting row the field before the last step is needed: it is there a front before the last.
            let support = if slant == Slant::Rising { seam - steps - 1 } else { seam + steps };
            turns.push((place_of(support) + steps - 1, Turn::Leave(handover)));
        }
        if let Some(seam) = taken_at {
            let handover = Handover::new(slant, seam, steps);
            // The own row beside the seam leans on the first that is taken over, from the first step on.
            let leaning = if slant == Slant::Rising { seam } else { seam - 1 };
            turns.push((place_of(leaning), Turn::TakeOver(handover)));
        }
        turns.sort_by_key(|turn| turn.0);
        Self { slant, rows, group, origin, fronts: highest - lowest + steps, turns }
    }

    /// The rows that are owned after the block.
    pub(super) fn end(&self) -> Range<usize> {
        self.rows[self.rows.len() - 1].clone()
    }

    /// All fronts, in parts, and the turn that comes after each part.
    pub(super) fn parts(&self) -> impl Iterator<Item = (Range<usize>, Option<&Turn>)> {
        let ends = self.turns.iter().map(|(front, turn)| ((*front).min(self.fronts), Some(turn)));
        ends.chain([(self.fronts, None)]).scan(0, |from, (to, turn)| Some((replace(from, to)..to, turn)))
    }

    /// The rows that a step takes at a place; `None` if it does not reach so far back.
    #[inline(always)]
    fn rows_at(&self, place: usize, step: usize) -> Option<Range<usize>> {
        let group = match self.slant {
            Slant::Rising => self.origin.checked_sub(place)?,
            Slant::Falling => self.origin + place,
        };
        let rows = &self.rows[step];
        let (from, to) = ((group * self.group).max(rows.start), ((group + 1) * self.group).min(rows.end));
        (from < to).then_some(from..to)
    }

    /// Whether a step has no rows at a place or beyond.
    #[inline(always)]
    fn is_passed(&self, place: usize, step: usize) -> bool {
        match self.slant {
            Slant::Rising => {
                self.origin < place || (self.origin - place + 1) * self.group <= self.rows[step].start
            }
            Slant::Falling => (self.origin + place) * self.group >= self.rows[step].end,
        }
    }
}

/// Some fronts of a block.
pub(super) struct Stretch<'a> {
    pub(super) plan: &'a Plan,
    pub(super) course: &'a Course,
    pub(super) fronts: Range<usize>,
    /// The newest field when the block begins, and the one a step before.
    pub(super) newest: &'a mut [Line],
    pub(super) older: &'a mut [Line],
    /// The first row that these hold; there is room for one before it, which is zero or never read.
    pub(super) first_row: usize,
    pub(super) drive: &'a [f32],
    pub(super) record: &'a mut Record,
}

impl Work for Stretch<'_> {
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

impl Stretch<'_> {
    #[inline(always)]
    fn sweep<L: Lanes, const N: usize, const KEEP_ALL: bool>(self, lanes: L) {
        let Self { plan, course, fronts, newest, older, first_row, drive, record } = self;
        let (steps, stride) = (drive.len(), plan.stride);
        let spread = Spread::new(lanes, plan.weights);
        // Rows before the first are not stored: this may be "negative".
        let offset = stride.wrapping_sub(first_row * stride);
        // The first steps have passed the last group (`passed` counts them), the last ones have not reached the first.
        let mut passed = 0;
        for front in fronts {
            while passed < steps && passed <= front && course.is_passed(front - passed, passed) {
                passed += 1;
            }
            for (step, &drive) in drive.iter().enumerate().skip(passed) {
                let Some(place) = front.checked_sub(step) else { break };
                let Some(rows) = course.rows_at(place, step) else { break };
                let (past, now): (&mut [Line], &[Line]) =
                    if step % 2 == 0 { (&mut *older, &*newest) } else { (&mut *newest, &*older) };
                let mut stage = Stage { plan, past, now, stride, offset, drive };
                if rows.len() == N {
                    stage.advance::<L, N, KEEP_ALL>(lanes, spread, rows.start);
                } else {
                    for row in rows.clone() {
                        stage.advance::<L, 1, KEEP_ALL>(lanes, spread, row);
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
