//! `cargo +nightly fuzz run --fuzz-dir tests --features fuzzing session`
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| slipline_tests::fuzz::session(data));
