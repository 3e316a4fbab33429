//! The inner loops of the sheet: the leapfrog update of rows, and the flush of denormal numbers.
//!
//! A row is stored in chunks of 64 cells, each as four columns of 16 lanes:
//!
//! ```text
//!           lane  0  1  2 ..  15
//!  column 0       0  4  8 ..  60      of every chunk: the neighbours of a cell along the row are in the same lane of
//!  column 1       1  5  9 ..  61      the next columns. Only the left neighbours of column 0 and the right neighbours
//!  column 2       2  6 10 ..  62      of column 3 are in another lane. So 64 cells take two moves across lanes; stored
//!  column 3       3  7 11 ..  63      in their natural order they would take eight.
//! ```
//!
//! Before the first chunk lies one more line. Its last lane is the cell before cell 0, and its lane 0 is the cell after
//! the last cell of the previous row.

#![expect(clippy::needless_range_loop, reason = "rows and columns number several arrays at once")]

use super::vector::{LANES, Lanes, Line, Work};

/// Lines of a chunk.
pub(super) const COLUMNS: usize = 4;
/// Cells of a chunk.
pub(super) const CHUNK: usize = COLUMNS * LANES;

/// Line and lane of a cell; lines are counted from the first line of the first chunk.
pub(super) fn place(cell: usize) -> (usize, usize) {
    let (chunk, within) = (cell / CHUNK, cell % CHUNK);
    (chunk * COLUMNS + within % COLUMNS, within / COLUMNS)
}

/// The four numbers of the update `next = own v - past before + along (left + right) + across (above + below)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Weights {
    pub(super) own: f32,
    pub(super) past: f32,
    pub(super) along: f32,
    pub(super) across: f32,
}

impl Weights {
    /// Whether there is no loss. Then the weight of the past field is 1, which saves a multiplication.
    pub(super) fn is_lossless(&self) -> bool {
        self.past == 1.0
    }
}

/// The four lines of a chunk.
pub(super) type Chunk = [Line; COLUMNS];

/// A chunk with cells next to the plate's edge and ghost cells beyond it, which stay zero.
///
/// The ghost value that the fixed edge requires is eliminated: instead, the cell inside has another own weight.
#[derive(Debug, Clone, Copy)]
pub(super) struct GhostCells {
    /// Own weight of each cell.
    pub(super) own: Chunk,
    /// 1 inside the plate, 0 outside.
    pub(super) inside: Chunk,
}

/// Positions of neighbouring rows in a field, and their chunks with ghost cells.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place<'a> {
    /// The line before the first row's first chunk.
    pub(super) at: usize,
    /// The same line of the row above the first.
    pub(super) above_at: usize,
    /// Lines from one row to the next.
    pub(super) stride: usize,
    /// Chunks per row. (32 bits show the compiler that no sum overflows.)
    pub(super) chunks: u32,
    /// The last chunks of each row, those with ghost cells, row after row.
    pub(super) ghosts: &'a [GhostCells],
}

/// The weights as vectors, the same number in each lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct WeightVectors<V> {
    own: V,
    minus_past: V,
    along: V,
    across: V,
}

impl<V> WeightVectors<V> {
    #[inline(always)]
    pub(super) fn new<L: Lanes<Vector = V>>(lanes: L, weights: Weights) -> Self {
        Self {
            own: lanes.splat(weights.own),
            minus_past: lanes.splat(-weights.past),
            along: lanes.splat(weights.along),
            across: lanes.splat(weights.across),
        }
    }
}

/// Advances `N` rows by one step: `past`, the field one step before `now`, becomes the field one step after it.
///
/// `LOSSLESS`: [`Weights::is_lossless`].
#[inline(always)]
pub(super) fn advance<L: Lanes, const N: usize, const LOSSLESS: bool>(
    lanes: L,
    weights: WeightVectors<L::Vector>,
    (past, now): (&mut [Line], &[Line]),
    place: Place<'_>,
) {
    let rows = Rows::<N>::new(past, now, place);
    let mut before = [weights.own; N];
    for (before, row) in before.iter_mut().zip((place.at..).step_by(place.stride)) {
        *before = lanes.load(&now[row]);
    }
    let chunks = place.chunks as usize;
    let beside = place.ghosts.len() / N;
    let plain = chunks.saturating_sub(beside);
    for chunk in 0..plain {
        let own = [[weights.own; COLUMNS]; N];
        let next = rows.next::<L, LOSSLESS>(lanes, chunk, &mut before, own, weights);
        for row in 0..N {
            for column in 0..COLUMNS {
                lanes.store(next[row][column], &mut rows.past[row][chunk][column]);
            }
        }
    }
    for chunk in plain..chunks {
        let mut own = [[weights.own; COLUMNS]; N];
        for row in 0..N {
            let ghosts = &place.ghosts[row * beside + chunk - plain];
            for column in 0..COLUMNS {
                own[row][column] = lanes.load(&ghosts.own[column]);
            }
        }
        let next = rows.next::<L, LOSSLESS>(lanes, chunk, &mut before, own, weights);
        for row in 0..N {
            let ghosts = &place.ghosts[row * beside + chunk - plain];
            for column in 0..COLUMNS {
                let inside = lanes.load(&ghosts.inside[column]);
                lanes.store(lanes.multiply(next[row][column], inside), &mut rows.past[row][chunk][column]);
            }
        }
    }
}

