//! A block of codes, folded about the centres of its sub-blocks.

use crate::bank::BLOCK;

/// Half a sub-block: 8 samples on either side of its centre.
pub(super) const HALF: usize = 8;
/// Sub-blocks of a block.
pub(super) const PARTS: usize = BLOCK / HALF / 2;
/// Packed words of a half: two samples in each, the one nearer to the centre in the lower half.
pub(super) const WORDS: usize = HALF / 2;

/// Twice mid-scale.
const TWICE_MID: i32 = 4096;
/// The bits of a code. Others are cut off, so that no port can make the sums overflow.
const CODE: u16 = 0x0FFF;

/// One sub-block: `x[tau] + x[-tau]` and `x[tau] - x[-tau]`, 13 bits and a sign each, two in a word.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Fold {
    pub(super) even: [i32; WORDS],
    pub(super) odd: [i32; WORDS],
}

impl Fold {
    pub(super) const NONE: Self = Self { even: [0; WORDS], odd: [0; WORDS] };
}

/// The lowest and the highest of some codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// The lowest code.
    pub lowest: u16,
    /// The highest code.
    pub highest: u16,
}

impl Span {
    /// The span of both.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self { lowest: self.lowest.min(other.lowest), highest: self.highest.max(other.highest) }
    }
}

/// Folds a block; returns the span of its codes, and their sum less mid-scale.
pub(super) fn fold(codes: &[u16; BLOCK], folds: &mut [Fold; PARTS]) -> (Span, i32) {
    let (mut lowest, mut highest) = (CODE, 0);
    let mut sum = 0;
    for (codes, fold) in codes.as_chunks::<{ 2 * HALF }>().0.iter().zip(folds) {
        let (below, above) = codes.split_at(HALF);
        let pairs = above.as_chunks::<2>().0.iter().zip(below.as_rchunks::<2>().1.iter().rev());
        for ((even, odd), ([a0, a1], [b1, b0])) in fold.even.iter_mut().zip(&mut fold.odd).zip(pairs) {
            let [a0, a1, b0, b1] = [a0, a1, b0, b1].map(|code| code & CODE);
            lowest = lowest.min(a0).min(a1).min(b0).min(b1);
            highest = highest.max(a0).max(a1).max(b0).max(b1);
            let [a0, a1, b0, b1] = [a0, a1, b0, b1].map(i32::from);
            let (near, far) = (a0 + b0 - TWICE_MID, a1 + b1 - TWICE_MID);
            // 128 numbers of 11 bits and a sign.
            sum += near + far;
            *even = pack(near, far);
            *odd = pack(a0 - b0, a1 - b1);
        }
    }
    (Span { lowest, highest }, sum)
}

/// Two numbers of 16 bits in one word.
#[inline(always)]
pub(super) const fn pack(lower: i32, upper: i32) -> i32 {
    (lower & 0xFFFF) | (upper << 16)
}
