//! spectra of a single tone, of the samples and of the DAC's codes.

use super::super::code::codes;
use super::super::quantize::quantize;
use super::super::{AMPLITUDE_ONE, BLOCK, Bank, FULL_SCALE, TONES, ToneBlock};
use super::{db, step};
use core::f64::consts::{PI, TAU};
use std::vec::Vec;

const SAMPLE_RATE: f64 = 400_000.0;
/// 0.66 s; lines are 1.5 Hz apart.
const LENGTH: usize = 1 << 18;
/// Half the main lobe of the window below, in lines.
const LOBE: usize = 10;

fn one_tone(frequency: f64) -> [ToneBlock; TONES] {
    let mut tones = [ToneBlock::default(); TONES];
    tones[5] = ToneBlock::steady(step(frequency / SAMPLE_RATE), AMPLITUDE_ONE);
    tones
}

/// The samples of `frequency` at full amplitude, full scale = 1.
fn samples(frequency: f64) -> Vec<f64> {
    let mut bank = Bank::new();
    let mut out = [0; BLOCK];
    (0..LENGTH / BLOCK)
        .flat_map(|_| {
            bank.render(&one_tone(frequency), &mut out);
            out
        })
        .map(|sample| f64::from(sample) / f64::from(FULL_SCALE))
        .collect()
}

/// The codes that `convert` makes of the same samples, minus mid-scale.
fn converted(frequency: f64, mut convert: impl FnMut(&[i32; BLOCK], &mut [u16; BLOCK]) -> u32) -> Vec<f64> {
    let mut bank = Bank::new();
    let (mut out, mut block) = ([0; BLOCK], [0; BLOCK]);
    (0..LENGTH / BLOCK)
        .flat_map(|_| {
            bank.render(&one_tone(frequency), &mut out);
            assert_eq!(convert(&out, &mut block), 0, "a tone of full amplitude clips");
            block
        })
        .map(|code| f64::from(code) - 2048.0)
        .collect()
}

/// The same tone through an ideal 12-bit quantiser.
fn ideal(frequency: f64) -> Vec<f64> {
    let turns = step(frequency / SAMPLE_RATE);
    (0..LENGTH as u64)
        .map(|n| (2047.0 * (TAU * (turns.wrapping_mul(n) as f64 / super::TURN)).sin()).round())
        .collect()
}

/// Powers of the lines from 0 to half the sample rate, under a Kaiser window with side lobes below -200 dB.
fn powers(signal: &[f64]) -> Vec<f64> {
    const BETA: f64 = 26.0;
    let bessel = |x: f64| {
        let (mut term, mut sum) = (1.0, 1.0);
        for k in 1..80 {
            term *= (x / 2.0 / f64::from(k)).powi(2);
            sum += term;
        }
        sum
    };
    let middle = signal.len() as f64 / 2.0;
    let mut lines: Vec<(f64, f64)> = signal
        .iter()
        .enumerate()
        .map(|(n, x)| (x * bessel(BETA * (1.0 - ((n as f64 - middle) / middle).powi(2)).sqrt()), 0.0))
        .collect();
    transform(&mut lines);
    lines[..signal.len() / 2].iter().map(|(re, im)| re * re + im * im).collect()
}

/// The fast Fourier transform, in place.
fn transform(x: &mut [(f64, f64)]) {
    let bits = x.len().trailing_zeros();
    for n in 0..x.len() {
        let mirrored = n.reverse_bits() >> (usize::BITS - bits);
        if n < mirrored {
            x.swap(n, mirrored);
        }
    }
    let mut half = 1;
    while half < x.len() {
        let turns: Vec<_> = (0..half).map(|k| (-PI * k as f64 / half as f64).sin_cos()).collect();
        for part in x.chunks_exact_mut(2 * half) {
            let (low, high) = part.split_at_mut(half);
            for ((a, b), (s, c)) in low.iter_mut().zip(high).zip(&turns) {
                let t = (b.0 * c - b.1 * s, b.0 * s + b.1 * c);
                *b = (a.0 - t.0, a.1 - t.1);
                *a = (a.0 + t.0, a.1 + t.1);
            }
        }
        half *= 2;
    }
}

