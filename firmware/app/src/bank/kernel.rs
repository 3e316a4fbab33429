//! What the bank does for every block.
//!
//! There are two implementations: `portable.rs`, which defines the result and runs on hosts, and `cortex_m4.rs` in
//! assembly. All sums are modulo 2^32, so their order does not matter: the two are equal bit for bit. The image
//! `slipline-bench` compares them over blocks of every kind.

use super::block::{BLOCK, TONES, ToneBlock};
use super::layout::{GlideBasis, GlideSeeds, SteadyBasis, SteadySeeds, Turn};

/// What a block asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Survey {
    /// Every tone is steady at a step that the basis is made for.
    Unchanged,
    /// Every tone is steady, some at a new step.
    Retuned,
    /// Some tone changes its step or its amplitude.
    Gliding,
}

/// The work of one block, on one kind of processor.
pub(super) trait Kernel {
    /// Which kernel a block needs; `inverted_steps` are those that the steady basis is made for.
    fn survey(tones: &[ToneBlock; TONES], inverted_steps: &[u64; TONES]) -> Survey;
    /// The basis of one steady tone, and the turn from the block's centre to those of its halves.
    fn rebuild(step: u64, slot: usize, basis: &mut SteadyBasis, turn: &mut Turn);
    /// The seeds of sixteen steady tones; moves the phases on.
    fn seed_steady(
        phases: &mut [u64; TONES],
        tones: &[ToneBlock; TONES],
        turns: &[Turn; TONES],
        seeds: &mut SteadySeeds,
    );
    /// The basis and the seeds of sixteen gliding tones; moves the phases on.
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
    /// The codes of a block, rounded and clamped; whether any had to be clamped.
    fn codes(samples: &[i32; BLOCK], out: &mut [u16; BLOCK]) -> bool;
    /// The sum of the squares of the codes' distances from mid-scale.
    fn energy(codes: &[u16; BLOCK]) -> u32;
}
