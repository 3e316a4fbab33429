//! The oscillator bank: sixteen sine tones, summed, a block of 128 samples at a time.
//! (The simple form: each sample's sine from its exact phase. The fast kernels come behind the same interface.)

#![deny(clippy::float_arithmetic)]
#![cfg_attr(
    not(test),
    deny(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::indexing_slicing,
        clippy::cast_possible_truncation
    )
)]

pub mod code;
pub mod sine;

use sine::{high, sine_cosine};

/// Tone slots of the bank.
pub const TONES: usize = 16;
/// Samples in a block.
pub const BLOCK: usize = 128;
/// A tone's amplitude in units of 2^-31 of full scale: `1 << 31` swings the DAC from end to end.
pub const AMPLITUDE_ONE: u32 = 1 << 31;
/// An output sample at full scale (half the DAC's swing): samples have 27 fractional bits, so that sixteen tones of
/// full amplitude still fit in an `i32` and the sum needs no saturation.
pub const FULL_SCALE: i32 = 1 << 27;
/// The largest change of a tone's step over one block for which the stated accuracy holds: 2^-10 turns per sample
/// (390 Hz per block at 400 kS/s, 1.2 MHz per second).
pub const MAX_STEP_CHANGE: u64 = 1 << 54;

/// One tone over one block: step and amplitude move linearly from the block's first sample to the next block's first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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
    #[must_use]
    pub const fn steady(step: u64, amplitude: u32) -> Self {
        Self { step, step_end: step, amplitude, amplitude_end: amplitude }
    }

    /// The phase gained up to sample `n` of the block: `n step + floor((step_end - step) n^2 / 256)`, modulo a turn.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, reason = "phases are counted modulo one turn")]
    pub const fn phase_gain(&self, n: u32) -> u64 {
        let change = self.step_end.wrapping_sub(self.step).cast_signed() as i128;
        let curve = (change * (n as i128 * n as i128)) >> 8;
        self.step.wrapping_mul(n as u64).wrapping_add(curve as u64)
    }
}

/// The state of the bank: one exact phase per tone.
#[derive(Clone, Debug)]
pub struct Bank {
    phases: [u64; TONES],
}

impl Default for Bank {
    fn default() -> Self {
        Self::new()
    }
}

impl Bank {
    /// A bank with every phase at zero.
    #[must_use]
    pub const fn new() -> Self {
        Self { phases: [0; TONES] }
    }

    /// The phase of `tone` at the next block's first sample, 2^64 = one turn. Zero for a slot that does not exist.
    #[must_use]
    pub fn phase(&self, tone: usize) -> u64 {
        self.phases.get(tone).copied().unwrap_or(0)
    }

    /// Sets the phase of `tone` at the next block's first sample: for a tone that is silent, else it jumps.
    pub fn set_phase(&mut self, tone: usize, phase: u64) {
        if let Some(slot) = self.phases.get_mut(tone) {
            *slot = phase;
        }
    }

    /// Renders the next block and moves every phase on by `phase_gain(128)`.
    pub fn render(&mut self, tones: &[ToneBlock; TONES], out: &mut [i32; BLOCK]) {
        out.fill(0);
        for (tone, phase) in tones.iter().zip(&mut self.phases) {
            let (start, end) = (
                i64::from(tone.amplitude.min(AMPLITUDE_ONE)),
                i64::from(tone.amplitude_end.min(AMPLITUDE_ONE)),
            );
            for (sample, n) in out.iter_mut().zip(0u32..) {
                let now = phase.wrapping_add(tone.phase_gain(n));
                #[expect(
                    clippy::cast_possible_truncation,
                    reason = "a 64-bit phase's upper half; an amplitude in Q29"
                )]
                let (angle, amplitude) = (
                    (now >> 32) as u32,
                    ((start * (BLOCK as i64 - i64::from(n)) + end * i64::from(n)) >> 9) as i32,
                );
                *sample = sample.wrapping_add(high(amplitude, sine_cosine(angle).0) >> 1);
            }
            *phase = phase.wrapping_add(tone.phase_gain(128));
        }
    }
}