/// The tone's power over that of the strongest other line, and over that of all other lines but DC, in dB.
fn purity(signal: &[f64], frequency: f64) -> (f64, f64) {
    let powers = powers(signal);
    let tone = (frequency / SAMPLE_RATE * LENGTH as f64).round() as usize;
    let lobe = tone.saturating_sub(LOBE)..=tone + LOBE;
    let wanted: f64 = powers[lobe.clone()].iter().sum();
    let others = powers.iter().enumerate().skip(LOBE).filter(|(line, _)| !lobe.contains(line));
    let strongest = others.clone().map(|(_, power)| *power).fold(0.0, f64::max);
    let peak = powers[lobe.clone()].iter().copied().fold(0.0, f64::max);
    let noise: f64 = others.map(|(_, power)| power).sum();
    (db((peak / strongest).sqrt()), db((wanted / noise).sqrt()))
}

#[test]
fn every_other_line_lies_160_db_below_the_tone_before_the_dac() {
    for frequency in [39_997.0, 40_000.0, 30.0, 179_000.0] {
        let (range, to_noise) = purity(&samples(frequency), frequency);
        std::println!("{frequency} Hz: SFDR {range:.1} dB, SINAD {to_noise:.1} dB before the DAC");
        assert!(range >= 160.0, "{frequency} Hz: {range:.1} dB");
    }
}

#[test]
fn the_codes_are_as_pure_as_twelve_bits_allow() {
    for frequency in [39_997.0, 40_000.0, 30.0] {
        let (range, to_noise) = purity(&converted(frequency, |from, to| codes(from, to).clipped), frequency);
        let (ideal_range, ideal_to_noise) = purity(&ideal(frequency), frequency);
        std::println!(
            "{frequency} Hz: SFDR {range:.1} dB (ideal {ideal_range:.1}), SINAD {to_noise:.2} dB (ideal {ideal_to_noise:.2})"
        );
        assert!(to_noise >= 73.5, "{frequency} Hz: {to_noise:.2} dB");
        assert!(
            range >= ideal_range - 1.0,
            "{frequency} Hz: {range:.1} dB, an ideal quantiser {ideal_range:.1} dB"
        );
    }
}

/// As [`codes`], with a rectangular dither of one code from `dither`: the codes' error does not follow the signal, but
/// the noise is 3 dB higher.
fn dithered_codes(samples: &[i32; BLOCK], dither: &mut Dither, codes: &mut [u16; BLOCK]) -> u32 {
    let mut clipped = 0;
    for (sample, code) in samples.iter().zip(codes) {
        let (value, clamped) = quantize(*sample, dither.draw());
        *code = value;
        clipped += u32::from(clamped);
    }
    clipped
}

/// A source of rectangular dither: a 32-bit xorshift, the same sequence on every machine.
struct Dither(u32);

impl Dither {
    /// Starts the sequence at `seed`. Zero counts as 1, because xorshift cannot leave zero.
    const fn new(seed: u32) -> Self {
        Self(if seed == 0 { 1 } else { seed })
    }

    fn draw(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0
    }
}

#[test]
fn dither_turns_the_lines_of_a_periodic_tone_into_noise() {
    let mut dither = Dither::new(1);
    let (range, to_noise) =
        purity(&converted(40_000.0, |from, to| dithered_codes(from, &mut dither, to)), 40_000.0);
    std::println!("40 kHz dithered: SFDR {range:.1} dB, SINAD {to_noise:.2} dB");
    assert!(range >= 104.0 && (70.5..73.0).contains(&to_noise), "{range:.1} dB, {to_noise:.2} dB");
}
