//! `cargo fuzz run --fuzz-dir tests --features fuzzing --sanitizer none program`
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| slipline_tests::fuzz::program(data));
