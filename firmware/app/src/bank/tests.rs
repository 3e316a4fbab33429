//! The bank against the truth, computed in doubles from the exact phases.
extern crate std;

use super::{BLOCK, Bank, FULL_SCALE, MAX_STEP_CHANGE, TONES, ToneBlock};
use core::f64::consts::TAU;
use proptest::prelude::*;
use std::vec::Vec;

/// One turn of phase as a double.
const TURN: f64 = 18_446_744_073_709_551_616.0;

/// The phase step of a frequency given as a fraction of the sample rate.
fn step(frequency: f64) -> u64 {
    (frequency * TURN) as u64
}

fn amplitude(of_full_scale: f64) -> u32 {
    (of_full_scale * 2_147_483_648.0) as u32
}

/// The sum that the samples of one block should be, full scale = 1.
fn truth(bank: &Bank, tones: &[ToneBlock; TONES]) -> [f64; BLOCK] {
    core::array::from_fn(|n| {
        tones
            .iter()
            .enumerate()
            .map(|(slot, tone)| {
                let phase = bank.phase(slot).wrapping_add(tone.phase_gain(n as u32)) as f64 / TURN;
                let (from, to) = (f64::from(tone.amplitude), f64::from(tone.amplitude_end));
                (from + (to - from) * n as f64 / BLOCK as f64) / 2_147_483_648.0 * (TAU * phase).sin()
            })
            .sum()
    })
}

fn db(ratio: f64) -> f64 {
    20.0 * ratio.log10()
}

#[test]
fn scratch_accuracy() {
    for (name, change, ramp, f) in [
        ("steady", 0_i64, 0_i64, 0.1),
        ("steady hi", 0, 0, 0.4499),
        ("steady lo", 0, 0, 0.000075),
        ("2^54", 1 << 54, 0, 0.1),
        ("-2^54", -(1 << 54), 0, 0.1),
        ("2^53", 1 << 53, 0, 0.1),
        ("2^50", 1 << 50, 0, 0.1),
        ("2^45", 1 << 45, 0, 0.1),
        ("ramp slow", 0, (1 << 31) / 20, 0.1),
        ("ramp full", 0, (1 << 31) - 1, 0.1),
        ("both", 1 << 54, (1 << 31) / 20, 0.1),
        ("both full", 1 << 54, (1 << 31) - 1, 0.1),
        ("both lo", 1 << 50, (1 << 31) / 20, 0.000075),
        ("tiny change", 1, 0, 0.1),
    ] {
        let (mut peak, mut square) = (0.0_f64, 0.0);
        let mut bank = Bank::new();
        for n in 0..200_u64 {
            let mut tones = [ToneBlock::default(); TONES];
            bank.set_phase(3, n.wrapping_mul(0x9E37_79B9_7F4A_7C15));
            let s = step(f);
            tones[3] = ToneBlock {
                step: s,
                step_end: s.wrapping_add_signed(change),
                amplitude: (1 << 31) - if ramp > 0 { ramp as u32 } else { 0 },
                amplitude_end: 1 << 31,
            };
            let want = truth(&bank, &tones);
            let mut out = [0; BLOCK];
            bank.render(&tones, &mut out);
            for (o, w) in out.iter().zip(want) {
                let e = f64::from(*o) / f64::from(FULL_SCALE) - w;
                peak = peak.max(e.abs());
                square += e * e;
            }
        }
        std::println!(
            "{name:12} peak {:.1} dB rms {:.1} dB",
            db(peak),
            db((square / 200.0 / 128.0 * 2.0).sqrt())
        );
    }
}
