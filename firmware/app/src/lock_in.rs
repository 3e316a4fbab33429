//! The lock-in: how strongly, and with what phase, the inputs answer each tone that sounds.
//!
//! ```text
//! SenseStream -> block of codes -> fold ---------------------------+
//!                                                                  v
//! renderer -> History (phases and ToneBlocks as rendered) -> basis -> correlate -> I, Q of the block -> weight -> sums
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
//! ADC code `n` belongs to DAC code `n`; what lies between them ([`SenseStream::delay_ns`](crate::ports::SenseStream))
//! is left in `psi`, for the host to take out: `psi` falls by `2 pi f delay`.
//!
//! **Computation.** As the bank, in sub-blocks of 16 samples about a centre with phase `p`; `x` at `tau` and `-tau` is
//! folded first, once for all tones:
//! ```text
//! C = sum (x[tau] + x[-tau]) cos(w tau)      S = sum (x[tau] - x[-tau]) sin(w tau)      tau = 1/2 .. 15/2
//! I = C sin p + S cos p                      Q = C cos p - S sin p
//! ```
//! Every block starts from the exact 64-bit phase at its first sample. From its first centre, seven turns lead along the
//! parabola that the bank follows, 1e-8 off at the last: no error grows, and a block's sums depend on nothing but its
//! codes, phases and steps. `w` is the tone's
//! frequency in the middle of the block. In a glide as fast as the bank takes
//! ([`MAX_STEP_CHANGE`](crate::bank::MAX_STEP_CHANGE)) the phase at a sub-block's outermost samples is off by up to
//! 0.020 rad, odd about the centre, and by 0.0013 rad, even. Summed up this costs 3.3e-5 of the amplitude and 0.029
//! degrees, which a test holds: far below what is asked of a measurement (0.05 dB and 0.3 degrees).
//!
//! **Word lengths.** The basis has 14 fractional bits, times [`BASIS_ONE`]` / 2^14`. Its rounding is at most 2^-15 a
//! sample: 4e-5 of a tone's own amplitude, and another tone of full scale shows at less than -100 dBFS.
//! No sum can overflow, whatever the codes:
//! ```text
//! |x[tau] +- x[-tau]| <= 2^12, so C and S: 8 * 2^12 * 16383 < 2^29                                     i32
//! one block: |x| <= 2^11, |sin|, |cos| <= 1; 128 * 2^11 * 16383 / 2 = 2^31 - 2^17                       i32
//!     + rounding of the basis: 128 * 2^11 * (1/2 + 1/2) / sqrt(2) / 2 < 2^16.6, of the products: 16
//! window: weights <= 2^15, at most 2^16 - 1 blocks: 2^31 * 2^15 * 2^16 = 2^62                           i64
//! offset: M: 128 * 2^11 * 2^31 = 2^49; M I0: 2^49 * 2^62                                                i128
//! ```
//!
//! **Cost** on a Cortex-M4 without wait states, sixteen tones on one input, all included, by a cycle model of the image
//! `slipline-bench`: 9.2 cycles per tone and sample while every tone is steady (35 % of a block's time at 168 MHz and
//! 400 kS/s), 11.7 while every tone glides (45 %). The goal is 5. The products and their turn are 2.9 of these, the phases
//! of the centres 1.8 (steady) or 2.7 (gliding), a new basis 1.4. All but the dual product is compiled Rust.
//!
//! **Messages.** What a protocol has to carry: *start*: a [`Window`] (first index, length in blocks, shape, slots);
//! refused with [`StartError`]. *Read*: [`LockIn::state`], and when it is [`State::Finished`] the [`Reading`]: the
//! [answers](Reading::answer) of 16 x 2 two 64-bit sums, the weight, the slots that were followed, the range of the codes. *Counters*: the overruns of the
//! [`Listener`](crate::listener::Listener). Nothing is lost by reading twice; a new start forgets the last reading.

#![cfg_attr(not(test), deny(clippy::float_arithmetic))]

mod correlate;
mod dual;
mod fold;
mod history;
mod window;

pub use self::correlate::{BASIS_ONE, CONSTANT};
use self::correlate::{Basis, Centres, Sums, correlate};
use self::dual::{Dual, Native, Portable};
pub use self::fold::Span;
use self::fold::{Fold, PARTS, fold};
pub use self::history::{History, Played};
use self::window::Weights;
pub use self::window::{MAX_WINDOW_BLOCKS, Shape, StartError, Window};
use crate::bank::{BLOCK, TONES};
use crate::ports::INPUTS;
use crate::timing::BLOCK_SAMPLES;
use slipline_protocol::units::SampleIndex;

