//! `cargo fuzz run --fuzz-dir tests --features fuzzing --sanitizer none load_plate`
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| slipline_tests::fuzz::load_plate(data));
