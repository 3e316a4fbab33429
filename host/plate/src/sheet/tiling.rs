//! The constant data of an FDTD grid: weights, the extent of each row, and the tiling in rows and steps.

use super::contact::TouchedCells;
use super::kernel::{CHUNK, COLUMNS, GhostCells, Weights, place};
use super::vector::{LANES, Line, Width};
use std::ops::Range;

/// Largest size of a block's rows in the first-level cache, bytes.
const NEAR_BYTES: usize = 52 * 1024;
/// Largest size of a block's rows in the second-level cache, bytes.
const FAR_BYTES: usize = 640 * 1024;

/// The constant data of an FDTD grid. Rows are numbered from the centre line or, without a mirror, from one edge.
#[derive(Debug, Clone)]
pub(super) struct Plan {
    /// Lines from one row to the next in memory.
    pub(super) stride: usize,
    /// Rows per group, 2 or 4. A whole group is advanced at once, an incomplete one row by row.
    pub(super) group: usize,
    /// Steps per block.
    pub(super) depth: usize,
    /// Whether row 0 is the line of symmetry; otherwise an edge lies before it.
    pub(super) mirrored: bool,
    pub(super) weights: Weights,
    /// Number of cells inside the plate in each row.
    pub(super) reach: Vec<usize>,
    /// The part of each row that is computed.
    computed: Vec<Computed>,
    /// The chunks with cells next to the edge or with ghost cells, row after row.
    ghosts: Vec<GhostCells>,
    /// The driven column at x = 0; `None` for a fixed edge.
    pub(super) column: Option<Column>,
    /// The cells under a finger, if there is one.
    pub(super) touched: Option<TouchedCells>,
    /// Rows whose envelope is recorded.
    pub(super) recorded: Range<usize>,
    pub(super) width: Width,
}

impl Plan {
    pub(super) fn rows(&self) -> usize {
        self.reach.len()
    }

    /// The computed part of the `N` rows of a group, starting at `row`.
    #[inline(always)]
    pub(super) fn extent<const N: usize>(&self, row: usize) -> Extent<'_> {
        let Computed { line, chunks, beside, ghosts } = self.computed[row];
        Extent { line: line as usize, chunks, ghosts: &self.ghosts[ghosts as usize..][..N * beside as usize] }
    }
}

/// The part of some rows that is computed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extent<'a> {
    /// The first line of the first row in a field of all rows.
    pub(super) line: usize,
    /// Chunks per row. (32 bits show the compiler that no sum overflows.)
    pub(super) chunks: u32,
    /// The last chunks of each row, those with ghost cells, row after row.
    pub(super) ghosts: &'a [GhostCells],
}

/// The part of a row that is computed; all rows of a group have the same number of chunks.
#[derive(Debug, Clone, Copy)]
struct Computed {
    line: u32,
    chunks: u32,
    /// Number of chunks with cells next to the edge or with ghost cells; they are the last ones.
    beside: u32,
    /// Index of the first of them in [`Plan::ghosts`].
    ghosts: u32,
}

/// The driven column, row by row.
#[derive(Debug, Clone)]
pub(super) struct Column {
    pub(super) points: Vec<ColumnPoint>,
}

/// A point of the driven column: `next = own v - past before + inward right + across (above + below) + profile u`.
#[derive(Debug, Clone, Copy)]
pub(super) struct ColumnPoint {
    pub(super) own: f32,
    pub(super) past: f32,
    pub(super) inward: f32,
    pub(super) across: f32,
    pub(super) profile: f32,
}

/// The cells of a grid.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cells<'a> {
    /// Number of cells inside the plate in each row.
    pub(super) reach: &'a [usize],
    /// Number of cells with the common weights in each row; the cells next to the edge follow them.
    pub(super) plain: &'a [usize],
    /// Own weight of every cell inside.
    pub(super) own: &'a [Vec<f32>],
    /// Whether row 0 is the line of symmetry.
    pub(super) mirrored: bool,
}

