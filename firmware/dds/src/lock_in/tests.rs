//! The lock-in on an input that answers with known amplitudes and phases, in doubles of the exact phases.
extern crate std;

mod accuracy;
mod basis;
mod edges;

use super::{BASIS_ONE, History, Shape, State, Window};
use crate::bank::{AMPLITUDE_ONE, BLOCK, TONES, ToneBlock};
use core::f64::consts::TAU;
use std::vec::Vec;

type LockIn = super::LockIn<2>;
type Reading = super::Reading<2>;

/// One turn of phase as a double.
const TURN: f64 = 18_446_744_073_709_551_616.0;
const RATE_HZ: f64 = 400_000.0;
/// 99.84 ms.
const BLOCKS: u16 = 312;
/// A sine of full scale, in codes.
const FULL_SCALE_CODES: f64 = 2047.0;

/// What the input answers to one tone.
#[derive(Clone, Copy, Debug)]
struct Answer {
    codes: f64,
    turns: f64,
}

/// An input behind a plate that answers each tone in its own way, with an offset and noise.
struct Input {
    answers: [Answer; TONES],
    offset: f64,
    noise: f64,
    seed: u64,
}

impl Input {
    fn quiet(answers: [Answer; TONES]) -> Self {
        Self { answers, offset: 0.0, noise: 0.0, seed: 1 }
    }

    /// A number from a normal distribution: the sum of twelve uniform ones.
    fn normal(&mut self) -> f64 {
        let mut sum = -6.0;
        for _ in 0..12 {
            self.seed =
                self.seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            sum += (self.seed >> 11) as f64 / (1_u64 << 53) as f64;
        }
        sum
    }

    /// The codes of one block.
    fn codes(&mut self, phases: &[u64; TONES], tones: &[ToneBlock; TONES]) -> [u16; BLOCK] {
        core::array::from_fn(|n| {
            let mut value = 2048.0 + self.offset + self.noise * self.normal();
            for ((phase, tone), answer) in phases.iter().zip(tones).zip(&self.answers) {
                if answer.codes != 0.0 {
                    let phase = phase.wrapping_add(tone.phase_gain(n as u32)) as f64 / TURN;
                    value += answer.codes * (TAU * (phase + answer.turns)).sin();
                }
            }
            value.round().clamp(0.0, 4095.0) as u16
        })
    }
}

/// A window over `blocks` from 0.
fn window(blocks: u16, shape: Shape) -> Window {
    Window { begin: 0, blocks, shape, slots: u16::MAX, input: None }
}

/// Plays `blocks`, made by `next` from the ends of the block before, and measures one input over all of them.
fn measured(
    window: Window,
    input: &mut Input,
    mut next: impl FnMut(usize, &[ToneBlock; TONES]) -> [ToneBlock; TONES],
) -> Reading {
    let (mut lock_in, mut history) = (LockIn::new(), History::new());
    lock_in.start(window, 0).expect("the window can be measured");
    let mut phases: [u64; TONES] =
        core::array::from_fn(|slot| (slot as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15));
    let mut tones = [ToneBlock::default(); TONES];
    for block in 0..usize::from(window.blocks) {
        tones = next(block, &tones);
        let index = (block * BLOCK) as u64;
        history.record(index, &phases, &tones);
        let codes = input.codes(&phases, &tones);
        lock_in.take_block(index, &[codes], history.at(index));
        for (phase, tone) in phases.iter_mut().zip(&tones) {
            *phase = phase.wrapping_add(tone.phase_gain(BLOCK as u32));
        }
    }
    assert_eq!(lock_in.state(), State::Finished);
    lock_in.reading().clone()
}

/// A tone's amplitude in codes and its phase in turns, from a reading.
fn answer(reading: &Reading, slot: usize) -> Answer {
    let sum = reading.answer(0, slot).expect("the tone was followed");
    let (i, q) = (sum.in_phase as f64, sum.quadrature as f64);
    let scale = 4.0 / (f64::from(BASIS_ONE) * BLOCK as f64 * f64::from(reading.weight));
    Answer { codes: i.hypot(q) * scale, turns: q.atan2(i) / TAU }
}

/// The errors of a reading's tones: the largest in dB and the largest in degrees.
fn errors(reading: &Reading, input: &Input, sounding: usize) -> (f64, f64) {
    let each = (0..sounding).map(|slot| {
        let (is, truth) = (answer(reading, slot), input.answers[slot]);
        let turns = is.turns - truth.turns;
        ((20.0 * (is.codes / truth.codes).log10()).abs(), 360.0 * (turns - turns.round()).abs())
    });
    each.fold((0.0, 0.0), |worst, error| (worst.0.max(error.0), worst.1.max(error.1)))
}

/// Steady tones of these frequencies in Hz.
fn steady(frequencies: &[f64]) -> [ToneBlock; TONES] {
    core::array::from_fn(|slot| match frequencies.get(slot) {
        Some(frequency) => ToneBlock::steady((frequency / RATE_HZ * TURN) as u64, AMPLITUDE_ONE / 16),
        None => ToneBlock::default(),
    })
}

/// Answers of these many codes to the first tones, each with another phase.
fn answers(sounding: usize, codes: f64) -> [Answer; TONES] {
    core::array::from_fn(|slot| Answer {
        codes: if slot < sounding { codes } else { 0.0 },
        turns: 0.137 + 0.271 * slot as f64,
    })
}

/// Frequencies in Hz from the lowest that is used to the highest, none of them a simple fraction of the rate.
fn frequencies() -> Vec<f64> {
    [97.3, 311.7, 1_003.1, 3_117.9, 9_973.0, 20_011.0, 39_989.0, 99_991.0, 179_017.0].to_vec()
}
