//! The bank's samples, compared with sines in doubles of the exact phases.
extern crate std;

mod spectrum;

use super::code::{codes, codes_portably};
use super::{AMPLITUDE_ONE, BLOCK, Bank, FULL_SCALE, MAX_STEP_CHANGE, TONES, ToneBlock};
use core::f64::consts::TAU;
use proptest::prelude::*;

/// One turn of phase as a double.
const TURN: f64 = 18_446_744_073_709_551_616.0;
/// The highest step a tone may have: 0.45 turns per sample.
const HIGHEST_STEP: u64 = u64::MAX / 20 * 9;

/// The phase step of a frequency given as a fraction of the sample rate.
fn step(frequency: f64) -> u64 {
    (frequency * TURN) as u64
}

/// A reproducible stream of numbers.
struct Numbers(u64);

impl Numbers {
    fn draw(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 ^ (self.0 >> 29)
    }

    fn below(&mut self, limit: u64) -> u64 {
        ((u128::from(self.draw()) * u128::from(limit)) >> 64) as u64
    }
}

/// The exact samples of one block, full scale = 1.
fn truth(bank: &Bank, tones: &[ToneBlock; TONES]) -> [f64; BLOCK] {
    let one = f64::from(AMPLITUDE_ONE);
    core::array::from_fn(|n| {
        let value = |(slot, tone): (usize, &ToneBlock)| {
            let phase = bank.phase(slot).wrapping_add(tone.phase_gain(n as u32)) as f64 / TURN;
            let (from, to) = (f64::from(tone.amplitude), f64::from(tone.amplitude_end));
            (from + (to - from) * n as f64 / BLOCK as f64) / one * (TAU * phase).sin()
        };
        tones.iter().enumerate().map(value).sum()
    })
}

fn db(ratio: f64) -> f64 {
    20.0 * ratio.log10()
}

/// Renders `blocks` of tones that `next` makes from the tones before, and returns the peak and the rms of the error in
/// dB: full scale is 0 dB, for the rms a sine of full scale.
fn error(
    blocks: usize,
    mut next: impl FnMut(usize, &[ToneBlock; TONES], &mut Bank) -> [ToneBlock; TONES],
) -> (f64, f64) {
    let (mut peak, mut power) = (0.0_f64, 0.0);
    let (mut bank, mut tones, mut out) = (Bank::new(), [ToneBlock::default(); TONES], [0; BLOCK]);
    for block in 0..blocks {
        tones = next(block, &tones, &mut bank);
        let wanted = truth(&bank, &tones);
        bank.render(&tones, &mut out);
        for (sample, wanted) in out.iter().zip(wanted) {
            let error = f64::from(*sample) / f64::from(FULL_SCALE) - wanted;
            peak = peak.max(error.abs());
            power += error * error;
        }
    }
    (db(peak), db((2.0 * power / (blocks * BLOCK) as f64).sqrt()))
}

/// One tone at every phase, with the given step, change of step, and change of amplitude up to full scale.
fn one_tone_error(frequency: f64, change: i64, ramp: u32) -> (f64, f64) {
    error(300, |block, _, bank| {
        bank.set_phase(3, (block as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15));
        let step = step(frequency);
        let mut tones = [ToneBlock::default(); TONES];
        tones[3] = ToneBlock {
            step,
            step_end: step.wrapping_add_signed(change),
            amplitude: AMPLITUDE_ONE - ramp,
            amplitude_end: AMPLITUDE_ONE,
        };
        tones
    })
}

#[test]
fn a_steady_tone_is_140_db_true_at_every_frequency_and_phase() {
    for frequency in [0.000_01, 0.000_075, 0.003, 0.1, 0.25, 0.333_333, 0.449_999] {
        let (peak, rms) = one_tone_error(frequency, 0, 0);
        std::println!("{frequency}: peak {peak:.1} dB, rms {rms:.1} dB");
        assert!(peak < -140.0 && rms < -147.0, "{frequency}: peak {peak:.1} dB, rms {rms:.1} dB");
    }
}

