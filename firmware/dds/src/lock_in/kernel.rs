//! The costly computations of one block, as a trait.
//!
//! It has two implementations: `portable.rs` defines the result and runs on hosts, `cortex_m4.rs` is in assembly. All
//! sums are modulo 2^32, so their order does not matter: the two are equal bit for bit. The image `slipline-bench`
//! compares them over blocks of every kind.

use super::basis::Follower;
use super::fold::{Folds, Span};
use super::history::PlayedTone;
use super::reading::InPhaseQuadrature;
use crate::bank::{BLOCK, TONES};

/// A block of all tones, and what they are added to.
#[repr(C)]
pub(super) struct Block<'a, const INPUTS: usize> {
    /// The tones as they were rendered.
    pub(super) tones: &'a [PlayedTone; TONES],
    pub(super) followers: &'a mut [Follower; TONES],
    /// The sums of the constant.
    pub(super) constant: &'a mut [InPhaseQuadrature; TONES],
    /// Those of each input.
    pub(super) sums: &'a mut [[InPhaseQuadrature; TONES]; INPUTS],
    /// Each input's block.
    pub(super) folds: &'a [Folds; INPUTS],
    /// Number of measured inputs; with `first` at most `INPUTS`.
    pub(super) inputs: u32,
    /// Eight times the block's weight.
    pub(super) weight: i32,
    /// Bit `n`: slot `n` is followed.
    pub(super) slots: u32,
    /// All bits set if a phase must begin where the last block ended, none in the first block.
    pub(super) jumps: u32,
    /// The first input that is measured; `INPUTS` or less.
    pub(super) first: u32,
}

/// The costly computations, for one kind of processor.
pub(super) trait Kernel {
    /// Folds a block; returns the span of its codes, and their sum less mid-scale.
    fn fold(codes: &[u16; BLOCK], folds: &mut Folds) -> (Span, i32);
    /// Adds the block to the sums of every tone that is followed, and returns the slots that are still followed: it gives up
    /// the tones that are silent or jump.
    fn follow<const INPUTS: usize>(block: Block<'_, INPUTS>) -> u32;
}
