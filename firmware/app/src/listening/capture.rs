//! A capture: up to 4096 values of one input from a named sample index on.
//!
//! A value is one code, or the sum of `M` = 2, 4 ... 1024 codes one after the other: 4096 values are 10 ms to 10.5 s at
//! 400 kS/s. The sums are exact, 22 bits at most. Less `2048 M` (mid-scale), and divided by `M`, they are the codes behind
//! a boxcar filter. At the sample rate `fs` its response, relative to one code, is
//! ```text
//! |H(f)| = |sin(pi f M / fs) / (M sin(pi f / fs))|        phase: linear, that of a delay of (M - 1)/2 samples
//! ```
//! with zeros at the multiples of the values' rate `fs / M`. At the highest frequency the values can carry, `fs / 2M`, it
//! is -3.9 dB (-3.0 dB for `M` = 2); at a quarter of the values' rate -0.9 dB (-0.7 dB). What lies above `fs / 2M` folds
//! back, weakened by the same `H`: at `fs/M - f` it is weaker than at `f` by `f / (fs/M - f)` for `M` of 8 or more.
//! White noise falls by the square root of `M`.
//!
//! **Messages.** *Start*: a [`Recipe`], refused with [`CaptureError`]. *Read*: [`Capture::progress`] and the
//! [values](Capture::values), in parts of any length, as often as wanted, also while the capture goes on; a value once
//! there stays until the next start. A gap in the codes ends the capture: what came before it can be read.

#![cfg_attr(not(test), deny(clippy::float_arithmetic))]

use crate::ports::INPUTS;
use crate::timing::BLOCK_SAMPLES;
use core::ops::Range;
use core::sync::atomic::{AtomicU32, Ordering};
use slipline_dds::bank::BLOCK;
pub use slipline_protocol::listen::Progress;
use slipline_protocol::units::SampleIndex;

/// Values at most.
pub const MAX_VALUES: usize = 4096;
/// The highest power of two of codes in a value: 1024 of them.
pub const MAX_LOG2_CODES: u8 = 10;

/// Parameters of a capture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Recipe {
    /// Index of the first code; any index is allowed.
    pub begin: SampleIndex,
    /// The input, from 0.
    pub input: u8,
    /// A value is the sum of two to this power of codes, `0..=`[`MAX_LOG2_CODES`].
    pub log2_codes: u8,
    /// Number of values, `1..=`[`MAX_VALUES`].
    pub values: u16,
}

impl Recipe {
    /// Checks it, for `next` the first sample of the first block that will be taken.
    pub(crate) fn check(&self, next: SampleIndex, inputs: usize) -> Result<(), CaptureError> {
        let inputs = u8::try_from(inputs.min(INPUTS)).unwrap_or(u8::MAX);
        if self.begin < next {
            return Err(CaptureError::Past { earliest: next });
        }
        if self.input >= inputs {
            return Err(CaptureError::NoSuchInput { inputs });
        }
        if self.log2_codes > MAX_LOG2_CODES {
            return Err(CaptureError::TooManyCodes);
        }
        if self.values == 0 || usize::from(self.values) > MAX_VALUES {
            return Err(CaptureError::Values);
        }
        let codes = u64::from(self.values) << self.log2_codes;
        // The last block must begin and end before the end of time, too.
        if self.begin.checked_add(codes).and_then(|end| end.checked_add(BLOCK_SAMPLES)).is_none() {
            return Err(CaptureError::BeyondTime);
        }
        Ok(())
    }
}

/// Why a capture cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CaptureError {
    /// `begin` is over.
    Past {
        /// The earliest that is not.
        earliest: SampleIndex,
    },
    /// The board has no such input.
    NoSuchInput {
        /// Number of inputs that it has.
        inputs: u8,
    },
    /// `log2_codes` is above [`MAX_LOG2_CODES`].
    TooManyCodes,
    /// `values` is 0 or above [`MAX_VALUES`].
    Values,
    /// The capture ends after the last sample index, 2^64 - 1.
    BeyondTime,
}

/// The memory of a capture's values, 16 KiB, shared by both sides: the capture writes each value once, and the thread side
/// reads only the values that are reported as captured.
#[derive(Debug)]
pub struct Values([AtomicU32; MAX_VALUES]);

impl Values {
    /// All zero.
    #[must_use]
    pub const fn new() -> Self {
        Self([const { AtomicU32::new(0) }; MAX_VALUES])
    }

    /// `count` values from index `first` on, or fewer at the end of the memory.
    pub fn range(&self, first: usize, count: usize) -> impl Iterator<Item = u32> + '_ {
        let values = self.0.get(first..).unwrap_or_default();
        values.iter().take(count).map(|value| value.load(Ordering::Relaxed))
    }
}

