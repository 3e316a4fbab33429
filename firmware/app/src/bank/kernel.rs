//! What the bank does for every block, in two equal forms: portable Rust, which defines it and runs on hosts, and
//! Cortex-M4 assembly. The bench image compares them, bit for bit, over blocks of everything.
//!
//! The two inner kernels are small matrix products. A *pass* adds, for four neighbouring samples of two sub-blocks at a time,
//! `word * coefficient` over the sixteen tones; each word (the basis, which depends on the tone and the sample within
//! a sub-block) serves two sub-blocks, each coefficient (which depends on the tone and the sub-block) four samples.
//! That is 8 products for 4 + 2 loads, and it fills the register file exactly:
//! ```text
//! r0 the words' address, r1-r8 the sums, r9-r12 four words, lr one coefficient; s0-s31 the 16 x 2 coefficients
//! per tone: LDM 5 cycles + 2 VMOV + 8 SMMLA = 15 cycles for 8 products, 1.875 each
//! ```
//! All sums are modulo 2^32, so their order does not matter and the two forms are equal bit for bit.
//! The loop over the four-sample groups is one straight run of 176 instructions, 704 bytes: it stays within the 1 KiB
//! instruction cache of an STM32F4.

use super::code::{MID_SCALE, ROUND, one_code};
use super::sine::{add_high, high};
use super::steady::Turn;
use super::{BLOCK, TONES, ToneBlock, glide, steady};

#[cfg(all(target_arch = "arm", target_os = "none"))]
#[expect(unsafe_code, reason = "assembly; the only unsafe code of the crate")]
// The formatter would put each operand of an instruction on a line of its own.
#[rustfmt::skip]
mod cortex_m4;

/// The kernel of this machine.
#[cfg(all(target_arch = "arm", target_os = "none"))]
pub(super) type Native = cortex_m4::CortexM4;
/// The kernel of this machine.
#[cfg(not(all(target_arch = "arm", target_os = "none")))]
pub(super) type Native = Portable;

/// Samples whose sums are formed together.
const GROUP: usize = 4;
/// Sub-blocks that share the words of one pass.
const PAIR: usize = 2;

/// Half a sub-block of a steady block: 32 samples on either side of the sub-block's centre.
pub(super) const STEADY_HALF: usize = BLOCK / PAIR / 2;
/// Half a sub-block of a gliding block: 8 samples on either side.
pub(super) const GLIDE_HALF: usize = 8;
/// Sub-blocks of a gliding block.
pub(super) const GLIDE_PARTS: usize = BLOCK / GLIDE_HALF / 2;

/// One basis word per tone and sample, in the order in which the kernel reads them.
type Words<const GROUPS: usize> = [[[i32; GROUP]; TONES]; GROUPS];
/// One coefficient per tone and sub-block of a pair.
type Pair = [[i32; PAIR]; TONES];

/// The basis of a steady block, 31 fractional bits: `cos(w tau)` and `sin(w tau)`, `tau = n + 1/2`.
#[derive(Clone, Debug)]
#[repr(C)]
pub(super) struct SteadyBasis {
    pub(super) even: Words<{ STEADY_HALF / GROUP }>,
    pub(super) odd: Words<{ STEADY_HALF / GROUP }>,
}

impl SteadyBasis {
    pub(super) const fn new() -> Self {
        let none = [[[0; GROUP]; TONES]; STEADY_HALF / GROUP];
        Self { even: none, odd: none }
    }
}

/// What multiplies the basis of a steady block, 28 fractional bits.
#[derive(Clone, Debug)]
#[repr(C)]
pub(super) struct SteadySeeds {
    pub(super) even: Pair,
    pub(super) odd: Pair,
}

impl SteadySeeds {
    pub(super) const fn new() -> Self {
        Self { even: [[0; PAIR]; TONES], odd: [[0; PAIR]; TONES] }
    }
}

/// The basis of a gliding block: as [`SteadyBasis`], and the packed corrections of [`super::glide`].
#[derive(Clone, Debug)]
#[repr(C)]
pub(super) struct GlideBasis {
    pub(super) even_bend: Words<{ GLIDE_HALF / GROUP }>,
    pub(super) even: Words<{ GLIDE_HALF / GROUP }>,
    pub(super) odd_bend: Words<{ GLIDE_HALF / GROUP }>,
    pub(super) odd: Words<{ GLIDE_HALF / GROUP }>,
}

impl GlideBasis {
    pub(super) const fn new() -> Self {
        let none = [[[0; GROUP]; TONES]; GLIDE_HALF / GROUP];
        Self { even_bend: none, odd_bend: none, even: none, odd: none }
    }
}

/// What multiplies the basis of a gliding block, per pair of sub-blocks.
#[derive(Clone, Debug)]
#[repr(C)]
pub(super) struct GlideSeeds {
    pub(super) even_bend: [Pair; GLIDE_PARTS / PAIR],
    pub(super) even: [Pair; GLIDE_PARTS / PAIR],
    pub(super) odd_bend: [Pair; GLIDE_PARTS / PAIR],
    pub(super) odd: [Pair; GLIDE_PARTS / PAIR],
}

impl GlideSeeds {
    pub(super) const fn new() -> Self {
        let none = [[[0; PAIR]; TONES]; GLIDE_PARTS / PAIR];
        Self { even_bend: none, odd_bend: none, even: none, odd: none }
    }
}

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

/// What is done for every block, on some machine.
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

/// The kernel in Rust: the definition, and what runs on a host.
pub(super) struct Portable;

