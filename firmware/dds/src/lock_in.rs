//! The lock-in: how strongly, and with what phase, the inputs answer each tone that sounds.
//!
//! ```text
//! ADC  -> block of codes -> fold twice ------------------------+
//!                                                              v
//! bank -> History (phases and ToneBlocks as rendered) -> basis -> X, D -> I, Q of the block -> weight -> sums
//! ```
//! With `x[n]` an input's code less mid-scale and `phi[n]` the phase at which the bank renders a tone (`a sin phi[n]`),
//! ```text
//! I = G sum w[n] x[n] sin phi[n]        Q = G sum w[n] x[n] cos phi[n]        G = BASIS_ONE / 2
//! ```
//! over a [window](Window) of whole blocks. An input that answers with `b sin(phi[n] + psi)`, `b` in codes, gives
//! `I + iQ = G W 64 b exp(i psi)`, where `W` is the sum of the blocks' weights ([`Reading::weight`]): so
//! ```text
//! b exp(i psi) = 4 (I + iQ) / (BASIS_ONE * 128 * W)
//! ```
//! **Offset.** An input rests some codes beside mid-scale, and a strong offset leaks into a low tone. So the sums are also
//! made of a constant input of [`CONSTANT`] codes (`I0`, `Q0`), and the codes themselves are summed up (`M`, by the same
//! weights). [`Reading::answer`] takes `m I0`, `m Q0` away, `m = M / (128 W CONSTANT)`.
//!
//! ADC code `n` belongs to DAC code `n`; what lies between them is a converter's delay. It is left in `psi`, for the
//! caller to take out: an input that is held later is farther in its phase, so `psi` rises by
//! `2 pi f delay`. The DAC holds each code for a sample, which takes `pi f / rate` away.
//!
//! **Computation.** With `t = n - 127/2`, `p` a tone's mean phase over the block, `w` its step in the middle and `theta` what
//! its step changes by over the block, all in radians, the parabola that the bank renders is
//! ```text
//! phi = p + w t + theta (t^2 - 16383/12) / 256
//! ```
//! A block has four pairs of sub-blocks of 16 samples, with centres at `t = +-16 (j + 1/2)`. The codes are folded about each
//! centre, `x[tau] +- x[-tau]`, and then about the block's: the sum and the difference of what each pair has of them. That is
//! done once for all tones. With `a_j = 16 w (j + 1/2)` and `tau = 1/2 .. 15/2`
//! ```text
//! E+- = sum (of even codes, sum or difference) cos(w tau)      O+- = sum (of odd ones) sin(w tau)
//! Y_j = cos a_j E+ - sin a_j O-  +  i (cos a_j O+ + sin a_j E-)
//! Q + iI = exp(ip) sum exp(i phi_j) Y_j      phi_j = theta (j (j + 1) - 5), the mean over the pair
//!        = exp(ip) (X + i theta D) (1 - 21/2 theta^2)      X = sum Y_j      D = sum (j (j + 1) - 5) Y_j
//! ```
//! where 21 is the mean of the squares of -5, -3, 1 and 7. So a block takes 64 dual products and four turns of each tone,
//! whether it glides or not. What depends on `w` alone, the basis, is kept until `w` changes. Every block starts from the exact
//! 64-bit phase: no error grows, and a block's sums depend on nothing but its codes, phases and steps.
//!
//! In a glide as fast as the bank takes ([`MAX_STEP_CHANGE`](crate::bank::MAX_STEP_CHANGE), `theta` = 0.0061) the phase at a
//! sub-block's outermost samples is off by up to 0.020 rad, odd about its centre, and by 0.0009 rad, even, with no mean. A test
//! holds what this costs: 3.3e-5 of the amplitude and less than 0.001 degrees, far below what is asked of a measurement (0.05 dB
//! and 0.3 degrees). The weight of a pair is off by up to `14 theta^2`, 5.3e-4, and by nothing on average.
//!
//! **Word lengths.** The basis has 14 fractional bits, times [`BASIS_ONE`]` / 2^14`. Its rounding is at most 2^-15 a
//! sample: 4e-5 of a tone's own amplitude, and another tone of full scale shows at less than -100 dBFS. The cosines are a
//! chain, `cos(n + 1) = 2 cos(1) cos(n) - cos(n - 1)`, 4e-7 off at the eighth. `cos a_j` and `sin a_j` are 1.4e-7 off at most
//! and have 29 bits, as `Y`, `X` and `D` are eighths of `G`'s unit, and `I` and `Q` of a block too, by the last product.
//! No sum can overflow, whatever the codes:
//! ```text
//! folded twice: |sum of four x| <= 2^13                                                                 i16
//! E, O: 8 * 2^13 * 16384 = 2^30                                                                         i32
//! Y_j: |x| <= 2^11, |exp| <= 1; 32 * 2^11 * 16383 / 8 = 2^27 - 2^13; D: 16 times that: 2^31 - 2^17      i32
//!     + rounding of the basis: 16 * 32 * 2^11 * (1/2 + 1/2) / sqrt(2) / 8 = 2^16.5, of the products: 2^9
//! one block: X / 2, 2^28; its weight, eight times at most 2^15; at most 2^16 - 1 blocks: 2^62           i64
//! offset: M: 128 * 2^11 * 2^31 = 2^49; M I0: 2^49 * 2^62                                                i128
//! ```
//!
//! **Cost** on a Cortex-M4 without wait states, sixteen tones on one input, all included, by a cycle model of the image
//! `slipline-bench`: 3.88 cycles per tone and sample while every tone is steady (15 % of a block's time at 168 MHz and
//! 400 kS/s), 4.95 while every tone glides (19 %). The goal is 5. Of these, the products and their turns are 1.5, a new
//! basis 1.1, folding 0.3, and remembering how the block was rendered 0.2.

