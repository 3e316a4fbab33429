//! A block of codes, folded twice: about the centres of its sub-blocks, and about its own.

use crate::bank::BLOCK;

/// Half a sub-block: 8 samples on either side of its centre.
pub(super) const HALF: usize = 8;
/// Pairs of sub-blocks, one on either side of the block's centre.
pub(super) const PAIRS: usize = BLOCK / HALF / 4;
/// Packed words of a half: two samples in each, the one nearer to the centre in the lower half.
pub(super) const WORDS: usize = HALF / 2;

/// Four times mid-scale.
pub(super) const FOUR_MID: i32 = 8192;
/// The bits of a code. Others are cut off, so that no port can make the sums overflow.
pub(super) const CODE: u16 = 0x0FFF;

/// The sum of a pair of sub-blocks, and the excess of the later one: 13 bits and a sign each, two in a word.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Pair {
    pub(super) sums: [i32; WORDS],
    pub(super) differences: [i32; WORDS],
}

impl Pair {
    const NONE: Self = Self { sums: [0; WORDS], differences: [0; WORDS] };
}

/// A block, in the order in which the products are made.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Folds {
    /// The sums `x[tau] + x[-tau]`, from the outermost pair to the innermost.
    pub(super) even: [Pair; PAIRS],
    /// The differences `x[tau] - x[-tau]`, from the innermost pair to the outermost.
    pub(super) odd: [Pair; PAIRS],
}

impl Folds {
    pub(super) const NONE: Self = Self { even: [Pair::NONE; PAIRS], odd: [Pair::NONE; PAIRS] };
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
    #[inline]
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self { lowest: self.lowest.min(other.lowest), highest: self.highest.max(other.highest) }
    }
}

/// Two numbers of 16 bits in one word.
#[inline(always)]
pub(super) const fn pack(lower: i32, upper: i32) -> i32 {
    (lower & 0xFFFF) | (upper << 16)
}
