//! `cargo fuzz run --fuzz-dir tests --features fuzzing --sanitizer none load_setup`
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| slipline_tests::fuzz::load_setup(data));
