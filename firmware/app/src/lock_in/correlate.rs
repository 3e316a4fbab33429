//! One tone and one block: the products with the folded codes, and the turn to each centre's phase.

use super::dual::Dual;
use super::fold::{Fold, PARTS, WORDS, pack};
use crate::bank::ToneBlock;
use crate::bank::sine::{add_high, doubled, high_rounded, sine_cosine, sub_high, turned};

/// The basis's number for 1, a little below 2^14: so no block's sum overflows (see [`super`]).
pub const BASIS_ONE: i32 = (1 << 14) - 1;

/// A tone's sums over one block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Sums {
    pub(super) in_phase: i32,
    pub(super) quadrature: i32,
}

/// The values of a tone's basis, and how they stand to the tone's phase.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Basis {
    /// `cos(w tau)` and `sin(w tau)`, 14 fractional bits, packed as the folded codes.
    even: [i32; WORDS],
    odd: [i32; WORDS],
    /// What a sub-block of the constant [`CONSTANT`] comes to: twice the sum of the cosines, times it.
    constant: i32,
    /// The step that they are made for, with every bit inverted: zeros stand for a step that no tone has.
    inverted_step: u64,
}

/// Sine and cosine of a tone's phase at the centre of each sub-block.
pub(super) type Centres = [[i32; 2]; PARTS];

/// An input that does not move, in codes: the sums of such a one show how much of an offset leaks into a tone.
pub const CONSTANT: i32 = 1024;

impl Basis {
    pub(super) const NONE: Self = Self { even: [0; WORDS], odd: [0; WORDS], constant: 0, inverted_step: 0 };

    /// Makes it for a tone that has `phase` at the block's first sample, and computes the centres. Returns the sums of an
    /// input of [`CONSTANT`] codes.
    pub(super) fn prepare(&mut self, phase: u64, tone: &ToneBlock, centres: &mut Centres) -> Sums {
        let step = tone.step;
        // The phase at sample n is `phase + n step + n^2 change / 256`. A change has a sign; the shifts keep it.
        let change = tone.step_end.wrapping_sub(step).cast_signed();
        let scaled = |factor: i64, bits: u32| (change >> bits).wrapping_mul(factor).cast_unsigned();
        // The slope at n = 127/2: step + 127/256 change.
        let middle = step.wrapping_add(scaled(127, 8));
        if self.inverted_step != !middle {
            self.inverted_step = !middle;
            self.rebuild(middle);
        }
        // n = 15/2: (15/2)^2 / 256 = 225 / 1024.
        let angle = phase.wrapping_add((step << 3).wrapping_sub(step >> 1)).wrapping_add(scaled(225, 10));
        // From n to n + 16: 16 step + (n/8 + 1) change, and each time 2 change more. Turning is cheaper than the table.
        let gain = (step << 4).wrapping_add(scaled(31, 4));
        let (mut s, mut c) = sine_cosine(upper(angle));
        let (mut turn_sine, mut turn_cosine) = sine_cosine(upper(gain));
        let bend = (change != 0).then(|| sine_cosine(upper(scaled(2, 0))));
        let mut sums = Sums::default();
        for centre in centres {
            *centre = [s, c];
            sums.in_phase = add_high(sums.in_phase, self.constant, s);
            sums.quadrature = add_high(sums.quadrature, self.constant, c);
            (s, c) = turned(s, c, turn_sine, turn_cosine);
            if let Some((sine, cosine)) = bend {
                (turn_sine, turn_cosine) = turned(turn_sine, turn_cosine, sine, cosine);
            }
        }
        sums
    }

    fn rebuild(&mut self, step: u64) {
        let (mut s, mut c) = sine_cosine(upper(step >> 1));
        // From w/2 to w.
        let (turn_sine, turn_cosine) = doubled(s, c);
        let mut sum = 0;
        for (even, odd) in self.even.iter_mut().zip(&mut self.odd) {
            let (s1, c1) = turned(s, c, turn_sine, turn_cosine);
            let [a, b] = [c, c1].map(rounded);
            // Eight numbers of 14 bits, times 2048: 28 bits.
            sum += a + b;
            *even = pack(a, b);
            *odd = pack(rounded(s), rounded(s1));
            (s, c) = turned(s1, c1, turn_sine, turn_cosine);
        }
        self.constant = sum * (2 * CONSTANT);
    }
}

/// A tone's sums over a block.
pub(super) fn correlate<D: Dual>(basis: &Basis, centres: &Centres, folds: &[Fold; PARTS]) -> Sums {
    let mut sums = Sums::default();
    for (fold, [s, c]) in folds.iter().zip(centres) {
        let even = products::<D>(&basis.even, &fold.even);
        let odd = products::<D>(&basis.odd, &fold.odd);
        sums.in_phase = add_high(add_high(sums.in_phase, even, *s), odd, *c);
        sums.quadrature = sub_high(add_high(sums.quadrature, even, *c), odd, *s);
    }
    sums
}

/// Both halves of each word times both halves of the other, summed.
#[inline(always)]
fn products<D: Dual>(words: &[i32; WORDS], codes: &[i32; WORDS]) -> i32 {
    words.iter().zip(codes).fold(0, |sum, (word, code)| D::add(sum, *word, *code))
}

/// A sine, 31 fractional bits, in the basis's unit, rounded to nearest.
#[inline(always)]
const fn rounded(sine: i32) -> i32 {
    high_rounded(0, sine, BASIS_ONE << 1)
}

/// The upper half of a 64-bit phase.
#[inline(always)]
const fn upper(phase: u64) -> u32 {
    (phase >> 32) as u32
}
