//! The largest gain and the steepest interval of any run of knots, without a walk over all of them.
//!
//! ```text
//! knots and intervals   0 1 2 3 4 5 6 7 | 8 ...                one by one
//! groups of 8           [      0      ] [ ...                  129 maxima
//! groups of 64          [      0 ... 7        ] [ ...           17 maxima
//! ```
//! A run is walked by the largest groups that lie in it as a whole: at most 7 + 7 + 14 + 7 + 7 steps for 1025 knots.
//! Interval `i` lies between the knots `i` and `i + 1`.

use core::ops::Range;
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

use slipline_protocol::limits::MAX_KNOTS;

use super::KnotCell;

const GROUP: usize = 8;
const LARGE: usize = GROUP * GROUP;

/// What lies between two knots of a table, both included.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Extremes {
    /// The largest gain of a knot.
    pub(crate) gain: u32,
    /// The largest difference of steps from a knot to the next.
    pub(crate) steepest: u32,
}

impl Extremes {
    fn with(self, other: Self) -> Self {
        Self { gain: self.gain.max(other.gain), steepest: self.steepest.max(other.steepest) }
    }
}

struct Cell {
    gain: AtomicU32,
    steepest: AtomicU32,
}

impl Cell {
    const fn new() -> Self {
        Self { gain: AtomicU32::new(0), steepest: AtomicU32::new(0) }
    }

    fn get(&self) -> Extremes {
        Extremes { gain: self.gain.load(Relaxed), steepest: self.steepest.load(Relaxed) }
    }

    fn set(&self, extremes: Extremes) {
        self.gain.store(extremes.gain, Relaxed);
        self.steepest.store(extremes.steepest, Relaxed);
    }
}

/// The groups' maxima of one slot. Only the thread side uses them.
pub(super) struct Maxima {
    groups: [Cell; MAX_KNOTS.div_ceil(GROUP)],
    large: [Cell; MAX_KNOTS.div_ceil(LARGE)],
}

impl Maxima {
    pub(super) const fn new() -> Self {
        Self {
            groups: [const { Cell::new() }; MAX_KNOTS.div_ceil(GROUP)],
            large: [const { Cell::new() }; MAX_KNOTS.div_ceil(LARGE)],
        }
    }

    /// Takes note that the knot at `index` has been written: it ends one interval and begins the next.
    pub(super) fn update(&self, index: usize, knots: &[KnotCell]) {
        let group = index / GROUP;
        self.sum_up(group, knots);
        if index.is_multiple_of(GROUP) && group > 0 {
            self.sum_up(group.saturating_sub(1), knots);
        }
    }

    /// Computes a group again, and the large group that it belongs to.
    fn sum_up(&self, group: usize, knots: &[KnotCell]) {
        let Some(cell) = self.groups.get(group) else { return };
        let (begin, end) = bounds(group);
        cell.set(one_by_one(begin..end, knots));
        let large = group / GROUP;
        if let Some(cell) = self.large.get(large) {
            let (begin, end) = bounds(large);
            cell.set(largest(&self.groups, begin..end.min(self.groups.len())));
        }
    }

    /// The extremes of the knots `first..=last` and of the intervals between them.
    pub(super) fn between(&self, first: usize, last: usize, knots: &[KnotCell]) -> Extremes {
        // A knot counts together with the interval that begins at it; the last one has none that counts.
        let gain = knots.get(last).map_or(0, |knot| knot.get().gain.0);
        let (begin, end) = inside(first, last);
        let extremes = if begin < end {
            self.groups_between(begin, end)
                .with(one_by_one(first..bounds(begin).0, knots))
                .with(one_by_one(bounds(end).0..last, knots))
        } else {
            one_by_one(first..last, knots)
        };
        extremes.with(Extremes { gain, steepest: 0 })
    }

    fn groups_between(&self, first: usize, end: usize) -> Extremes {
        let (begin_large, end_large) = inside(first, end);
        if begin_large < end_large {
            largest(&self.large, begin_large..end_large)
                .with(largest(&self.groups, first..bounds(begin_large).0))
                .with(largest(&self.groups, bounds(end_large).0..end))
        } else {
            largest(&self.groups, first..end)
        }
    }
}

/// The first member of a group, and the first after it.
const fn bounds(group: usize) -> (usize, usize) {
    let first = group.saturating_mul(GROUP);
    (first, first.saturating_add(GROUP))
}

/// The groups that lie wholly in `first..end`: the first of them, and the first after them.
const fn inside(first: usize, end: usize) -> (usize, usize) {
    (first.div_ceil(GROUP), end / GROUP)
}

fn largest(cells: &[Cell], range: Range<usize>) -> Extremes {
    let cells = cells.get(range).unwrap_or_default();
    cells.iter().fold(Extremes::default(), |extremes, cell| extremes.with(cell.get()))
}

/// The extremes of knots and of the intervals that begin at them.
fn one_by_one(range: Range<usize>, knots: &[KnotCell]) -> Extremes {
    let end = range.end.saturating_add(1).min(knots.len());
    let Some([first, others @ ..]) = knots.get(range.start..end) else { return Extremes::default() };
    let mut here = first.get();
    let mut extremes = Extremes::default();
    for next in others {
        let next = next.get();
        extremes = extremes.with(Extremes { gain: here.gain.0, steepest: here.step.abs_diff(next.step) });
        here = next;
    }
    extremes
}
