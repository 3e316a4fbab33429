//! The computations in the assembly of a Cortex-M4 with its DSP and floating-point extensions (M7 runs it too).
//!
//! As in `bank/cortex_m4.rs`, all are *naked* functions that follow the procedure call standard and write no other memory
//! than their arguments, and the floating-point registers are storage only. The comments use the names of `portable.rs`
//! and `basis.rs`; cycles are those of the M4's reference manual without wait states.

mod fold;
mod follow;

use core::mem::offset_of;

use self::fold::{Totals, fold};
use self::follow::follow;
use super::basis::{Basis, Follower};
use super::fold::{Folds, HALF, PAIRS, Pair, Span, WORDS};
use super::history::PlayedTone;
use super::kernel::{Block, Kernel};
use super::reading::InPhaseQuadrature;
use crate::bank::{BLOCK, TONES, ToneBlock};

/// The computations in assembly.
pub(super) struct CortexM4;

// The memory layout that the assembly relies on.
const _: () = {
    assert!(BLOCK == 128 && HALF == 8 && PAIRS == 4 && WORDS == 4);
    assert!(size_of::<Pair>() == 32 && offset_of!(Pair, differences) == 16 && offset_of!(Folds, odd) == 128);
    assert!(offset_of!(Basis, odd) == 16 && offset_of!(Basis, cosines) == 32 && offset_of!(Basis, sines) == 48);
    assert!(offset_of!(Basis, constant) == 64 && offset_of!(Basis, constant_bend) == 68);
    assert!(offset_of!(Basis, inverted_step) == 72);
    assert!(size_of::<Follower>() == 88 && offset_of!(Follower, basis) == 8 && size_of::<PlayedTone>() == 32);
    assert!(offset_of!(PlayedTone, tone) == 8 && offset_of!(ToneBlock, step_end) == 8);
    assert!(offset_of!(ToneBlock, amplitude) == 16 && offset_of!(ToneBlock, amplitude_end) == 20);
    assert!(offset_of!(Block<'_, 1>, followers) == 4 && offset_of!(Block<'_, 1>, constant) == 8 && offset_of!(Block<'_, 1>, sums) == 12);
    assert!(offset_of!(Block<'_, 1>, folds) == 16 && offset_of!(Block<'_, 1>, inputs) == 20 && offset_of!(Block<'_, 1>, weight) == 24);
    assert!(offset_of!(Block<'_, 1>, slots) == 28 && offset_of!(Block<'_, 1>, jumps) == 32 && TONES == 16);
    assert!(offset_of!(Block<'_, 1>, first) == 36 && size_of::<[InPhaseQuadrature; TONES]>() == 256);
    assert!(offset_of!(InPhaseQuadrature, quadrature) == 8 && size_of::<Folds>() == 256);
};

impl Kernel for CortexM4 {
    #[inline]
    fn fold(codes: &[u16; BLOCK], folds: &mut Folds) -> (Span, i32) {
        let mut totals = Totals::default();
        // SAFETY: the function reads 128 codes, and writes the folds and the totals.
        unsafe { fold(codes, folds, &mut totals) }
        let Totals { lowest: [low, other_low], highest: [high, other_high], sum } = totals;
        (Span { lowest: low.min(other_low), highest: high.max(other_high) }, sum)
    }

    #[inline]
    fn follow<const INPUTS: usize>(mut block: Block<'_, INPUTS>) -> u32 {
        // SAFETY: the function reads and writes what the block refers to, in the sizes of their types, and of the inputs' sums
        // and folds as many as `inputs` says after `first`, at most `INPUTS` in all. A block has the same layout for any
        // number of inputs, as it holds their arrays by reference.
        unsafe { follow(core::ptr::from_mut(&mut block).cast()) }
    }
}
