//! Where a window begins and ends, what breaks it, and the largest sums.
use super::*;
use crate::bank::MAX_STEP_CHANGE;
use crate::lock_in::{MAX_WINDOW_BLOCKS, Span, StartError};

const LOUD: [u16; BLOCK] = [4095; BLOCK];

/// One tone of a quarter of the rate over a block.
fn one_tone() -> [ToneBlock; TONES] {
    steady(&[100_000.0])
}

/// A lock-in that waits for `blocks` blocks from 256 on.
fn waiting(blocks: u16) -> (LockIn, History) {
    let mut lock_in = LockIn::new();
    let window = Window { begin: 256, blocks, shape: Shape::Rectangular, slots: 1, input: None };
    lock_in.start(window, 0).expect("the window can be measured");
    (lock_in, History::new())
}

/// Plays the tone over the block at `index`, in which the input has these codes.
fn play(lock_in: &mut LockIn, history: &mut History, index: u64, codes: &[u16; BLOCK]) {
    history.record(index, &[0; TONES], &one_tone());
    lock_in.take_block(index, &[*codes], history.at(index));
}

/// The sums of one block, in doubles.
fn direct(phase: u64, tone: &ToneBlock, codes: &[u16; BLOCK]) -> (f64, f64) {
    codes.iter().enumerate().fold((0.0, 0.0), |(i, q), (n, code)| {
        let angle = TAU * phase.wrapping_add(tone.phase_gain(n as u32)) as f64 / TURN;
        let x = (f64::from(*code) - 2048.0) * f64::from(BASIS_ONE) / 2.0;
        (i + x * angle.sin(), q + x * angle.cos())
    })
}

#[test]
fn nothing_outside_the_window_counts_and_everything_inside_does() {
    // One code off mid-scale, at each sample in turn, in the blocks about the window's edges.
    for (index, counts) in [(128, false), (256, true), (384, true), (512, false)] {
        for n in [0, 1, 63, 64, 126, 127] {
            let (mut lock_in, mut history) = waiting(2);
            for block in [0, 128, 256, 384, 512] {
                let mut codes = [2048; BLOCK];
                codes[n] += if block == index { 1000 } else { 0 };
                play(&mut lock_in, &mut history, block, &codes);
            }
            assert_eq!(lock_in.state(), State::Finished);
            let sum = lock_in.reading().sums[0][0];
            let size = (sum.in_phase as f64).hypot(sum.quadrature as f64) / 32_768.0;
            let wanted = if counts { 1000.0 * f64::from(BASIS_ONE) / 2.0 } else { 0.0 };
            assert!(
                (size - wanted).abs() <= wanted * 1e-3 + 32.0,
                "sample {n} at {index}: {size}, not {wanted}"
            );
        }
    }
}

#[test]
fn the_sums_match_the_definition() {
    let mut seed = 3_u64;
    let mut draw = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        seed ^ (seed >> 29)
    };
    for round in 0..200 {
        let step = draw() / 20 * 9;
        // Up to a quarter of the fastest glide: 0.005 rad at the ends of a sub-block.
        let (change, within) = if round % 2 == 0 { (0, 1e-5) } else { (draw() >> 12, 6e-4) };
        let tone = ToneBlock { step_end: step.wrapping_add(change), ..ToneBlock::steady(step, 1) };
        let (phase, mut tones) = (draw(), [ToneBlock::default(); TONES]);
        tones[7] = tone;
        let codes = core::array::from_fn(|_| (draw() >> 52) as u16);
        let (mut lock_in, mut history) = (LockIn::new(), History::new());
        lock_in
            .start(Window { slots: 1 << 7, ..window(1, Shape::Rectangular) }, 0)
            .expect("the window can be measured");
        history.record(0, &[phase; TONES], &tones);
        lock_in.take_block(0, &[[0; BLOCK], codes], history.at(0));
        let sum = lock_in.reading().sums[1][7];
        let (i, q) = direct(phase, &tone, &codes);
        let off = (sum.in_phase as f64 / 32_768.0 - i).hypot(sum.quadrature as f64 / 32_768.0 - q);
        // Of codes at random, rms 1182, over 128 samples.
        assert!(off < within * 1182.0 * 128.0 * f64::from(BASIS_ONE) / 2.0, "{off}");
    }
}