/// One capture at a time.
#[derive(Clone, Debug)]
pub struct Capture<'a> {
    progress: Progress,
    recipe: Recipe,
    /// The next code.
    due: SampleIndex,
    /// The sum of the value under way, and of how many codes.
    sum: u32,
    summed: u16,
    filled: usize,
    values: &'a Values,
}

impl<'a> Capture<'a> {
    /// No capture. Its values will be in `values`.
    #[must_use]
    pub const fn new(values: &'a Values) -> Self {
        Self {
            progress: Progress::Idle,
            recipe: Recipe { begin: 0, input: 0, log2_codes: 0, values: 0 },
            due: 0,
            sum: 0,
            summed: 0,
            filled: 0,
            values,
        }
    }

    /// Begins a capture and forgets the last one. `next` is the first sample of the next block that will be taken,
    /// `inputs` how many inputs the board has.
    ///
    /// # Errors
    /// [`CaptureError`] if it cannot be made; the last capture stays as it is.
    pub fn start(&mut self, recipe: Recipe, next: SampleIndex, inputs: usize) -> Result<(), CaptureError> {
        recipe.check(next, inputs)?;
        self.recipe = recipe;
        self.due = recipe.begin;
        (self.sum, self.summed, self.filled) = (0, 0, 0);
        self.progress = Progress::Running;
        Ok(())
    }

    /// Ends a capture that is under way; what it has captured can be read.
    pub fn stop(&mut self) {
        if self.progress == Progress::Running {
            self.progress = if self.filled == 0 { Progress::Idle } else { Progress::Broken { at: self.due } };
        }
    }

    /// Ends a capture and forgets its values.
    pub const fn forget(&mut self) {
        self.progress = Progress::Idle;
        self.filled = 0;
    }

    /// The index of its first code.
    #[must_use]
    pub const fn begin(&self) -> SampleIndex {
        self.recipe.begin
    }

    /// Its progress.
    #[must_use]
    pub const fn progress(&self) -> Progress {
        self.progress
    }

    /// The input whose codes it takes next.
    #[must_use]
    pub fn wanted_inputs(&self) -> Range<usize> {
        let input = usize::from(self.recipe.input);
        if self.progress == Progress::Running { input..input.saturating_add(1) } else { 0..0 }
    }

    /// Number of values so far.
    #[must_use]
    pub const fn filled(&self) -> usize {
        self.filled
    }

    /// The values so far.
    pub fn values(&self) -> impl Iterator<Item = u32> + '_ {
        self.values.range(0, self.filled)
    }

    /// Adds codes up, and writes the sums that are whole to the places to come.
    #[expect(clippy::cast_possible_truncation, reason = "fewer codes than a value has, 1024 at most")]
    fn sum_up(&mut self, codes_each: u16, places: &[AtomicU32], mut codes: &[u16]) {
        for place in places {
            let missing = usize::from(codes_each.wrapping_sub(self.summed));
            let (now, later) = codes.split_at_checked(missing).unwrap_or((codes, &[]));
            // 1024 codes of 16 bits: 26 bits.
            self.sum = now.iter().fold(self.sum, |sum, code| sum.wrapping_add(u32::from(*code)));
            if now.len() < missing {
                self.summed = self.summed.wrapping_add(now.len() as u16);
                return;
            }
            place.store(self.sum, Ordering::Relaxed);
            self.filled = self.filled.wrapping_add(1);
            (self.sum, self.summed) = (0, 0);
            codes = later;
        }
    }

    /// Takes a block of codes of each input; `index` is its first sample.
    pub fn take_block(&mut self, index: SampleIndex, inputs: &[[u16; BLOCK]]) {
        let end = index.saturating_add(BLOCK_SAMPLES);
        if self.progress != Progress::Running || end <= self.due {
            return;
        }
        let codes = inputs.get(usize::from(self.recipe.input));
        let rest = self.due.checked_sub(index).and_then(|past| codes?.get(usize::try_from(past).ok()?..));
        let Some(rest) = rest else {
            self.progress = Progress::Broken { at: self.due };
            return;
        };
        self.due = end;
        let codes_each = 1 << self.recipe.log2_codes;
        let places = self.values.0.get(..usize::from(self.recipe.values)).unwrap_or_default();
        let places = places.get(self.filled..).unwrap_or_default();
        if codes_each == 1 {
            // There are no sums to be kept, which saves half of the time.
            for (value, code) in places.iter().zip(rest) {
                value.store(u32::from(*code), Ordering::Relaxed);
            }
            self.filled = self.filled.wrapping_add(places.len().min(rest.len()));
        } else {
            self.sum_up(codes_each, places, rest);
        }
        if self.filled >= usize::from(self.recipe.values) {
            self.progress = Progress::Finished;
        }
    }
}

#[cfg(test)]
mod tests;
