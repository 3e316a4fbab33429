//! What stays the same while an FDTD grid runs: weights, the extent of each row, and the tiling in rows and steps.

use super::kernel::{CHUNK, COLUMNS, GhostCells, Weights, place};
use super::vector::{LANES, Line, Width};
use std::ops::Range;

/// Bytes of a block's rows that may fill the first-level cache.
const NEAR_BYTES: usize = 52 * 1024;
/// Bytes of a block's rows that stay in the second-level cache.
const FAR_BYTES: usize = 640 * 1024;

/// What stays the same while an FDTD grid runs; rows are numbered from the centre line or from one edge.
#[derive(Debug, Clone)]
pub(super) struct Plan {
    /// Lines from one row to the next in memory.
    pub(super) stride: usize,
    /// Rows of a group, 2 or 4: a whole group is advanced at once, a part of one row by row.
    pub(super) group: usize,
    /// Steps per block.
    pub(super) depth: usize,
    /// Whether row 0 is a line of symmetry (else there is an edge before it).
    pub(super) mirrored: bool,
    pub(super) weights: Weights,
    /// Number of cells of each row that are inside.
    pub(super) reach: Vec<usize>,
    /// The extent that is computed of each row.
    computed: Vec<Computed>,
    /// The chunks with cells beside the edge or with ghost cells, row after row.
    ghosts: Vec<GhostCells>,
    /// The driven column at x = 0; `None` for a fixed edge.
    pub(super) column: Option<Column>,
    /// Rows whose envelope is recorded.
    pub(super) recorded: Range<usize>,
    pub(super) width: Width,
}

impl Plan {
    pub(super) fn rows(&self) -> usize {
        self.reach.len()
    }

    /// What is computed of `N` rows of a group from `row` on.
    #[inline(always)]
    pub(super) fn extent<const N: usize>(&self, row: usize) -> Extent<'_> {
        let Computed { line, chunks, beside, ghosts } = self.computed[row];
        Extent { line: line as usize, chunks, ghosts: &self.ghosts[ghosts as usize..][..N * beside as usize] }
    }
}

/// What is computed of some rows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extent<'a> {
    /// Where the first row would begin in a field that holds all rows.
    pub(super) line: usize,
    /// Chunks of a row. (Of 32 bits, so that the compiler sees that no sum overflows.)
    pub(super) chunks: u32,
    /// The last chunks of each row, those beside the edge, row after row.
    pub(super) ghosts: &'a [GhostCells],
}

/// What is computed of a row, the same number of chunks for the rows of a group.
#[derive(Debug, Clone, Copy)]
struct Computed {
    line: u32,
    chunks: u32,
    /// Chunks with cells beside the edge or with ghost cells: the last ones.
    beside: u32,
    /// Where those begin in [`Plan::ghosts`].
    ghosts: u32,
}

/// The driven column: `next = own v - past before + inward right + across (above + below) + profile u`.
#[derive(Debug, Clone)]
pub(super) struct Column {
    pub(super) own: Vec<f32>,
    pub(super) past: f32,
    pub(super) inward: f32,
    pub(super) across: f32,
    pub(super) profile: Vec<f32>,
}

/// Which cells there are.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cells<'a> {
    /// Cells of each row that are inside.
    pub(super) reach: &'a [usize],
    /// Where each row's cells beside the edge begin.
    pub(super) plain: &'a [usize],
    /// Every inside cell's own weight.
    pub(super) own: &'a [Vec<f32>],
    /// Whether row 0 is a line of symmetry.
    pub(super) mirrored: bool,
}

/// Lays the rows out in memory and chooses the tiling.
pub(super) fn plan_of(
    cells: Cells<'_>,
    weights: Weights,
    column: Option<Column>,
    recorded: Range<usize>,
) -> Plan {
    plan_at(tiling_of(stride_of(cells.reach)), cells, weights, column, recorded)
}

/// Lines from one row to the next: at least one chunk, for the kernel looks one beyond a row, and before it the line
/// whose last lane is the driven column and whose lane 0 is the zero after the row before. That line keeps rows of a
/// power of two from falling on the same cache sets.
fn stride_of(reach: &[usize]) -> usize {
    reach.iter().copied().max().unwrap_or(0).max(1).next_multiple_of(CHUNK) / LANES + 1
}

/// As [`plan_of`], in groups of 2 or 4 rows and blocks of so many steps (at most 64, a power of two).
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
        // The rows of a group are computed as far as the longest one goes.
        // (A sheet's numbers of lines and chunks are far below 2^32: it has some 2^24 cells at most.)
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
/// The rows of a group share what they read and are advanced in one pass. Best is a block of groups of four whose rows
/// stay in the first-level cache; then one of pairs; then a deep one that stays in the second-level cache.
fn tiling_of(stride: usize) -> (usize, usize) {
    // A block of d steps keeps d + 2 groups of both fields busy.
    let bytes = |group: usize, depth: usize| 2 * (depth + 2) * group * stride * size_of::<Line>();
    // Depths are powers of two, so that blocks end on multiples of FLUSH_EVERY.
    let depth = |group: usize, budget: usize| [16, 8, 4].into_iter().find(|&d| bytes(group, d) <= budget);
    let near = |group: usize| depth(group, NEAR_BYTES).map(|depth| (group, depth));
    near(4).or_else(|| near(2)).unwrap_or((2, depth(2, FAR_BYTES).unwrap_or(4)))
}