/// How far a measurement has come.
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
        at: SampleIndex,
    },
}

/// The sums of one tone and one input; their unit is in the [module's](self) equations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InPhaseQuadrature {
    /// `I`: along the tone's sine.
    pub in_phase: i64,
    /// `Q`: along its cosine, a quarter of a turn ahead.
    pub quadrature: i64,
}

impl InPhaseQuadrature {
    const NONE: Self = Self { in_phase: 0, quadrature: 0 };

    /// Adds a block's sums. The [module](self) shows that 63 bits hold the longest window.
    fn add(&mut self, sums: Sums, weight: u32) {
        let times = |sum: i32| i64::from(sum).wrapping_mul(weight.into());
        self.in_phase = self.in_phase.wrapping_add(times(sums.in_phase));
        self.quadrature = self.quadrature.wrapping_add(times(sums.quadrature));
    }
}

/// What a window has measured so far.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reading {
    /// The sums of each input's tones, the input's offset not taken away.
    pub sums: [[InPhaseQuadrature; TONES]; INPUTS],
    /// The sums of the constant, [`CONSTANT`] codes.
    pub constant: [InPhaseQuadrature; TONES],
    /// Each input's codes less mid-scale, summed up by the same weights.
    pub codes: [i64; INPUTS],
    /// The sum of the weights of the blocks that have been taken.
    pub weight: u32,
    /// Blocks that have been taken.
    pub blocks: u16,
    /// Bit `n`: slot `n` was asked for, sounded in every block, and its phase ran on without a jump. The sums of other
    /// slots mean nothing.
    pub followed: u16,
    /// The lowest and the highest code of each input: an input is clipped where one of them is at an end of the range,
    /// and dead or stuck where they are equal. `None` for an input that the board has not.
    pub spans: [Option<Span>; INPUTS],
}

impl Reading {
    const NONE: Self = Self {
        sums: [[InPhaseQuadrature::NONE; TONES]; INPUTS],
        constant: [InPhaseQuadrature::NONE; TONES],
        codes: [0; INPUTS],
        weight: 0,
        blocks: 0,
        followed: 0,
        spans: [None; INPUTS],
    };

    /// `I` and `Q` of a tone and an input, with the input's offset taken away. `None` for a slot that was not followed, an
    /// input that does not exist, or an empty window.
    ///
    /// For the thread side: it divides numbers of 128 bits.
    #[must_use]
    pub fn answer(&self, input: usize, slot: usize) -> Option<InPhaseQuadrature> {
        self.spans.get(input).copied().flatten()?;
        if self.followed & 1_u16.checked_shl(u32::try_from(slot).ok()?)? == 0 {
            return None;
        }
        let sum = self.sums.get(input)?.get(slot)?;
        let (constant, codes) = (self.constant.get(slot)?, i128::from(*self.codes.get(input)?));
        let scale = i128::from(self.weight) * (BLOCK as i128 * i128::from(CONSTANT));
        let less = |sum: i64, constant: i64| {
            let share = codes.wrapping_mul(constant.into()).checked_div(scale)?;
            i64::try_from(i128::from(sum) - share).ok()
        };
        Some(InPhaseQuadrature {
            in_phase: less(sum.in_phase, constant.in_phase)?,
            quadrature: less(sum.quadrature, constant.quadrature)?,
        })
    }
}

/// The lock-ins of all tones, over one window at a time.
#[derive(Clone, Debug)]
pub struct LockIn {
    state: State,
    window: Window,
    weights: Weights,
    reading: Reading,
    bases: [Basis; TONES],
    /// Each tone's phase where the last block ended.
    ends: [u64; TONES],
    centres: Centres,
    folds: [[Fold; PARTS]; INPUTS],
}

impl Default for LockIn {
    fn default() -> Self {
        Self::new()
    }
}

