//! How bases and seeds lie in memory, in the order in which the kernels read them.
//!
//! The two inner loops are small matrix products. A *pass* adds, for four neighbouring samples of two sub-blocks at a
//! time, `word * coefficient` over the sixteen tones. A word (of the basis) depends on the tone and on the sample within
//! a sub-block: it serves two sub-blocks. A coefficient (a seed) depends on the tone and on the sub-block: it serves
//! four samples. So a tone takes 4 + 2 loads for 8 products.

use super::block::{BLOCK, TONES};

/// Samples whose sums are formed together.
pub(super) const GROUP: usize = 4;
/// Sub-blocks that share the words of one pass.
pub(super) const PAIR: usize = 2;

/// Half a sub-block of a steady block: 32 samples on either side of the sub-block's centre.
pub(super) const STEADY_HALF: usize = BLOCK / PAIR / 2;
/// Half a sub-block of a gliding block: 8 samples on either side.
pub(super) const GLIDE_HALF: usize = 8;
/// Sub-blocks of a gliding block.
pub(super) const GLIDE_PARTS: usize = BLOCK / GLIDE_HALF / 2;

/// One basis word per tone and sample, in the order in which the kernel reads them.
pub(super) type Words<const GROUPS: usize> = [[[i32; GROUP]; TONES]; GROUPS];
/// One coefficient per tone and sub-block of a pair.
pub(super) type Pair = [[i32; PAIR]; TONES];

/// What a steady block needs of each kind, basis or seeds.
#[derive(Clone, Debug)]
#[repr(C)]
pub(super) struct Halves<T> {
    pub(super) even: T,
    pub(super) odd: T,
}

impl<T: Copy> Halves<T> {
    pub(super) const fn both(value: T) -> Self {
        Self { even: value, odd: value }
    }
}

/// The basis of a steady block, 31 fractional bits: `cos(w tau)` (`even`) and `sin(w tau)` (`odd`), `tau = n + 1/2`.
pub(super) type SteadyBasis = Halves<Words<{ STEADY_HALF / GROUP }>>;
/// The factors of a steady block's basis, 28 fractional bits: `a sin p` (`even`) and `a cos p` (`odd`).
pub(super) type SteadySeeds = Halves<Pair>;

/// What a gliding block needs of each kind: as [`Halves`], and those of the packed corrections of `bank/glide.rs`.
#[derive(Clone, Debug)]
#[repr(C)]
pub(super) struct Bent<T> {
    pub(super) even_bend: T,
    pub(super) even: T,
    pub(super) odd_bend: T,
    pub(super) odd: T,
}

impl<T: Copy> Bent<T> {
    pub(super) const fn all(value: T) -> Self {
        Self { even_bend: value, odd_bend: value, even: value, odd: value }
    }
}

/// The basis of a gliding block: as [`SteadyBasis`], and the packed corrections.
pub(super) type GlideBasis = Bent<Words<{ GLIDE_HALF / GROUP }>>;
/// The factors of a gliding block's basis, for each pair of sub-blocks; their scales are in `bank/glide.rs`.
pub(super) type GlideSeeds = Bent<[Pair; GLIDE_PARTS / PAIR]>;

/// No words.
pub(super) const fn no_words<const GROUPS: usize>() -> Words<GROUPS> {
    [[[0; GROUP]; TONES]; GROUPS]
}

/// No coefficient.
pub(super) const NO_PAIR: Pair = [[0; PAIR]; TONES];

/// Turns a tone's amplitude and phase at the block's centre into those at the centres of its two sub-blocks.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Turn {
    pub(super) cosine: i32,
    pub(super) sine: i32,
}

impl Turn {
    /// No turn; for a tone that has no basis yet.
    pub(super) const NONE: Self = Self { cosine: 0, sine: 0 };
}