#[test]
fn a_glide_within_the_limit_is_true_to_the_documented_levels() {
    let limit = MAX_STEP_CHANGE.cast_signed();
    // Full scale in 10 ms at 400 kS/s is 1/31 of it per block.
    let slow = AMPLITUDE_ONE / 31;
    for (change, ramp, peak_limit, rms_limit) in [
        (limit, 0, -93.0, -105.0),
        (-limit, 0, -93.0, -105.0),
        (limit / 4, slow, -98.0, -108.0),
        (limit / 1024, slow, -98.0, -108.0),
        (limit, slow, -93.0, -105.0),
        (0, slow, -98.0, -108.0),
        (0, AMPLITUDE_ONE, -96.0, -103.0),
        (limit, AMPLITUDE_ONE, -86.0, -94.0),
    ] {
        for frequency in [0.003, 0.1, 0.31, 0.44] {
            let (peak, rms) = one_tone_error(frequency, change, ramp);
            std::println!("{frequency} change {change} ramp {ramp}: peak {peak:.1} dB, rms {rms:.1} dB");
            assert!(
                peak < peak_limit && rms < rms_limit,
                "{frequency} change {change} ramp {ramp}: peak {peak:.1} dB, rms {rms:.1} dB"
            );
        }
    }
}

#[test]
fn a_steady_tone_is_the_same_through_either_kernel() {
    // One unit of change in a silent slot sends the block through the gliding kernel.
    let (peak, rms) = error(300, |block, _, bank| {
        bank.set_phase(0, (block as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15));
        let mut tones = [ToneBlock::default(); TONES];
        tones[0] = ToneBlock::steady(step(0.000_075 + 0.0015 * block as f64), AMPLITUDE_ONE);
        tones[1].step_end = 1;
        tones
    });
    assert!(peak < -133.0 && rms < -138.0, "peak {peak:.1} dB, rms {rms:.1} dB");
}

/// The next block of a random sequence: unless `calm`, some tones change step or amplitude, within the limits.
fn storm(numbers: &mut Numbers, before: &[ToneBlock; TONES], calm: bool, highest: u64) -> [ToneBlock; TONES] {
    core::array::from_fn(|slot| {
        let (step, amplitude) = (before[slot].step_end, before[slot].amplitude_end);
        let mut next = ToneBlock::steady(step, amplitude);
        if !calm && numbers.below(3) == 0 {
            let change = numbers.below(2 * MAX_STEP_CHANGE) as i64 - MAX_STEP_CHANGE.cast_signed();
            next.step_end = step.saturating_add_signed(change).clamp(1 << 40, highest);
        }
        if !calm && numbers.below(3) == 0 {
            // Full scale is shared by the tones; 1/31 of it per block is 10 ms from nothing to all.
            let share = AMPLITUDE_ONE / TONES as u32;
            let target = numbers.below(u64::from(share) + 1) as u32;
            next.amplitude_end = target.clamp(amplitude.saturating_sub(share / 31), amplitude + share / 31);
        }
        next
    })
}

