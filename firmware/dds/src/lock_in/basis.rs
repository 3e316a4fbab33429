//! One tone and one block: the basis, and the turn of what lies along it to the tone's phase.

use super::fold::{PAIRS, WORDS, pack};
use crate::bank::ToneBlock;
use crate::bank::glide::change;
use crate::bank::sine::{add_high, high, high_rounded, sine_cosine, sub_high};

/// The basis's number for 1, a little below 2^14: so no block's sum overflows (see [`super`]).
pub const BASIS_ONE: i32 = (1 << 14) - 1;

/// An input that does not move, in codes: the sums of such a one show how much of an offset leaks into a tone.
pub const CONSTANT: i32 = 1024;

/// `phi_j / theta = j (j + 1) - 5` of a pair of sub-blocks, from the innermost to the outermost (see [`super`]).
pub(super) const BEND_WEIGHTS: [i32; PAIRS] = [-5, -3, 1, 7];

/// `2 pi 2^-40 2^32`: turns a change of step (2^-40 turns) into radians with 32 fractional bits.
pub(super) const THETA: i32 = 105_414_357;

/// The step at sample 127/2 is `step + 127/256 change`; turns a change of step (2^-40 turns) into that, 2^-32 turns.
pub(super) const MIDDLE: i32 = 127 << 16;
/// The mean of `phase + n step + n^2 change / 256` over the block is `phase + 127/2 step + 10795/512 change`; the same for it.
pub(super) const MEAN: i32 = 10_795 << 15;

/// A tone's sums over one block, in eighths of the [module's](super) unit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Sums {
    pub(super) in_phase: i32,
    pub(super) quadrature: i32,
}

/// `X` and `D` of a block: what lies along a tone's basis, and how it moves from the block's middle to its ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub(super) struct Projection {
    pub(super) real: i32,
    pub(super) imaginary: i32,
    pub(super) bend_real: i32,
    pub(super) bend_imaginary: i32,
}

impl Projection {
    /// Adds that of one pair of sub-blocks.
    #[inline(always)]
    pub(super) const fn add(&mut self, real: i32, imaginary: i32, weight: i32) {
        self.real = self.real.wrapping_add(real);
        self.imaginary = self.imaginary.wrapping_add(imaginary);
        self.bend_real = self.bend_real.wrapping_add(real.wrapping_mul(weight));
        self.bend_imaginary = self.bend_imaginary.wrapping_add(imaginary.wrapping_mul(weight));
    }
}

/// The constants of one step.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Basis {
    /// `cos(w tau)` and `sin(w tau)`, 14 fractional bits, packed as the folded codes.
    pub(super) even: [i32; WORDS],
    pub(super) odd: [i32; WORDS],
    /// `cos(16 w (j + 1/2))` and the sine, from the innermost pair to the outermost, 29 fractional bits.
    pub(super) cosines: [i32; PAIRS],
    pub(super) sines: [i32; PAIRS],
    /// `X` and `D` of the constant [`CONSTANT`]; both are real.
    pub(super) constant: i32,
    pub(super) constant_bend: i32,
    /// The step that they are made for, 2^32 = one turn, with every bit inverted: zeros stand for a step that no tone has.
    pub(super) inverted_step: u32,
}

/// What is kept of a tone from block to block.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Follower {
    /// Its phase where the last block ended.
    pub(super) end: u64,
    pub(super) basis: Basis,
}

impl Follower {
    pub(super) const NONE: Self = Self { end: 0, basis: Basis::NONE };
}

/// Phase and step of a tone in a block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// The step in the block's middle, 2^32 = one turn per sample.
    pub(super) step: u32,
    /// Sine and cosine of the mean phase, times `1 - 21/2 theta^2`.
    sine: i32,
    cosine: i32,
    /// `theta`, 32 fractional bits.
    theta: i32,
}

impl Place {
    /// The place of a tone that has `phase` at the block's first sample.
    #[inline(always)]
    pub(super) fn new(phase: u64, tone: &ToneBlock) -> Self {
        let change = change(tone);
        let step = upper(tone.step).wrapping_add_signed(high(change, MIDDLE));
        let mean = upper(phase)
            .wrapping_add(upper(tone.step << 6))
            .wrapping_sub(upper(tone.step) >> 1)
            .wrapping_add_signed(high(change, MEAN));
        let (sine, cosine) = sine_cosine(mean);
        let theta = high(change, THETA);
        // At most 2^-14.6, and times 21/2.
        let shrink = (high(theta, theta) * 21) >> 1;
        Self { step, sine: sub_high(sine, sine, shrink), cosine: sub_high(cosine, cosine, shrink), theta }
    }

