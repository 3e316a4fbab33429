//! A block of samples, and one tone over it.

/// Tone slots of the bank.
pub const TONES: usize = 16;
/// Samples in a block.
pub const BLOCK: usize = 128;
/// A tone's amplitude in units of 2^-31 of full scale: `1 << 31` swings the DAC from end to end.
pub const AMPLITUDE_ONE: u32 = 1 << 31;
/// An output sample at full scale (half the DAC's swing). Samples have 27 fractional bits: the sum of amplitudes may
/// reach fifteen times full scale before an `i32` wraps, so the sum needs no saturation and the codes' clamp suffices.
pub const FULL_SCALE: i32 = 1 << 27;
/// The largest change of a tone's step over one block: 2^-10 turns per sample (390 Hz per block at 400 kS/s, 1.2 MHz
/// per second). A faster change is rendered as one of this size, so the wave jumps at the block's end; the phases stay
/// exact.
pub const MAX_STEP_CHANGE: u64 = 1 << 54;

/// One tone over one block: step and amplitude move linearly from the block's first sample to the next block's first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct ToneBlock {
    /// Phase step at the block's first sample, 2^64 = one turn per sample; below 0.45 turns.
    pub step: u64,
    /// Phase step at the next block's first sample.
    pub step_end: u64,
    /// Amplitude at the block's first sample, `0..=AMPLITUDE_ONE`.
    pub amplitude: u32,
    /// Amplitude at the next block's first sample.
    pub amplitude_end: u32,
}

impl ToneBlock {
    /// A tone that keeps its step and its amplitude over the block.
    #[inline]
    #[must_use]
    pub const fn steady(step: u64, amplitude: u32) -> Self {
        Self { step, step_end: step, amplitude, amplitude_end: amplitude }
    }

    /// Whether the tone keeps its step and its amplitude over the block.
    #[inline]
    #[must_use]
    pub const fn is_steady(&self) -> bool {
        self.step == self.step_end && self.amplitude == self.amplitude_end
    }

    /// The phase gained over the block, `64 (step + step_end)`, modulo one turn.
    #[inline(always)]
    #[must_use]
    pub const fn block_gain(&self) -> u64 {
        self.step.wrapping_add(self.step_end) << 6
    }

    /// The phase gained up to sample `n` of the block: `n step + floor((step_end - step) n^2 / 256)`, modulo one turn.
    #[cfg(test)]
    #[expect(clippy::cast_possible_truncation, reason = "phases are counted modulo one turn")]
    pub(crate) const fn phase_gain(&self, n: u32) -> u64 {
        let change = self.step_end.wrapping_sub(self.step).cast_signed() as i128;
        let curve = (change * (n as i128 * n as i128)) >> 8;
        self.step.wrapping_mul(n as u64).wrapping_add(curve as u64)
    }
}
