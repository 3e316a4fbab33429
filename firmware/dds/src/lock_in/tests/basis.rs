//! The basis of one step: how far it is from the cosines and sines that it stands for.
use super::*;
use crate::lock_in::CONSTANT;
use crate::lock_in::basis::{BEND_WEIGHTS, Basis};

/// Steps from 0 to half a turn, with the smallest, and those next to the simple fractions of a turn.
fn steps() -> impl Iterator<Item = u32> {
    let fractions = (0..=64_u32).flat_map(|n| [n << 25, (n << 25) + 1, (n << 25).saturating_sub(1)]);
    let small = (0..31).map(|n| 3_u32 << n >> 1);
    fractions.chain(small).chain((0..20_000_u32).map(|n| n.wrapping_mul(0x9E37_79B9) >> 1))
}

/// A step in radians.
fn radians(step: u32) -> f64 {
    f64::from(step) * TAU / 4_294_967_296.0
}

#[test]
fn every_word_of_a_basis_is_rounded_to_nearest_but_for_less_than_a_hundredth() {
    let mut worst = 0.0_f64;
    for step in steps() {
        let mut basis = Basis::NONE;
        basis.rebuild(step);
        let numbers = |words: [i32; 4]| words.into_iter().flat_map(|word| [word as i16, (word >> 16) as i16]);
        for (n, (even, odd)) in numbers(basis.even).zip(numbers(basis.odd)).enumerate() {
            let (sine, cosine) = (radians(step) * (n as f64 + 0.5)).sin_cos();
            let off = |is: i16, should: f64| (f64::from(is) - should * f64::from(BASIS_ONE)).abs();
            worst = worst.max(off(even, cosine)).max(off(odd, sine));
            assert!(i32::from(even).abs().max(i32::from(odd).abs()) <= BASIS_ONE);
        }
    }
    std::println!("a basis is {worst:.4} units off at worst");
    assert!(worst < 0.507, "{worst}");
}

#[test]
fn the_turns_to_the_pairs_of_sub_blocks_are_1_4e_7_off_at_most() {
    let mut worst = 0.0_f64;
    for step in steps() {
        let mut basis = Basis::NONE;
        basis.rebuild(step);
        for (j, (c, s)) in basis.cosines.into_iter().zip(basis.sines).enumerate() {
            let (sine, cosine) = (radians(step) * 16.0 * (j as f64 + 0.5)).sin_cos();
            let off = |is: i32, should: f64| (f64::from(is) / f64::from(1 << 29) - should).abs();
            worst = worst.max(off(c, cosine)).max(off(s, sine));
        }
    }
    std::println!("a turn is {worst:.2e} off at worst");
    assert!(worst < 1.4e-7, "{worst:e}");
}

#[test]
fn the_constants_part_matches_a_block_of_constant_codes() {
    for step in steps() {
        let mut basis = Basis::NONE;
        basis.rebuild(step);
        let cosines = basis.even.into_iter().flat_map(|word| [word as i16, (word >> 16) as i16]);
        // Each cosine meets four samples of the constant; the sums are kept in eighths.
        let each = f64::from(cosines.map(i32::from).sum::<i32>() * 4 * CONSTANT) / 8.0;
        let turns = basis.cosines.map(|cosine| f64::from(cosine) / f64::from(1 << 29));
        let real: f64 = turns.iter().map(|turn| each * turn).sum();
        let bend: f64 =
            turns.iter().zip(BEND_WEIGHTS).map(|(turn, weight)| each * turn * f64::from(weight)).sum();
        let is = basis.constant();
        assert!((f64::from(is.real) - real).abs() <= 2.0, "{step:x}: {} is not {real}", is.real);
        assert!((f64::from(is.bend_real) - bend).abs() <= 8.0, "{step:x}: {} is not {bend}", is.bend_real);
        assert_eq!((is.imaginary, is.bend_imaginary), (0, 0));
    }
}