#[test]
fn the_largest_sums_do_not_overflow() {
    // Constant phases and square waves in phase with the tone: nothing is larger. Then the same in the fastest glides,
    // which lead away from the largest phase on both sides, or over the ends of the range.
    let steady = [(0_u64, 1_u64 << 62), (0, 1 << 61), (0, 3 << 62), (1 << 56, 0), (1 << 58, 1 << 57)];
    let cases = steady.into_iter().flat_map(|(step, phase)| {
        [0, MAX_STEP_CHANGE, MAX_STEP_CHANGE.wrapping_neg()].map(|change| {
            // The middle of the block has the step.
            let begin = step.wrapping_sub((change.cast_signed() / 2).cast_unsigned());
            let tone = ToneBlock { step_end: begin.wrapping_add(change), ..ToneBlock::steady(begin, 1) };
            // And the phase.
            (tone, if change == 0 { phase } else { phase.wrapping_sub(tone.phase_gain(64)) })
        })
    });
    for (tone, phase) in cases {
        for flip in [false, true] {
            let codes: [u16; BLOCK] = core::array::from_fn(|n| {
                let is_up = phase.wrapping_add(tone.phase_gain(n as u32)) < 1 << 63;
                if is_up == flip { 0 } else { 4095 }
            });
            let (i, q) = direct(phase, &tone, &codes);
            let (mut lock_in, mut history) = (LockIn::new(), History::new());
            lock_in.start(window(1, Shape::Rectangular), 0).expect("the window can be measured");
            history.record(0, &[phase; TONES], &[tone; TONES]);
            lock_in.take_block(0, &[codes], history.at(0));
            let sum = lock_in.reading().sums[0][0];
            let (of_i, of_q) = (sum.in_phase as f64 / 32_768.0 - i, sum.quadrature as f64 / 32_768.0 - q);
            // A glide's weights are 5.3e-4 off at worst, of at most 2^31.
            let within = if tone.is_steady() { 1e5 } else { 1.2e6 };
            assert!(of_i.abs() < within && of_q.abs() < within, "{tone:?}: {of_i} {of_q} of {i} {q}");
            // The longest window: as many blocks at most, of at most weight 1.
            let longest = i128::from(sum.in_phase) * i128::from(MAX_WINDOW_BLOCKS);
            assert!(i64::try_from(longest).is_ok());
        }
    }
}

#[test]
fn a_lost_block_breaks_the_measurement_and_says_where() {
    let (mut lock_in, mut history) = waiting(3);
    play(&mut lock_in, &mut history, 256, &LOUD);
    assert_eq!(lock_in.state(), State::Measuring);
    play(&mut lock_in, &mut history, 512, &LOUD);
    assert_eq!(lock_in.state(), State::Broken { at: 384 });
    assert_eq!(lock_in.reading().blocks, 1);
}

#[test]
fn a_block_whose_phases_are_forgotten_breaks_the_measurement() {
    let (mut lock_in, mut history) = waiting(3);
    for index in [256, 384, 512, 640, 768] {
        history.record(index, &[0; TONES], &one_tone());
    }
    lock_in.take_block(256, &[LOUD], history.at(256));
    assert_eq!(lock_in.state(), State::Broken { at: 256 });
}

