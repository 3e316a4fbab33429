//! The computations in portable Rust.

use super::basis::{BEND_WEIGHTS, Basis, Place, Projection};
use super::fold::{CODE, FOUR_MID, Folds, HALF, Span, WORDS, pack};
use super::history::PlayedTone;
use super::kernel::{Block, Kernel};
use crate::bank::BLOCK;
use crate::bank::sine::{add_halves, high_rounded};

/// The computations in Rust. They define the results, and run on hosts.
pub(super) struct Portable;

impl Kernel for Portable {
    fn fold(codes: &[u16; BLOCK], folds: &mut Folds) -> (Span, i32) {
        let codes = codes.map(|code| code & CODE);
        let span = Span {
            lowest: codes.iter().copied().min().unwrap_or_default(),
            highest: codes.iter().copied().max().unwrap_or_default(),
        };
        let (before, after) = codes.split_at(BLOCK / 2);
        let after = after.as_chunks::<{ 2 * HALF }>().0;
        let before = before.as_chunks::<{ 2 * HALF }>().0.iter().rev();
        let mut sum = 0;
        let pairs = folds.even.iter_mut().rev().zip(&mut folds.odd);
        for ((after, before), (even, odd)) in after.iter().zip(before).zip(pairs) {
            let (after, before) = (folded(after), folded(before));
            let words = even.sums.iter_mut().zip(&mut even.differences);
            let words = words.zip(odd.sums.iter_mut().zip(&mut odd.differences));
            for (words, (after, before)) in
                words.zip(after.as_chunks::<2>().0.iter().zip(before.as_chunks::<2>().0))
            {
                let ((even_sum, even_difference), (odd_sum, odd_difference)) = words;
                let [[near_even, near_odd], [far_even, far_odd]] = *after;
                let [[near_even_before, near_odd_before], [far_even_before, far_odd_before]] = *before;
                let (near, far) =
                    (near_even + near_even_before - FOUR_MID, far_even + far_even_before - FOUR_MID);
                // 32 numbers of 13 bits and a sign.
                sum += near + far;
                *even_sum = pack(near, far);
                *even_difference = pack(near_even - near_even_before, far_even - far_even_before);
                *odd_sum = pack(near_odd + near_odd_before, far_odd + far_odd_before);
                *odd_difference = pack(near_odd - near_odd_before, far_odd - far_odd_before);
            }
        }
        (span, sum)
    }

    fn follow<const INPUTS: usize>(block: Block<'_, INPUTS>) -> u32 {
        let mut slots = block.slots;
        let own = block.followers.iter_mut().zip(block.constant).zip(block.tones);
        for (slot, ((follower, constant), PlayedTone { phase, tone })) in own.enumerate() {
            let bit = 1 << slot;
            if slots & bit == 0 {
                continue;
            }
            let is_silent = tone.amplitude == 0 && tone.amplitude_end == 0;
            if is_silent || block.jumps != 0 && follower.end != *phase {
                slots &= !bit;
                continue;
            }
            follower.end = phase.wrapping_add(tone.block_gain());
            let (basis, place) = (&mut follower.basis, Place::new(*phase, tone));
            if !basis.fits(&place) {
                basis.rebuild(place.step);
            }
            constant.add(place.turn(basis.constant()), block.weight);
            let [first, inputs] = [block.first, block.inputs].map(|count| count as usize);
            for (sums, folds) in block.sums.iter_mut().zip(block.folds).skip(first).take(inputs) {
                if let Some(sums) = sums.get_mut(slot) {
                    sums.add(place.turn(project(basis, folds)), block.weight);
                }
            }
        }
        slots
    }
}

/// A folded block's part along a basis.
fn project(basis: &Basis, folds: &Folds) -> Projection {
    let mut projection = Projection::default();
    let pairs = folds.even.iter().rev().zip(&folds.odd);
    let rotors = basis.cosines.iter().zip(&basis.sines).zip(BEND_WEIGHTS);
    for ((even, odd), ((cosine, sine), weight)) in pairs.zip(rotors) {
        let along = |words, codes, rotor| high_rounded(0, products(words, codes), rotor);
        let real =
            along(&basis.even, &even.sums, *cosine).wrapping_add(along(&basis.odd, &odd.differences, -*sine));
        let imaginary =
            along(&basis.odd, &odd.sums, *cosine).wrapping_add(along(&basis.even, &even.differences, *sine));
        projection.add(real, imaginary, weight);
    }
    projection
}

/// `x[tau] + x[-tau]` and `x[tau] - x[-tau]` of a sub-block, from its centre outwards.
fn folded(codes: &[u16; 2 * HALF]) -> [[i32; 2]; HALF] {
    let (below, above) = codes.split_at(HALF);
    let mut folded = [[0; 2]; HALF];
    for (folded, (above, below)) in folded.iter_mut().zip(above.iter().zip(below.iter().rev())) {
        let (above, below) = (i32::from(*above), i32::from(*below));
        *folded = [above + below, above - below];
    }
    folded
}

/// Both halves of each word times both halves of the other, summed.
fn products(words: &[i32; WORDS], codes: &[i32; WORDS]) -> i32 {
    words.iter().zip(codes).fold(0, |sum, (word, code)| add_halves(sum, *word, *code))
}