/// Largest number of rows advanced together.
const ROWS_MAX: usize = 4;

/// The chunks of `N` rows and of the rows above and below them.
struct Rows<'a, const N: usize> {
    past: [&'a mut [Chunk]; ROWS_MAX],
    now: [&'a [Chunk]; N],
    /// As `now`, one chunk later: its first line follows the chunk of `now`.
    after: [&'a [Chunk]; N],
    above: &'a [Chunk],
    below: &'a [Chunk],
}

impl<'a, const N: usize> Rows<'a, N> {
    #[inline(always)]
    fn new(past: &'a mut [Line], now: &'a [Line], place: Place<'_>) -> Self {
        const { assert!(N <= ROWS_MAX) };
        let count = place.chunks as usize * COLUMNS;
        let above = now[place.above_at..][1..1 + count].as_chunks().0;
        let mut rows = Self {
            past: [&mut [], &mut [], &mut [], &mut []],
            now: [above; N],
            after: [above; N],
            above,
            below: above,
        };
        let (mut past, mut now) = (&mut past[place.at..], &now[place.at..]);
        for row in 0..N {
            let window = &now[..1 + count + COLUMNS];
            rows.now[row] = window[1..1 + count].as_chunks().0;
            rows.after[row] = window[1 + COLUMNS..].as_chunks().0;
            now = &now[place.stride..];
            let (lines, others) = past.split_at_mut(place.stride);
            rows.past[row] = lines[1..1 + count].as_chunks_mut().0;
            past = others;
        }
        rows.below = now[1..1 + count].as_chunks().0;
        rows
    }

    /// Computes a chunk after the step. `before` is the line before the chunk, and on return the line before the next
    /// one.
    #[inline(always)]
    fn next<L: Lanes, const LOSSLESS: bool>(
        &self,
        lanes: L,
        chunk: usize,
        before: &mut [L::Vector; N],
        own: [[L::Vector; COLUMNS]; N],
        weights: WeightVectors<L::Vector>,
    ) -> [[L::Vector; COLUMNS]; N] {
        const LAST: usize = COLUMNS - 1;
        let (above, below) = (&self.above[chunk], &self.below[chunk]);
        let mut now = own;
        for row in 0..N {
            for column in 0..COLUMNS {
                now[row][column] = lanes.load(&self.now[row][chunk][column]);
            }
        }
        let mut next = own;
        for row in 0..N {
            let cells = now[row];
            let after = lanes.load(&self.after[row][chunk][0]);
            for column in 0..COLUMNS {
                let left = if column == 0 { lanes.up(before[row], cells[LAST]) } else { cells[column - 1] };
                let right = if column == LAST { lanes.down(cells[0], after) } else { cells[column + 1] };
                let up = if row == 0 { lanes.load(&above[column]) } else { now[row - 1][column] };
                let down = if row == N - 1 { lanes.load(&below[column]) } else { now[row + 1][column] };
                let (beside, across) = (lanes.add(left, right), lanes.add(up, down));
                let past = lanes.load(&self.past[row][chunk][column]);
                let rest = if LOSSLESS {
                    lanes.multiply_subtract(weights.across, across, past)
                } else {
                    lanes.multiply_add(weights.minus_past, past, lanes.multiply(weights.across, across))
                };
                let others = lanes.multiply_add(weights.along, beside, rest);
                next[row][column] = lanes.multiply_add(own[row][column], cells[column], others);
            }
            before[row] = cells[LAST];
        }
        next
    }
}

/// Sets numbers below 1e-30 to zero before they become denormal: an operation on a denormal number takes some hundred
/// cycles.
pub(super) struct FlushDenormals<'a>(pub(super) &'a mut [Line]);

impl Work for FlushDenormals<'_> {
    #[inline(always)]
    fn with<L: Lanes>(self, _lanes: L) {
        for value in self.0.as_flattened_mut() {
            *value = if value.abs() < 1e-30 { 0.0 } else { *value };
        }
    }
}
