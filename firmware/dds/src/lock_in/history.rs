//! Phases and tones of the last rendered blocks, kept until the ADC's codes of the same samples come.

use crate::bank::{TONES, ToneBlock};

/// Blocks that are remembered: one is rendered while one waits, one plays, and one has just been played.
const BLOCKS: usize = 4;

/// How one tone of a block was rendered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct PlayedTone {
    /// Its phase at the block's first sample, 2^64 = one turn.
    pub phase: u64,
    /// The tone.
    pub tone: ToneBlock,
}

/// How one block was rendered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Played {
    /// Its first sample.
    pub index: u64,
    /// The tones.
    pub tones: [PlayedTone; TONES],
}

impl Played {
    /// Stands for no block: no block has this index, which is not a multiple of a block's length.
    const NONE: Self =
        Self { index: u64::MAX, tones: [PlayedTone { phase: 0, tone: ToneBlock::steady(0, 0) }; TONES] };
}

/// The last blocks that were rendered. A stop that revises a block changes amplitudes, not phases, and is not noted here.
#[derive(Clone, Debug)]
pub struct History {
    blocks: [Played; BLOCKS],
    next: usize,
}

impl History {
    /// No blocks.
    #[must_use]
    pub const fn new() -> Self {
        Self { blocks: [Played::NONE; BLOCKS], next: 0 }
    }

    /// Remembers a block, and forgets the oldest.
    // A call: a caller that measures nothing does not pay for its registers.
    #[inline(never)]
    pub fn record(&mut self, index: u64, phases: &[u64; TONES], tones: &[ToneBlock; TONES]) {
        if let Some(place) = self.blocks.get_mut(self.next) {
            place.index = index;
            for (played, (phase, tone)) in place.tones.iter_mut().zip(phases.iter().zip(tones)) {
                *played = PlayedTone { phase: *phase, tone: *tone };
            }
        }
        self.next = (self.next + 1) % BLOCKS;
    }

    /// The block that begins at an index, if it is remembered.
    #[must_use]
    pub fn at(&self, index: u64) -> Option<&Played> {
        self.blocks.iter().find(|block| block.index == index)
    }
}