/// Chooses the tiling and the memory layout of the rows.
pub(super) fn plan_of(
    cells: Cells<'_>,
    weights: Weights,
    column: Option<Column>,
    recorded: Range<usize>,
) -> Plan {
    plan_at(tiling_of(stride_of(cells.reach)), cells, weights, column, recorded)
}

/// Lines from one row to the next: the row's chunks, at least one because the kernel reads one beyond the row, and
/// before them a line whose last lane is the driven column and whose lane 0 is the zero after the previous row. That
/// line also makes the stride odd, so that rows whose length is a power of two do not share the same cache sets.
fn stride_of(reach: &[usize]) -> usize {
    reach.iter().copied().max().unwrap_or(0).max(1).next_multiple_of(CHUNK) / LANES + 1
}

/// As [`plan_of`] with a given tiling: groups of 2 or 4 rows, and blocks of `depth` steps (a power of two, at most 64).
pub(super) fn plan_at(
    (group, depth): (usize, usize),
    Cells { reach, plain, own, mirrored }: Cells<'_>,
    weights: Weights,
    column: Option<Column>,
    recorded: Range<usize>,
) -> Plan {
    let stride = stride_of(reach);
    let (mut computed, mut ghosts) = (Vec::with_capacity(reach.len()), Vec::new());
    for (number, (reaches, plains)) in reach.chunks(group).zip(plain.chunks(group)).enumerate() {
        // All rows of a group are computed up to the end of the longest one.
        // (A sheet has about 2^24 cells at most, so its numbers of lines and chunks are far below 2^32.)
        let end = reaches.iter().copied().max().unwrap_or(0).div_ceil(CHUNK);
        let start = (plains.iter().copied().min().unwrap_or(0) / CHUNK).min(end);
        for (&reach, own) in reaches.iter().zip(&own[group * number..]) {
            let beside = (end - start) as u32;
            let line = (computed.len() * stride) as u32;
            computed.push(Computed { line, chunks: end as u32, beside, ghosts: ghosts.len() as u32 });
            ghosts.extend((start..end).map(|chunk| ghost_cells_at(chunk, reach, own)));
        }
    }
    Plan {
        stride,
        group,
        depth,
        mirrored,
        weights,
        reach: reach.to_vec(),
        computed,
        ghosts,
        column,
        touched: None,
        recorded,
        width: Width::detect(),
    }
}

/// One chunk of a row that has `reach` cells inside, with their own weights.
fn ghost_cells_at(chunk: usize, reach: usize, own: &[f32]) -> GhostCells {
    let mut ghosts = GhostCells { own: [[0.0; LANES]; COLUMNS], inside: [[0.0; LANES]; COLUMNS] };
    for (cell, own) in own[..reach].iter().skip(chunk * CHUNK).take(CHUNK).enumerate() {
        let (line, lane) = place(cell);
        ghosts.own[line][lane] = *own;
        ghosts.inside[line][lane] = 1.0;
    }
    ghosts
}

/// The tiling for rows of `stride` lines: rows in a group and steps in a block.
///
/// The rows of a group are advanced together and share the rows that they read. The first choice is a block of groups
/// of four whose rows fit in the first-level cache, then one of groups of two, then one whose rows fit in the
/// second-level cache.
fn tiling_of(stride: usize) -> (usize, usize) {
    // A block of d steps keeps d + 2 groups of both fields busy.
    let bytes = |group: usize, depth: usize| 2 * (depth + 2) * group * stride * size_of::<Line>();
    // Depths are powers of two, so that blocks end on multiples of FLUSH_EVERY.
    let depth = |group: usize, budget: usize| [16, 8, 4].into_iter().find(|&d| bytes(group, d) <= budget);
    let near = |group: usize| depth(group, NEAR_BYTES).map(|depth| (group, depth));
    near(4).or_else(|| near(2)).unwrap_or((2, depth(2, FAR_BYTES).unwrap_or(4)))
}