mod basis;
#[cfg(all(target_arch = "arm", target_os = "none"))]
#[expect(unsafe_code, reason = "assembly; listed in firmware/UNSAFE.md")]
// The formatter would put each operand of an instruction on a line of its own.
#[rustfmt::skip]
mod cortex_m4;
mod fold;
mod history;
mod kernel;
mod native;
mod portable;
mod reading;
mod window;

use self::basis::Follower;
pub use self::basis::{BASIS_ONE, CONSTANT};
use self::fold::Folds;
pub use self::fold::Span;
pub use self::history::{History, Played, PlayedTone};
use self::kernel::{Block, Kernel};
use self::native::Native;
use self::portable::Portable;
pub use self::reading::{InPhaseQuadrature, Reading, without_offset};
use self::window::Weights;
pub use self::window::{MAX_WINDOW_BLOCKS, Shape, StartError, Window};
use crate::bank::{BLOCK, TONES};
use core::ops::Range;

/// Progress of a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// None has been started.
    Idle,
    /// It waits for its first block, or is under way.
    Measuring,
    /// It is complete.
    Finished,
    /// A block of the window was lost, or came so late that its phases were forgotten; the sums end there.
    Broken {
        /// The first sample that is missing.
        at: u64,
    },
}

/// The lock-ins of all tones on `INPUTS` inputs, over one window at a time.
#[derive(Clone, Debug)]
pub struct LockIn<const INPUTS: usize> {
    state: State,
    window: Window,
    weights: Weights,
    reading: Reading<INPUTS>,
    followers: [Follower; TONES],
    folds: [Folds; INPUTS],
}

