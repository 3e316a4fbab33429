//! Row 1: how well a lock-in measures in 100 ms.
use super::*;
use crate::bank::MAX_STEP_CHANGE;

/// Full scale less some dB, in codes.
fn below_full_scale(db: f64) -> f64 {
    FULL_SCALE_CODES * 10_f64.powf(-db / 20.0)
}

/// The worst errors of single tones, one after the other, in dB and degrees.
fn single_tones(codes: f64, noise: f64, shape: Shape) -> (f64, f64) {
    let each = frequencies().into_iter().enumerate().map(|(number, frequency)| {
        let mut input =
            Input { offset: 31.4, noise, seed: 7 + number as u64, ..Input::quiet(answers(1, codes)) };
        let reading = measured(window(BLOCKS, shape), &mut input, |_, _| steady(&[frequency]));
        assert_eq!(reading.followed, 1);
        errors(&reading, &input, 1)
    });
    each.fold((0.0_f64, 0.0_f64), |worst, error| (worst.0.max(error.0), worst.1.max(error.1)))
}

#[test]
fn a_tone_at_minus_40_db_with_half_a_code_of_noise_is_measured_to_0_05_db_and_0_3_degrees() {
    let (db, degrees) = single_tones(below_full_scale(40.0), 0.5, Shape::Hann);
    std::println!("-40 dBFS with noise: {db:.4} dB, {degrees:.3} degrees");
    assert!(db < 0.05 && degrees < 0.3, "{db} dB, {degrees} degrees");
}

#[test]
fn a_tone_at_minus_80_db_with_half_a_code_of_noise_is_measured_to_1_db() {
    let (db, degrees) = single_tones(below_full_scale(80.0), 0.5, Shape::Hann);
    std::println!("-80 dBFS with noise: {db:.4} dB, {degrees:.3} degrees");
    assert!(db < 1.0, "{db} dB, {degrees} degrees");
}

#[test]
fn a_tone_without_noise_is_measured_to_0_2_db_and_1_degree() {
    let (db, degrees) = single_tones(below_full_scale(40.0), 0.0, Shape::Hann);
    std::println!("-40 dBFS without noise: {db:.4} dB, {degrees:.3} degrees");
    assert!(db < 0.2 && degrees < 1.0, "{db} dB, {degrees} degrees");
}

#[test]
fn sixteen_tones_at_once_are_separated() {
    // No comb: the distances are not multiples of one over the window.
    let tones: Vec<f64> = (0..16).map(|n| 1_203.7 + 411.3 * f64::from(n)).collect();
    let mut input = Input { offset: -55.0, noise: 0.5, ..Input::quiet(answers(16, below_full_scale(40.0))) };
    let reading = measured(window(BLOCKS, Shape::Hann), &mut input, |_, _| steady(&tones));
    let (db, degrees) = errors(&reading, &input, 16);
    std::println!("sixteen at -40 dBFS, Hann: {db:.4} dB, {degrees:.3} degrees");
    assert_eq!(reading.followed, u16::MAX);
    assert!(db < 0.05 && degrees < 0.3, "{db} dB, {degrees} degrees");
}

#[test]
fn a_coherent_comb_is_separated_by_the_rectangular_window() {
    // Multiples of 25 / 39936 samples, which are whole turns over the window.
    let tones: Vec<f64> = (0..16).map(|n| RATE_HZ * f64::from(100 + 25 * n) / 39_936.0).collect();
    let mut input = Input { offset: -55.0, noise: 0.5, ..Input::quiet(answers(16, below_full_scale(40.0))) };
    let reading = measured(window(BLOCKS, Shape::Rectangular), &mut input, |_, _| steady(&tones));
    let (db, degrees) = errors(&reading, &input, 16);
    std::println!("sixteen at -40 dBFS, comb: {db:.4} dB, {degrees:.3} degrees");
    assert!(db < 0.05 && degrees < 0.3, "{db} dB, {degrees} degrees");
}

/// Sixteen tones that glide up and down by this change of step, over and over.
fn gliding(change: u64) -> impl FnMut(usize, &[ToneBlock; TONES]) -> [ToneBlock; TONES] {
    move |block, before| {
        core::array::from_fn(|slot| {
            let step = if block == 0 {
                (f64::from(20_000 + 9_000 * slot as u32) / RATE_HZ * TURN) as u64
            } else {
                before[slot].step_end
            };
            let up = (block / 8 + slot).is_multiple_of(2);
            let step_end = if up { step.wrapping_add(change) } else { step.wrapping_sub(change) };
            ToneBlock { step, step_end, amplitude: AMPLITUDE_ONE / 16, amplitude_end: AMPLITUDE_ONE / 16 }
        })
    }
}

#[test]
fn gliding_tones_are_measured_as_well_as_steady_ones() {
    for change in [MAX_STEP_CHANGE, MAX_STEP_CHANGE / 16] {
        // One after the other: what the others let in belongs to the window, not to the glide.
        for slot in 0..TONES {
            let mut all = [Answer { codes: 0.0, turns: 0.0 }; TONES];
            all[slot] = Answer { codes: below_full_scale(40.0), turns: 0.3 };
            let mut input = Input { noise: 0.5, seed: slot as u64, ..Input::quiet(all) };
            let reading = measured(window(BLOCKS, Shape::Hann), &mut input, gliding(change));
            let is = answer(&reading, slot);
            let (db, degrees) =
                (20.0 * (is.codes / all[slot].codes).log10(), 360.0 * (is.turns - all[slot].turns));
            assert!(db.abs() < 0.05 && degrees.abs() < 0.3, "slot {slot}: {db} dB, {degrees} degrees");
        }
    }
}

#[test]
fn the_fastest_glide_costs_3e_5_of_the_amplitude_and_no_phase() {
    let mut all = answers(1, 2_000.0);
    all[0].turns = 0.0;
    let mut input = Input::quiet(all);
    let reading = measured(window(BLOCKS, Shape::Hann), &mut input, |block, before| {
        let step = if block == 0 { u64::MAX / 50 } else { before[0].step_end };
        let tone = ToneBlock { step_end: step + MAX_STEP_CHANGE, ..ToneBlock::steady(step, AMPLITUDE_ONE) };
        core::array::from_fn(|slot| if slot == 0 { tone } else { ToneBlock::default() })
    });
    let is = answer(&reading, 0);
    let (short, degrees) = (1.0 - is.codes / 2_000.0, 360.0 * is.turns);
    std::println!("the fastest glide: {short:.2e} of the amplitude, {degrees:.5} degrees");
    assert!((3e-5..3.6e-5).contains(&short), "{short:e} of the amplitude");
    assert!(degrees.abs() < 0.001, "{degrees} degrees");
}

#[test]
fn a_slot_rejects_another_full_scale_tone_by_90_db() {
    let mut all = answers(2, 2_000.0);
    all[1].codes = 0.0;
    for (loud, silent) in [(10_000.0, 25_013.0), (40_011.0, 3_127.0), (97.0, 110_003.0)] {
        let mut input = Input::quiet(all);
        let reading = measured(window(BLOCKS, Shape::Hann), &mut input, |_, _| steady(&[loud, silent]));
        let leak = 20.0 * (answer(&reading, 1).codes / FULL_SCALE_CODES).log10();
        std::println!("{loud} Hz shows at {silent} Hz: {leak:.1} dBFS");
        assert!(leak < -90.0, "{loud} Hz shows at {silent} Hz with {leak} dBFS");
    }
}
