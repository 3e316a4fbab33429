//! `cargo fuzz run --fuzz-dir tests --features fuzzing --sanitizer none connection`
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| slipline_tests::fuzz::connection(data));