#[test]
fn a_storm_of_glides_leaves_no_step_and_no_drift() {
    let mut numbers = Numbers(7);
    let (mut bank, mut tones) = (Bank::new(), [ToneBlock::default(); TONES]);
    let (mut out, mut last, mut worst_share) = ([0; BLOCK], 0.0, 0.0_f64);
    let mut phases = [0_u64; TONES];
    let highest = step(0.02);
    let (mut peak, mut biggest) = (0.0_f64, 0.0_f64);
    for block in 0..6000 {
        // Three gliding blocks and two steady ones in turn: the change between the two kernels is tested, too.
        tones = storm(&mut numbers, &tones, block % 5 > 2, highest);
        let wanted = truth(&bank, &tones);
        // A tone's phase moves by at most its higher step and its amplitude by its ramp. The gliding kernel's error
        // comes on top: a tenth of a DAC code for all tones together.
        let bound: f64 = tones
            .iter()
            .map(|tone| {
                let (from, to) = (f64::from(tone.amplitude), f64::from(tone.amplitude_end));
                let turns = tone.step.max(tone.step_end) as f64 / TURN;
                let loudest = from.max(to);
                (loudest * TAU * turns + (to - from).abs() / BLOCK as f64) / f64::from(AMPLITUDE_ONE)
            })
            .sum::<f64>()
            + 0.1 / 2047.0;
        bank.render(&tones, &mut out);
        for (n, (sample, wanted)) in out.iter().zip(wanted).enumerate() {
            let sample = f64::from(*sample) / f64::from(FULL_SCALE);
            assert!(
                (sample - last).abs() <= bound,
                "block {block}, sample {n}: from {last} to {sample}, the bound is {bound}"
            );
            worst_share = worst_share.max((sample - last).abs() / bound);
            peak = peak.max((sample - wanted).abs());
            biggest = biggest.max(sample.abs());
            last = sample;
        }
        for (phase, tone) in phases.iter_mut().zip(&tones) {
            *phase = (0..BLOCK as u32).fold(*phase, |phase, n| {
                phase.wrapping_add(tone.phase_gain(n + 1).wrapping_sub(tone.phase_gain(n)))
            });
        }
    }
    for (slot, phase) in phases.iter().enumerate() {
        assert_eq!(bank.phase(slot), *phase, "slot {slot} has drifted from the sum of its steps");
    }
    assert!(db(peak) < -86.0, "the storm's error reaches {:.1} dB", db(peak));
    assert!(biggest > 0.2 && worst_share > 0.3, "the storm is too weak: {biggest} {worst_share}");
}

#[test]
fn a_day_of_a_steady_tone_ends_at_the_phase_of_its_64_bit_count() {
    const BLOCKS_A_DAY: u64 = 400_000 * 86_400 / BLOCK as u64;
    let step = step(0.1) + 12_345;
    let mut tones = [ToneBlock::default(); TONES];
    tones[0] = ToneBlock::steady(step, AMPLITUDE_ONE);
    let per_block = tones[0].phase_gain(BLOCK as u32);
    // The first minutes one by one, then, as the gain of a block never changes, the rest at once.
    let (mut bank, mut out) = (Bank::new(), [0; BLOCK]);
    const RUN: u64 = 40_000;
    for _ in 0..RUN {
        bank.render(&tones, &mut out);
    }
    assert_eq!(bank.phase(0), step.wrapping_mul(RUN * BLOCK as u64));
    let mut late = Bank::new();
    late.set_phase(0, bank.phase(0).wrapping_add(per_block.wrapping_mul(BLOCKS_A_DAY - RUN)));
    assert_eq!(late.phase(0), step.wrapping_mul(BLOCKS_A_DAY * BLOCK as u64));
    let wanted = truth(&late, &tones);
    late.render(&tones, &mut out);
    for (sample, wanted) in out.iter().zip(wanted) {
        assert!(db((f64::from(*sample) / f64::from(FULL_SCALE) - wanted).abs()) < -135.0);
    }
}

#[test]
fn fifteen_tones_of_full_amplitude_in_step_do_not_wrap() {
    let mut tones = [ToneBlock::steady(step(0.01), u32::MAX); TONES];
    tones[15] = ToneBlock::default();
    for end in [u32::MAX, 0] {
        tones[2].amplitude_end = end;
        let (mut bank, mut out) = (Bank::new(), [0; BLOCK]);
        bank.render(&tones, &mut out);
        for (n, sample) in out.iter().enumerate() {
            let sine = (TAU * 0.01 * n as f64).sin();
            assert!(f64::from(*sample) * sine >= -1000.0, "sample {n} has the wrong sign");
        }
    }
}

