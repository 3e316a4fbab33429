//! Interrupt side to thread side: what the renderer writes at the end of a block.

use crate::safety::foldback::Foldback;

/// The renderer's report at the end of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Report {
    /// Nothing sounds from the next block on, until a program says so.
    pub silent: bool,
    /// A stop is ramping.
    pub stopping: bool,
    /// The amplifier is off while the block sounds.
    pub muted: bool,
    /// The sum of the amplitudes at the block's end, Q1.31.
    pub sum: u64,
    /// The sum of the squares of all codes' distances from mid-scale since reset; wraps.
    pub energy: u64,
    /// Codes clamped since reset.
    pub clips: u32,
    /// Underruns since reset.
    pub underruns: u32,
    /// The most cycles a block took.
    pub max_cycles: u32,
    /// The thermal fold-back; the present period began at [`limit_since`](crate::Timing::limit_since) this block's end.
    /// `None` before the first block after the coil's data arrived.
    pub foldback: Option<Foldback>,
}

impl Report {
    /// Before the first block.
    pub(crate) const SILENT: Self = Self {
        silent: true,
        stopping: false,
        muted: true,
        sum: 0,
        energy: 0,
        clips: 0,
        underruns: 0,
        max_cycles: 0,
        foldback: None,
    };
}
