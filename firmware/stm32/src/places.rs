//! Where the renderer's blocks lie among the ADC's codes.
//!
//! ```text
//! trigger        0     1 ... 128     129 ... 256     257 ...       counted since the sample timer began
//! DAC's pin    held    half 0        half 1          half 2        the code that the DMA fetched with the trigger before
//! ADC            code of every trigger, the first one's first
//! ```
//! So the block that the ring takes as half `n` is at the pin with triggers `128 n + 1 ..= 128 n + 128`, and the ADC's codes
//! of these triggers are its own. The renderer's blocks usually are the halves from 2 on, one after the other; one that is
//! late may leave halves out, and the DAC's ring may restart. So each block's half is kept until its codes are read, or
//! lost: what the renderer counts and what the ADC counts cannot part.

use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

use slipline_app::BLOCK;

/// Blocks that are remembered: two wait or play when one is read, and the ADC's ring has no more.
const REMEMBERED: usize = 4;

/// The oldest block that has not been read, searched among the sampled codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Search {
    /// It is not over yet, or there is none.
    Pending,
    /// The trigger of its first code.
    Found(u32),
    /// Number of lost blocks, this one the first.
    Lost(u32),
}

/// The codes of the ADC that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Sampled {
    /// The trigger after the last code's, modulo 2^32.
    pub(crate) until: u32,
    /// The number of blocks before it.
    pub(crate) count: u32,
}

/// The halves of the blocks that the DAC has taken. All of it is the renderer's, before it runs the start-up's.
pub(crate) struct Places {
    halves: [AtomicU32; REMEMBERED],
    /// Blocks that were taken, and those of them, from the first on, that cannot be read; modulo 2^32.
    taken: AtomicU32,
    gone: AtomicU32,
}

impl Places {
    /// No block has been taken.
    pub(crate) const fn new() -> Self {
        Self {
            halves: [const { AtomicU32::new(0) }; REMEMBERED],
            taken: AtomicU32::new(0),
            gone: AtomicU32::new(0),
        }
    }

    /// The ring has taken a block as its half `half`.
    pub(crate) fn take(&self, half: u32) {
        let taken = self.taken.load(Relaxed);
        if let Some(place) = self.halves.get(taken as usize % REMEMBERED) {
            place.store(half, Relaxed);
        }
        self.taken.store(taken.wrapping_add(1), Relaxed);
    }

    /// A block has come that the ring cannot take.
    pub(crate) fn skip(&self) {
        self.taken.store(self.taken.load(Relaxed).wrapping_add(1), Relaxed);
        self.forget();
    }

    /// All blocks so far are lost: the ring restarts.
    pub(crate) fn forget(&self) {
        self.gone.store(self.taken.load(Relaxed), Relaxed);
    }

    /// Blocks that were taken, from block `next` on.
    pub(crate) fn waiting(&self, next: u32) -> u32 {
        self.taken.load(Relaxed).wrapping_sub(next)
    }

    /// Looks for block `next`, of those that were taken.
    pub(crate) fn find(&self, next: u32, sampled: Sampled) -> Search {
        let waiting = self.waiting(next);
        // Blocks before `gone` are gone; where `next` is beyond it, the difference is a huge number.
        let gone = self.gone.load(Relaxed).wrapping_sub(next);
        let gone = if gone <= waiting { gone } else { 0 };
        let mut lost = gone.max(waiting.saturating_sub(REMEMBERED as u32));
        while lost < waiting {
            match self.look(next.wrapping_add(lost), sampled) {
                Search::Lost(blocks) => lost = lost.wrapping_add(blocks),
                other if lost == 0 => return other,
                _ => break,
            }
        }
        if lost == 0 { Search::Pending } else { Search::Lost(lost) }
    }

    /// Looks for one block, which is remembered.
    fn look(&self, block: u32, sampled: Sampled) -> Search {
        let half = self.halves.get(block as usize % REMEMBERED).map_or(0, |half| half.load(Relaxed));
        let first = half.wrapping_mul(BLOCK as u32).wrapping_add(1);
        // How long ago its first code was sampled; beyond 2^31 it is yet to be.
        match sampled.until.wrapping_sub(first) {
            ago if ago > u32::MAX / 2 => Search::Pending,
            ago if ago > sampled.count => Search::Lost(1),
            ago if ago < BLOCK as u32 => Search::Pending,
            _ => Search::Found(first),
        }
    }
}

#[cfg(test)]
mod tests;
