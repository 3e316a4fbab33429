//! The DAC's ring of two halves: which half may be written, and what it holds until then.
//!
//! ```text
//! ring:   | half 0: one block | half 1: one block |      DMA reads both in turn, one code per timer tick
//!              ^ written while      ^ played
//! ```
//! When the DMA leaves a half, its interrupt calls [`Halves::finish`], which fills that half with a straight line from
//! the last code of the half now playing to mid-scale (`slipline_app::safety::fade`). The renderer then writes its block over it.
//!
//! **A block that is late is not played.** Late is not only a half that the DMA has entered, but one that it will enter
//! within [`MARGIN`] samples: while the block is copied the DMA must not come into the same half, or it would play some
//! codes of the line and then some of the block. From a late block on, the halves keep what the interrupt wrote, one
//! line over as many of them as it needs; then blocks are taken again. So a missed deadline sounds as one line
//! from the last good code to mid-scale, and [`Halves::offer`] reports it.
//!
//! **A block that waits can be revised**, for a stop that comes after it was rendered, while [`REVISION`] samples are left
//! until the DMA enters its half ([`Halves::revise`]).
//!
//! Latency: a block is rendered and written while the other half plays, so the renderer has one block's time less
//! [`MARGIN`], and what it renders sounds one block after it began.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};

use slipline_app::BLOCK;
use slipline_app::dds::bank::code::MID_SCALE;
use slipline_app::safety::fade::fade;

/// A block is late if the DMA enters its half in fewer samples. Copying it takes about 600 cycles, at most 900 with the
/// interrupts that may come between, twice that with the flash's wait states: 1800 cycles
/// are 4.3 samples on the F407, 4.2 on the G474. The DMA holds one code more ready than its counter says.
pub(crate) const MARGIN: usize = 8;

/// A block that has been handed over can be revised if the DMA enters its half in no fewer samples. Until the new codes are
/// handed over the renderer takes 5709 cycles (F407) or 6604 cycles (G474), wait states included: 15.5 samples
/// (`tests/board/test_speed.py` compares). The DMA's interrupt may come between and take 3 more, and [`MARGIN`] comes on top.
pub(crate) const REVISION: usize = 28;

/// The block came too late.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Late;

/// The ring's memory and the DMA that reads it.
pub(crate) trait Ring {
    /// Writes a half (0 or 1), first code first.
    fn write(&self, half: usize, codes: impl Iterator<Item = u16>);
    /// As `write`, of a block.
    fn write_block(&self, half: usize, codes: &[u16; BLOCK]) {
        self.write(half, codes.iter().copied());
    }
    /// The last code of a half.
    fn last(&self, half: usize) -> u16;
    /// Codes of the ring that are left until the DMA begins it again: 1 to 2 * [`BLOCK`].
    fn left(&self) -> usize;

    /// The half that the DMA reads now.
    fn playing(&self) -> usize {
        usize::from(self.left() <= BLOCK)
    }
}

/// Counts of halves, modulo 2^32; the half a count stands for is its lowest bit.
///
/// `played` is written by the DMA's interrupt alone (or while it is off), the others by the renderer alone, and the
/// interrupt has the higher priority, so plain loads and stores are enough.
pub(crate) struct Halves {
    played: AtomicU32,
    written: AtomicU32,
    /// A block was late, and the line that it left is not known to be over.
    fading: AtomicBool,
}

impl Halves {
    /// A ring whose two halves both hold codes that may be played.
    pub(crate) const fn full() -> Self {
        Self { played: AtomicU32::new(0), written: AtomicU32::new(2), fading: AtomicBool::new(false) }
    }

    /// Fills the whole ring with the line from a code, and restarts; while the DMA is off.
    pub(crate) fn refill(&self, ring: &impl Ring, from: u16) {
        ring.write(0, fade(from));
        ring.write(1, fade(ring.last(0)));
        self.played.store(0, Relaxed);
        self.written.store(2, Relaxed);
        self.fading.store(true, Relaxed);
    }

    /// The DMA has left a half: it holds the line until it is written.
    pub(crate) fn finish(&self, ring: &impl Ring) {
        let played = self.played.load(Relaxed);
        self.played.store(played.wrapping_add(1), Relaxed);
        let left = (played & 1) as usize;
        ring.write(left, fade(ring.last(1 - left)));
    }

    /// Puts the counts in step with the DMA after interrupts were lost, and the line into the half it does not read.
    // Rare: it takes no room among what every block runs.
    #[cold]
    pub(crate) fn resynchronise(&self, ring: &impl Ring) {
        let playing = ring.playing();
        let played = self.played.load(Relaxed).wrapping_add(2);
        let behind = u32::from((played & 1) as usize != playing);
        self.played.store(played.wrapping_add(behind), Relaxed);
        ring.write(1 - playing, fade(ring.last(playing)));
    }