#[test]
fn codes_round_to_nearest_clamp_and_count_what_they_clamp() {
    let mut samples = [0; BLOCK];
    let full = FULL_SCALE;
    for (slot, sample) in
        samples.iter_mut().zip([full, -full, full + full / 2047, i32::MAX, i32::MIN, 32_784, 32_785])
    {
        *slot = sample;
    }
    let mut out = [0; BLOCK];
    assert_eq!(codes(&samples, &mut out).clipped, 3);
    assert_eq!(out[..8], [4095, 1, 4095, 4095, 0, 2048, 2049, 2048]);
}

#[test]
fn a_basis_is_built_once_for_each_new_step() {
    use super::kernel::{Kernel, Survey};
    use super::portable::Portable;
    let mut tones = [ToneBlock::steady(step(0.1), AMPLITUDE_ONE / 16); TONES];
    let (mut bank, mut out) = (Bank::new(), [0; BLOCK]);
    assert_eq!(Portable::survey(&tones, &bank.inverted_steps), Survey::Retuned);
    bank.render(&tones, &mut out);
    assert_eq!(Portable::survey(&tones, &bank.inverted_steps), Survey::Unchanged);
    tones[15].step_end += 1;
    assert_eq!(Portable::survey(&tones, &bank.inverted_steps), Survey::Gliding);
    tones[15].step += 1;
    assert_eq!(Portable::survey(&tones, &bank.inverted_steps), Survey::Retuned);
    tones[15].amplitude_end += 1;
    assert_eq!(Portable::survey(&tones, &bank.inverted_steps), Survey::Gliding);
}

fn any_tone() -> impl Strategy<Value = ToneBlock> {
    (any::<u64>(), any::<u64>(), any::<u32>(), any::<u32>()).prop_map(
        |(step, step_end, amplitude, amplitude_end)| ToneBlock { step, step_end, amplitude, amplitude_end },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn what_was_rendered_before_does_not_matter(
        before in proptest::collection::vec(proptest::array::uniform16(any_tone()), 0..4),
        steady in any::<bool>(),
        tones in proptest::array::uniform16(any_tone()),
    ) {
        let tones = if steady { tones.map(|tone| ToneBlock::steady(tone.step, tone.amplitude)) } else { tones };
        let (mut used, mut fresh) = (Bank::new(), Bank::new());
        let (mut out, mut expected) = ([0; BLOCK], [0; BLOCK]);
        for tones in &before {
            used.render(tones, &mut out);
            // The steady kernel keeps tables between blocks.
            used.render(&tones.map(|tone| ToneBlock::steady(tone.step_end, tone.amplitude_end)), &mut out);
        }
        (0..TONES).for_each(|slot| fresh.set_phase(slot, used.phase(slot)));
        used.render(&tones, &mut out);
        fresh.render(&tones, &mut expected);
        prop_assert_eq!(out, expected);
        let (mut used_codes, mut portable_codes) = ([0; BLOCK], [0; BLOCK]);
        prop_assert_eq!(codes(&out, &mut used_codes), codes_portably(&expected, &mut portable_codes));
        prop_assert_eq!(used_codes, portable_codes);
    }

    #[test]
    fn the_phase_gained_is_the_integral_of_a_linear_step(
        step in 0..HIGHEST_STEP,
        step_end in 0..HIGHEST_STEP,
        n in 0..BLOCK as u32,
    ) {
        let tone = ToneBlock { step, step_end, amplitude: 0, amplitude_end: 0 };
        let gained = tone.phase_gain(n + 1).wrapping_sub(tone.phase_gain(n));
        let middle = step as f64 + (step_end as f64 - step as f64) * (f64::from(n) + 0.5) / BLOCK as f64;
        prop_assert!((gained as f64 - middle).abs() <= 1e-12 * TURN);
        prop_assert_eq!(tone.phase_gain(BLOCK as u32), tone.block_gain());
    }
}
