//! The listener: hands the ADC's blocks to the lock-ins and the capture, with the index of each, and counts what is lost.

use crate::bank::BLOCK;
use crate::capture::Capture;
use crate::lock_in::{History, LockIn};
use crate::ports::{INPUTS, Overrun, SenseStream};
use crate::timing::BLOCK_SAMPLES;
use slipline_protocol::units::SampleIndex;

/// What listens to the inputs. The renderer records every block in `history` before the DAC plays it.
#[derive(Clone, Debug)]
pub struct Listener {
    /// How the blocks were rendered that the ADC has yet to sample.
    pub history: History,
    /// The lock-ins of the tones.
    pub lock_in: LockIn,
    /// The capture.
    pub capture: Capture,
    next: SampleIndex,
    lost_blocks: u32,
    codes: [[u16; BLOCK]; INPUTS],
}

impl Listener {
    /// A listener whose first block begins at `index`, a multiple of 128: that of the DAC's first code.
    #[must_use]
    pub const fn starting_at(index: SampleIndex) -> Self {
        Self {
            history: History::new(),
            lock_in: LockIn::new(),
            capture: Capture::new(),
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