impl<const INPUTS: usize> Default for LockIn<INPUTS> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const INPUTS: usize> LockIn<INPUTS> {
    /// No measurement.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            state: State::Idle,
            window: Window::NONE,
            weights: Weights::NONE,
            reading: Reading::NONE,
            followers: [Follower::NONE; TONES],
            folds: [Folds::NONE; INPUTS],
        }
    }

    /// Begins a measurement and forgets the last one. `next` is the first sample of the next block that will be taken.
    ///
    /// # Errors
    /// [`StartError`] if the window cannot be measured; the last measurement stays as it is.
    pub fn start(&mut self, window: Window, next: u64) -> Result<(), StartError> {
        window.check(next)?;
        self.window = window;
        self.weights = Weights::new(window.shape, window.blocks);
        self.reading = Reading { followed: window.slots, ..Reading::NONE };
        self.state = State::Measuring;
        Ok(())
    }

    /// Ends a measurement that is under way; its sums are forgotten.
    pub fn stop(&mut self) {
        self.state = State::Idle;
        self.reading = Reading::NONE;
    }

    /// Its progress.
    #[must_use]
    pub const fn state(&self) -> State {
        self.state
    }

    /// Whether a block that begins at an index, if it is taken next, is correlated with any tone.
    #[must_use]
    pub const fn works_at(&self, index: u64) -> bool {
        matches!(self.state, State::Measuring) && index >= self.window.begin && self.reading.followed != 0
    }

    /// The inputs whose codes it takes next.
    #[must_use]
    pub const fn wanted_inputs(&self) -> Range<usize> {
        if matches!(self.state, State::Measuring) { self.window.inputs::<INPUTS>() } else { 0..0 }
    }

    /// The first sample of the window.
    #[must_use]
    pub const fn begin(&self) -> u64 {
        self.window.begin
    }

    /// The sums so far; whole when [`LockIn::state`] is [`State::Finished`].
    #[must_use]
    pub const fn reading(&self) -> &Reading<INPUTS> {
        &self.reading
    }

    /// Takes a block of codes of each input, and how the tones were rendered in it. Blocks outside the window change
    /// nothing, nor do the codes of an input that is not measured.
    ///
    /// `index` is the block's first sample. A block of the window that is left out breaks the measurement when the next
    /// one comes; one without `played` breaks it at once. More than `INPUTS` inputs are not looked at.
    // A call, so that a linker can place it in fast memory by its name: it is generic, and built where it is called.
    #[inline(never)]
    pub fn take_block(&mut self, index: u64, inputs: &[[u16; BLOCK]], played: Option<&Played>) {
        self.take_by::<Native>(index, inputs, played);
    }

    /// As [`LockIn::take_block`], by the portable product on every machine. Tests compare the assembly with it.
    pub fn take_block_portably(&mut self, index: u64, inputs: &[[u16; BLOCK]], played: Option<&Played>) {
        self.take_by::<Portable>(index, inputs, played);
    }

    fn take_by<K: Kernel>(&mut self, index: u64, inputs: &[[u16; BLOCK]], played: Option<&Played>) {
        if self.state != State::Measuring || index < self.window.begin {
            return;
        }
        // 64 bits of samples last for a million years.
        let due = self.window.begin.wrapping_add(BLOCK as u64 * u64::from(self.reading.blocks));
        let Some(played) = played.filter(|played| played.index == index && index == due) else {
            self.state = State::Broken { at: due };
            return;
        };
        let weight = self.weights.at(self.reading.blocks);
        let Range { start: first, end } = self.window.inputs::<INPUTS>();
        let inputs = inputs.get(first..end.min(inputs.len()).min(INPUTS)).unwrap_or_default();
        self.fold::<K>(first, inputs, weight);
        self.follow::<K>(first, inputs.len(), played, weight);
        // At most 2^16 - 1 times 2^15.
        self.reading.weight = self.reading.weight.wrapping_add(weight);
        self.reading.blocks = self.reading.blocks.saturating_add(1);
        if self.reading.blocks >= self.window.blocks {
            self.state = State::Finished;
        }
    }

    /// Folds each input's block, from the `first` one on, and adds its codes up.
    fn fold<K: Kernel>(&mut self, first: usize, inputs: &[[u16; BLOCK]], weight: u32) {
        let Reading { spans, codes: sums, .. } = &mut self.reading;
        let totals = self.folds.iter_mut().zip(spans.iter_mut().zip(sums)).skip(first);
        for (codes, (folds, (all, total))) in inputs.iter().zip(totals) {
            let (span, sum) = K::fold(codes, folds);
            *all = Some(all.map_or(span, |all| all.with(span)));
            // The module's proof: 49 bits.
            *total = total.wrapping_add(i64::from(sum).wrapping_mul(weight.into()));
        }
    }

    /// Adds the block to every tone's sums; gives up the tones that are silent or jump.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "sixteen slots, and as many inputs as a computer has memory for"
    )]
    fn follow<K: Kernel>(&mut self, first: usize, inputs: usize, played: &Played, weight: u32) {
        let Reading { sums, constant, followed, blocks, .. } = &mut self.reading;
        *followed = K::follow(Block {
            tones: &played.tones,
            followers: &mut self.followers,
            constant,
            sums,
            folds: &self.folds,
            inputs: inputs as u32,
            first: first as u32,
            weight: (weight << 3).cast_signed(),
            slots: u32::from(*followed),
            jumps: if *blocks == 0 { 0 } else { u32::MAX },
        }) as u16;
    }
}

#[cfg(test)]
mod tests;
