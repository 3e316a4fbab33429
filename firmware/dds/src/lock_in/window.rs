//! The samples that a lock-in sums up, and how much each block counts.

use crate::bank::BLOCK;
use crate::bank::sine::sine_cosine;
use core::ops::Range;

/// The longest window in blocks: 21 s at 400 kS/s.
pub const MAX_WINDOW_BLOCKS: u16 = u16::MAX;

/// The weight 1.
const WEIGHT_ONE: u32 = 1 << 15;

/// The weights of a window's blocks. All 128 samples of a block have the same weight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// Equal weights. Least noise; tones whose spacing is a whole multiple of `1 / T`, `T` the window's length, do not
    /// leak into each other. Any other tone, `df` away, leaks by up to `1 / (pi df T)`; an input's offset by twice that.
    Rectangular,
    /// Hann: `1/2 - 1/2 cos(2 pi (b + 1/2) / blocks)` for block `b`. Only `1 / (pi (df T)^3)` leaks in, but there is 1.8 dB
    /// more noise. Of a tone that is `d` from a distance of `m` times the block rate (3125 Hz at 400 kS/s), the steps
    /// between the blocks let in up to `d / (m 3125 Hz)`.
    Hann,
}

/// The window of a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// The first sample: a multiple of a block's length, 128.
    pub begin: u64,
    /// The length in blocks, `1..=`[`MAX_WINDOW_BLOCKS`].
    pub blocks: u16,
    /// The weights.
    pub shape: Shape,
    /// Bit `n`: slot `n` is measured.
    pub slots: u16,
    /// The input that is measured, from 0; `None`: all at once.
    pub input: Option<u8>,
}

impl Window {
    pub(super) const NONE: Self =
        Self { begin: 0, blocks: 0, shape: Shape::Rectangular, slots: 0, input: None };

    /// Those of the inputs that are measured.
    #[inline]
    pub(super) const fn inputs<const INPUTS: usize>(&self) -> Range<usize> {
        match self.input {
            Some(input) => input as usize..input as usize + 1,
            None => 0..INPUTS,
        }
    }

    /// Checks it, for `next` the first sample of the first block that will be taken.
    ///
    /// # Errors
    /// [`StartError`].
    #[inline]
    pub const fn check(&self, next: u64) -> Result<(), StartError> {
        if !self.begin.is_multiple_of(BLOCK as u64) {
            return Err(StartError::WithinBlock);
        }
        if self.begin < next {
            return Err(StartError::Past { earliest: next });
        }
        if self.blocks == 0 {
            return Err(StartError::Empty);
        }
        if self.begin.checked_add(BLOCK as u64 * self.blocks as u64).is_none() {
            return Err(StartError::BeyondTime);
        }
        Ok(())
    }
}

/// Why a window cannot be measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StartError {
    /// `begin` is no multiple of 128.
    WithinBlock,
    /// `begin` is over.
    Past {
        /// The earliest that is not.
        earliest: u64,
    },
    /// `blocks` is 0; the least is 1.
    Empty,
    /// The window ends after the last sample index, 2^64 - 1.
    BeyondTime,
}

/// The weights of a window's blocks, 15 fractional bits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weights {
    shape: Shape,
    /// One turn over the window's length in blocks, 2^32 = one turn.
    turn: u32,
}

impl Weights {
    pub(super) const NONE: Self = Self { shape: Shape::Rectangular, turn: 0 };

    #[inline]
    pub(super) const fn new(shape: Shape, blocks: u16) -> Self {
        // One block is the whole turn; its middle half counts.
        let blocks = if blocks == 0 { 1 } else { blocks as u32 };
        Self { shape, turn: u32::MAX / blocks }
    }

    /// The weight of a block, at most 1.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and 2^15")]
    #[inline]
    pub(super) fn at(self, block: u16) -> u32 {
        match self.shape {
            Shape::Rectangular => WEIGHT_ONE,
            Shape::Hann => {
                let phase = self.turn.wrapping_mul(block.into()).wrapping_add(self.turn >> 1);
                let (_, cosine) = sine_cosine(phase);
                (((1_i64 << 31) - i64::from(cosine)) >> 17) as u32
            }
        }
    }
}