    /// Turns what lies along the basis to the tone's phase.
    #[inline(always)]
    pub(super) const fn turn(&self, projection: Projection) -> Sums {
        let Projection { real, imaginary, bend_real, bend_imaginary } = projection;
        let real = sub_high(real, bend_imaginary, self.theta);
        let imaginary = add_high(imaginary, bend_real, self.theta);
        Sums {
            in_phase: add_high(high(real, self.sine), imaginary, self.cosine),
            quadrature: sub_high(high(real, self.cosine), imaginary, self.sine),
        }
    }
}

impl Basis {
    pub(super) const NONE: Self = Self {
        even: [0; WORDS],
        odd: [0; WORDS],
        cosines: [0; PAIRS],
        sines: [0; PAIRS],
        constant: 0,
        constant_bend: 0,
        inverted_step: 0,
    };

    /// Whether it is made for the step of this place.
    #[inline(always)]
    pub(super) const fn fits(&self, place: &Place) -> bool {
        self.inverted_step == !place.step
    }

    /// Makes it for a step, 2^32 = one turn per sample.
    pub(super) fn rebuild(&mut self, step: u32) {
        self.inverted_step = !step;
        let (sine, cosine) = sine_cosine(step >> 1);
        let turn = cosine_of_double(sine, cosine);
        // A little below 1, so that neither their rounding nor the basis's can reach 1.
        let (mut c, mut s) = (cosine - (cosine >> 14), sine - (sine >> 14));
        let (mut c_before, mut s_before) = (c, -s);
        let mut sum = 0;
        for (even, odd) in self.even.iter_mut().zip(&mut self.odd) {
            (c_before, c) = (c, next(c_before, c, turn));
            (s_before, s) = (s, next(s_before, s, turn));
            let [near, far] = [c_before, c].map(rounded);
            // Eight numbers of 14 bits.
            sum += near + far;
            *even = pack(near, far);
            *odd = pack(rounded(s_before), rounded(s));
            (c_before, c) = (c, next(c_before, c, turn));
            (s_before, s) = (s, next(s_before, s, turn));
        }
        // Four sub-blocks' halves are folded: 29 bits.
        let constant = sum * (4 * CONSTANT);

        let (sine, cosine) = sine_cosine(step << 3);
        let turn = cosine_of_double(sine, cosine);
        let (mut c, mut s) = (cosine >> 2, sine >> 2);
        let (mut c_before, mut s_before) = (c, -s);
        let mut projection = Projection::default();
        for ((cosine, sine), weight) in self.cosines.iter_mut().zip(&mut self.sines).zip(BEND_WEIGHTS) {
            (*cosine, *sine) = (c, s);
            projection.add(high_rounded(0, constant, c), 0, weight);
            (c_before, c) = (c, next(c_before, c, turn));
            (s_before, s) = (s, next(s_before, s, turn));
        }
        (self.constant, self.constant_bend) = (projection.real, projection.bend_real);
    }

    /// The projection of the constant [`CONSTANT`] on it.
    #[inline(always)]
    pub(super) const fn constant(&self) -> Projection {
        Projection { real: self.constant, imaginary: 0, bend_real: self.constant_bend, bend_imaginary: 0 }
    }
}

/// `cos(n + 1)`, or the sine, from those of `n - 1` and `n` and from `cos 1`: `2 cos(1) cos(n) - cos(n - 1)`.
#[inline(always)]
const fn next(before: i32, at: i32, turn_cosine: i32) -> i32 {
    (high_rounded(0, at, turn_cosine) << 2).wrapping_sub(before)
}

/// The cosine of twice an angle.
#[inline(always)]
const fn cosine_of_double(s: i32, c: i32) -> i32 {
    high_rounded(high_rounded(0, c, c), s, -s) << 1
}

/// A sine, 31 fractional bits, with 14, rounded to nearest.
#[inline(always)]
const fn rounded(sine: i32) -> i32 {
    (sine + (1 << 16)) >> 17
}

/// The upper half of a 64-bit phase.
#[inline(always)]
const fn upper(phase: u64) -> u32 {
    (phase >> 32) as u32
}
