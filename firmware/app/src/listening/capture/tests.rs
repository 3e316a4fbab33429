//! Captures of codes that count up, and the filter's response.
extern crate std;

use super::*;
use core::f64::consts::PI;
use std::boxed::Box;
use std::vec::Vec;

/// Memory for one capture.
fn memory() -> &'static Values {
    Box::leak(Box::new(Values::new()))
}

/// The code at an index: a hash of it, so that a block at another index has other codes.
fn code(index: u64) -> u16 {
    (index.wrapping_mul(2_654_435_761) >> 7) as u16 & 0xFFF
}

/// The block at an index: the first input is mid-scale, the second has the codes of [`code`].
fn block(index: u64) -> [[u16; BLOCK]; INPUTS] {
    [[2048; BLOCK], core::array::from_fn(|n| code(index + n as u64))]
}

fn recipe(begin: u64, log2_codes: u8, values: u16) -> Recipe {
    Recipe { begin, input: 1, log2_codes, values }
}

/// A capture of all that it asks for, from the block at 0 on.
fn captured(recipe: Recipe) -> Capture<'static> {
    let mut capture = Capture::new(memory());
    capture.start(recipe, 0, INPUTS).expect("it can be made");
    let end = recipe.begin + (u64::from(recipe.values) << recipe.log2_codes);
    for index in (0..end).step_by(BLOCK) {
        assert_eq!(capture.progress(), Progress::Running);
        capture.take_block(index, &block(index));
    }
    capture
}

#[test]
fn every_value_is_the_sum_of_its_codes_from_the_requested_index_on() {
    for (begin, log2_codes, values) in
        [(0, 0, 4096), (1, 0, 1), (127, 0, 2), (128, 1, 64), (300, 3, 1000), (5, 7, 9), (999, 10, 4096)]
    {
        let capture = captured(recipe(begin, log2_codes, values));
        assert_eq!(capture.progress(), Progress::Finished);
        let wanted: Vec<u32> = (0..u64::from(values))
            .map(|value| {
                (0..1 << log2_codes).map(|n| u32::from(code(begin + (value << log2_codes) + n))).sum()
            })
            .collect();
        assert_eq!(capture.values().collect::<Vec<_>>(), wanted, "{begin} {log2_codes} {values}");
    }
}

#[test]
fn a_lost_block_ends_the_capture_and_what_came_before_stays() {
    let mut capture = Capture::new(memory());
    capture.start(recipe(130, 2, 100), 0, INPUTS).expect("it can be made");
    for index in [0, 128, 256, 512] {
        capture.take_block(index, &block(index));
    }
    assert_eq!(capture.progress(), Progress::Broken { at: 384 });
    assert_eq!(capture.filled(), (384 - 130) / 4);
    capture.take_block(640, &block(640));
    assert_eq!(capture.filled(), (384 - 130) / 4);
}

#[test]
fn a_stop_keeps_what_has_been_captured() {
    let mut capture = Capture::new(memory());
    capture.start(recipe(0, 0, 300), 0, INPUTS).expect("it can be made");
    capture.take_block(0, &block(0));
    capture.stop();
    assert_eq!((capture.progress(), capture.filled()), (Progress::Broken { at: 128 }, 128));
}

#[test]
fn what_cannot_be_captured_is_refused_and_the_last_capture_stays() {
    let mut capture = captured(recipe(0, 0, 3));
    for (recipe, error) in [
        (recipe(127, 0, 1), CaptureError::Past { earliest: 128 }),
        (Recipe { input: 2, ..recipe(128, 0, 1) }, CaptureError::NoSuchInput { inputs: 2 }),
        (recipe(128, 11, 1), CaptureError::TooManyCodes),
        (recipe(128, 0, 0), CaptureError::Values),
        (recipe(128, 0, 4097), CaptureError::Values),
        (recipe(u64::MAX - 200, 0, 100), CaptureError::BeyondTime),
    ] {
        assert_eq!(capture.start(recipe, 128, INPUTS), Err(error));
        assert_eq!((capture.progress(), capture.filled()), (Progress::Finished, 3));
    }
    assert_eq!(capture.start(recipe(128, 10, 4096), 128, INPUTS), Ok(()));
    assert_eq!(capture.values().count(), 0);
}

/// The documented response in dB at a frequency in units of the values' rate.
fn response_db(codes: f64, frequency: f64) -> f64 {
    let angle = PI * frequency;
    20.0 * (angle.sin() / (codes * (angle / codes).sin())).abs().log10()
}

#[test]
fn the_filter_is_the_boxcar_that_the_documentation_states() {
    for log2_codes in [1_u8, 3, 6] {
        let codes = f64::from(1_u32 << log2_codes);
        for frequency in [0.01, 0.25, 0.5, 0.75] {
            // The values of a sine, compared with a sine of the same frequency by least squares over whole turns.
            let mut capture = Capture::new(memory());
            capture.start(recipe(0, log2_codes, 400), 0, INPUTS).expect("it can be made");
            for index in (0..400_u64 << log2_codes).step_by(BLOCK) {
                let codes = core::array::from_fn(|n| {
                    let turns = frequency * (index + n as u64) as f64 / codes;
                    (2048.0 + 2000.0 * (2.0 * PI * turns + 0.4).sin()).round() as u16
                });
                capture.take_block(index, &[codes, codes]);
            }
            let (mut re, mut im) = (0.0, 0.0);
            for (n, value) in capture.values().enumerate() {
                let (sine, cosine) = (2.0 * PI * frequency * n as f64).sin_cos();
                let x = f64::from(value) / codes - 2048.0;
                (re, im) = (re + x * cosine, im + x * sine);
            }
            // At half the rate the sine is its own mirror image: what is seen depends on its phase at the values' middle.
            if frequency != 0.5 {
                let db = 20.0 * (f64::hypot(re, im) / 200.0 / 2000.0).log10();
                assert!(
                    (db - response_db(codes, frequency)).abs() < 0.02,
                    "{codes} codes, {frequency}: {db} dB"
                );
            }
        }
    }
    let rounded = |codes, frequency| (10.0 * response_db(codes, frequency)).round() / 10.0;
    assert_eq!([2.0, 8.0, 1024.0].map(|codes| rounded(codes, 0.5)), [-3.0, -3.9, -3.9]);
    assert_eq!([2.0, 8.0, 1024.0].map(|codes| rounded(codes, 0.25)), [-0.7, -0.9, -0.9]);
}