impl Kernel for Portable {
    fn survey(tones: &[ToneBlock; TONES], inverted_steps: &[u64; TONES]) -> Survey {
        if !tones.iter().all(ToneBlock::is_steady) {
            Survey::Gliding
        } else if tones.iter().zip(inverted_steps).all(|(tone, inverted)| tone.step == !inverted) {
            Survey::Unchanged
        } else {
            Survey::Retuned
        }
    }

    fn rebuild(step: u64, slot: usize, basis: &mut SteadyBasis, turn: &mut Turn) {
        *turn = steady::rebuild(step, slot, basis);
    }

    fn seed_steady(
        phases: &mut [u64; TONES],
        tones: &[ToneBlock; TONES],
        turns: &[Turn; TONES],
        seeds: &mut SteadySeeds,
    ) {
        let seeds = seeds.even.iter_mut().zip(&mut seeds.odd);
        for (((phase, tone), turn), (even, odd)) in phases.iter_mut().zip(tones).zip(turns).zip(seeds) {
            steady::seed(*phase, tone, turn, even, odd);
            *phase = phase.wrapping_add(tone.block_gain());
        }
    }

    fn seed_glide(
        phases: &mut [u64; TONES],
        tones: &[ToneBlock; TONES],
        basis: &mut GlideBasis,
        seeds: &mut GlideSeeds,
    ) {
        for (slot, (phase, tone)) in phases.iter_mut().zip(tones).enumerate() {
            glide::rebuild(tone, slot, basis);
            glide::seed(*phase, tone, slot, seeds);
            *phase = phase.wrapping_add(tone.block_gain());
        }
    }

    fn steady(basis: &SteadyBasis, seeds: &SteadySeeds, out: &mut [i32; BLOCK]) {
        let mut even = [[0; PAIR]; STEADY_HALF];
        let mut odd = even;
        products(&basis.even, &seeds.even, &mut even);
        products(&basis.odd, &seeds.odd, &mut odd);
        unfold(&even, &odd, out);
    }

    fn glide(basis: &GlideBasis, seeds: &GlideSeeds, out: &mut [i32; BLOCK]) {
        let bends = seeds.even_bend.iter().zip(&seeds.odd_bend);
        let pairs = seeds.even.iter().zip(&seeds.odd).zip(bends);
        for (((even_seed, odd_seed), (even_bend, odd_bend)), out) in
            pairs.zip(out.chunks_exact_mut(PAIR * 2 * GLIDE_HALF))
        {
            let mut even = [[0; PAIR]; GLIDE_HALF];
            let mut odd = even;
            bend(&basis.even_bend, even_bend, &mut even);
            products(&basis.even, even_seed, &mut even);
            bend(&basis.odd_bend, odd_bend, &mut odd);
            products(&basis.odd, odd_seed, &mut odd);
            unfold(&even, &odd, out);
        }
    }

    fn codes(samples: &[i32; BLOCK], out: &mut [u16; BLOCK]) -> bool {
        let mut clipped = false;
        for (sample, code) in samples.iter().zip(out) {
            let (value, clamped) = one_code(*sample, ROUND);
            *code = value;
            clipped |= clamped;
        }
        clipped
    }

    fn energy(codes: &[u16; BLOCK]) -> u32 {
        codes.iter().map(|code| u32::from(code.abs_diff(MID_SCALE)).pow(2)).sum()
    }
}

/// `sums[n][part] += sum over tones of words[n][tone] * seeds[tone][part]`, upper halves of the products.
fn products(words: &[[[i32; GROUP]; TONES]], seeds: &Pair, sums: &mut [[i32; PAIR]]) {
    for (group, sums) in words.iter().zip(sums.chunks_exact_mut(GROUP)) {
        for (words, seeds) in group.iter().zip(seeds) {
            for (word, sums) in words.iter().zip(&mut *sums) {
                for (seed, sum) in seeds.iter().zip(sums) {
                    *sum = add_high(*sum, *word, *seed);
                }
            }
        }
    }
}

/// The packed corrections, both halves of a word times both halves of a coefficient; their sum times `tau / 8`, and
/// from 30 to 27 fractional bits.
fn bend(words: &[[[i32; GROUP]; TONES]], seeds: &Pair, sums: &mut [[i32; PAIR]]) {
    let mut tau = 1;
    for (group, sums) in words.iter().zip(sums.chunks_exact_mut(GROUP)) {
        for (words, seeds) in group.iter().zip(seeds) {
            for (word, sums) in words.iter().zip(&mut *sums) {
                for (seed, sum) in seeds.iter().zip(sums) {
                    *sum = sum
                        .wrapping_add(lower(*word) * lower(*seed))
                        .wrapping_add((*word >> 16) * (*seed >> 16));
                }
            }
        }
        for sums in sums {
            sums.iter_mut().for_each(|sum| *sum = high(*sum, tau << 25));
            tau += 2;
        }
    }
}

/// The signed lower half of a packed word.
const fn lower(packed: i32) -> i32 {
    (packed << 16) >> 16
}

/// Writes `even + odd` upwards and `even - odd` downwards from the centre of each sub-block.
fn unfold(even: &[[i32; PAIR]], odd: &[[i32; PAIR]], out: &mut [i32]) {
    for (part, out) in out.chunks_exact_mut(2 * even.len()).enumerate() {
        let (below, above) = out.split_at_mut(even.len());
        let sums = even.iter().zip(odd).filter_map(|(e, o)| Some((*e.get(part)?, *o.get(part)?)));
        for ((below, above), (even, odd)) in below.iter_mut().rev().zip(above).zip(sums) {
            *above = even.wrapping_add(odd);
            *below = even.wrapping_sub(odd);
        }
    }
}
