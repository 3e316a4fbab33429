//! The oscillator bank: sixteen sine tones, summed, a block of 128 samples at a time.
//!
//! ```text
//! tones (step, amplitude: at the block's start and end) + exact 64-bit phases
//!     |
//!     +- survey: does any tone move?
//!     |     no: basis of new steps only -> seeds at the 2 centres -> kernel    3.3 cycles per tone and sample
//!     |    yes: basis -> seeds and corrections at the 8 centres -> kernel      9.7
//!     v
//! 128 samples, 27 fractional bits -> code::codes -> 128 codes of 12 bits
//! ```
//! (Cycles of a Cortex-M4 without wait states, all included, by a cycle model of the image `slipline-bench`. A block
//! that re-tunes all tones at once costs 6.6. At 168 MHz and 400 kS/s a block lasts 53 760 cycles: a steady block takes
//! 12 % of that, a re-tuned one 25 %, the worst, gliding one 37 %.)
//!
//! **Phase.** A tone's step moves linearly over the block, so its phase at sample `n` is the parabola
//! `n step + floor((step_end - step) n^2 / 256)`, in integers; over a whole block that is [`ToneBlock::block_gain`]. Only
//! this 64-bit count is carried from block to block, and every block starts from it: there is no drift, and a block's
//! samples depend only on its phases and its tones.
//!
//! **The symmetric basis.** About a centre with phase `p`, `tau = n + 1/2` samples away on either side,
//! ```text
//! a sin(p + w tau) = a sin p cos(w tau) + a cos p sin(w tau) = E + O
//! a sin(p - w tau) = a sin p cos(w tau) - a cos p sin(w tau) = E - O
//! ```
//! so each product with the *basis* `cos(w tau)`, `sin(w tau)` serves two samples, and the *seeds* `a sin p`, `a cos p`
//! are all that depends on the block. Summed over the tones first, `E` and `O` are two matrix products. A block has two
//! such centres (64 samples each), which share one basis: a basis word, once loaded, serves four samples. The seeds at
//! the two centres are those at the block's middle, turned by `+-32 w`.
//!
//! **Glides** use eight centres of 16 samples and second-order corrections: see `bank/glide.rs`.
//!
//! **Word lengths** (fractional bits; what they cost relative to full scale):
//! ```text
//! phase 64, its upper 32 into the sine table           2^-33 turns   -180 dB
//! sine and cosine 31, see sine.rs                      3.5e-9        -169 dB
//! basis 31: up to seven turns by a rounded rotor       4.2e-8        -147 dB at worst
//! amplitude 30 -> seeds 29 -> turned seeds 28          2^-28         -169 dB
//! sums 27: two products a tone, rounded down           2^-27         -162 dB, mostly an offset
//! ```
//! All these errors but the last follow the signal: the frequency is slightly wrong for half a block. They are smooth
//! and make no spectral lines of their own. The tests measure a peak error below -140 dB at every frequency, and the
//! strongest other line 160 dB below a tone of full amplitude, at 30 Hz, 40 kHz and 179 kHz.

mod block;
pub mod code;
#[cfg(all(target_arch = "arm", target_os = "none"))]
#[expect(unsafe_code, reason = "assembly; listed in firmware/UNSAFE.md")]
// The formatter would put each operand of an instruction on a line of its own.
#[rustfmt::skip]
pub(crate) mod cortex_m4;
pub(crate) mod glide;
mod kernel;
mod layout;
mod native;
mod portable;
mod quantize;
pub mod sine;
mod steady;
mod steady_bank;

pub use self::block::{AMPLITUDE_ONE, BLOCK, FULL_SCALE, MAX_STEP_CHANGE, TONES, ToneBlock};
use self::kernel::{Kernel, Survey};
use self::layout::{
    GLIDE_PARTS, GlideBasis, GlideSeeds, NO_PAIR, PAIR, SteadyBasis, SteadySeeds, Turn, no_words,
};
use self::native::Native;
use self::portable::Portable;
pub use self::steady_bank::SteadyBank;

/// The bank. Its state is one exact phase per tone; the other fields are tables that are computed from the tones.
#[derive(Clone, Debug)]
pub struct Bank {
    phases: [u64; TONES],
    /// The steps that `steady_basis` and `turns` are made for, with every bit inverted. So the initial zeros stand for
    /// `u64::MAX`, a step that no tone has.
    inverted_steps: [u64; TONES],
    turns: [Turn; TONES],
    steady_basis: SteadyBasis,
    steady_seeds: SteadySeeds,
    glide_basis: GlideBasis,
    glide_seeds: GlideSeeds,
}

impl Bank {
    /// A bank with every phase at zero.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            phases: [0; TONES],
            inverted_steps: [0; TONES],
            turns: [Turn::NONE; TONES],
            steady_basis: SteadyBasis::both(no_words()),
            steady_seeds: SteadySeeds::both(NO_PAIR),
            glide_basis: GlideBasis::all(no_words()),
            glide_seeds: GlideSeeds::all([NO_PAIR; GLIDE_PARTS / PAIR]),
        }
    }

    /// The phase of `tone` at the next block's first sample, 2^64 = one turn. Zero for a slot that does not exist.
    #[inline]
    #[must_use]
    pub fn phase(&self, tone: usize) -> u64 {
        self.phases.get(tone).copied().unwrap_or(0)
    }

    /// Every tone's phase at the next block's first sample, 2^64 = one turn.
    #[inline]
    #[must_use]
    pub const fn phases(&self) -> &[u64; TONES] {
        &self.phases
    }

    /// Sets the phase of `tone` at the next block's first sample. The tone must be silent: a sounding one would jump.
    /// Does nothing for a slot that does not exist.
    #[inline]
    pub fn set_phase(&mut self, tone: usize, phase: u64) {
        if let Some(slot) = self.phases.get_mut(tone) {
            *slot = phase;
        }
    }

    /// Renders the next block, in units of 1/[`FULL_SCALE`] of half the DAC's swing, and adds its gain over the block to
    /// every phase.
    pub fn render(&mut self, tones: &[ToneBlock; TONES], out: &mut [i32; BLOCK]) {
        self.render_with::<Native>(tones, out);
    }

    /// As [`Bank::render`], by the portable kernel on every machine. Tests compare the assembly with it.
    pub fn render_portable(&mut self, tones: &[ToneBlock; TONES], out: &mut [i32; BLOCK]) {
        self.render_with::<Portable>(tones, out);
    }

    fn render_with<K: Kernel>(&mut self, tones: &[ToneBlock; TONES], out: &mut [i32; BLOCK]) {
        let survey = K::survey(tones, &self.inverted_steps);
        if survey == Survey::Gliding {
            K::seed_glide(&mut self.phases, tones, &mut self.glide_basis, &mut self.glide_seeds);
            K::glide(&self.glide_basis, &self.glide_seeds, out);
            return;
        }
        if survey == Survey::Retuned {
            for (slot, (tone, made_for)) in tones.iter().zip(&mut self.inverted_steps).enumerate() {
                if *made_for != !tone.step
                    && let Some(turn) = self.turns.get_mut(slot)
                {
                    *made_for = !tone.step;
                    K::rebuild(tone.step, slot, &mut self.steady_basis, turn);
                }
            }
        }
        K::seed_steady(&mut self.phases, tones, &self.turns, &mut self.steady_seeds);
        K::steady(&self.steady_basis, &self.steady_seeds, out);
    }
}

#[cfg(test)]
mod tests;
