//! `cargo +nightly fuzz run --fuzz-dir tests --features fuzzing decode`
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| slipline_tests::fuzz::decode(data));
