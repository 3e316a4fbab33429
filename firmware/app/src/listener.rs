//! The listener: hands the ADC's blocks to the lock-ins and the capture, with the index of each, and counts what is lost.
//!
//! ```text
//! renderer --block_is_rendered--> History --+
//!                                           v
//! SenseStream --catch_up--> block ------> lock-ins, capture
//! ```
//! A listener that measures nothing takes the blocks and drops them, which costs next to nothing.

use crate::bank::{BLOCK, TONES, ToneBlock};
use crate::capture::{Capture, Values};
use crate::lock_in::{History, LockIn, State};
use crate::ports::{INPUTS, Overrun, SenseStream};
use crate::timing::BLOCK_SAMPLES;
use slipline_protocol::units::SampleIndex;

/// What listens to the inputs.
#[derive(Clone, Debug)]
pub struct Listener<'a> {
    /// How the blocks were rendered that the ADC has yet to sample.
    pub history: History,
    /// The lock-ins of the tones.
    pub lock_in: LockIn,
    /// The capture.
    pub capture: Capture<'a>,
    next: SampleIndex,
    lost_blocks: u32,
    codes: [[u16; BLOCK]; INPUTS],
}

impl<'a> Listener<'a> {
    /// A listener whose first block begins at `index`, a multiple of 128: that of the DAC's first code. What it captures will
    /// be in `values`.
    #[must_use]
    pub const fn starting_at(index: SampleIndex, values: &'a Values) -> Self {
        Self {
            history: History::new(),
            lock_in: LockIn::new(),
            capture: Capture::new(values),
            next: index,
            lost_blocks: 0,
            codes: [[0; BLOCK]; INPUTS],
        }
    }

    /// The first sample of the next block.
    #[must_use]
    pub const fn next(&self) -> SampleIndex {
        self.next
    }

    /// Blocks that were lost since the start; stays at `u32::MAX` once there.
    #[must_use]
    pub const fn lost_blocks(&self) -> u32 {
        self.lost_blocks
    }

    /// Remembers how a block is rendered, while a lock-in may need it: its first sample, every tone's phase there, and the
    /// tones. For every block, before the DAC plays it.
    pub fn block_is_rendered(
        &mut self,
        index: SampleIndex,
        phases: &[u64; TONES],
        tones: &[ToneBlock; TONES],
    ) {
        if self.lock_in.state() == State::Measuring {
            self.history.record(index, phases, tones);
        }
    }

    /// Takes the blocks that have been sampled, but at most one that the lock-ins work on: two would cost more time than
    /// a block has. One that waits is taken at the next turn.
    pub fn catch_up(&mut self, stream: &mut impl SenseStream) {
        loop {
            let is_dear = self.lock_in.works_at(self.next);
            if !self.listen(stream) || is_dear {
                return;
            }
        }
    }

    /// Takes one block, if one has been sampled; returns whether there was one. Blocks that were lost take up their
    /// indices: a measurement over them [breaks](crate::lock_in::State::Broken), all others go on.
    pub fn listen(&mut self, stream: &mut impl SenseStream) -> bool {
        match stream.take_block(&mut self.codes) {
            None => return false,
            Some(Err(Overrun { blocks })) => {
                self.lost_blocks = self.lost_blocks.saturating_add(blocks);
                self.next = self.next.saturating_add(BLOCK_SAMPLES * u64::from(blocks));
            }
            Some(Ok(())) => {
                let inputs = self.codes.get(..stream.inputs().min(INPUTS)).unwrap_or_default();
                self.lock_in.take_block(self.next, inputs, self.history.at(self.next));
                self.capture.take_block(self.next, inputs);
                self.next = self.next.saturating_add(BLOCK_SAMPLES);
            }
        }
        true
    }
}

#[cfg(test)]
mod tests;
