//! The kernel in portable Rust.

use super::block::{BLOCK, TONES, ToneBlock};
use super::kernel::{Converted, Kernel, Survey};
use super::layout::{
    GLIDE_HALF, GROUP, GlideBasis, GlideSeeds, PAIR, Pair, STEADY_HALF, SteadyBasis, SteadySeeds, Turn,
};
use super::quantize::{MID_SCALE, ROUND, quantize};
use super::sine::{add_halves, add_high, high};
use super::{glide, steady};

/// The kernel in Rust. It defines the results, and it runs on hosts.
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

    fn codes(samples: &[i32; BLOCK], out: &mut [u16; BLOCK]) -> Converted {
        let mut converted = Converted { is_clamped: false, energy: 0 };
        for (sample, code) in samples.iter().zip(out) {
            let (value, is_clamped) = quantize(*sample, ROUND);
            *code = value;
            converted.is_clamped |= is_clamped;
            converted.energy = converted.energy.wrapping_add(u32::from(value.abs_diff(MID_SCALE)).pow(2));
        }
        converted
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
                    *sum = add_halves(*sum, *word, *seed);
                }
            }
        }
        for sums in sums {
            sums.iter_mut().for_each(|sum| *sum = high(*sum, tau << 25));
            tau += 2;
        }
    }
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