    /// Which half of the ring's endless row of halves the block has that was taken last, modulo 2^32; the codes of half
    /// `n` are the DMA's fetches from `128 n` on. A block that was late has one, too.
    pub(crate) fn taken(&self) -> u32 {
        self.written.load(Relaxed).wrapping_sub(1)
    }

    /// Codes that the DMA has fetched since it began, modulo 2^32. Exact unless the DMA's interrupt has been late by a whole
    /// block; an interrupt that is pending during the call is counted.
    pub(crate) fn fetched(&self, ring: &impl Ring) -> u32 {
        let mut played = self.played.load(Relaxed);
        loop {
            let left = ring.left();
            let again = self.played.load(Relaxed);
            // Between the two reads the interrupt may have come, once: it does not come twice in a row.
            if again == played {
                let is_pending = (played & 1) as usize != usize::from(left <= BLOCK);
                let half = played.wrapping_add(u32::from(is_pending));
                let within = (2 * BLOCK).saturating_sub(left) % BLOCK;
                return half.wrapping_mul(BLOCK as u32).wrapping_add(within as u32);
            }
            played = again;
        }
    }

    /// Whether both halves hold codes that have not been played, so that neither can be written. Changes nothing.
    pub(crate) fn is_full(&self) -> bool {
        self.unplayed() == 2
    }

    /// Halves that hold unplayed codes, the one that plays included: 2 if the ring is full, 1 if a half is free, anything
    /// else if the DMA plays a half that was not written.
    fn unplayed(&self) -> u32 {
        self.written.load(Relaxed).wrapping_sub(self.played.load(Relaxed))
    }

    /// Takes a block and returns true, or false while the ring is full.
    ///
    /// # Errors
    /// [`Late`]: the block is not played, it has taken up its time in the ring, and the ring is in step again.
    pub(crate) fn offer(&self, ring: &impl Ring, codes: &[u16; BLOCK]) -> Result<bool, Late> {
        match self.unplayed() {
            2 => return Ok(false),
            1 => {}
            _ => return Err(self.late()),
        }
        let written = self.written.load(Relaxed);
        let free = (written & 1) as usize;
        if samples_until(free, ring) < MARGIN {
            return Err(self.late());
        }
        // The line is over when the half that plays ends at mid-scale: so does all of the free half then.
        let fading = self.fading.load(Relaxed) && ring.last(1 - free) != MID_SCALE;
        self.fading.store(fading, Relaxed);
        if !fading {
            ring.write_block(free, codes);
        }
        if self.unplayed() != 1 {
            return Err(self.late());
        }
        self.written.store(written.wrapping_add(1), Relaxed);
        Ok(true)
    }

    /// Whether the half that was written last will be played as it is, and waits for long enough still to be written again.
    pub(crate) fn is_revisable(&self, ring: &impl Ring) -> bool {
        !self.fading.load(Relaxed) && self.waits_for(ring) >= REVISION
    }

    /// Writes other codes into the half that was written last, which is revisable.
    ///
    /// # Errors
    /// [`Late`]: the half is played as it was, and the line follows it.
    pub(crate) fn revise(&self, ring: &impl Ring, codes: &[u16; BLOCK]) -> Result<(), Late> {
        if self.waits_for(ring) < MARGIN {
            self.fading.store(true, Relaxed);
            return Err(Late);
        }
        ring.write_block(self.written_last(), codes);
        Ok(())
    }

    fn written_last(&self) -> usize {
        (self.written.load(Relaxed).wrapping_sub(1) & 1) as usize
    }

    /// Samples until the DMA enters the half that was written last; 0 if it may have done so.
    fn waits_for(&self, ring: &impl Ring) -> usize {
        if self.unplayed() == 2 { samples_until(self.written_last(), ring) } else { 0 }
    }

    /// The block's half is the one that is free or, if the DMA has left that behind, the one that plays.
    fn late(&self) -> Late {
        let free = if self.unplayed() == 1 { 2 } else { 1 };
        self.written.store(self.played.load(Relaxed).wrapping_add(free), Relaxed);
        self.fading.store(true, Relaxed);
        Late
    }
}

/// Samples until the DMA enters a half; 0 while it plays that.
fn samples_until(half: usize, ring: &impl Ring) -> usize {
    let left = ring.left();
    // Half 0 plays while more than a block is left of the ring.
    match (half, left > BLOCK) {
        (0, true) | (1, false) => 0,
        (0, false) => left,
        (_, _) => left.saturating_sub(BLOCK),
    }
}

#[cfg(test)]
mod tests;
