//! The computations of one block, as a trait.
//!
//! It has two implementations: `portable.rs` defines the result and runs on hosts, `cortex_m4.rs` is in assembly. All
//! sums are modulo 2^32, so their order does not matter: the two are equal bit for bit. The image `slipline-bench`
//! compares them over blocks of every kind.

use super::block::{BLOCK, TONES, ToneBlock};
use super::layout::{GlideBasis, GlideSeeds, SteadyBasis, SteadySeeds, Turn};

/// The kind of computation that the tones of a block need.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Survey {
    /// Every tone is steady at a step that the basis is made for.
    Unchanged,
    /// Every tone is steady, some at a new step.
    Retuned,
    /// Some tone changes its step or its amplitude.
    Gliding,
}

/// The totals of a block's codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Converted {
    /// Whether any sample had to be clamped.
    pub(super) is_clamped: bool,
    /// The sum of the squares of the codes' distances from mid-scale: at most `128 * 2048^2`, 29 bits.
    pub(super) energy: u32,
}

/// The computations of one block, for one kind of processor.
pub(super) trait Kernel {
    /// What the tones need; `inverted_steps` are the steps that the steady basis is made for, with every bit inverted.
    fn survey(tones: &[ToneBlock; TONES], inverted_steps: &[u64; TONES]) -> Survey;
    /// The basis of one steady tone, and the turn from the block's centre to the centres of its halves.
    fn rebuild(step: u64, slot: usize, basis: &mut SteadyBasis, turn: &mut Turn);
    /// The seeds of sixteen steady tones; advances the phases to the next block.
    fn seed_steady(
        phases: &mut [u64; TONES],
        tones: &[ToneBlock; TONES],
        turns: &[Turn; TONES],
        seeds: &mut SteadySeeds,
    );
    /// The basis and the seeds of sixteen gliding tones; advances the phases to the next block.
    fn seed_glide(
        phases: &mut [u64; TONES],
        tones: &[ToneBlock; TONES],
        basis: &mut GlideBasis,
        seeds: &mut GlideSeeds,
    );
    /// `out[centre + tau] = E + O`, `out[centre - tau] = E - O` with `E = sum even seed * even word`, for both
    /// sub-blocks of 64 samples.
    fn steady(basis: &SteadyBasis, seeds: &SteadySeeds, out: &mut [i32; BLOCK]);
    /// The same for the eight sub-blocks of 16 samples of a gliding block, `E` and `O` each with their corrections.
    fn glide(basis: &GlideBasis, seeds: &GlideSeeds, out: &mut [i32; BLOCK]);
    /// The codes of a block, rounded and clamped.
    fn codes(samples: &[i32; BLOCK], out: &mut [u16; BLOCK]) -> Converted;
}