impl LockIn {
    /// No measurement.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            state: State::Idle,
            window: Window::NONE,
            weights: Weights::NONE,
            reading: Reading::NONE,
            bases: [Basis::NONE; TONES],
            ends: [0; TONES],
            centres: [[0; 2]; PARTS],
            folds: [[Fold::NONE; PARTS]; INPUTS],
        }
    }

    /// Begins a measurement and forgets the last one. `next` is the first sample of the next block that will be taken.
    ///
    /// # Errors
    /// [`StartError`] if the window cannot be measured; the last measurement stays as it is.
    pub fn start(&mut self, window: Window, next: SampleIndex) -> Result<(), StartError> {
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

    /// How far it has come.
    #[must_use]
    pub const fn state(&self) -> State {
        self.state
    }

    /// Whether a block that begins at an index, if it is taken next, is correlated with any tone.
    #[must_use]
    pub const fn works_at(&self, index: SampleIndex) -> bool {
        matches!(self.state, State::Measuring) && index >= self.window.begin && self.reading.followed != 0
    }

    /// The sums so far; whole when [`LockIn::state`] is [`State::Finished`].
    #[must_use]
    pub const fn reading(&self) -> &Reading {
        &self.reading
    }

    /// Takes a block of codes of each input, and how the tones were rendered in it. Blocks outside the window change
    /// nothing.
    ///
    /// `index` is the block's first sample. A block of the window that is left out breaks the measurement when the next
    /// one comes; one without `played` breaks it at once. More than [`INPUTS`] inputs are not looked at.
    pub fn take_block(&mut self, index: SampleIndex, inputs: &[[u16; BLOCK]], played: Option<&Played>) {
        self.take_by::<Native>(index, inputs, played);
    }

    /// As [`LockIn::take_block`], by the portable product on every machine. Tests compare the assembly with it.
    pub fn take_block_portably(
        &mut self,
        index: SampleIndex,
        inputs: &[[u16; BLOCK]],
        played: Option<&Played>,
    ) {
        self.take_by::<Portable>(index, inputs, played);
    }

    fn take_by<D: Dual>(&mut self, index: SampleIndex, inputs: &[[u16; BLOCK]], played: Option<&Played>) {
        if self.state != State::Measuring || index < self.window.begin {
            return;
        }
        let due = self.window.begin.saturating_add(BLOCK_SAMPLES * u64::from(self.reading.blocks));
        let Some(played) = played.filter(|played| played.index == index && index == due) else {
            self.state = State::Broken { at: due };
            return;
        };
        let weight = self.weights.at(self.reading.blocks);
        self.fold(inputs, weight);
        self.follow::<D>(played, inputs.len(), weight);
        // At most 2^16 - 1 times 2^15.
        self.reading.weight = self.reading.weight.wrapping_add(weight);
        self.reading.blocks = self.reading.blocks.saturating_add(1);
        if self.reading.blocks >= self.window.blocks {
            self.state = State::Finished;
        }
    }

    /// Folds each input's block, and adds its codes up.
    fn fold(&mut self, inputs: &[[u16; BLOCK]], weight: u32) {
        let Reading { spans, codes: sums, .. } = &mut self.reading;
        let totals = spans.iter_mut().zip(sums);
        for ((codes, folds), (all, total)) in inputs.iter().zip(&mut self.folds).zip(totals) {
            let (span, sum) = fold(codes, folds);
            *all = Some(all.map_or(span, |all| all.with(span)));
            // The module's proof: 49 bits.
            *total = total.wrapping_add(i64::from(sum).wrapping_mul(weight.into()));
        }
    }

    /// Adds the block to every tone's sums; gives up the tones that are silent or jump.
    fn follow<D: Dual>(&mut self, played: &Played, inputs: usize, weight: u32) {
        let is_first = self.reading.blocks == 0;
        let own = self.bases.iter_mut().zip(&mut self.ends).zip(&mut self.reading.constant);
        let tones = played.phases.iter().zip(&played.tones);
        for (slot, ((phase, tone), ((basis, end), constant))) in tones.zip(own).enumerate() {
            let bit = 1 << slot;
            if self.reading.followed & bit == 0 {
                continue;
            }
            let is_silent = tone.amplitude == 0 && tone.amplitude_end == 0;
            if is_silent || !is_first && *end != *phase {
                self.reading.followed &= !bit;
                continue;
            }
            *end = phase.wrapping_add(tone.block_gain());
            constant.add(basis.prepare(*phase, tone, &mut self.centres), weight);
            for (sums, folds) in self.reading.sums.iter_mut().zip(&self.folds).take(inputs) {
                if let Some(sum) = sums.get_mut(slot) {
                    sum.add(correlate::<D>(basis, &self.centres, folds), weight);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