#[test]
fn a_tone_that_is_silent_or_jumps_is_not_followed() {
    let tones = steady(&[100_000.0, 100_000.0, 100_000.0, 0.0]);
    let (mut lock_in, mut history) = (LockIn::new(), History::new());
    lock_in.start(window(2, Shape::Rectangular), 0).expect("the window can be measured");
    history.record(0, &[0; TONES], &tones);
    lock_in.take_block(0, &[LOUD], history.at(0));
    // A quarter of the rate gains whole turns in a block, but for the rounding of its step.
    let gain = tones[0].phase_gain(BLOCK as u32);
    let mut phases = [gain; TONES];
    phases[1] = gain + 1;
    let mut later = tones;
    (later[2].amplitude, later[2].amplitude_end) = (0, 0);
    phases[3] = 0;
    history.record(128, &phases, &later);
    lock_in.take_block(128, &[LOUD], history.at(128));
    assert_eq!(lock_in.reading().followed, 0b1001);
}

#[test]
fn the_span_of_the_codes_reveals_a_clipped_input() {
    let (mut lock_in, mut history) = waiting(2);
    let mut codes = [2048; BLOCK];
    (codes[3], codes[127]) = (17, 3000);
    play(&mut lock_in, &mut history, 256, &codes);
    assert_eq!(lock_in.reading().spans, [Some(Span { lowest: 17, highest: 3000 }), None]);
    codes[0] = 4095;
    play(&mut lock_in, &mut history, 384, &codes);
    assert_eq!(lock_in.reading().spans, [Some(Span { lowest: 17, highest: 4095 }), None]);
}

#[test]
fn an_input_has_the_same_sums_alone_and_beside_others() {
    let sensed = [core::array::from_fn(|n| 1000 + n as u16), core::array::from_fn(|n| 3000 - 7 * n as u16)];
    let measured = |input| {
        let (mut lock_in, mut history) = (LockIn::new(), History::new());
        lock_in.start(Window { input, ..window(1, Shape::Hann) }, 0).expect("the window can be measured");
        history.record(0, &[1 << 60; TONES], &steady(&frequencies()));
        lock_in.take_block(0, &sensed, history.at(0));
        assert_eq!(lock_in.state(), State::Finished);
        lock_in.reading().clone()
    };
    let both = measured(None);
    assert!(both.sums[0][0] != both.sums[1][0] && both.codes[0] != both.codes[1]);
    for (alone, other) in [(0, 1), (1, 0)] {
        let reading = measured(Some(alone as u8));
        assert_eq!(reading.sums[alone], both.sums[alone]);
        assert_eq!((reading.codes[alone], reading.spans[alone]), (both.codes[alone], both.spans[alone]));
        assert_eq!((reading.constant, reading.followed), (both.constant, both.followed));
        assert_eq!(reading.sums[other], [Default::default(); TONES]);
        assert_eq!((reading.codes[other], reading.spans[other]), (0, None));
        assert_eq!(reading.answer(other, 0), None, "it was not measured");
    }
    // An input that the board has not.
    assert_eq!(measured(Some(u8::MAX)).spans, [None, None]);
}

#[test]
fn a_window_that_cannot_be_measured_is_refused_and_the_last_reading_stays() {
    let (mut lock_in, mut history) = waiting(1);
    play(&mut lock_in, &mut history, 256, &LOUD);
    let (ok, before) = (Window { begin: 512, ..window(1, Shape::Hann) }, lock_in.reading().clone());
    for (window, error) in [
        (Window { begin: 500, ..ok }, StartError::WithinBlock),
        (Window { begin: 256, ..ok }, StartError::Past { earliest: 384 }),
        (Window { blocks: 0, ..ok }, StartError::Empty),
        (Window { begin: u64::MAX - 127, ..ok }, StartError::BeyondTime),
    ] {
        assert_eq!(lock_in.start(window, 384), Err(error));
        assert_eq!((lock_in.reading(), lock_in.state()), (&before, State::Finished));
    }
    assert_eq!(lock_in.start(ok, 384), Ok(()));
    assert_eq!(lock_in.state(), State::Measuring);
}
