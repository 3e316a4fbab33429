//! `cargo fuzz run --fuzz-dir tests --features fuzzing --sanitizer none load_measurement`
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| slipline_tests::fuzz::load_measurement(data));
